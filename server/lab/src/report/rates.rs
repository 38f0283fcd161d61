//! The shipped scenes at 1, 2, 4 and 8 kHz: what a tick takes at each, and which of them this machine holds.

use serde::Serialize;
use sulcus_cases::{Observer, Played, record};
use sulcus_core::Scene;
use sulcus_operator::HandParams;
use sulcus_operator::script::Script;

use super::shipped::{SEED, SHIPPED};
use super::times::Times;

/// Ticks a second, up to what a scene may ask for; the first and the last but one in a quick report. Where a rate is not held, no higher one
/// is tried.
pub(crate) const RATES: [u16; 4] = [1000, 2000, 4000, 8000];
/// How long is measured from when the hands are at work, seconds, in a full report and in a quick one.
const SECONDS: [f64; 2] = [6.0, 1.5];
/// Time between two looks at the residual (all pairs of spheres: it takes longer than a tick), seconds, in a full report and in a quick
/// one; the page says so.
pub(crate) const LOOKS_S: [f64; 2] = [4e-3, 16e-3];

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

/// Measures them all.
pub(super) fn measure(quick: bool, progress: &dyn Fn(&str, f64)) -> Vec<Rate> {
    let tried: Vec<u16> = if quick {
        vec![RATES[0], RATES[RATES.len() - 2]]
    } else {
        RATES.to_vec()
    };
    let all = SHIPPED.len() * tried.len();
    let mut rates = Vec::with_capacity(all);
    for shipped in SHIPPED {
        let (name, begins) = (shipped.name, shipped.begins);
        let mut scene = (shipped.scene)();
        for &rate_hz in &tried {
            progress(
                &format!("{name} at {rate_hz} Hz"),
                rates.len() as f64 / all as f64,
            );
            scene.params.rate_hz = rate_hz;
            // (From 4 kHz on as many ticks as there.)
            let fewer = (4e3 / f64::from(rate_hz)).min(1.0);
            let ends = begins + SECONDS[usize::from(quick)] * fewer;
            let script = shipped.hands(&scene, ends);
            let rate = one(name, &scene, script, (begins, ends), quick);
            let held = rate.holds;
            rates.push(rate);
            if !held {
                break;
            }
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
    let hand = (HandParams::default(), SEED);
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
