//! The whole mouth with two hands at work: for measurements of what a tick costs in it, and of how well it is probed.

use std::path::Path;
use std::sync::Mutex;

use sulcus_core::{Object, Scene};
use sulcus_operator::bimanual::Bimanual;
use sulcus_operator::habit::Habit;
use sulcus_operator::retraction::RetractionParams;
use sulcus_operator::tour_params::{TourParams, Visit};
use sulcus_scene::instruments::Probe;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::{BuildOptions, BuiltIn, compile_text};

use crate::inside::{Points, allowed_inside, solid_of};
use crate::toured::{Toured, perform};

/// The tooth that is probed, and its neighbours with theirs.
pub const PROBED: u8 = 36;
const NEAR: [u8; 4] = [34, 35, 36, 37];

/// What [`mouth`] was asked for last, and what it gave.
type Built = ((u64, bool, u8), Scene);

/// The shipped mouth with a patient of that seed, all of the patient's teeth or four about the probed one, in contact at
/// `level`.
///
/// # Panics
/// When the shipped scene does not compile: a fault of this function.
pub fn mouth(seed: u64, four: bool, level: u8) -> Scene {
    // Compiling one takes seconds, and several measurements want the same.
    static BUILT: Mutex<Option<Built>> = Mutex::new(None);
    let mut built = BUILT.lock().expect("no build panicked");
    if let Some((key, scene)) = &*built
        && *key == (seed, four, level)
    {
        return scene.clone();
    }
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
    let scene = compiled.expect("the shipped mouth").scene;
    *built = Some(((seed, four, level), scene.clone()));
    scene
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

/// How well one operator charted one mouth.
#[derive(Debug)]
pub struct Examined {
    /// Zone by zone.
    pub toured: Toured,
    /// By tooth: FDI number, the deepest that the probe was inside its mesh (negative: outside) and the most that the
    /// trees' stated errors allow, metres.
    pub inside: Vec<(u8, f64, f64)>,
}

/// Ticks between two measurements against the meshes.
const SAMPLED: u64 = 20;
/// Points on the probe, metres apart, and how far up its working end.
const POINTS: (f64, f64) = (2e-4, 14e-3);
/// Farthest from a tooth's middle that a tip can be with anything of the probe in reach of the tooth, metres.
const NEARBY: f64 = 25e-3;

/// Every tooth among `teeth` (none: all) probed all round with both hands by an operator with that habit, or a good one.
///
/// # Panics
/// When the scene is no mouth: no such tooth, no tongue, no probe and mirror.
pub fn examine(scene: &Scene, teeth: &[u8], habit: Option<Habit>) -> Examined {
    let wanted = |object: &&Object| {
        object.tissue.is_rigid()
            && object.fdi != 0
            && (teeth.is_empty() || teeth.contains(&object.fdi))
    };
    let solids: Vec<(&Object, MeshDistance)> = scene
        .objects
        .iter()
        .filter(wanted)
        .map(|object| (object, solid_of(&object.mesh)))
        .collect();
    let mut params = TourParams::default();
    let mut tour: Vec<Visit> = solids
        .iter()
        .map(|(object, _)| Visit::whole(object.fdi))
        .collect();
    if let Some(habit) = habit {
        habit.spoil(&mut params, &mut tour, 3);
    }
    let until = Habit::holds_until(habit);
    let mirror = RetractionParams::default();
    let script = Bimanual::new(scene, &tour, params, mirror, until).expect("a mouth");
    let slot = scene
        .tools
        .iter()
        .position(|tool| !tool.bands.is_empty())
        .expect("a probe");
    let tool = &scene.tools[slot];
    // (It is shown with its handle.)
    let surface = MeshDistance::new(Probe::default().touching_mesh());
    let near = |point: &sulcus_core::Vec3| (point - tool.tip).norm() < POINTS.1;
    let points = Points::of(surface.mesh(), POINTS.0, near);
    let mut deepest = vec![f64::NEG_INFINITY; solids.len()];
    let toured = perform(scene, Box::new(script), (slot, 7), |output| {
        let pose = &output.tools[slot].graphic;
        if output.tick % SAMPLED != 0 {
            return;
        }
        for (deepest, (object, solid)) in deepest.iter_mut().zip(&solids) {
            let middle = object.tree.nodes()[0].centre;
            if (pose.transform(&tool.tip) - middle).norm() < NEARBY {
                *deepest = points.deepest_inside(solid, pose, *deepest);
            }
        }
    });
    let inside = solids.iter().zip(deepest).map(|((object, solid), inside)| {
        let allowed = allowed_inside((object, solid), (tool, &surface));
        (object.fdi, inside, allowed)
    });
    Examined {
        inside: inside.collect(),
        toured,
    }
}
