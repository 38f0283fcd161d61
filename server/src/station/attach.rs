//! Students who come to a station: whom it takes, and with which plan and couplings.

use std::time::Instant;

use sulcus_proto::control::{EndReason, Refused, RefusedReason};
use sulcus_proto::station::StationEvent;
use tokio::sync::mpsc;

use crate::net::Stage;
use crate::net::hello::clean;
use crate::session::coupling;
use crate::station::actor::{Present, State, Station};
use crate::station::config::Exercise;
use crate::station::door::{Attached, Student, ToStudent};
use crate::station::quota;

/// Number of messages that wait for a student. A student who reads none is gone soon.
const HEARS: usize = 64;
const TICKS_GONE: &str = "the ticks of the running session ran in a program that is gone; its recording is being finished, connect again in a moment";
const IN_USE: &str = "this station is in use by another client; wait until its session ends";

impl Station {
    /// Takes a student: a free station gets ready, a session gets its student back.
    pub(super) fn attach(&mut self, student: Student) -> Result<Attached, Refused> {
        if *self.shared.stage.borrow() != Stage::Serve {
            return refused(RefusedReason::Server, "the server is ending");
        }
        if let Some(text) = self.occupied(&student) {
            return refused(RefusedReason::Busy, &text);
        }
        if let State::Running(session) = &self.state
            && session.running.ports().hand().is_some()
            && student.follows == 0
        {
            // The state of the ticks is lost with the program that computed them.
            self.end_now(EndReason::ConnectionLost);
            return refused(RefusedReason::Busy, TICKS_GONE);
        }
        let (plan, couplings) = match &self.state {
            State::Running(session) => {
                let (scene, devices) = (&session.plan.scene, &student.devices);
                if let Some(text) = coupling::too_stiff(scene, &session.couplings, devices) {
                    return refused(RefusedReason::Device, &text);
                }
                (session.plan.clone(), session.couplings.clone())
            }
            _ => {
                let couplings = coupling::in_force(&self.plan.scene, &student.devices);
                (self.plan.clone(), couplings)
            }
        };
        // A station with free exploration accepts every exercise.
        let offered = &plan.exercise.name;
        let free = *offered == Exercise::default().name;
        if !student.exercise.is_empty() && !free && &student.exercise != offered {
            let text = format!(
                "exercise `{}` is not offered here; this station offers `{offered}`",
                clean(&student.exercise)
            );
            return refused(RefusedReason::Exercise, &text);
        }
        if matches!(self.state, State::Free) {
            let rate_hz = plan.scene.params.rate_hz;
            match self.shared.admit(self.number, plan.cost, rate_hz) {
                Ok(core) => self.core = core,
                Err(text) => return refused(RefusedReason::Full, &text),
            }
            let forecast = quota::forecast(self.shared.config.viewers, &plan);
            let reserved = self.shared.reserve(self.number, forecast);
            if let Err(text) = reserved {
                self.shared.release(self.number);
                self.core = None;
                self.tell_refusal(&text);
                return refused(RefusedReason::Full, &text);
            }
        }
        let at_hand = match &self.state {
            State::Running(session) => Ok(session.running.ports().hand().is_some()),
            _ => student.wish.granted(&plan),
        };
        let epoch = self.next_epoch();
        let (to_student, hears) = mpsc::channel(HEARS);
        let present = Present { epoch, to_student };
        let now = Instant::now();
        let (ports, before) = match &mut self.state {
            State::Running(session) => {
                let before = session.present.replace(present);
                session.bring(student.devices);
                session.attached(epoch, before.is_some(), now);
                (Some(session.running.ports().clone()), before)
            }
            other => {
                let state = State::Ready {
                    student: Box::new(student),
                    present,
                    told: plan.clone(),
                    at_hand: at_hand == Ok(true),
                    since: now,
                };
                match std::mem::replace(other, state) {
                    State::Ready { present, .. } => (None, Some(present)),
                    _ => {
                        let limit_n = self.plan.force_limit_n;
                        self.levels = self.door.levels.of_new_session(limit_n);
                        (None, None)
                    }
                }
            }
        };
        if let Some(before) = before {
            let _ = before.to_student.try_send(ToStudent::Replaced);
        }
        Ok(Attached {
            epoch,
            plan,
            couplings,
            ports,
            at_hand,
            levels: self.levels.clone(),
            hears,
        })
    }

    /// Tells the log and all instructors that a session was refused. An error means that nobody listens.
    fn tell_refusal(&self, text: &str) {
        tracing::warn!("station {}: a session is refused: {text}", self.door.name);
        let why = serde_json::json!({ "why": text });
        let _ = self.behind.events.send(StationEvent {
            station: self.door.name.to_string(),
            tick: 0,
            text: format!("session_refused at tick 0: {why}"),
        });
    }

    /// Reason why a student cannot attach now; `None` if the student can.
    fn occupied(&self, student: &Student) -> Option<String> {
        let (first, present) = match &self.state {
            State::Free => return None,
            State::Ending { .. } => {
                let text =
                    "the last session's recording is being finished; connect again in a moment";
                return Some(text.to_owned());
            }
            State::Ready {
                student, present, ..
            } => (&**student, Some(present)),
            State::Running(session) => (&session.student, session.present.as_ref()),
        };
        match (present, &self.state) {
            // A client that connects again before its old connection has timed out.
            (Some(present), _) if first.is_same(student) && student.follows == present.epoch => {
                None
            }
            (None, _) if first.is_same(student) => None,
            (None, State::Running(session)) => {
                let gap = session.clock.gap(Instant::now());
                let left = session.plan.resume_within.saturating_sub(gap).as_secs() + 1;
                Some(format!(
                    "this station is in use: its session waits {left} s more for the return of its learner"
                ))
            }
            _ => Some(IN_USE.to_owned()),
        }
    }
}

fn refused<T>(reason: RefusedReason, text: &str) -> Result<T, Refused> {
    Err(Refused {
        reason,
        text: text.to_owned(),
    })
}
