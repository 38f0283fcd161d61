//! Rules of a door: constants of one hand in one session.

use std::time::Duration;

use sulcus_core::math::fmin;

use crate::continuous::ContinuousLimit;
use crate::freshness::Silence;
use crate::limits::{Limits, SlewLimits};
use crate::mapping::Mapping;
use crate::passivity::PassivityParams;

/// Rules of a door.
#[derive(Clone, Debug, PartialEq)]
pub struct DoorRules {
    /// Largest wrench: the smallest of device, model file, user and scene.
    pub limits: Limits,
    /// Largest change of the wrench.
    pub slew: SlewLimits,
    /// Passivity controller; its period is that of the device.
    pub passivity: PassivityParams,
    /// Guard of a device with a thread of its own; `None` for a source in step with the loop.
    pub guard: Option<Guard>,
}

/// Rules of a device with a thread of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Guard {
    /// Mapping between the device and the world.
    pub mapping: Mapping,
    /// Whether the device displays torque.
    pub has_torque: bool,
    /// Ages of the newest wrench at which the force falls.
    pub silence: Silence,
    /// Time over which the force moves from one wrench of the link to the next, nanoseconds; 0 holds each wrench.
    pub blend_ns: u64,
    /// Continuous limit of the force, newtons.
    pub force: ContinuousLimit,
    /// Continuous limit of the torque, newton-metres.
    pub torque: ContinuousLimit,
    /// Buttons that hold the clutch, one bit each; 0 for no clutch.
    pub clutch: u16,
}

impl DoorRules {
    /// Rules of a source in step with the loop, with a period in seconds.
    pub fn in_step(limits: Limits, slew: SlewLimits, period_s: f64) -> Self {
        Self {
            limits,
            slew,
            passivity: PassivityParams {
                period_s,
                ..PassivityParams::default()
            },
            guard: None,
        }
    }

    /// Rules of a guarded device. The force is limited further, so that the slew limit can take the whole force away
    /// within the fall of [`Silence`].
    pub fn guarded(
        limits: Limits,
        slew: SlewLimits,
        passivity: PassivityParams,
        guard: Guard,
    ) -> Self {
        let fall_ms = guard.silence.fall().as_secs_f64() * 1e3;
        let limits = Limits {
            force_n: fmin(limits.force_n, slew.force_n_per_ms * fall_ms),
            torque_nm: fmin(limits.torque_nm, slew.torque_nm_per_ms * fall_ms),
        };
        Self {
            limits,
            slew,
            passivity: PassivityParams {
                max_force: fmin(passivity.max_force, limits.force_n),
                ..passivity
            },
            guard: Some(guard),
        }
    }
}

impl Guard {
    /// Time of [`Guard::blend_ns`] for a device of `device` period on a link of `link` period: that of the link, or 0
    /// for a device that is not faster than the link.
    pub fn blend(device: Duration, link: Duration) -> u64 {
        if device < link {
            u64::try_from(link.as_nanos()).unwrap_or(u64::MAX)
        } else {
            0
        }
    }
}
