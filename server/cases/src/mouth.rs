//! The whole mouth with two hands, for measurements of a tick's duration and of the accuracy of probing.

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

/// FDI number of the probed tooth.
pub const PROBED: u8 = 36;
/// FDI numbers of the probed tooth and its neighbours.
const NEAR: [u8; 4] = [34, 35, 36, 37];

/// Arguments and result of the last call of [`mouth`].
type Built = ((u64, bool, u8), Scene);

/// The shipped mouth with the generated patient of `seed` and teeth at the level of detail `level`. With `four`, the
/// mouth has only four teeth, about the probed one.
///
/// # Panics
/// The shipped scene does not compile, which is a fault of this function.
pub fn mouth(seed: u64, four: bool, level: u8) -> Scene {
    // A scene takes seconds to compile, and several measurements use the same one.
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

/// Script of two hands for `seconds`: one probes [`PROBED`] all round, the other holds the tongue aside.
///
/// # Panics
/// The scene has no such tooth or no tongue.
pub fn hands(scene: &Scene, seconds: f64) -> Bimanual {
    let params = TourParams {
        duration: seconds,
        ..TourParams::default()
    };
    let tour = [Visit::whole(PROBED)];
    let mirror = RetractionParams::default();
    Bimanual::new(scene, &tour, params, mirror, 1.0).expect("a tooth and a tongue")
}

/// Accuracy of one operator in one mouth.
#[derive(Debug)]
pub struct Examined {
    /// Readings of each zone.
    pub toured: Toured,
    /// For each tooth: FDI number, largest depth of the probe inside the tooth's mesh, and largest depth by the stated
    /// errors of the trees, metres. A negative depth is outside.
    pub inside: Vec<(u8, f64, f64)>,
}

/// Number of ticks from one measurement with the meshes to the next.
const SAMPLED: u64 = 20;
/// Distance between points on the probe, and length of the working end that has points, metres.
const POINTS: (f64, f64) = (2e-4, 14e-3);
/// Largest distance of the tip from a tooth's centre at which the probe can touch the tooth, metres.
const NEARBY: f64 = 25e-3;

/// Result of an operator who probes `teeth` all round with both hands, with `habit` or well. An empty list means all
/// teeth.
///
/// # Panics
/// The scene lacks such a tooth, a tongue, a probe or a mirror.
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
    // The display mesh includes the handle.
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
