//! Device loop, once per period: newest wrench, gate, display, device, pose.

use std::sync::atomic::{AtomicU64, Ordering};

use sulcus_core::math::norm;
use sulcus_core::{MAX_TOOLS, RawPose, TickInput, ToolInput, Vec3, Wrench};
use sulcus_haptics::guide::{Guide, Moment};
use sulcus_haptics::{Door, DoorRules, Limits, Merged, Shown, SlewLimits, Wanted, drawn};
use sulcus_link::Times;
use sulcus_link::clock::sleep_until;
use sulcus_link::schedule::{exact_timers, fifo};
use sulcus_proto::at_hand::LIVE_POSE_MS;
use sulcus_proto::control::Event;
use sulcus_proto::datagram::{ToolPose, WirePose, WireWrench};
use sulcus_proto::device::PHASE_EVENT;

use crate::at_hand::HandTicker;
use crate::carrier::Carrier;
use crate::device::{DeviceEvent, EventDevice, Glance};
use crate::interrupt;
use crate::link::{Heard, Link, PosePacket, WrenchPacket, now_ns};
use crate::phase::Phase;
use crate::report::LoopReport;

/// SCHED_FIFO priority of the device thread, below that of an embedded simulation.
const PRIORITY: i32 = 45;
/// Time of a closed gate after which the server counts as gone although its connection lives, nanoseconds. A lost
/// connection shows earlier, as the end of the link or as its attempt to return.
const GONE_NS: u64 = 10_000_000_000;
/// Time between two events about the phase, nanoseconds.
const PHASE_NS: u64 = 10_000_000_000;
/// Longest wait for the first wrench of a started session, nanoseconds.
const START_NS: u64 = 5_000_000_000;

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
    run_with_ticks(link, device, (periods, disturb), None, done).0
}

/// Runs `device` like [`run`]. `hand` computes the ticks if they run at the hand, and is returned.
pub fn run_with_ticks(
    link: &mut Link,
    device: &mut dyn EventDevice,
    (periods, disturb): (u64, Option<Disturb>),
    hand: Option<HandTicker>,
    done: &AtomicU64,
) -> (LoopReport, Option<HandTicker>) {
    punctual(PRIORITY);
    let device_loop = DeviceLoop::new(link, now_ns(), periods, disturb).in_phase();
    let mut device_loop = match hand {
        Some(hand) => device_loop.with_ticks(hand),
        None => device_loop,
    };
    while device_loop.goes_on(device) {
        sleep_until(device_loop.grid_ns);
        device_loop.pass(link, device, now_ns());
        done.store(device_loop.report.periods, Ordering::Relaxed);
    }
    device_loop.end(link, device)
}

/// State of a device's loop between two passes.
pub struct DeviceLoop {
    /// Time of the next pass, by [`now_ns`].
    grid_ns: u64,
    period_ns: u64,
    /// Control loop of the phase. `None`: the passes keep their grid.
    phase: Option<Phase>,
    /// Number of periods to perform.
    periods: u64,
    disturb: Option<Disturb>,
    /// Doors of hands in step with the loop.
    doors: [Door; MAX_TOOLS],
    /// Newest state of the hands of devices with threads of their own.
    merged: Option<[Merged; MAX_TOOLS]>,
    ages: [Times; MAX_TOOLS],
    hand_ages: Times,
    /// Poses of the tools in the last pass, for a guide.
    hands: Moment,
    /// Ghost that an instructor shows. The device's own guide rests meanwhile.
    shown: Option<Box<Guide>>,
    displayed: [Wrench; MAX_TOOLS],
    /// Number of periods spent waiting for the first wrench.
    waited: u64,
    /// Number of periods since the gate closed.
    closed_for: u64,
    was_open: bool,
    /// Whether the wrench falls to zero before the end.
    leaving: bool,
    over: bool,
    /// Ticks at the hand; `None`: the server ticks.
    hand: Option<HandTicker>,
    /// Whether the rows of the ticks cannot be handed in any more.
    stuck: bool,
    report: LoopReport,
}

impl DeviceLoop {
    /// Loop for a link. The first pass is due one period after `begin_ns`, a time by [`now_ns`].
    pub fn new(link: &impl Carrier, begin_ns: u64, periods: u64, disturb: Option<Disturb>) -> Self {
        let hello = link.hello();
        let period_ns = hello.tick_ns;
        let slew = SlewLimits {
            force_n_per_ms: f64::from(hello.max_force_step_n),
            torque_nm_per_ms: f64::from(hello.max_torque_step_nm),
        };
        let limits = Limits {
            force_n: f64::from(hello.max_force_n),
            torque_nm: f64::from(hello.max_torque_nm),
        };
        let rules = DoorRules::in_step(limits, slew, period_ns as f64 / 1e9);
        Self {
            grid_ns: begin_ns + period_ns,
            period_ns,
            phase: None,
            periods,
            disturb,
            doors: [0; MAX_TOOLS].map(|_| Door::new(rules.clone())),
            merged: None,
            ages: [0; MAX_TOOLS].map(|_| Times::up_to(1)),
            hand_ages: Times::up_to(1),
            hands: [None; MAX_TOOLS],
            shown: None,
            displayed: [Wrench::ZERO; MAX_TOOLS],
            waited: 0,
            closed_for: 0,
            was_open: false,
            leaving: false,
            over: false,
            hand: None,
            stuck: false,
            report: LoopReport::default(),
        }
    }

    /// The same loop with ticks of its own, for a session whose ticks run at the hand.
    #[must_use]
    pub fn with_ticks(mut self, hand: HandTicker) -> Self {
        self.hand = Some(hand);
        self.phase = None;
        self
    }

    /// The same loop with passes that move until each pose arrives shortly before the server's tick.
    #[must_use]
    pub fn in_phase(mut self) -> Self {
        self.phase = Some(Phase::new(self.period_ns));
        self
    }

    /// Time of the next pass, by [`now_ns`].
    pub fn next_ns(&self) -> u64 {
        self.grid_ns
    }

    /// Number of periods in which a passivity controller of the loop's doors has acted, summed over both hands.
    pub fn braked_periods(&self) -> u64 {
        self.doors.iter().map(|door| door.energy().acted).sum()
    }

    /// Number of periods completed so far.
    pub fn periods_done(&self) -> u64 {
        self.report.periods
    }

    /// Whether the loop has a further pass. The slew limit also applies at the end: the loop continues until the
    /// displayed wrench is zero.
    pub fn goes_on(&mut self, device: &dyn EventDevice) -> bool {
        self.report.interrupted |= interrupt::asked();
        self.leaving = self.report.interrupted
            || self.stuck
            || self.report.periods >= self.periods
            || device.is_done();
        let has_ended = self.leaving && is_let_go(&self.displayed);
        !(self.over || has_ended)
    }

    /// Sends the last events of the device, and gives the report of the ended loop.
    pub fn end(
        mut self,
        link: &mut impl Carrier,
        device: &mut dyn EventDevice,
    ) -> (LoopReport, Option<HandTicker>) {
        // A person may have called a depth and left the session after the last pass.
        self.send_events(link, device);
        let mut report = self.report;
        let of_merged = self
            .merged
            .map(|merged| merged.map(|hand| (hand.sample.energy, hand.sample.counts)));
        let of_doors = || {
            self.doors
                .each_ref()
                .map(|door| (door.energy(), door.counts()))
        };
        for (energy, counts) in of_merged.unwrap_or_else(of_doors) {
            report.energy_out_j = report.energy_out_j.max(energy.most_out);
            report.energy_taken_j += energy.taken;
            report.damped_periods += energy.acted;
            report.trips += counts.trips;
            report.dropped_torque_periods += counts.dropped;
            report.most_dropped_torque_nm =
                report.most_dropped_torque_nm.max(counts.most_dropped_nm);
            report.limited_periods += counts.limited;
        }
        report.phase = self.phase.map(|phase| phase.report()).unwrap_or_default();
        report.pose_age_us = self.ages.each_ref().map(Times::percentiles);
        report.hand_age_us = self.hand_ages.percentiles();
        (report, self.hand.take())
    }

    /// Sends the waiting events of the device. The link refuses an event if it has ended, which the loop detects, or if
    /// its message queue is full.
    fn send_events(&self, link: &mut impl Carrier, device: &mut dyn EventDevice) {
        let tick = self.report.last_tick;
        for DeviceEvent { kind, json } in device.events() {
            let kind = kind.into();
            let _ = link.event(Event { tick, kind, json });
        }
    }

    /// Performs a pass of the loop. `now` is the present time by [`now_ns`], at or after [`DeviceLoop::next_ns`].
    pub fn pass(&mut self, link: &mut impl Carrier, device: &mut dyn EventDevice, now: u64) {
        let (leaving, period_ns) = (self.leaving, self.period_ns);
        let late = now.saturating_sub(self.grid_ns) / period_ns;
        let told = link.latest_wrench();
        // Ticks at the hand need no server: the watchdog waits for the ticks.
        let gate = match &self.hand {
            Some(_) => f64::from(u8::from(link.is_open() && told.is_some())),
            None => link.force_gate(now),
        };
        let leaving = leaving || self.hand.is_some() && gate == 0.0;
        self.grid_ns += (late + 1) * period_ns;
        self.keep_phase(told.as_ref());
        if let Some(hand) = &mut self.hand
            && hand.run() != link.restarts()
        {
            hand.begin_again(link.restarts());
        }
        // Later the hands must not stand still.
        let begins = self.report.periods == 0;
        if begins && told.is_none() && self.waited < START_NS / period_ns && link.is_open() {
            // The server is still opening its recording: motion of the hands would be lost.
            self.waited += 1 + late;
            return;
        }
        let newest = match &self.hand {
            Some(hand) => hand.newest(told.as_ref(), now),
            None => told,
        };
        if self.hand.is_some()
            && let Some(age_ns) = newest.and_then(|packet| packet.age_ns)
        {
            self.hand_ages.record(age_ns);
        }
        let wanted: [Wanted; MAX_TOOLS] = std::array::from_fn(|t| Wanted {
            leaving,
            ..newest.map_or(Wanted::NOTHING, |packet| wanted(&packet, t))
        });
        while let Some(heard) = link.heard() {
            match heard {
                Heard::Text(text) => device.hear(&text),
                Heard::Ghost(ghost) => self.shown = ghost,
            }
        }
        let wanted = self.guided(device, wanted, newest.as_ref());
        let felt = self.felt(device, &wanted, now);
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
        let before = self.report.periods;
        let input = self.read_hands(device, &shown, late);
        self.hands = input
            .tools
            .map(|tool| drawn(&tool.pose).filter(|_| tool.present));
        self.send_events(link, device);
        let report = &mut self.report;
        let every = (PHASE_NS / period_ns).max(1);
        if let Some(phase) = self.phase
            && report.periods / every != before / every
        {
            let (tick, kind) = (report.last_tick, PHASE_EVENT.into());
            let json = phase.report().json();
            let _ = link.event(Event { tick, kind, json });
        }
        for command in device.commands() {
            if let Some(hand) = &mut self.hand {
                hand.command(command);
            }
            // Refused for the same reasons as an event.
            let _ = link.command(command);
        }
        let ghost = match &self.shown {
            Some(ghost) => ghost.ghost(),
            None => device
                .guide()
                .map_or([None; MAX_TOOLS], |guide| guide.ghost()),
        };
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
            ghost,
            stages: std::array::from_fn(|t| self.merged.map(|merged| merged[t].sample.stage)),
        });
        report.overslept += late;
        let mut packet = packet((report.periods, now, period_ns), &input.tools, &felt);
        if let Some(merged) = &self.merged {
            // The reading of a device with a clock of its own has the device's number and time.
            for (tool, hand) in packet.tools.iter_mut().zip(merged) {
                if hand.age_ns.is_some() {
                    tool.sequence = hand.sample.sequence;
                    tool.device_time_ns = hand.sample.at_ns;
                }
            }
        }
        match &mut self.hand {
            None => link.send_pose(&packet),
            // A server that has lost the session opens a new one first.
            Some(_) if told.is_none() || self.stuck => {}
            Some(hand) => {
                let levels = told.map(|told| told.datagram.levels).unwrap_or_default();
                let out = hand.pass(&input.tools, &packet.tools, levels, late);
                (packet.tick, packet.run) = (out.tick, out.run);
                if let Some(merger) = device.threaded() {
                    // The device has a rate of its own, and need not wait for the next pass.
                    let newest = hand.newest(told.as_ref(), now);
                    merger.order(&std::array::from_fn(|t| Wanted {
                        leaving,
                        guide: wanted[t].guide,
                        ..newest.map_or(Wanted::NOTHING, |packet| self::wanted(&packet, t))
                    }));
                }
                // The force falls to zero, and the session ends with a stop.
                self.stuck = !link.send_row(out);
                let every = (LIVE_POSE_MS * 1_000_000 / period_ns).max(1);
                if out.tick / every != (out.tick - 1 - u64::from(out.row.skipped)) / every {
                    link.send_pose(&packet);
                }
            }
        }
        let report = &mut self.report;

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

    /// Moves the next pass by the wait of the newest answered pose at the server.
    fn keep_phase(&mut self, newest: Option<&WrenchPacket>) {
        let Some(phase) = &mut self.phase else {
            return;
        };
        // The first tool that has an answer stands for both.
        let tools = newest.map(|packet| packet.datagram.tools);
        let echoes = tools.into_iter().flatten().map(|tool| tool.echo);
        if let Some(echo) = echoes.into_iter().find(|echo| echo.valid) {
            let age_ns = newest.and_then(|packet| packet.age_ns).unwrap_or(0);
            phase.heard(echo.sequence, echo.wait_us, age_ns);
        }
        let moved_ns = self.grid_ns.checked_add_signed(phase.correction_ns());
        self.grid_ns = moved_ns.unwrap_or(self.grid_ns);
    }

    /// Adds the wrenches of a guide to the orders. A paused session has no guide, and the force limit of the session
    /// applies to both together.
    fn guided(
        &mut self,
        device: &mut dyn EventDevice,
        mut wanted: [Wanted; MAX_TOOLS],
        newest: Option<&WrenchPacket>,
    ) -> [Wanted; MAX_TOOLS] {
        let Some(packet) = newest else {
            return wanted;
        };
        let levels = &packet.datagram.levels;
        if levels.paused_by_student || levels.paused_by_station {
            return wanted;
        }
        let limit = f64::from(levels.force_limit_n);
        let seconds = self.period_ns as f64 / 1e9;
        if let Some(ghost) = &mut self.shown {
            // A ghost of the server is seen and never felt.
            ghost.step(&self.hands, seconds);
            return wanted;
        }
        let Some(guide) = device.guide() else {
            return wanted;
        };
        for (wanted, guide) in wanted.iter_mut().zip(guide.step(&self.hands, seconds)) {
            let left = if limit > 0.0 {
                (limit - norm(&wanted.wrench.force)).max(0.0)
            } else {
                f64::INFINITY
            };
            let length = norm(&guide.force);
            let share = if length > left { left / length } else { 1.0 };
            wanted.guide = Wrench {
                force: guide.force * share,
                torque: guide.torque * share,
            };
        }
        wanted
    }

    /// Wrenches that the hands feel from `now` on, about the device points of the tools, world axes.
    fn felt(
        &mut self,
        device: &mut dyn EventDevice,
        wanted: &[Wanted; MAX_TOOLS],
        now: u64,
    ) -> [Wrench; MAX_TOOLS] {
        if let Some(merger) = device.threaded() {
            merger.order(wanted);
            let merged = merger.read(now);
            for (ages, hand) in self.ages.iter_mut().zip(&merged) {
                if let Some(age_ns) = hand.age_ns {
                    ages.record(age_ns);
                }
            }
            self.merged = Some(merged);
            return merged.map(|hand| hand.displayed(now));
        }
        std::array::from_fn(|t| {
            self.doors[t].order(&wanted[t]);
            self.doors[t].pass(now)
        })
    }

    /// Reads the hands after `late` periods that passed while the loop slept.
    fn read_hands(&mut self, device: &mut dyn EventDevice, shown: &Shown, late: u64) -> TickInput {
        let mut input = TickInput::IDLE;
        if let Some(merged) = &self.merged {
            input.tools = merged.map(|hand| hand.tool);
            self.report.periods += 1 + late;
            return input;
        }
        // A real hand moves on while the loop sleeps; the simulated hand must do the same.
        for _ in 0..=late {
            input.tools = device.exchange(shown);
            for (door, tool) in self.doors.iter_mut().zip(&input.tools) {
                let hand = drawn(&tool.pose).filter(|_| tool.present);
                door.moved(hand.as_ref(), 1);
            }
            if let Some(disturb) = self.disturb {
                disturb(self.report.periods, &mut input);
            }
            self.report.periods += 1;
        }
        input
    }
}

/// Order of `packet` to the hand in `slot`.
fn wanted(packet: &WrenchPacket, slot: usize) -> Wanted {
    let WireWrench { force, torque } = packet.datagram.tools[slot].wrench;
    let levels = &packet.datagram.levels;
    Wanted {
        paused: levels.paused_by_student || levels.paused_by_station,
        wrench: Wrench {
            force: Vec3::from(force.map(f64::from)),
            torque: Vec3::from(torque.map(f64::from)),
        },
        heard_ns: Some(packet.arrived_ns),
        ..Wanted::NOTHING
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
        tick: 0,
        run: 0,
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
