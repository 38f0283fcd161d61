//! Report of a device's loop.

use serde::Serialize;
use sulcus_core::MAX_TOOLS;
use sulcus_proto::Percentiles;

use crate::phase::PhaseReport;

/// Report of one run of the loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LoopReport {
    /// Number of periods of the device.
    pub periods: u64,
    /// Number of periods that passed before the system woke the loop. The device moved on in these periods too.
    pub overslept: u64,
    /// Largest force displayed on either hand, newtons.
    pub max_displayed_n: f64,
    /// Largest change of the displayed force between two passes of the loop, newtons.
    pub max_displayed_step_n: f64,
    /// Force displayed last, newtons: the larger of both hands.
    pub last_displayed_n: f64,
    /// Number of times that the watchdog began to close the gate.
    pub gate_closings: u64,
    /// Largest net energy that the displayed force put out into a hand since a contact began, joules.
    pub energy_out_j: f64,
    /// Energy removed by the passivity controllers of both hands, joules.
    pub energy_taken_j: f64,
    /// Number of periods in which a passivity controller acted, summed over both hands.
    pub damped_periods: u64,
    /// Age of the pose of each hand when the loop reads it, microseconds; zero for hands in step with the loop.
    pub pose_age_us: [Percentiles; MAX_TOOLS],
    /// Time from the newest reading to the display of the wrench that answers it, for ticks at the hand, microseconds;
    /// zero if the server ticks.
    pub hand_age_us: Percentiles,
    /// Number of trips of the doors at the devices.
    pub trips: u64,
    /// Number of periods of a device with a torque that the device could not display.
    pub dropped_torque_periods: u64,
    /// Largest torque that a device could not display, newton-metres.
    pub most_dropped_torque_nm: f64,
    /// Number of periods of a device in which its continuous force limited the force.
    pub limited_periods: u64,
    /// Phase of the passes against the server's ticks; zero without the control loop.
    pub phase: PhaseReport,
    /// Tick of the newest wrench received.
    pub last_tick: u64,
    /// Whether the run ended because no more wrenches came: the server was silent or ended the session.
    pub server_silent: bool,
    /// Whether the user interrupted the run.
    pub interrupted: bool,
}
