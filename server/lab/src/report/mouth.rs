//! The whole mouth with two hands at work: does it hold a kilohertz here, and how far is it from the drawn teeth?

use std::sync::LazyLock;

use serde::Serialize;
use sulcus_cases::inside::solid_of;
use sulcus_cases::mouth::{PROBED, hands, mouth};
use sulcus_cases::record;
use sulcus_cases::statistics::percentile;
use sulcus_core::{MAX_TOOLS, Object, Scene, TickInput};
use sulcus_operator::HandParams;
use sulcus_scene::tree::blend::{BlendError, blend_error};

use super::shipped::SEED;
use super::times::Times;

/// When both hands are at work, and how long is measured from then on, seconds.
const BEGINS: f64 = 7.0;
const SECONDS: f64 = 10.0;
/// Time for the hands to leave, seconds.
const LEAVING: f64 = 8.0;
/// Level of the teeth in the mouth as it is shipped.
const SHIPPED_LEVEL: u8 = 3;
/// A patient with all teeth.
const PATIENT: u64 = 1;
/// Radius of a probe's tip, metres: what the error of a blended surface is measured with.
const TIP: f64 = 2.5e-4;

/// The mouth at one level of its teeth.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Level {
    pub(crate) level: u8,
    /// Spheres of the probed molar.
    pub(crate) spheres: usize,
    /// Distance of the molar as it is touched from the molar as it is drawn, micrometres: mean and largest.
    pub(crate) tooth_error_mean_um: f64,
    pub(crate) tooth_error_max_um: f64,
    #[serde(flatten)]
    pub(crate) times: Times,
    /// Share of the measured ticks in which each tool bears load, percent.
    pub(crate) in_contact_percent: Vec<f64>,
    pub(crate) max_hz: f64,
    /// Microseconds at each of [`SHARES`] of ticks that take longer, one run: what the curve is drawn from.
    pub(crate) longer_than_us: Vec<f64>,
}

/// Shares of ticks, of the curve.
pub(crate) const SHARES: [f64; 10] = [0.9, 0.7, 0.5, 0.3, 0.1, 0.05, 0.01, 0.003, 0.001, 0.0001];

/// What was measured in it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Mouth {
    pub(crate) patient: u64,
    pub(crate) objects: usize,
    pub(crate) levels: Vec<Level>,
}

/// The mouth as it is shipped, built once: it takes seconds, and three parts of the report want it.
pub(super) fn shipped() -> &'static Scene {
    static SHIPPED: LazyLock<Scene> = LazyLock::new(|| mouth(PATIENT, false, SHIPPED_LEVEL));
    &SHIPPED
}

/// Measures it.
pub(super) fn measure(quick: bool, progress: &dyn Fn(&str, f64)) -> Mouth {
    let levels: &[u8] = if quick {
        &[SHIPPED_LEVEL]
    } else {
        &[4, 2, SHIPPED_LEVEL]
    };
    let mut objects = 0;
    progress("two hands", 0.0);
    let hand = one_hand();
    let measured = levels.iter().enumerate().map(|(k, &level)| {
        let share = |of: f64| (k as f64 + of) / levels.len() as f64;
        progress(&format!("building it at level {level}"), share(0.0));
        let built;
        let scene = if level == SHIPPED_LEVEL {
            shipped()
        } else {
            built = mouth(PATIENT, false, level);
            &built
        };
        objects = scene.objects.len();
        progress(&format!("two hands at level {level}"), share(0.5));
        at_level(scene, level, &hand, if quick { 1 } else { 5 })
    });
    let mut levels: Vec<Level> = measured.collect();
    levels.sort_by_key(|level| level.level);
    Mouth {
        patient: PATIENT,
        objects,
        levels,
    }
}

/// What two hands do in the shipped mouth: every level is given the same, so that nothing but the level differs.
fn one_hand() -> Vec<TickInput> {
    let scene = shipped();
    let ticks = ((BEGINS + SECONDS) / scene.tick_s()).round() as u64;
    let script = hands(scene, BEGINS + SECONDS + LEAVING);
    let hand = (HandParams::default(), SEED);
    record(scene, Box::new(script), hand, ticks, |_, _| {})
}

/// How far an object as it is touched is from it as it is drawn, millimetres.
pub(super) fn off_drawn(object: &Object) -> BlendError {
    blend_error(&object.tree, object.level, &solid_of(&object.mesh), TIP)
}

fn at_level(scene: &Scene, level: u8, inputs: &[TickInput], runs: usize) -> Level {
    let molar = scene
        .objects
        .iter()
        .find(|object| object.fdi == PROBED && object.tissue.is_rigid())
        .expect("the patient has the molar");
    let error = off_drawn(molar);
    let begins = (BEGINS / scene.tick_s()).round() as usize;
    let mut contact = [0_usize; MAX_TOOLS];
    let counts = |k| k >= begins;
    let times = Times::of(scene, inputs, runs, counts).with_stages(scene, inputs, counts);
    let run = sulcus_cases::timing::time(scene, inputs, |k, output| {
        for (contact, tool) in contact.iter_mut().zip(&output.tools) {
            *contact += usize::from(tool.active > 0 && k >= begins);
        }
    });
    let mut cpu = run.cpu[begins..].to_vec();
    cpu.sort_unstable();
    let at = |share: f64| percentile(&cpu, 1.0 - share).map_or(0.0, |ns| ns as f64 * 1e-3);
    Level {
        level,
        spheres: molar.tree.shape_at(level).count(),
        tooth_error_mean_um: error.mean * 1e3,
        tooth_error_max_um: error.max * 1e3,
        in_contact_percent: contact
            .iter()
            .map(|n| 100.0 * *n as f64 * scene.tick_s() / SECONDS)
            .collect(),
        max_hz: times.rate_hz(),
        longer_than_us: SHARES.map(at).to_vec(),
        times,
    }
}
