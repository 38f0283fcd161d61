//! Instructions of instructors to a station, each answered with the first tick that obeys it.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use serde_json::json;
use sulcus_proto::control::{Answer, Command, EndReason, Instruction, Say};
use sulcus_sessions::{Mode, Occurrence};
use tokio::sync::oneshot;

use crate::net::codes::Left;
use crate::session::levels::Taken;
use crate::session::ports::Ports;
use crate::station::actor::{State, Station};
use crate::station::config::SessionPlan;
use crate::station::door::ToStudent;
use crate::station::ghost::Read;
use crate::station::planner::{NewPlan, Planner};

/// Timeout for a tick that obeys a command. A simulation that does not tick by then has failed.
const OBEYED: Duration = Duration::from_secs(2);
/// The same for ticks at the hand: a connection that is lost for longer returns as a gap of the session.
const OBEYED_AT_HAND: Duration = Duration::from_secs(60);
/// Interval between two looks at the newest tick.
const LOOK: Duration = Duration::from_millis(2);

/// Result of a thread that worked for the station.
pub(super) enum Prepared {
    /// A plan that has been compiled, or the reason why not, and the instructor who waits for it.
    Plan {
        plan: Box<Result<SessionPlan, String>>,
        reply: Option<oneshot::Sender<Answer>>,
    },
    /// Path of a ghost.
    Ghost(Read),
}

/// Answer of an instruction that is in force from `tick` on; 0: without a session.
fn taken(tick: u64) -> Answer {
    Answer {
        number: 0,
        taken: true,
        tick,
        text: String::new(),
    }
}

pub(super) fn refused(text: &str) -> Answer {
    Answer {
        number: 0,
        taken: false,
        tick: 0,
        text: text.to_owned(),
    }
}

impl Station {
    /// Carries out an instruction of `by`, an opaque token id.
    pub(super) fn instruct(
        &mut self,
        by: String,
        instruction: Instruction,
        exams: bool,
        reply: oneshot::Sender<Answer>,
    ) {
        let command = match &instruction {
            Instruction::Pause => Some(Command::Pause),
            Instruction::Resume => Some(Command::Resume),
            Instruction::ForceLimit(newtons) => Some(Command::ForceLimit(*newtons)),
            _ => None,
        };
        if let Some(command) = command {
            return self.level(by, command, reply);
        }
        let said = |kind: &str, text: &str| Occurrence {
            kind: kind.to_owned(),
            tick: 0,
            data: json!({ "by": by, "text": text }),
        };
        let answer = match &instruction {
            Instruction::Note(text) => self.log(said("note", text)),
            Instruction::Flag(text) => self.log(said("flag", text)),
            Instruction::Say(text) => {
                let answer = self.log(said("message", text));
                if answer.taken {
                    self.say(&by, text, answer)
                } else {
                    answer
                }
            }
            Instruction::End => {
                let answer = self.log(said("ended", ""));
                if answer.taken {
                    self.end_now(EndReason::Instructor);
                }
                answer
            }
            Instruction::Plan(text) => return self.plan(by, text.clone(), exams, reply),
            Instruction::Ghost(file) => return self.ghost(by, file.clone(), reply),
            Instruction::Pause | Instruction::Resume | Instruction::ForceLimit(_) => return,
        };
        // An error means that the instructor has left.
        let _ = reply.send(answer);
    }

    /// Sets a level of the station's side. The answer waits for the tick that obeys it.
    fn level(&mut self, by: String, command: Command, reply: oneshot::Sender<Answer>) {
        match self.door.levels.station(command) {
            Taken::NoForce(newtons) => {
                let text = format!(
                    "force limit is {newtons} N, expected 0 (the scene's limit) or a positive force"
                );
                let _ = reply.send(refused(&text));
                return;
            }
            Taken::Lifted => self.new_epoch(),
            Taken::Set => {}
        }
        let number = self.door.levels.commands();
        self.set_by.clone_from(&by);
        let State::Running(session) = &self.state else {
            let _ = reply.send(taken(0));
            return;
        };
        let ports = session.running.ports().clone();
        tokio::spawn(async move {
            let answer = match obeyed(&ports, number).await {
                Some(tick) => {
                    ports.occurrence(Occurrence {
                        kind: "instructed".into(),
                        tick,
                        data: match command {
                            Command::Pause => json!({ "by": by, "level": "paused" }),
                            Command::Resume => json!({ "by": by, "level": "resumed" }),
                            Command::ForceLimit(newtons) => {
                                json!({ "by": by, "level": "force_limit", "force_limit_n": newtons })
                            }
                        },
                    });
                    taken(tick)
                }
                None => refused("the simulation has not answered within 2 s"),
            };
            let _ = reply.send(answer);
        });
    }

    /// Writes an event of an instructor into the recording.
    pub(super) fn log(&self, mut said: Occurrence) -> Answer {
        let State::Running(session) = &self.state else {
            return refused("no session runs at this station");
        };
        let ports = session.running.ports();
        said.tick = ports.tick();
        let tick = said.tick;
        if ports.occurrence(said) {
            taken(tick)
        } else {
            refused("the recorder's queue is full")
        }
    }

    /// Sends a message to the attached student.
    fn say(&mut self, by: &str, text: &str, answer: Answer) -> Answer {
        let State::Running(session) = &self.state else {
            return answer;
        };
        let say = Say {
            by: by.to_owned(),
            text: text.to_owned(),
        };
        let sent = session
            .present
            .as_ref()
            .is_some_and(|present| present.to_student.try_send(ToStudent::Say(say)).is_ok());
        if sent {
            answer
        } else {
            let text = "recorded; the student is not connected".to_owned();
            Answer { text, ..answer }
        }
    }

    /// Compiles a plan on a thread of its own. [`Station::planned`] takes the result.
    fn plan(&mut self, by: String, text: String, exams: bool, reply: oneshot::Sender<Answer>) {
        if let Some(why) = self.exam_runs() {
            let _ = reply.send(refused(why));
            return;
        }
        let asked = NewPlan {
            station: self.door.name.to_string(),
            text,
            by,
            exams,
        };
        self.compile(Some(reply), move |planner| planner.change(&asked));
    }

    /// Compiles the present plan anew: the patient of an exam is that of one session.
    pub(super) fn renew(&mut self) {
        let station = self.door.name.to_string();
        self.compile(None, move |planner| planner.renew(&station));
    }

    /// Ends a seat: the next learner is not the one of before, and the station has its own plan again.
    pub(super) fn leave(&mut self, left: Left) {
        // A student who comes before the plan is compiled is not that learner either.
        Arc::make_mut(&mut self.plan).learner.clear();
        let station = self.door.name.to_string();
        self.compile(None, move |planner| planner.leave(&station, left.had_task));
    }

    fn compile(
        &mut self,
        reply: Option<oneshot::Sender<Answer>>,
        work: impl FnOnce(&dyn Planner) -> Result<SessionPlan, String> + Send + 'static,
    ) {
        let shared = self.shared.clone();
        let to_self = self.prepared.0.clone();
        tokio::spawn(async move {
            let compiled = tokio::task::spawn_blocking(move || work(&*shared.config.planner));
            let plan = compiled
                .await
                .unwrap_or_else(|_| Err("the compiler of the scene ended unexpectedly".into()));
            let plan = Box::new(plan);
            let _ = to_self.send(Prepared::Plan { plan, reply }).await;
        });
    }

    /// Takes the result of a thread.
    pub(super) fn prepared(&mut self, prepared: Prepared) {
        match prepared {
            Prepared::Plan { plan, reply } => self.planned(*plan, reply),
            Prepared::Ghost(read) => self.show_ghost(read),
        }
    }

    /// Takes a compiled plan for the next session.
    fn planned(
        &mut self,
        plan: Result<SessionPlan, String>,
        reply: Option<oneshot::Sender<Answer>>,
    ) {
        let answer = match plan {
            Ok(plan) => {
                self.set_plan(plan);
                taken(0)
            }
            Err(why) => {
                if reply.is_none() {
                    tracing::error!("station {}: {why}", self.door.name);
                }
                refused(&why)
            }
        };
        if let Some(reply) = reply {
            let _ = reply.send(answer);
        }
    }

    /// Reason why the plan cannot be changed now.
    fn exam_runs(&self) -> Option<&'static str> {
        match &self.state {
            State::Running(session) if session.plan.mode == Mode::Exam => Some(EXAM_RUNS),
            _ => None,
        }
    }
}

const EXAM_RUNS: &str = "an exam runs at this station; its plan can be changed after its end";

/// First tick that obeys the command `number` of the station's side; `None` after [`OBEYED`].
async fn obeyed(ports: &Ports, number: u64) -> Option<u64> {
    let begin = tokio::time::Instant::now();
    loop {
        let progress = ports.progress();
        if progress.commands.load(Ordering::Acquire) >= number {
            return Some(progress.since.load(Ordering::Relaxed));
        }
        // A hand far away may be out of reach for a while.
        let patience = if ports.hand().is_some() {
            OBEYED_AT_HAND
        } else {
            OBEYED
        };
        if begin.elapsed() >= patience {
            return None;
        }
        tokio::time::sleep(LOOK).await;
    }
}
