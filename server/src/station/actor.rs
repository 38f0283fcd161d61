//! Task of a station: the life of its sessions. Connections attach and detach; the session goes on.
//!
//! | phase | leaves by |
//! |---|---|
//! | free | a student attaches |
//! | ready | start, stop, a lost connection, 20 s without a start |
//! | running | stop, time limit, an instructor's end, a failure, the end of the server |
//! | waiting: running without its student | the return of the same token, `resume_within` |
//! | ending: the recording is being finished | its end |

use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

use sulcus_proto::SessionSummary;
use sulcus_proto::control::{EndReason, Goodbye};
use sulcus_proto::station::{Phase, StationStatus};
use sulcus_sessions::Detached;
use tokio::sync::mpsc;
use tokio::task::JoinHandle;

use crate::net::Stage;
use crate::net::codes::Left;
use crate::net::hello::names_of;
use crate::outlets::opening::Opening;
use crate::outlets::status::Live;
use crate::session::coupling;
use crate::session::handoff::Provoked;
use crate::session::levels::Levels;
use crate::session::loops::Begin;
use crate::session::ports::Ports;
use crate::session::running::Running;
use crate::station::config::SessionPlan;
use crate::station::door::{Behind, Door, Student, ToStation, ToStudent, goodbye};
use crate::station::gap::SessionClock;
use crate::station::journal::Journal;
use crate::station::quota::forecast;
use crate::station::session::Session;
use crate::station::shared::Shared;

/// Timeout from a student's attach to the start. In this time the station is in use.
const START: Duration = Duration::from_secs(20);
/// Interval at which limits of time and failures are checked.
const CHECK: Duration = Duration::from_millis(20);
/// Number of checks between two statuses: five statuses a second.
const CHECKS_PER_STATUS: u32 = 10;
/// The connection of an attached student, as the station sees it.
pub(super) struct Present {
    pub epoch: u32,
    pub to_student: mpsc::Sender<ToStudent>,
}

/// Summary and sentence of a finished session, and the seat that ended with it.
type Finished = (SessionSummary, String, Option<Left>);

pub(super) enum State {
    Free,
    Ready {
        student: Box<Student>,
        present: Present,
        /// Plan that the student was told, and whether the ticks run at the hand.
        told: Arc<SessionPlan>,
        at_hand: bool,
        since: Instant,
    },
    Running(Box<Session>),
    /// Recording of a session that is being finished, and the student who hears its goodbye.
    Ending {
        finishing: JoinHandle<Finished>,
        present: Option<Present>,
    },
}

/// A station: plan, levels, session.
pub(crate) struct Station {
    pub(super) shared: Arc<Shared>,
    pub(super) door: Door,
    pub(super) behind: Behind,
    pub(super) plan: Arc<SessionPlan>,
    /// Levels of the next or running session.
    pub(super) levels: Levels,
    pub(super) state: State,
    /// Id of the token that set pause or limit last.
    pub(super) set_by: String,
    pub(super) epoch: u32,
    /// Number of the station at the server, from 0 on.
    pub(super) number: usize,
    /// Core of the session; `None`: any.
    pub(super) core: Option<usize>,
    /// Status of the running session, by its recorder.
    live: Arc<Live>,
    journal: Journal,
    /// Messages from tasks of this station to itself: compiled plans, paths of ghosts.
    pub(super) prepared: (
        mpsc::Sender<super::instruct::Prepared>,
        mpsc::Receiver<super::instruct::Prepared>,
    ),
}

impl Station {
    /// A free station, the `number`-th of the server.
    pub fn new(
        shared: Arc<Shared>,
        number: usize,
        door: Door,
        behind: Behind,
        plan: SessionPlan,
    ) -> Self {
        let journal = Journal::of(shared.config.journal.as_deref(), &door.name);
        if let Some(quota) = &shared.quota {
            quota.planned(number, forecast(shared.config.viewers, &plan));
        }
        Self {
            levels: door.levels.of_new_session(plan.force_limit_n),
            number,
            core: None,
            plan: Arc::new(plan),
            state: State::Free,
            set_by: String::new(),
            epoch: 0,
            live: Arc::default(),
            journal,
            prepared: mpsc::channel(4),
            shared,
            door,
            behind,
        }
    }

    /// Ends of the door, for a successor.
    pub fn into_behind(self) -> Behind {
        self.behind
    }

    /// Runs the station until the server ends and its session is finished.
    pub async fn run(&mut self) {
        self.show();
        let mut stage = self.shared.stage.clone();
        let mut check = tokio::time::interval(CHECK);
        check.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        let mut checks = 0;
        loop {
            if *stage.borrow_and_update() != Stage::Serve {
                self.end_now(EndReason::Shutdown);
                if matches!(self.state, State::Free) {
                    return;
                }
            }
            tokio::select! {
                message = self.behind.messages.recv() => match message {
                    Some(message) => self.take(message).await,
                    None => return,
                },
                prepared = self.prepared.1.recv() => if let Some(prepared) = prepared {
                    self.prepared(prepared);
                },
                finished = finished(&mut self.state) => self.finished(finished),
                _ = stage.changed() => {}
                _ = check.tick() => {
                    self.check();
                    checks += 1;
                    if checks % CHECKS_PER_STATUS == 0 {
                        self.publish();
                    }
                }
            }
        }
    }

    async fn take(&mut self, message: ToStation) {
        match message {
            ToStation::Attach { student, reply } => {
                let answer = self.attach(*student);
                let epoch = answer.as_ref().ok().map(|attached| attached.epoch);
                if let (Err(_), Some(epoch)) = (reply.send(answer), epoch) {
                    let why = "the connection ended while it attached";
                    self.gone(epoch, Detached::ConnectionLost, why);
                }
            }
            ToStation::Start { epoch, reply } => {
                let started = self.start(epoch).await;
                let _ = reply.send(started);
            }
            ToStation::End { epoch, reason } => {
                if self.present_epoch() == Some(epoch) {
                    self.end_now(reason);
                }
            }
            ToStation::Gone { epoch, reason, why } => self.gone(epoch, reason, &why),
            ToStation::Lifted { epoch } => {
                if epoch.is_none() || self.present_epoch() == epoch {
                    self.new_epoch();
                }
            }
            ToStation::Instruct {
                by,
                instruction,
                exams,
                reply,
            } => self.instruct(by, instruction, exams, reply),
            ToStation::Plan(plan) => self.set_plan(*plan),
            ToStation::Provoke(Provoked::Station) => panic!("a fault that a test provokes"),
            ToStation::Provoke(fault) => {
                if let State::Running(session) = &self.state {
                    session.running.provoke(fault);
                }
            }
        }
        self.publish();
    }

    /// Takes a plan for the next session. Displays of a free station show its scene at rest.
    pub(super) fn set_plan(&mut self, plan: SessionPlan) {
        if let Some(quota) = &self.shared.quota {
            let viewers = self.shared.config.viewers;
            quota.planned(self.number, forecast(viewers, &plan));
        }
        self.plan = Arc::new(plan);
        self.show();
    }

    fn show(&self) {
        if let (State::Free, Some(display)) = (&self.state, &self.plan.display) {
            let feed = self.behind.feed.lock();
            let mut feed = feed.unwrap_or_else(PoisonError::into_inner);
            feed.begin(display.clone());
        }
    }

    /// Epoch of the attached student.
    fn present_epoch(&self) -> Option<u32> {
        let present = match &self.state {
            State::Ready { present, .. } => Some(present),
            State::Running(session) => session.present.as_ref(),
            State::Free | State::Ending { .. } => None,
        };
        present.map(|present| present.epoch)
    }

    /// Next epoch. After the largest number comes 1; 0 is never used.
    pub(super) fn next_epoch(&mut self) -> u32 {
        self.epoch = self.epoch.wrapping_add(1).max(1);
        self.epoch
    }

    /// Starts the session of the attached student. A session that runs already is not started again.
    async fn start(&mut self, epoch: u32) -> Result<Arc<Ports>, Box<Goodbye>> {
        let name = self.door.name.to_string();
        if let State::Running(session) = &self.state {
            return Ok(session.running.ports().clone());
        }
        if self.present_epoch() != Some(epoch) {
            let text = "The connection is no longer attached.";
            return Err(goodbye(&name, EndReason::ConnectionLost, text));
        }
        let State::Ready {
            student,
            present,
            told,
            at_hand,
            ..
        } = std::mem::replace(&mut self.state, State::Free)
        else {
            let text = "No session can be started now.";
            return Err(goodbye(&name, EndReason::Simulation, text));
        };
        let plan = self.plan.clone();
        if at_hand && !Arc::ptr_eq(&told, &plan) {
            // The client ticks with the scene of the former plan.
            let text = "The plan of this station has changed; connect again.";
            self.free();
            return Err(goodbye(&name, EndReason::Simulation, text));
        }
        let learner = if student.learner.is_empty() {
            plan.learner.clone()
        } else {
            student.learner.clone()
        };
        let folder = &self.shared.config.recordings;
        let interrupted = self.journal.predecessor(&student.grant.id, &learner, &plan);
        let predecessor = interrupted.map(|file| folder.join(file));
        let couplings = coupling::in_force(&plan.scene, &student.devices);
        let opening = Opening {
            plan: plan.clone(),
            softer: if couplings == plan.scene.couplings() {
                Vec::new()
            } else {
                couplings.clone()
            },
            folder: self.shared.config.recordings.clone(),
            viewers: self.shared.config.viewers,
            key: self.shared.config.station_key.clone(),
            station: name.clone(),
            learner: learner.clone(),
            client: format!(
                "client {} with device {}",
                student.program,
                names_of(&student.devices)
            ),
            devices: student.devices.clone(),
            epoch,
            predecessor,
            live: self.live.clone(),
            events: self.behind.events.clone(),
            feed: self.behind.feed.clone(),
        };
        let begin = Begin {
            epoch,
            levels: self.levels.clone(),
            real_time: self.shared.config.real_time,
            places: self.shared.places.clone(),
            core: self.core,
            at_hand,
        };
        // The start of a recording writes the whole scene. The thread of the packets must not wait for it.
        let opened = tokio::task::spawn_blocking(move || Running::start(opening, begin)).await;
        let running = match opened {
            Ok(Ok(running)) => running,
            Ok(Err((reason, text))) => {
                tracing::error!("station {name}: {text}");
                let bye = goodbye(&name, reason, &text);
                self.shared.ended(bye.summary.clone());
                self.free();
                return Err(bye);
            }
            Err(_) => {
                self.free();
                let text = "The session could not be started.";
                return Err(goodbye(&name, EndReason::Simulation, text));
            }
        };
        self.journal
            .begin(running.file_name(), &student.grant.id, &learner, &plan);
        if let Some(quota) = &self.shared.quota {
            quota.began(self.number, running.file_name());
        }
        let ports = running.ports().clone();
        let now = Instant::now();
        let student = Student {
            learner,
            ..*student
        };
        self.state = State::Running(Box::new(Session {
            running,
            student,
            clock: SessionClock::begin(now, plan.clock_in_gap),
            plan,
            couplings,
            present: Some(present),
            gap_tick: 0,
            gap_ticks: 0,
            heard: (0, now),
        }));
        Ok(ports)
    }

    /// Handles the loss of a connection. Only the attached connection counts.
    fn gone(&mut self, epoch: u32, reason: Detached, why: &str) {
        if self.present_epoch() != Some(epoch) {
            return;
        }
        match &mut self.state {
            State::Running(session) if !session.plan.resume_within.is_zero() => {
                session.present = None;
                session.detached(reason, Instant::now());
                tracing::info!(
                    "station {}: the student is gone ({why}); the session waits {} s",
                    self.door.name,
                    session.plan.resume_within.as_secs()
                );
            }
            _ => self.end_now(EndReason::ConnectionLost),
        }
    }

    /// Checks limits of time and failures of threads.
    fn check(&mut self) {
        let now = Instant::now();
        let reason = match &mut self.state {
            State::Free | State::Ending { .. } => None,
            State::Ready { since, .. } => {
                (now.saturating_duration_since(*since) >= START).then_some(EndReason::TimeUp)
            }
            State::Running(session) => session.check(now, &self.door.name),
        };
        if let Some(reason) = reason {
            self.end_now(reason);
        }
    }

    /// Begins the end of the session, if there is one. The goodbye follows when the recording is finished.
    pub(super) fn end_now(&mut self, reason: EndReason) {
        match std::mem::replace(&mut self.state, State::Free) {
            State::Free => {}
            ending @ State::Ending { .. } => self.state = ending,
            State::Ready { present, .. } => {
                tracing::info!(
                    "station {}: the client ended before a session was started ({reason:?})",
                    self.door.name
                );
                let text = match reason {
                    EndReason::TimeUp => format!(
                        "No session was started within {} s; connect again.",
                        START.as_secs()
                    ),
                    EndReason::Shutdown => "The server is shutting down.".to_owned(),
                    _ => "No session was started.".to_owned(),
                };
                let bye = goodbye(&self.door.name, reason, &text);
                let _ = present.to_student.try_send(ToStudent::Goodbye(bye));
                self.free();
            }
            State::Running(session) => {
                let Session {
                    running,
                    student,
                    present,
                    clock,
                    gap_tick,
                    mut gap_ticks,
                    ..
                } = *session;
                if clock.is_open() {
                    gap_ticks += running.ports().tick().saturating_sub(gap_tick);
                }
                let summary = SessionSummary {
                    station: self.door.name.to_string(),
                    gaps: clock.count(),
                    gap_ticks,
                    ..SessionSummary::empty(reason)
                };
                // The slow part on a thread of its own: joins threads and waits for the disk.
                let (codes, station) = (self.shared.config.codes.clone(), self.door.name.clone());
                let finishing = tokio::task::spawn_blocking(move || {
                    let (summary, text) = running.finish(summary);
                    let left = codes.left(&station, &student.learner);
                    (summary, text, left)
                });
                self.state = State::Ending { finishing, present };
            }
        }
    }

    fn finished(&mut self, finished: Result<Finished, tokio::task::JoinError>) {
        let State::Ending { present, .. } = std::mem::replace(&mut self.state, State::Free) else {
            return;
        };
        let (summary, text, left) = finished.unwrap_or_else(|_| {
            let summary = SessionSummary {
                station: self.door.name.to_string(),
                ..SessionSummary::empty(EndReason::Simulation)
            };
            (summary, "The session ended unexpectedly.".to_owned(), None)
        });
        tracing::info!(
            "station {}: the session has ended ({:?}): {} ticks, {} gaps, recording {}",
            self.door.name,
            summary.end,
            summary.ticks,
            summary.gaps,
            summary.recording
        );
        self.journal.end();
        self.shared.ended(summary.clone());
        if let Some(present) = present {
            let goodbye = Box::new(Goodbye { text, summary });
            let _ = present.to_student.try_send(ToStudent::Goodbye(goodbye));
        }
        match left {
            Some(left) => self.leave(left),
            None if self.plan.renews => self.renew(),
            None => {}
        }
        self.free();
    }

    /// Frees the place of a session on this machine, and forgets the levels of its student. A patient that was drawn is
    /// drawn anew.
    fn free(&mut self) {
        self.shared.release(self.number);
        self.core = None;
        self.levels = self.door.levels.of_new_session(self.plan.force_limit_n);
    }

    /// Begins a new epoch after the end of a pause: poses from before its end must not move a tool.
    pub(super) fn new_epoch(&mut self) {
        let epoch = self.next_epoch();
        let State::Running(session) = &mut self.state else {
            return;
        };
        session.running.ports().begin_epoch(epoch);
        if let Some(present) = &mut session.present {
            present.epoch = epoch;
            let _ = present.to_student.try_send(ToStudent::Epoch(epoch));
        }
    }

    /// Publishes the status, and corrects the cost of the session.
    fn publish(&mut self) {
        let in_force = self.levels.in_force();
        let plan = &self.plan;
        let mut status = StationStatus {
            station: self.door.name.to_string(),
            exercise: plan.exercise.name.clone(),
            mode: plan.mode.to_string(),
            plan_revision: plan.revision,
            rate_hz: plan.scene.params.rate_hz,
            paused: in_force.station.paused,
            paused_by_student: in_force.student.paused,
            force_limit_n: in_force.station.force_limit_n,
            set_by: self.set_by.clone(),
            disk_free_mib: self.shared.disk_free_mib(),
            ..StationStatus::default()
        };
        match &self.state {
            State::Free => {}
            State::Ready { student, .. } => {
                status.phase = Phase::Ready;
                status.learner.clone_from(&student.learner);
            }
            State::Running(session) => {
                session.fill(&mut status, &self.live);
                if let Some(cost) = self.plan.cost {
                    self.shared.correct(self.number, self.live.cost(cost));
                }
            }
            State::Ending { .. } => status.phase = Phase::Ending,
        }
        self.behind.status.send_replace(status);
    }
}

/// Waits for the end of a recording; never returns in another phase.
async fn finished(state: &mut State) -> Result<Finished, tokio::task::JoinError> {
    match state {
        State::Ending { finishing, .. } => finishing.await,
        _ => std::future::pending().await,
    }
}
