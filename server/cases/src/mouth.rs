//! The whole mouth with two hands at work: for measurements of what a tick costs in it, and of how well it is probed.

use std::path::Path;

use sulcus_core::Scene;
use sulcus_operator::bimanual::Bimanual;
use sulcus_operator::retraction::RetractionParams;
use sulcus_operator::tour_params::{TourParams, Visit};
use sulcus_scene::{BuildOptions, BuiltIn, compile_text};

/// The tooth that is probed, and its neighbours with theirs.
pub const PROBED: u8 = 36;
const NEAR: [u8; 4] = [34, 35, 36, 37];

/// The shipped mouth with a patient of that seed, all of the patient's teeth or four about the probed one, in contact at
/// `level`.
///
/// # Panics
/// When the shipped scene does not compile: a fault of this function.
pub fn mouth(seed: u64, four: bool, level: u8) -> Scene {
    let teeth = if four {
        format!("\nteeth = {NEAR:?}")
    } else {
        String::new()
    };
    let text = BuiltIn::Mouth
        .text()
        .replacen("seed = 1", &format!("seed = {seed}{teeth}"), 1)
        .replacen("tooth_level = 3", &format!("tooth_level = {level}"), 1)
        .replacen("tooth_levels = 3", &format!("tooth_levels = {level}"), 1);
    let (path, options) = (Path::new("mouth.toml"), BuildOptions::cached());
    let compiled = compile_text(&text, path, &options, &|_, _| {});
    compiled.expect("the shipped mouth").scene
}

/// Two hands for `seconds`: one walks round [`PROBED`], the other holds the tongue aside.
///
/// # Panics
/// When the scene has no such tooth or no tongue.
pub fn hands(scene: &Scene, seconds: f64) -> Bimanual {
    let params = TourParams {
        duration: seconds,
        ..TourParams::default()
    };
    let tour = [Visit::whole(PROBED)];
    let mirror = RetractionParams::default();
    Bimanual::new(scene, &tour, params, mirror, 1.0).expect("a tooth and a tongue")
}
