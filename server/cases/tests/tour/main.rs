//! The simulated operator probes whole teeth: well, and badly in named ways.

mod charted;

use charted::{perform, print};
use sulcus_core::Scene;
use sulcus_core::tissue::gingiva::Site;
use sulcus_operator::tour::Tour;
use sulcus_operator::tour_params::{TourParams, Visit};
use sulcus_scene::{BuildOptions, compile_text};

/// The teeth `fdis` of a generated patient, with a probe.
fn mouth(seed: u64, fdis: &[u8]) -> Scene {
    let text = format!(
        r#"
name = "part of a mouth"
[mouth]
condition = "periodontitis"
seed = {seed}
teeth = {fdis:?}
[[tool]]
name = "probe"
kind = "periodontal_probe"
level = 3
levels = 4
park_mm = [0.0, 0.0, 140.0]
"#
    );
    compile_text(&text, "part.toml".as_ref(), &BuildOptions::cached(), &|_, _| {})
        .expect("compiles")
        .scene
}

#[test]
fn a_whole_tooth_is_charted() {
    let scene = if std::env::var("LONE").is_ok() {
        sulcus_cases::tissue_scenes::changed(sulcus_scene::BuiltIn::Pocket, &[("depths_mm", "[5.0, 2.5, 4.0, 4.0, 2.0, 5.0]")])
    } else { mouth(1, &[35, 36, 37]) };
    let begin = std::time::Instant::now();
    let tour = Tour::new(&scene, &[Visit::whole(36)], TourParams::default()).expect("a tooth");
    println!("planned in {:?}", begin.elapsed());
    for path in tour.paths() {
        for degrees in (-180..=180).step_by(8) {
            let around = f64::from(degrees).to_radians();
            let tilts: Vec<String> = [-2e-3, 0.0, 2e-3, 4e-3, 6e-3]
                .iter()
                .map(|depth| {
                    let place = path.place(around, *depth, 0.0);
                    let frame = path.tooth();
                    format!(
                        "{:.0}/{:.0}",
                        libm::atan2(place.up.dot(&frame.mesial), place.up.dot(&frame.axis)).to_degrees(),
                        libm::atan2(place.up.dot(&frame.buccal), place.up.dot(&frame.axis)).to_degrees()
                    )
                })
                .collect();
            println!("{degrees:4} ceiling {:?} tilts {tilts:?}", path.ceiling(around).map(|c| c * 1e3));
        }
    }
    let charted = perform(&scene, Box::new(tour), 0, 7);
    print(&charted);
    assert!(charted.done);
    assert_eq!(charted.calls.len(), 6);
    for site in Site::ALL {
        let read = charted.of(36, site);
        assert!((read.reached - read.prescribed).abs() <= 0.3e-3, "{read:?}");
    }
}

#[test]
#[ignore = "long: the whole mouth"]
fn a_whole_mouth_is_charted() {
    let compiled = sulcus_scene::compile_file(
        concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/mouth.toml").as_ref(),
        &BuildOptions::cached(),
        &|_, _| {},
    );
    let scene = compiled.expect("compiles").scene;
    let mut teeth: Vec<u8> = scene.objects.iter().filter(|o| o.fdi != 0 && o.tissue.is_rigid()).map(|o| o.fdi).collect();
    if let Ok(only) = std::env::var("TEETH") {
        teeth.retain(|fdi| only.split(',').any(|t| t == fdi.to_string()));
    }
    let tour: Vec<Visit> = teeth.into_iter().map(Visit::whole).collect();
    let begin = std::time::Instant::now();
    let script = sulcus_operator::bimanual::Bimanual::new(&scene, &tour, TourParams::default(), Default::default(), 1.0).expect("a mouth");
    println!("planned in {:?}", begin.elapsed());
    let charted = perform(&scene, Box::new(script), 0, 7);
    print(&charted);
}
