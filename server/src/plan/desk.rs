//! Desk: present plans of the stations, and their way from a change to a session that is ready to run.

use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Duration;

use serde_json::{Value, json};
use sulcus_link::clock::unix_ns;
use sulcus_proto::control::{Answer, Instruction};
use sulcus_proto::station::Phase;
use sulcus_sessions::Mode;

use super::{
    ClockInGap, Plan, PlanBook, PlanChange, PlanError, Prepared, Revision, Running, StationPlan,
    prepare,
};
use crate::capacity::measure_cost;
use crate::control_socket::{Control, StationCommand};
use crate::station::config::{Changed, SessionPlan};
use crate::station::door::{Door, ToStation};
use crate::station::planner::{NewPlan, Planner, RecordingsState};
use crate::{Budget, Detail};

/// Author of a change after the end of a seat.
const SEAT: &str = "end of a seat";

/// Plans of the stations of a running server.
pub struct Desk {
    book: Mutex<PlanBook>,
    doors: OnceLock<Vec<Door>>,
    /// State of the folder of recordings; not set without a quota.
    recordings: OnceLock<RecordingsState>,
    /// Whether the cost of a tick is measured for each plan.
    measures: bool,
}

impl Desk {
    /// Desk with the plans of `book`. With `measures` each compiled plan gets the cost of its ticks.
    pub fn new(book: PlanBook, measures: bool) -> Arc<Self> {
        Arc::new(Self {
            book: Mutex::new(book),
            doors: OnceLock::new(),
            recordings: OnceLock::new(),
            measures,
        })
    }

    fn book(&self) -> MutexGuard<'_, PlanBook> {
        self.book.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn door(&self, station: &str) -> Option<&Door> {
        let doors = self.doors.get()?;
        doors.iter().find(|door| *door.name == *station)
    }

    /// Session that runs at a station.
    fn running(&self, station: &str) -> Option<Running> {
        let status = self.door(station)?.status();
        let runs = matches!(status.phase, Phase::Running | Phase::Waiting);
        let mode = Mode::from_name(&status.mode).unwrap_or_default();
        runs.then_some(Running { mode })
    }

    /// Compiles the present plan of a station.
    ///
    /// # Errors
    /// The station is unknown, or the plan cannot be compiled: see [`prepare()`].
    pub fn compile(
        &self,
        station: &str,
        progress: &dyn Fn(&str, f64),
    ) -> anyhow::Result<(SessionPlan, Vec<String>)> {
        let (plan, revision) = {
            let book = self.book();
            let found = book.plan(station);
            let (plan, revision) =
                found.ok_or_else(|| anyhow::anyhow!("station `{station}` is unknown"))?;
            (plan.clone(), revision.clone())
        };
        let prepared = prepare(&plan, progress)?;
        let warnings = prepared.warnings.clone();
        Ok((self.ready(&plan, &revision, prepared)?, warnings))
    }

    /// Session plan of a compiled plan.
    fn ready(
        &self,
        plan: &Plan,
        revision: &Revision,
        prepared: Prepared,
    ) -> anyhow::Result<SessionPlan> {
        let cost = match self.measures {
            true => Some(measure_cost(&prepared.scene)?),
            false => None,
        };
        let mut ready = SessionPlan::new(Arc::new(prepared.scene), Arc::new(prepared.bytes));
        ready.revision = revision.number;
        ready.changed = (revision.number > 1).then(|| Changed {
            unix_ns: revision.changed_unix_ns,
            by: revision.by.clone(),
        });
        ready.exercise = prepared.exercise;
        ready.learner.clone_from(&plan.learner);
        ready.mode = plan.mode;
        ready.patient = prepared.patient;
        ready.rubric = prepared.rubric;
        if let Some(budget_us) = plan.detail_budget_us {
            ready.detail = Detail::ByTime(Budget {
                budget_us,
                ..Budget::default()
            });
        }
        let seconds = |s: u32| Duration::from_secs(u64::from(s));
        ready.max_session = plan.time_limit_s.map(seconds);
        ready.resume_within = seconds(plan.resume_within_s);
        ready.clock_in_gap = plan.clock_in_gap == ClockInGap::Runs;
        ready.force_limit_n = plan.force_limit_n.unwrap_or(0.0);
        ready.tick_at_hand = plan.tick_at_hand.unwrap_or(plan.mode != Mode::Exam);
        // A drawn patient is that of one session.
        ready.renews = prepared.seed.is_some() && plan.draws_its_patient();
        ready.cost = cost;
        ready.show()?;
        ready.validate()?;
        Ok(ready)
    }

    /// Changes a plan: compiled first, then set and kept, so that a plan that cannot run is never set.
    fn change(
        &self,
        station: &str,
        change: &PlanChange,
        by: &str,
    ) -> Result<(StationPlan, SessionPlan), PlanError> {
        let present = self.book().plan(station).map(|(plan, _)| plan.clone());
        let running = self.running(station);
        let Some(present) = present else {
            // The book names the known stations.
            let set = self.book().set(station, change, by, running, unix_ns());
            return Err(match set {
                Err(error) => error,
                Ok(_) => not_ready(station, "the station is unknown"),
            });
        };
        let plan = present.with(change).map_err(|fault| PlanError::Fault {
            station: station.to_owned(),
            fault,
        })?;
        let prepared = prepare(&plan, &|_, _| ());
        let prepared = prepared.map_err(|error| not_ready(station, &format!("{error:#}")))?;
        let set = self.book().set(station, change, by, running, unix_ns())?;
        let ready = self.ready(&set.plan, &set.revision, prepared);
        let ready = ready.map_err(|error| not_ready(station, &format!("{error:#}")))?;
        Ok((set, ready))
    }

    /// Hands a plan to its station.
    fn hand_over(&self, station: &str, plan: SessionPlan) {
        let Some(door) = self.door(station) else {
            return;
        };
        if !door.try_tell(ToStation::Plan(Box::new(plan))) {
            tracing::error!("station {station}: busy, the new plan is used after a restart");
        }
    }
}

fn not_ready(station: &str, why: &str) -> PlanError {
    PlanError::NotReady {
        station: station.to_owned(),
        why: why.to_owned(),
    }
}

impl Planner for Desk {
    fn connect(&self, doors: &[Door]) {
        // A second server with the same desk has the same stations.
        let _ = self.doors.set(doors.to_vec());
    }

    fn connect_recordings(&self, state: RecordingsState) {
        // The same server calls this once.
        let _ = self.recordings.set(state);
    }

    fn change(&self, asked: &NewPlan) -> Result<SessionPlan, String> {
        let NewPlan {
            station,
            text,
            by,
            exams,
        } = asked;
        let change =
            PlanChange::parse(text, Path::new("plan")).map_err(|error| error.to_string())?;
        let before = self.book().plan(station).map(|(plan, _)| plan.mode);
        let exam = change.mode == Some(Mode::Exam) || before == Some(Mode::Exam);
        if exam && !exams {
            return Err("a plan of an exam needs the role examiner or admin".into());
        }
        match Desk::change(self, station, &change, by) {
            Ok((_, plan)) => Ok(plan),
            Err(error) => Err(error.to_string()),
        }
    }

    fn renew(&self, station: &str) -> Result<SessionPlan, String> {
        let compiled = self.compile(station, &|_, _| ());
        compiled
            .map(|(plan, _)| plan)
            .map_err(|error| format!("{error:#}"))
    }

    fn leave(&self, station: &str, had_task: bool) -> Result<SessionPlan, String> {
        let nobody = PlanChange {
            learner: Some(String::new()),
            ..PlanChange::default()
        };
        // The session has ended, whatever the status that is published next still says.
        let set = match had_task {
            true => self.book().reset(station, SEAT, None, unix_ns()),
            false => self.book().set(station, &nobody, SEAT, None, unix_ns()),
        };
        set.map_err(|error| error.to_string())?;
        self.renew(station)
    }
}

impl Control for Desk {
    fn plans(&self) -> Vec<StationPlan> {
        self.book().all(|station| self.running(station))
    }

    fn set_plan(
        &self,
        station: &str,
        change: &PlanChange,
        by: &str,
    ) -> Result<StationPlan, PlanError> {
        let (set, plan) = Desk::change(self, station, change, by)?;
        self.hand_over(station, plan);
        Ok(set)
    }

    fn reset_plan(&self, station: &str, by: &str) -> Result<StationPlan, PlanError> {
        let running = self.running(station);
        let set = self.book().reset(station, by, running, unix_ns())?;
        let compiled = self.compile(station, &|_, _| ());
        let (plan, _) = compiled.map_err(|error| not_ready(station, &format!("{error:#}")))?;
        self.hand_over(station, plan);
        Ok(set)
    }

    fn status(&self) -> Value {
        let doors = self.doors.get().map(Vec::as_slice).unwrap_or_default();
        let stations: Vec<_> = doors.iter().map(Door::status).collect();
        let recordings = self.recordings.get().map(|state| state());
        json!({ "stations": stations, "recordings": recordings })
    }

    fn command(&self, station: &str, command: StationCommand, by: &str) -> Result<Value, String> {
        let door = self
            .door(station)
            .ok_or_else(|| format!("station `{}` is unknown", station.escape_debug()))?;
        let instruction = match command {
            StationCommand::Pause => Instruction::Pause,
            StationCommand::Resume => Instruction::Resume,
            StationCommand::ForceLimit(newtons) => Instruction::ForceLimit(newtons),
        };
        let by = by.to_owned();
        let answer = door.ask_blocking(|reply| ToStation::Instruct {
            by,
            instruction,
            exams: true,
            reply,
        });
        match answer {
            Some(Answer {
                taken: true, tick, ..
            }) => Ok(json!({ "tick": tick })),
            Some(Answer { text, .. }) => Err(text),
            None => Err("the station is ending".into()),
        }
    }
}
