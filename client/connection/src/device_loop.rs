//! Device loop, once per period: newest wrench, gate, display, device, pose.

use std::sync::atomic::{AtomicU64, Ordering};

use serde::Serialize;
use sulcus_core::math::norm;
use sulcus_core::{MAX_TOOLS, RawPose, TickInput, ToolInput, Vec3, Wrench};
use sulcus_haptics::{Display, Limits, PassivityParams, Shown, SlewLimits, drawn, gated};
use sulcus_link::clock::sleep_until;
use sulcus_link::schedule::{exact_timers, fifo};
use sulcus_proto::control::Event;
use sulcus_proto::datagram::{ToolPose, WirePose, WireWrench};

use crate::device::{DeviceEvent, EventDevice};
use crate::interrupt;
use crate::link::{Link, PosePacket, now_ns};

/// SCHED_FIFO priority of the device thread, below that of an embedded simulation.
const PRIORITY: i32 = 45;
/// Time of a closed gate after which the server counts as gone although its connection lives, nanoseconds. A lost
/// connection shows earlier, as the end of the link or as its attempt to return.
const GONE_NS: u64 = 10_000_000_000;
/// Longest wait for the first wrench of a started session, nanoseconds.
const START_NS: u64 = 5_000_000_000;

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
    /// Tick of the newest wrench received.
    pub last_tick: u64,
    /// Whether the run ended because no more wrenches came: the server was silent or ended the session.
    pub server_silent: bool,
    /// Whether the user interrupted the run.
    pub interrupted: bool,
}

/// Disturbance of the input of one period, by period number: lost packets and invalid numbers of the hard cases.
pub type Disturb = fn(u64, &mut TickInput);

/// Runs `device` on `link` for `periods` periods of the server's tick.
///
/// The run ends earlier on an interrupt, when the device is done, or when the server is gone. After the end of the
/// periods the loop continues until the displayed wrench has fallen to zero. `done` receives the number of periods
/// completed so far.
pub fn run(
    link: &mut Link,
    device: &mut dyn EventDevice,
    periods: u64,
    disturb: Option<Disturb>,
    done: &AtomicU64,
) -> LoopReport {
    punctual();
    let mut report = LoopReport::default();
    let (mut displayed, mut closed_for, mut was_open) = ([Wrench::ZERO; MAX_TOOLS], 0, false);
    let hello = link.hello();
    let period_ns = hello.tick_ns;
    let limits = Limits {
        force_n: f64::from(hello.max_force_n),
        torque_nm: f64::from(hello.max_torque_nm),
    };
    let slew = SlewLimits {
        force_n_per_ms: f64::from(hello.max_force_step_n),
        torque_nm_per_ms: f64::from(hello.max_torque_step_nm),
    };
    let controller = PassivityParams {
        period_s: period_ns as f64 / 1e9,
        ..PassivityParams::default()
    };
    let mut displays = [0; MAX_TOOLS].map(|_| Display::new(controller, slew));
    let mut grid_ns = now_ns() + period_ns;
    let mut waited = 0;
    loop {
        report.interrupted |= interrupt::asked();
        // The slew limit also applies at the end: the loop continues until the displayed wrench is zero.
        let leaving = report.interrupted || report.periods >= periods || device.is_done();
        if leaving && is_let_go(&displayed) {
            break;
        }
        sleep_until(grid_ns);
        let now = now_ns();
        let late = now.saturating_sub(grid_ns) / period_ns;
        let gate = link.force_gate(now);
        let newest = link.latest_wrench();
        if newest.is_none() && waited < START_NS / period_ns && link.is_open() {
            // The server is still opening its recording: motion of the hands would be lost.
            waited += 1 + late;
            grid_ns += (late + 1) * period_ns;
            continue;
        }
        let felt: [Wrench; MAX_TOOLS] = std::array::from_fn(|t| {
            let wanted = newest.filter(|_| !leaving).map_or(Wrench::ZERO, |packet| {
                let WireWrench { force, torque } = packet.datagram.tools[t].wrench;
                let sent = Wrench {
                    force: Vec3::from(force.map(f64::from)),
                    torque: Vec3::from(torque.map(f64::from)),
                };
                gated(&sent, gate, &limits)
            });
            // No damping at the end: the wrench must reach zero.
            displays[t].next(&wanted, if leaving { 0.0 } else { gate })
        });
        for (now, before) in felt.iter().zip(&displayed) {
            let force = norm(&now.force);
            report.max_displayed_n = report.max_displayed_n.max(force);
            report.max_displayed_step_n = report
                .max_displayed_step_n
                .max(norm(&(now.force - before.force)));
        }
        report.last_displayed_n = felt
            .iter()
            .map(|wrench| norm(&wrench.force))
            .fold(0.0, f64::max);
        displayed = felt;
        report.last_tick = newest.map_or(report.last_tick, |packet| packet.datagram.tick);

        // The newest picture stays on the screen while the force is gated.
        let shown = Shown {
            wrenches: felt,
            graphics: std::array::from_fn(|t| {
                let sent = newest?.datagram.tools[t].graphic;
                drawn(&RawPose {
                    position: sent.position,
                    orientation: sent.orientation,
                })
            }),
        };
        // A real device moves on while the loop sleeps; the simulated device must do the same.
        let mut input = TickInput::IDLE;
        for _ in 0..=late {
            input.tools = device.exchange(&shown);
            for (display, tool) in displays.iter_mut().zip(&input.tools) {
                let hand = drawn(&tool.pose).filter(|_| tool.present);
                display.moved(hand.as_ref(), 1);
            }
            if let Some(disturb) = disturb {
                disturb(report.periods, &mut input);
            }
            report.periods += 1;
        }
        for DeviceEvent { kind, json } in device.events() {
            let (tick, kind) = (report.last_tick, kind.into());
            // Refused if the link has ended, which the loop detects, or if its message queue is full.
            let _ = link.event(Event { tick, kind, json });
        }
        report.overslept += late;
        grid_ns += (late + 1) * period_ns;
        link.send_pose(&packet(
            (report.periods, now, period_ns),
            &input.tools,
            &felt,
        ));
        done.store(report.periods, Ordering::Relaxed);

        report.gate_closings += u64::from(was_open && gate < 1.0);
        was_open = gate >= 1.0;
        let silent = gate == 0.0 && !link.is_returning();
        closed_for = if silent { closed_for + 1 + late } else { 0 };
        // In a new session the gate is still rising: a closed link alone does not end the loop.
        if closed_for >= GONE_NS / period_ns
            || !link.is_open() && is_let_go(&displayed) && gate == 0.0
        {
            report.server_silent = true;
            break;
        }
    }
    for energy in displays.map(|display| display.energy()) {
        report.energy_out_j = report.energy_out_j.max(energy.most_out);
        report.energy_taken_j += energy.taken;
        report.damped_periods += energy.acted;
    }
    report
}

/// Whether all displayed wrenches are zero. A torque also holds a hand.
fn is_let_go(displayed: &[Wrench; MAX_TOOLS]) -> bool {
    displayed.iter().all(|wrench| *wrench == Wrench::ZERO)
}

/// Packet of the reading `number` at `now`, of a loop with a period of `period_ns`.
fn packet(
    (number, now, period_ns): (u64, u64, u64),
    tools: &[ToolInput; MAX_TOOLS],
    displayed: &[Wrench; MAX_TOOLS],
) -> PosePacket {
    let narrow = |v: &Vec3| [v.x as f32, v.y as f32, v.z as f32];
    PosePacket {
        tools: std::array::from_fn(|t| ToolPose {
            present: tools[t].present,
            buttons: tools[t].buttons,
            // Wraps, as the wire's number does.
            sequence: number as u32,
            device_time_ns: now,
            period_us: u32::try_from(period_ns / 1000).unwrap_or(u32::MAX),
            pose: WirePose {
                position: tools[t].pose.position,
                orientation: tools[t].pose.orientation,
            },
            displayed: WireWrench {
                force: narrow(&displayed[t].force),
                torque: narrow(&displayed[t].torque),
            },
        }),
    }
}

/// Requests SCHED_FIFO, and sets exact timers in any case. Without SCHED_FIFO poses are late under load; the counters
/// show the delay.
fn punctual() {
    exact_timers();
    if let Err(error) = fifo(PRIORITY) {
        tracing::debug!("no real-time scheduling for the device: {error}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_that_still_feels_a_torque_is_not_let_go() {
        let mut displayed = [Wrench::ZERO; MAX_TOOLS];
        assert!(is_let_go(&displayed));
        displayed[1].torque = Vec3::new(0.0, -1e-3, 0.0);
        assert!(!is_let_go(&displayed));
        displayed[1] = Wrench {
            force: Vec3::new(0.0, 0.0, 0.1),
            torque: Vec3::zeros(),
        };
        assert!(!is_let_go(&displayed));
    }
}
