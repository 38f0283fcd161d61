//! Mouths of patients, and pairs of patients who look the same.

use std::path::Path;

use sulcus_core::Scene;
use sulcus_scene::anatomy::mouth;
use sulcus_scene::anatomy::patient::{Condition, Patient, Sides, ToothChart, generate};
use sulcus_scene::{BuildOptions, compile_text};

/// Tools of a scene file: a probe and a mirror.
const TOOLS: &str = "
[[tool]]
name = \"probe\"
kind = \"periodontal_probe\"
level = 3
levels = 4
park_mm = [60.0, 40.0, 140.0]

[[tool]]
name = \"mirror\"
kind = \"mouth_mirror\"
level = 3
levels = 3
stiffness_nmm_per_rad = 3000.0
park_mm = [60.0, -40.0, 140.0]
";

/// Compiles the mouth of a patient with these teeth.
pub fn compiled(patient: &Patient, teeth: &[u8]) -> Scene {
    let folder = tempfile::tempdir().expect("folder");
    std::fs::write(folder.path().join("patient.toml"), patient.to_toml()).expect("written");
    let text = format!(
        "name = \"mouth\"\n[mouth]\npatient = \"patient.toml\"\nteeth = {teeth:?}\ntooth_level = 3\ntooth_levels = 3\n{TOOLS}"
    );
    let file = folder.path().join("scene.toml");
    compiled_text(&text, &file)
}

/// Compiles a scene file.
pub fn compiled_text(text: &str, file: &Path) -> Scene {
    let options = BuildOptions::cached();
    compile_text(text, file, &options, &|_, _| ())
        .expect("a scene")
        .scene
}

/// Returns a patient who looks like `seen`, margins and inflammation included, with other hidden values from numbers of
/// 0 to 1. `None`: the mouth has no room for them.
pub fn disguised(seen: &Patient, hidden: &[f64]) -> Option<Patient> {
    let mut numbers = hidden.iter().cycle().copied();
    let mut next = move || numbers.next().unwrap_or(0.5);
    let mut other = seen.clone();
    other.name = format!("another patient {}", next());
    other.teeth = seen
        .teeth
        .iter()
        .map(|chart| disguised_tooth(chart, &mut next))
        .collect();
    mouth::check(&other).is_ok().then_some(other)
}

fn disguised_tooth(seen: &ToothChart, next: &mut impl FnMut() -> f64) -> ToothChart {
    let recession = seen.recession_mm.round();
    let depth = |recession: f64, next: &mut dyn FnMut() -> f64| {
        // The attachment loss is at most 9 mm.
        let most = (9.0 - recession).min(7.0);
        1.2 + (most - 1.2) * next()
    };
    let depths = recession.map(|recession| depth(recession, next));
    let loss = |k: usize| depths[k] + recession[k];
    let is_molar = seen.fdi % 10 >= 6;
    let degree = |k: usize, next: &mut dyn FnMut() -> f64| {
        let opens = is_molar && loss(k) > 5.5;
        if opens { (next() * 3.0) as u8 } else { 0 }
    };
    let mut chart = ToothChart {
        depth_mm: Sides::from_round(depths),
        bleeding: Sides::from_round([(); 6].map(|()| next() < 0.5)),
        mobility: (next() * 3.0) as u8,
        ..seen.clone()
    };
    chart.furcation.buccal = degree(1, next);
    chart.furcation.lingual = degree(4, next);
    chart
}

/// Generated patient of any condition.
pub fn any_patient(seed: u64) -> Patient {
    generate(seed, Condition::ALL[(seed % 3) as usize])
}
