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

use crate::device::{DeviceEvent, EventDevice, Glance};
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
    punctual(PRIORITY);
    let mut device_loop = DeviceLoop::new(link, now_ns(), periods, disturb);
    while device_loop.goes_on(device) {
        sleep_until(device_loop.grid_ns);
        device_loop.pass(link, device, now_ns());
        done.store(device_loop.report.periods, Ordering::Relaxed);
    }
    device_loop.end()
}

/// State of a device's loop between two passes.
pub struct DeviceLoop {
    /// Time of the next pass, by [`now_ns`].
    grid_ns: u64,
    period_ns: u64,
    /// Number of periods to perform.
    periods: u64,
    disturb: Option<Disturb>,
    limits: Limits,
    displays: [Display; MAX_TOOLS],
    displayed: [Wrench; MAX_TOOLS],
    /// Number of periods spent waiting for the first wrench.
    waited: u64,
    /// Number of periods since the gate closed.
    closed_for: u64,
    was_open: bool,
    /// Whether the wrench falls to zero before the end.
    leaving: bool,
    over: bool,
    report: LoopReport,
}

impl DeviceLoop {
    /// Loop for a connected link. The first pass is due one period after `begin_ns`, a time by [`now_ns`].
    pub fn new(link: &Link, begin_ns: u64, periods: u64, disturb: Option<Disturb>) -> Self {
        let hello = link.hello();
        let period_ns = hello.tick_ns;
        let slew = SlewLimits {
            force_n_per_ms: f64::from(hello.max_force_step_n),
            torque_nm_per_ms: f64::from(hello.max_torque_step_nm),
        };
        let controller = PassivityParams {
            period_s: period_ns as f64 / 1e9,
            ..PassivityParams::default()
        };
        Self {
            grid_ns: begin_ns + period_ns,
            period_ns,
            periods,
            disturb,
            limits: Limits {
                force_n: f64::from(hello.max_force_n),
                torque_nm: f64::from(hello.max_torque_nm),
            },
            displays: [0; MAX_TOOLS].map(|_| Display::new(controller, slew)),
            displayed: [Wrench::ZERO; MAX_TOOLS],
            waited: 0,
            closed_for: 0,
            was_open: false,
            leaving: false,
            over: false,
            report: LoopReport::default(),
        }
    }

    /// Time of the next pass, by [`now_ns`].
    pub fn next_ns(&self) -> u64 {
        self.grid_ns
    }

    /// Number of periods completed so far.
    pub fn periods_done(&self) -> u64 {
        self.report.periods
    }

    /// Whether the loop has a further pass. The slew limit also applies at the end: the loop continues until the
    /// displayed wrench is zero.
    pub fn goes_on(&mut self, device: &dyn EventDevice) -> bool {
        self.report.interrupted |= interrupt::asked();
        self.leaving =
            self.report.interrupted || self.report.periods >= self.periods || device.is_done();
        let has_ended = self.leaving && is_let_go(&self.displayed);
        !(self.over || has_ended)
    }

    /// Report of the ended loop.
    pub fn end(self) -> LoopReport {
        let mut report = self.report;
        for energy in self.displays.map(|display| display.energy()) {
            report.energy_out_j = report.energy_out_j.max(energy.most_out);
            report.energy_taken_j += energy.taken;
            report.damped_periods += energy.acted;
        }
        report
    }

    /// Performs a pass of the loop. `now` is the present time by [`now_ns`], at or after [`DeviceLoop::next_ns`].
    pub fn pass(&mut self, link: &mut Link, device: &mut dyn EventDevice, now: u64) {
        let (leaving, period_ns) = (self.leaving, self.period_ns);
        let late = now.saturating_sub(self.grid_ns) / period_ns;
        let gate = link.force_gate(now);
        let newest = link.latest_wrench();
        self.grid_ns += (late + 1) * period_ns;
        if newest.is_none() && self.waited < START_NS / period_ns && link.is_open() {
            // The server is still opening its recording: motion of the hands would be lost.
            self.waited += 1 + late;
            return;
        }
        let felt: [Wrench; MAX_TOOLS] = std::array::from_fn(|t| {
            let wanted = newest.filter(|_| !leaving).map_or(Wrench::ZERO, |packet| {
                let WireWrench { force, torque } = packet.datagram.tools[t].wrench;
                let sent = Wrench {
                    force: Vec3::from(force.map(f64::from)),
                    torque: Vec3::from(torque.map(f64::from)),
                };
                gated(&sent, gate, &self.limits)
            });
            // No damping at the end: the wrench must reach zero.
            self.displays[t].next(&wanted, if leaving { 0.0 } else { gate })
        });
        let report = &mut self.report;
        for (now, before) in felt.iter().zip(&self.displayed) {
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
        self.displayed = felt;
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
            for (display, tool) in self.displays.iter_mut().zip(&input.tools) {
                let hand = drawn(&tool.pose).filter(|_| tool.present);
                display.moved(hand.as_ref(), 1);
            }
            if let Some(disturb) = self.disturb {
                disturb(report.periods, &mut input);
            }
            report.periods += 1;
        }
        for DeviceEvent { kind, json } in device.events() {
            let (tick, kind) = (report.last_tick, kind.into());
            // Refused if the link has ended, which the loop detects, or if its message queue is full.
            let _ = link.event(Event { tick, kind, json });
        }
        for command in device.commands() {
            // Refused for the same reasons as an event.
            let _ = link.command(command);
        }
        device.glance(&Glance {
            now_ns: now,
            tick: report.last_tick,
            levels: newest
                .map(|packet| packet.datagram.levels)
                .unwrap_or_default(),
            gate,
            is_returning: link.is_returning(),
            age_ms: newest.and_then(|packet| packet.age_ms()),
            displayed: felt,
            graphics: shown.graphics,
            held: input.tools.map(|tool| tool.present),
        });
        report.overslept += late;
        link.send_pose(&packet(
            (report.periods, now, period_ns),
            &input.tools,
            &felt,
        ));

        report.gate_closings += u64::from(self.was_open && gate < 1.0);
        self.was_open = gate >= 1.0;
        let silent = gate == 0.0 && !link.is_returning();
        self.closed_for = if silent {
            self.closed_for + 1 + late
        } else {
            0
        };
        // In a new session the gate is still rising: a closed link alone does not end the loop.
        if self.closed_for >= GONE_NS / period_ns
            || !link.is_open() && is_let_go(&self.displayed) && gate == 0.0
        {
            report.server_silent = true;
            self.over = true;
        }
    }
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
pub(crate) fn punctual(priority: i32) {
    exact_timers();
    if let Err(error) = fifo(priority) {
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
