//! A random device, session and mapping, with the terms of the judge.

use std::time::Duration;

use sulcus_core::math::exp_rotation;
use sulcus_core::{Pose, Vec3};
use sulcus_haptics::continuous::ContinuousLimit;
use sulcus_haptics::freshness::Silence;
use sulcus_haptics::{DoorRules, Guard, Limits, Mapping, PassivityParams, SlewLimits};

use crate::dice::Dice;
use crate::judge::{Bound, Terms};

/// Constants of one sequence.
#[derive(Clone, Debug)]
pub struct World {
    pub period_ns: u64,
    pub link_ns: u64,
    pub rules: DoorRules,
    pub terms: Terms,
}

/// Smallest of the limits of device, model file, user and scene; the largest is `peak`.
fn smallest(dice: &mut Dice, peak: f64) -> f64 {
    let mut least = peak;
    for _ in 0..3 {
        if dice.chance(0.3) {
            least = least.min(dice.scaled(0.2, 2.0) * peak);
        }
    }
    least
}

impl World {
    pub fn random(dice: &mut Dice) -> Self {
        let period_ns = dice.pick(&[125_000, 250_000, 500_000, 1_000_000, 2_000_000]);
        let link_ns = dice.pick(&[500_000, 1_000_000, 1_000_000, 2_000_000]);
        let exact_slew = dice.chance(0.3);
        let has_torque = dice.chance(0.5);
        let mut bound = |low: f64, high: f64| {
            let peak = dice.scaled(low, high);
            let lasting = if exact_slew {
                peak
            } else {
                peak * dice.between(0.05, 1.0)
            };
            let slew_per_ms = peak * dice.scaled(0.02, 0.5);
            Bound {
                peak,
                slew_per_ms,
                lasting,
                time_s: dice.scaled(0.2, 10.0),
            }
        };
        let (force, torque) = (bound(0.1, 40.0), bound(0.01, 1.0));
        let motors = |bound: &Bound| ContinuousLimit {
            lasting: bound.lasting,
            peak: bound.peak,
            time_s: bound.time_s,
        };
        let limits = Limits {
            force_n: smallest(dice, force.peak),
            torque_nm: smallest(dice, torque.peak),
        };
        let slew = SlewLimits {
            force_n_per_ms: force.slew_per_ms,
            torque_nm_per_ms: torque.slew_per_ms,
        };
        let max_damping = if exact_slew {
            0.0
        } else {
            dice.pick(&[0.0, 30.0, 30.0, 300.0])
        };
        let passivity = PassivityParams {
            max_damping,
            period_s: period_ns as f64 * 1e-9,
            ..PassivityParams::default()
        };
        let clutch = dice.pick(&[0, 2, 6]);
        let guard = Guard {
            mapping: mapping(dice),
            has_torque,
            silence: Silence::DEVICE,
            blend_ns: Guard::blend(
                Duration::from_nanos(period_ns),
                Duration::from_nanos(link_ns),
            ),
            force: motors(&force),
            torque: motors(&torque),
            clutch,
        };
        let rules = DoorRules::guarded(limits, slew, passivity, guard);
        let terms = Terms {
            force: Bound {
                peak: limits.force_n,
                ..force
            },
            torque: Bound {
                peak: limits.torque_nm,
                ..torque
            },
            period_ms: period_ns as f64 * 1e-6,
            has_torque,
            clutch,
            exact_slew,
        };
        Self {
            period_ns,
            link_ns,
            rules,
            terms,
        }
    }
}

fn mapping(dice: &mut Dice) -> Mapping {
    Mapping {
        world_from_base: exp_rotation(&dice.vector(2.0)),
        origin: dice.vector(0.3),
        scale: dice.scaled(0.1, 5.0),
        gimbal_from_tool: Pose::new(dice.vector(0.2), exp_rotation(&dice.vector(2.0))),
    }
}

/// Wrench components that no simulation should send.
pub const ODD: [f64; 12] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    1e300,
    -1e160,
    1e9,
    f64::MIN_POSITIVE,
    5e-324,
    -5e-324,
    -0.0,
];

/// `v` with one component replaced by an odd number.
pub fn odd(dice: &mut Dice, mut v: Vec3) -> Vec3 {
    v[dice.below(3) as usize] = dice.pick(&ODD);
    v
}
