//! The shipped scenes at 1, 2 and 4 kHz: what a tick takes at each, and which of them this machine holds.

use std::path::Path;

use serde::Serialize;
use sulcus_cases::{Observer, Played, mouth, record};
use sulcus_core::Scene;
use sulcus_operator::HandParams;
use sulcus_operator::crown::{Crown, CrownParams};
use sulcus_operator::retraction::{Retraction, RetractionParams};
use sulcus_operator::script::Script;
use sulcus_operator::tour::Tour;
use sulcus_operator::tour_params::{TourParams, Visit};
use sulcus_scene::{BuildOptions, BuiltIn, compile_text};

use super::times::Times;

/// Ticks a second; the first and the last in a quick report.
pub(crate) const RATES: [u16; 3] = [1000, 2000, 4000];
/// Time until the hands are at work, seconds, and how long is measured from then on, in a full report and in a quick one.
const BEGINS: f64 = 2.5;
const SECONDS: [f64; 2] = [8.0, 2.0];
/// Time between two looks at the residual (all pairs of spheres: it takes longer than a tick), seconds, in a full report and in a quick
/// one; the page says so.
pub(crate) const LOOKS_S: [f64; 2] = [4e-3, 16e-3];
/// The same in the whole mouth, where the mirror comes first.
const MOUTH_BEGINS: f64 = 7.0;
/// The hands come out of the mouth after what is measured.
const LEAVING: f64 = 8.0;

/// One scene at one rate.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Rate {
    pub(crate) scene: &'static str,
    pub(crate) rate_hz: u16,
    #[serde(flatten)]
    pub(crate) times: Times,
    /// The time that a tick has, microseconds.
    pub(crate) period_us: f64,
    /// Whether 99.9 % of the ticks keep to it.
    pub(crate) holds: bool,
    /// Rate that 99.9 % of these ticks would keep, hertz.
    pub(crate) max_hz: f64,
    /// Mean over the ticks in contact, newtons, both hands' together: the same at any rate but for the hand's own way.
    pub(crate) force_n: f64,
    pub(crate) residual_um: f64,
    pub(crate) slow_force_step_n: f64,
    pub(crate) buzz_n: f64,
}

type Make = (
    &'static str,
    f64,
    fn() -> Scene,
    fn(&Scene, f64) -> Box<dyn Script + Send>,
);

const SCENES: [Make; 5] = [
    (
        "crown",
        BEGINS,
        || built_in(BuiltIn::Crown),
        |scene, duration| {
            let params = CrownParams {
                duration,
                ..CrownParams::default()
            };
            Box::new(Crown::new(scene, None, params).expect("a crown"))
        },
    ),
    (
        "pocket",
        BEGINS,
        || built_in(BuiltIn::Pocket),
        |scene, duration| {
            let params = TourParams {
                duration,
                ..TourParams::default()
            };
            let tour = [Visit::whole(mouth::PROBED)];
            Box::new(Tour::new(scene, &tour, params).expect("a pocket"))
        },
    ),
    ("tongue", BEGINS, || built_in(BuiltIn::Tongue), retraction),
    ("organ", BEGINS, || built_in(BuiltIn::Organ), retraction),
    (
        "mouth",
        MOUTH_BEGINS,
        || super::mouth::shipped().clone(),
        |scene, duration| Box::new(mouth::hands(scene, duration)),
    ),
];

fn built_in(which: BuiltIn) -> Scene {
    let compiled = compile_text(
        which.text(),
        Path::new("shipped.toml"),
        &BuildOptions::cached(),
        &|_, _| {},
    );
    compiled.expect("a shipped scene").scene
}

fn retraction(scene: &Scene, duration: f64) -> Box<dyn Script + Send> {
    let params = RetractionParams {
        duration,
        ..RetractionParams::default()
    };
    Box::new(Retraction::new(scene, params).expect("a tongue and a mirror"))
}

/// Measures them all.
pub(super) fn measure(quick: bool, progress: &dyn Fn(&str, f64)) -> Vec<Rate> {
    let tried: Vec<u16> = if quick {
        vec![RATES[0], RATES[RATES.len() - 1]]
    } else {
        RATES.to_vec()
    };
    let all = SCENES.len() * tried.len();
    let mut rates = Vec::with_capacity(all);
    for (name, begins, scene, script) in SCENES {
        let mut scene = scene();
        for &rate_hz in &tried {
            progress(
                &format!("{name} at {rate_hz} Hz"),
                rates.len() as f64 / all as f64,
            );
            scene.params.rate_hz = rate_hz;
            let ends = begins + SECONDS[usize::from(quick)];
            let script = script(&scene, ends + LEAVING);
            rates.push(one(name, &scene, script, (begins, ends), quick));
        }
    }
    rates
}

fn one(
    name: &'static str,
    scene: &Scene,
    script: Box<dyn Script + Send>,
    (begins, ends): (f64, f64),
    quick: bool,
) -> Rate {
    let params = &scene.params;
    let (from, to) = (params.ticks_in(begins), params.ticks_in(ends));
    let hand = (HandParams::default(), 7);
    let (mut force, mut touching) = (0.0, 0_u64);
    let mut observer = Observer::new(scene);
    observer.residual_every = params.ticks_in(LOOKS_S[usize::from(quick)]);
    let inputs = record(scene, script, hand, to, |k, played| {
        let Played {
            input,
            output,
            workspace,
        } = played;
        observer.observe(scene, input, output, workspace);
        let sum: f64 = output
            .tools
            .iter()
            .map(|tool| tool.raw_wrench.force.norm())
            .sum();
        if k >= from && sum > 0.0 {
            force += sum;
            touching += 1;
        }
    });
    let runs = if quick { 1 } else { 3 };
    let times = Times::of(scene, &inputs, runs, |k| k as u64 >= from);
    let measures = observer.measures();
    let period_us = scene.tick_s() * 1e6;
    Rate {
        scene: name,
        rate_hz: params.rate_hz,
        period_us,
        holds: times.tick_us.p999 <= period_us,
        max_hz: times.rate_hz(),
        times,
        force_n: force / touching.max(1) as f64,
        residual_um: measures.residual * 1e6,
        slow_force_step_n: measures.slow_force_step,
        buzz_n: measures.buzz,
    }
}
