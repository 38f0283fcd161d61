//! Poses made up at random: what comes of them.

use serde::Serialize;
use sulcus_cases::fuzz::ALL;

use super::together::on_all_cores;

/// One scene under them.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Rough {
    pub(crate) scene: &'static str,
    pub(crate) ticks: u64,
    pub(crate) contact_ticks: u64,
    /// Ticks in which a number that is not finite came out.
    pub(crate) not_finite: u64,
    /// Tool-ticks in which the tick met one itself, and sent nothing.
    pub(crate) faults: u64,
    pub(crate) bad_input: u64,
    pub(crate) exhausted_ticks: u64,
    /// Their share of the tools' ticks, and whether it and the overlap meanwhile are within the scene's bounds.
    pub(crate) exhausted_percent: f64,
    pub(crate) keeps_up: bool,
    pub(crate) solver_failed: u64,
    pub(crate) residual_um: f64,
    pub(crate) exhausted_residual_um: f64,
    pub(crate) slow_force_step_n: f64,
    pub(crate) max_force_n: f64,
}

impl Rough {
    /// Whether all holds that must.
    pub(crate) fn holds(&self) -> bool {
        let finite = self.not_finite == 0 && self.faults == 0;
        finite && self.keeps_up && self.residual_um <= 1.0 && self.slow_force_step_n <= 0.02 + 1e-9
    }
}

/// Measures them all.
pub(super) fn measure(quick: bool, progress: &dyn Fn(&str, f64)) -> Vec<Rough> {
    let ticks = if quick { 1_000 } else { 10_000 };
    let numbered: Vec<_> = ALL.iter().enumerate().collect();
    on_all_cores(&numbered, &|share| progress("", share), |(k, fuzz)| {
        let found = fuzz.run(*k as u64, ticks, |_| {});
        let m = &found;
        Rough {
            scene: fuzz.name,
            ticks: m.ticks,
            contact_ticks: m.contact_ticks,
            not_finite: m.not_finite,
            faults: m.faults,
            bad_input: m.bad_input,
            exhausted_ticks: m.exhausted,
            exhausted_percent: 100.0 * fuzz.exhausted_share(m),
            keeps_up: fuzz.keeps_up(m, 1.0),
            solver_failed: m.solver_failed,
            residual_um: m.residual * 1e6,
            exhausted_residual_um: m.exhausted_residual * 1e6,
            slow_force_step_n: m.slow_force_step,
            max_force_n: m.max_force,
        }
    })
}
