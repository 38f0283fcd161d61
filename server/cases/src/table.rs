//! Table of the hard cases, one row each: scene, hand, bounds.

mod limits;
pub mod margin;
mod passing;
mod rigid;
mod squeezed;
pub(crate) mod tissue;

use sulcus_core::{Scene, TickInput};
use sulcus_operator::{HandParams, Script};

use crate::measure::Measures;
use margin::Moment;

/// Maker of a script for a scene.
pub type MakeScript = fn(&Scene) -> Box<dyn Script + Send>;

/// Driver of the tools.
#[derive(Clone, Copy)]
pub enum Driver {
    /// The haptic pose is the target of the script. The script still perceives, but no hand yields to the wrench and
    /// hides a number.
    Kinematic(MakeScript),
    /// A hand with its device, which feels the wrench and follows the script.
    Closed(MakeScript, fn() -> HandParams),
}

/// Bounds of a case, SI units. The names are those of [`Measures`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Largest residual of converged ticks.
    pub residual: f64,
    /// Largest residual of ticks that did not converge. A later tick finishes them.
    pub exhausted_residual: f64,
    /// Largest energy put out into the hands, joules.
    pub energy: f64,
    /// Largest energy put out into a hand that feels, joules, over a link of 5 ms with the passivity controller.
    pub linked_energy: f64,
    /// Largest number of tool-ticks whose substeps ran out, relative to the number of ticks.
    pub exhausted_share: f64,
    /// Largest jump.
    pub jump: f64,
    /// Largest force step.
    pub force_step: f64,
    /// Largest slow force step.
    pub slow_force_step: f64,
    /// Largest torque step, newton metres.
    pub torque_step: f64,
    /// Largest change of the sent force in a tick.
    pub sent_step: f64,
    /// Largest buzz.
    pub buzz: f64,
    /// Largest imbalance.
    pub imbalance: f64,
    /// Largest number of flips of a normal.
    pub flips: u64,
    /// Largest rebound.
    pub rebound: f64,
    /// Largest unrest in the last tick.
    pub unrest: f64,
    /// Largest drift.
    pub drift: f64,
    /// Largest coupling error, relative.
    pub coupling_error: f64,
    /// Smallest margin of the case, metres; `None` for a case without one.
    pub margin: Option<f64>,
    /// Smallest number of ticks in contact. A case without contact proves nothing.
    pub contact_ticks: u64,
}

/// Largest slow force step, newtons: the tick's own limit, and rounding.
const SLOW_FORCE_STEP: f64 = 0.02 + 1e-9;

/// Largest energy of a late wrench with the controller, joules: ten times [`crate::linked::FELT`].
const LINKED_ENERGY: f64 = 1e-3;

/// One hard case.
#[derive(Clone, Copy)]
pub struct Case {
    /// Name, as in `--exercise hard/NAME`.
    pub name: &'static str,
    /// Description for people.
    pub about: &'static str,
    /// Maker of the scene.
    pub scene: fn() -> Scene,
    /// Driver of the tools.
    pub driver: Driver,
    /// Disturbance of the input by tick number, such as lost packets or invalid numbers.
    pub disturb: fn(u64, &mut TickInput),
    /// Margin of the case, metres, from the last tick to this one; positive: no object was passed through; infinite:
    /// nothing to measure.
    pub margin: fn(&Moment<'_>) -> f64,
    /// Seed of the tremor.
    pub seed: u64,
    /// Bounds of the case.
    pub bounds: Bounds,
}

/// Comparison of one measure with its bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Check {
    /// Name of the measure.
    pub what: &'static str,
    /// Number found, in `unit`.
    pub found: f64,
    /// Bound, in `unit`.
    pub bound: f64,
    /// Whether the bound is the smallest allowed number; otherwise it is the largest.
    pub floor: bool,
    /// Unit of both numbers.
    pub unit: &'static str,
}

impl Check {
    /// Whether the number is within the bound. NaN is not. An infinite number is within no smallest bound, because it
    /// was never measured.
    pub fn holds(&self) -> bool {
        if self.floor {
            self.found >= self.bound && self.found < f64::INFINITY
        } else {
            self.found <= self.bound
        }
    }

    /// Used share of the bound: above 1 beyond the bound. 0 for an infinite bound, for a number equal to the bound, and
    /// for a share of zero or less.
    pub fn used(&self) -> f64 {
        let (part, whole) = if self.floor {
            (self.bound, self.found)
        } else {
            (self.found, self.bound)
        };
        if self.floor && self.found == f64::INFINITY {
            return f64::INFINITY;
        }
        if self.holds() && (part <= 0.0 || whole == f64::INFINITY || whole == part) {
            // A bound of zero that is met has no share.
            return 0.0;
        }
        part / whole
    }
}

impl Bounds {
    /// All measures with their bounds, and three counters that must be zero.
    pub fn checks(&self, m: &Measures, margin: f64) -> Vec<Check> {
        let most = |what, found: f64, bound: f64, scale: f64, unit| Check {
            what,
            found: found * scale,
            bound: bound * scale,
            floor: false,
            unit,
        };
        let least = |what, found: f64, bound: f64, scale, unit| Check {
            floor: true,
            ..most(what, found, bound, scale, unit)
        };
        let exhausted = m.exhausted as f64 / m.ticks.max(1) as f64;
        let mut checks = vec![
            most("residual", m.residual, self.residual, 1e6, "um"),
            most(
                "residual, exhausted",
                m.exhausted_residual,
                self.exhausted_residual,
                1e6,
                "um",
            ),
            most("energy", m.energy, self.energy, 1e3, "mJ"),
            most(
                "exhausted share",
                exhausted,
                self.exhausted_share,
                100.0,
                "%",
            ),
            most("jump", m.jump, self.jump, 1e3, "mm"),
            most("force step", m.force_step, self.force_step, 1.0, "N"),
            most(
                "slow force step",
                m.slow_force_step,
                self.slow_force_step,
                1.0,
                "N",
            ),
            most("torque step", m.torque_step, self.torque_step, 1e3, "N mm"),
            most("step sent", m.sent_step, self.sent_step, 1.0, "N"),
            most("buzz", m.buzz, self.buzz, 1.0, "N"),
            most("imbalance", m.imbalance, self.imbalance, 100.0, "%"),
            most("flips", m.flips as f64, self.flips as f64, 1.0, ""),
            most("rebound", m.rebound, self.rebound, 100.0, "%"),
            most("unrest", m.unrest, self.unrest, 1e6, "um"),
            most("drift", m.drift, self.drift, 1e6, "um"),
            most(
                "coupling error",
                m.coupling_error,
                self.coupling_error,
                100.0,
                "%",
            ),
            most("solver failures", m.solver_failed as f64, 0.0, 1.0, "ticks"),
            most("faults", m.faults as f64, 0.0, 1.0, "ticks"),
            most("not finite", m.not_finite as f64, 0.0, 1.0, "ticks"),
            least(
                "contact",
                m.contact_ticks as f64,
                self.contact_ticks as f64,
                1.0,
                "ticks",
            ),
        ];
        checks.extend(
            self.margin
                .map(|bound| least("margin", margin, bound, 1e3, "mm")),
        );
        checks
    }

    /// Broken bounds in words.
    pub fn broken(&self, m: &Measures, margin: f64) -> Vec<String> {
        let checks = self.checks(m, margin);
        let broken = checks.iter().filter(|check| !check.holds());
        let say = |check: &Check| {
            let how = if check.floor { "at least" } else { "at most" };
            format!(
                "{} {:.4} {}, {how} {:.4}",
                check.what, check.found, check.unit, check.bound
            )
        };
        broken.map(say).collect()
    }
}

fn undisturbed(_: u64, _: &mut TickInput) {}

/// All hard cases, in the order of the report.
pub const TABLE: &[Case] = &joined();

const GROUPS: [&[Case]; 5] = [
    rigid::CASES,
    squeezed::CASES,
    passing::CASES,
    tissue::CASES,
    limits::CASES,
];

const COUNT: usize = {
    let (mut count, mut group) = (0, 0);
    while group < GROUPS.len() {
        count += GROUPS[group].len();
        group += 1;
    }
    count
};

const fn joined() -> [Case; COUNT] {
    let mut all = [GROUPS[0][0]; COUNT];
    let (mut at, mut group) = (0, 0);
    while group < GROUPS.len() {
        let mut k = 0;
        while k < GROUPS[group].len() {
            all[at] = GROUPS[group][k];
            at += 1;
            k += 1;
        }
        group += 1;
    }
    all
}

/// Case with a name; `None` for an unknown name.
pub fn find(name: &str) -> Option<&'static Case> {
    TABLE.iter().find(|case| case.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_margin_that_was_never_measured_does_not_hold() {
        let bounds = find("teeth-gap-0.02").expect("in the table").bounds;
        let holds = |margin: f64| {
            let checks = bounds.checks(&Measures::default(), margin);
            let check = checks.iter().find(|check| check.what == "margin");
            check.expect("it declares one").holds()
        };
        assert!(holds(4e-4));
        assert!(!holds(2e-4) && !holds(f64::INFINITY) && !holds(f64::NAN));
        let none = find("wedge").expect("in the table").bounds;
        let checks = none.checks(&Measures::default(), f64::INFINITY);
        assert!(checks.iter().all(|check| check.what != "margin"));
    }

    #[test]
    fn names_are_unique() {
        for (k, case) in TABLE.iter().enumerate() {
            assert!(
                TABLE[..k].iter().all(|other| other.name != case.name),
                "{}",
                case.name
            );
        }
    }
}
