//! Many teeth and a tongue, for measurements of what a tick costs in a whole mouth: copies of one molar with its gingiva
//! in a row, the tongue beside them, a probe and a mirror, and two hands at work.
//!
//! The trees are those of the shipped scenes, so whoever has these built has them all.

use std::path::Path;

use sulcus_core::Scene;
use sulcus_operator::probing::{Probing, ProbingParams};
use sulcus_operator::retraction::{Retraction, RetractionParams};
use sulcus_operator::script::Both;
use sulcus_scene::{BuildOptions, BuiltIn, compile_text};

/// Numbers of the teeth, the one that is probed first.
const FDI: [u8; 14] = [36, 35, 37, 34, 33, 32, 31, 41, 42, 43, 44, 45, 46, 47];
/// The tooth that is probed.
pub const PROBED: u8 = FDI[0];
/// Distance from tooth to tooth, mm.
const SPACING_MM: f64 = 12.0;
/// Where the tongue lies: lingually of the row, its back a little above the teeth's necks, mm.
const TONGUE_MM: [f64; 3] = [0.0, -36.0, -24.0];

/// A scene of `teeth` (1 to 14) molars, each with its gingiva, all in contact at `level`; the probed one stands in the
/// middle, at the same place whatever their number.
///
/// # Panics
/// When the shipped scenes do not compile: a fault of this function.
pub fn row(teeth: usize, level: u8) -> Scene {
    let part = |of: BuiltIn, kind: &str| -> String {
        let parts = of.text().split("\n[[").skip(1);
        let mut parts = parts.filter(|part| part.contains(&format!("kind = \"{kind}\"")));
        format!("\n[[{}\n", parts.next().expect("a part of that kind"))
    };
    let mut text = String::from("name = \"row\"\n");
    text += &part(BuiltIn::Pocket, "periodontal_probe");
    text += &part(BuiltIn::Tongue, "mouth_mirror");
    let tooth = part(BuiltIn::Pocket, "molar").replace("level = 3", &format!("level = {level}"));
    let gingiva = part(BuiltIn::Pocket, "gingiva");
    for (k, fdi) in FDI.iter().enumerate().take(teeth) {
        // 0, 1, -1, 2, -2, ...: the neighbours come first.
        let places = k.div_ceil(2) as f64 * if k % 2 == 1 { 1.0 } else { -1.0 };
        let x = SPACING_MM * places;
        let numbered = |part: &str| part.replace("36", &fdi.to_string());
        let placed = numbered(&tooth).replacen(
            "tissue =",
            &format!("translate_mm = [{x:?}, 0.0, 0.0]\ntissue ="),
            1,
        );
        text += &placed;
        text += &numbered(&gingiva);
    }
    text += &part(BuiltIn::Tongue, "tongue").replacen(
        "tissue =",
        &format!("translate_mm = {TONGUE_MM:?}\ntissue ="),
        1,
    );
    let compiled = compile_text(
        &text,
        Path::new("row.toml"),
        &BuildOptions::cached(),
        &|_, _| {},
    );
    compiled.expect("parts of the shipped scenes").scene
}

/// Two hands for `seconds`: one probes [`PROBED`], the other holds the tongue aside.
///
/// # Panics
/// When the scene has no such tooth or no tongue.
pub fn hands(scene: &Scene, seconds: f64) -> Both<Probing, Retraction> {
    let probing = ProbingParams {
        duration: seconds,
        ..ProbingParams::default()
    };
    let retraction = RetractionParams {
        duration: seconds,
        ..RetractionParams::default()
    };
    Both(
        Probing::new(scene, Some(PROBED), probing).expect("a tooth with a pocket"),
        Retraction::new(scene, retraction).expect("a tongue and a mirror"),
    )
}
