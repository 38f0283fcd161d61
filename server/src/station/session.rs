//! A session whose threads run, as its station sees it: attachment, gaps, limits of time, status.

use std::sync::Arc;
use std::time::{Duration, Instant};

use sulcus_core::Coupling;
use sulcus_proto::control::{DeviceInfo, EndReason};
use sulcus_proto::station::{Phase, StationStatus};
use sulcus_sessions::{Detached, Occurrence};

use crate::outlets::opening;
use crate::outlets::status::Live;
use crate::session::at_hand::HandPort;
use crate::session::handoff::Flags;
use crate::session::running::Running;
use crate::station::actor::Present;
use crate::station::config::SessionPlan;
use crate::station::door::Student;
use crate::station::gap::SessionClock;

/// Longest time after the motion in which the rest of ticks at the hand is handed in. A client gives up before.
const HAND_IN: Duration = Duration::from_secs(600);

/// A session whose threads run.
pub(super) struct Session {
    pub running: Running,
    pub student: Student,
    pub plan: Arc<SessionPlan>,
    /// Couplings in force, in the order of the tools.
    pub couplings: Vec<Coupling>,
    pub present: Option<Present>,
    pub clock: SessionClock,
    /// Tick at which the present gap began.
    pub gap_tick: u64,
    /// Ticks in gaps that have closed.
    pub gap_ticks: u64,
    /// Poses and batches accepted at the last check, and the time of the newest.
    pub heard: (u64, Instant),
}

impl Session {
    /// Student returned under a new epoch, after a gap or in place of an older connection.
    pub fn attached(&mut self, epoch: u32, replaced: bool, now: Instant) {
        let ports = self.running.ports();
        ports.begin_epoch(epoch);
        self.clock.attach(now);
        let tick = ports.tick();
        if ports.hand().is_some() && !replaced {
            ports.returned();
            self.tell(Occurrence::hand_returned(tick, epoch));
        }
        let ticks = if replaced {
            0
        } else {
            tick.saturating_sub(self.gap_tick)
        };
        self.gap_ticks += ticks;
        self.heard.1 = now;
    }

    /// Takes the devices with which the student is back. The recording names them if they differ from those before.
    pub fn bring(&mut self, devices: Vec<DeviceInfo>) {
        if devices == self.student.devices {
            return;
        }
        let ports = self.running.ports();
        let facts = opening::devices(&self.plan.scene, &devices);
        if !ports.occurrence(Occurrence::devices_changed(ports.tick(), &facts)) {
            tracing::warn!(
                "the recording does not name the devices of a return: its queue is full"
            );
        }
        self.student.devices = devices;
    }

    /// Student gone: the tools are let go, the session waits.
    pub fn detached(&mut self, reason: Detached, now: Instant) {
        let ports = self.running.ports();
        ports.let_go(reason);
        if ports.hand().is_some() {
            self.tell(Occurrence::hand_away(ports.tick(), reason));
        }
        self.clock.detach(now);
        self.gap_tick = ports.tick();
    }

    /// Passes an event to the recorder.
    fn tell(&self, occurrence: Occurrence) {
        let kind = occurrence.kind.clone();
        if !self.running.ports().occurrence(occurrence) {
            tracing::warn!("the recording lacks an event `{kind}`: its queue is full");
        }
    }

    /// Writes the state of the session into a status.
    pub fn fill(&self, status: &mut StationStatus, live: &Live) {
        let now = Instant::now();
        let ports = self.running.ports();
        status.phase = if self.present.is_some() {
            Phase::Running
        } else {
            Phase::Waiting
        };
        status.learner.clone_from(&self.student.learner);
        status.exercise.clone_from(&self.plan.exercise.name);
        status.mode = self.plan.mode.to_string();
        status.recording = self.running.file_name().to_owned();
        status.tick = ports.tick();
        status.rate_hz = self.plan.scene.params.rate_hz;
        status.elapsed_ms = self.clock.elapsed(now).as_millis() as u64;
        status.gap_ms = u32::try_from(self.clock.gap(now).as_millis()).unwrap_or(u32::MAX);
        status.gaps = self.clock.count();
        status.behind_ms = ports.hand().map(|hand| {
            let ticks = hand.newest().saturating_sub(ports.tick());
            let ms = ticks.saturating_mul(self.plan.scene.params.tick_ns()) / 1_000_000;
            u32::try_from(ms).unwrap_or(u32::MAX)
        });
        status.poses_lost = ports.datagrams().counts().lost;
        live.fill(status);
    }

    /// Reason to end the session now.
    pub fn check(&mut self, now: Instant, station: &str) -> Option<EndReason> {
        let ports = self.running.ports();
        if Flags::is_up(&ports.flags().record_failed) {
            return Some(EndReason::Recording);
        }
        if Flags::is_up(&ports.flags().diverged) {
            return Some(EndReason::Diverged);
        }
        if Flags::is_up(&ports.flags().simulation_over) {
            return Some(EndReason::Simulation);
        }
        // Ticks at the hand go on in gaps, and may be handed in later: they count by themselves.
        let elapsed = match ports.hand() {
            Some(hand) => Duration::from_nanos(hand.newest() * self.plan.scene.params.tick_ns()),
            None => self.clock.elapsed(now),
        };
        if let Some(limit) = self.plan.max_session
            && elapsed >= limit
        {
            return Some(EndReason::TimeUp);
        }
        // A client that is alive hands the rest in within this time.
        if ports
            .hand()
            .is_some_and(|hand| hand.handing_in() >= HAND_IN)
        {
            return Some(EndReason::TimeUp);
        }
        if self.present.is_none() {
            let over = self.clock.gap(now) >= self.plan.resume_within;
            return over.then_some(EndReason::ConnectionLost);
        }
        let batches = ports.hand().map_or(0, HandPort::batches);
        let accepted = ports.datagrams().counts().accepted + batches;
        if accepted != self.heard.0 {
            self.heard = (accepted, now);
            return None;
        }
        let silent = now.saturating_duration_since(self.heard.1);
        if silent < self.plan.max_silence {
            return None;
        }
        tracing::warn!(
            "station {station}: the session ends: no new pose for {:.1} s, expected one within {:.0} s",
            silent.as_secs_f64(),
            self.plan.max_silence.as_secs_f64()
        );
        Some(EndReason::ConnectionLost)
    }
}
