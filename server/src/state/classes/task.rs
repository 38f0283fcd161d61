//! Tasks of classes and learners, and the plan that a station gets for a learner.

use std::io::ErrorKind;
use std::path::PathBuf;

use sulcus_sessions::{Exercise, Mode};

use super::record::{Roll, Task};
use super::{ClassError, told};
use crate::plan::{Plan, PlanChange};
use crate::state::error::StateError;
use crate::state::folder::StateFolder;

/// Folder of the cases in the state folder.
const CASES: &str = "cases";
/// Ending of a compiled scene.
const ENDING: &str = ".scene";
/// Longest name of a case, bytes.
const LONGEST_CASE: usize = 64;
/// Longest session of a task, seconds.
pub const MOST_SECONDS: u32 = 86_400;

/// Task that is asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Name of a built-in exercise, or `free`.
    pub exercise: String,
    /// Name of a case; `None`: the scene of the exercise.
    pub case: Option<String>,
    /// Purpose of the sessions.
    pub mode: Mode,
    /// Longest session, seconds; `None`: no limit.
    pub time_limit_s: Option<u32>,
}

/// Change of a station's plan for a learner.
#[derive(Clone, Debug, PartialEq)]
pub struct Seating {
    /// Parts that change.
    pub change: PlanChange,
    /// Whether the station's present plan may be that of an exam: the learner's own task is an exam, or the learner
    /// has no task and takes part in the one of the station.
    pub exams: bool,
}

impl Seating {
    /// The change as TOML.
    ///
    /// # Errors
    /// The path of a case has no text form.
    pub fn text(&self) -> Result<String, ClassError> {
        toml::to_string(&self.change)
            .map_err(|error| ClassError::Invalid(format!("the plan has no text form: {error}")))
    }
}

/// Names of the exercises: the built-in ones, then `free`.
pub fn exercises() -> Vec<String> {
    let built_in = Exercise::built_in().into_iter().map(|one| one.name);
    built_in.chain([Plan::FREE.to_owned()]).collect()
}

/// Names of the cases, in alphabetical order: compiled scenes `cases/NAME.scene` of the state folder.
///
/// # Errors
/// The folder cannot be listed.
pub fn cases(folder: &StateFolder) -> Result<Vec<String>, StateError> {
    let path = folder.file(CASES);
    let entries = match std::fs::read_dir(&path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(StateError::io("list", &path))?,
    };
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        let name = entry.ok()?.file_name().into_string().ok()?;
        let name = name.strip_suffix(ENDING)?;
        is_case(name).then(|| name.to_owned())
    };
    let mut names: Vec<String> = entries.filter_map(name).collect();
    names.sort();
    Ok(names)
}

/// Whether a text can be the name of a case: letters, digits, `-`, `_` and `.`, a letter or digit first.
fn is_case(name: &str) -> bool {
    let plain = |c: u8| c.is_ascii_alphanumeric() || matches!(c, b'-' | b'_' | b'.');
    let first = name.bytes().next();
    name.len() <= LONGEST_CASE
        && name.bytes().all(plain)
        && first.is_some_and(|c| c.is_ascii_alphanumeric())
}

/// Path of the compiled scene of a case.
fn scene(folder: &StateFolder, case: &str) -> PathBuf {
    let folder = std::path::absolute(folder.path()).unwrap_or_else(|_| folder.path().to_owned());
    folder.join(CASES).join(format!("{case}{ENDING}"))
}

impl Wanted {
    /// Checks exercise, case and limit.
    ///
    /// # Errors
    /// The first part that is not valid.
    pub(super) fn check(&self, folder: &StateFolder) -> Result<(), ClassError> {
        let wrong = |field: &str, found: &str, expected: &str| {
            let found = told(found);
            Err(ClassError::Invalid(format!(
                "{field} is `{found}`, expected {expected}"
            )))
        };
        let known = exercises();
        if !known.contains(&self.exercise) {
            let expected = format!("one of {}", known.join(", "));
            return wrong("exercise", &self.exercise, &expected);
        }
        if self.is_exam() && self.exercise == Plan::FREE {
            return wrong(
                "exercise",
                &self.exercise,
                "an exercise with a grade for an exam",
            );
        }
        if let Some(case) = &self.case {
            let known = cases(folder)?;
            if !known.contains(case) {
                let expected = match known.is_empty() {
                    true => "none: no case is compiled yet".to_owned(),
                    false => format!("one of {}", known.join(", ")),
                };
                return wrong("case", case, &expected);
            }
        }
        if let Some(limit) = self.time_limit_s
            && !(1..=MOST_SECONDS).contains(&limit)
        {
            let expected = format!("1 to {MOST_SECONDS} s");
            return wrong("time_limit_s", &limit.to_string(), &expected);
        }
        Ok(())
    }

    /// Whether the task is an exam.
    pub fn is_exam(&self) -> bool {
        self.mode == Mode::Exam
    }

    /// Whether `task` has the same parts.
    pub(super) fn is(&self, task: &Task) -> bool {
        self.exercise == task.exercise
            && self.case == task.case
            && self.mode == task.mode
            && self.time_limit_s == task.time_limit_s
    }

    /// Exercise and case, for people.
    pub(super) fn title(&self) -> String {
        match &self.case {
            Some(case) => format!("{}, case {case}", self.exercise),
            None => self.exercise.clone(),
        }
    }

    /// All parts, for people.
    pub fn words(&self) -> String {
        let mut text = format!("{}, mode {}", self.title(), self.mode);
        if let Some(limit) = self.time_limit_s {
            text.push_str(&format!(", {limit} s"));
        }
        text
    }

    pub(super) fn task(&self, exam: Option<String>, by: &str, now_s: u64) -> Task {
        Task {
            exercise: self.exercise.clone(),
            case: self.case.clone(),
            mode: self.mode,
            time_limit_s: self.time_limit_s,
            exam,
            by: by.to_owned(),
            given_unix_s: now_s,
        }
    }
}

impl Task {
    /// Parts of the task.
    pub fn wanted(&self) -> Wanted {
        Wanted {
            exercise: self.exercise.clone(),
            case: self.case.clone(),
            mode: self.mode,
            time_limit_s: self.time_limit_s,
        }
    }
}

/// Change of a station's plan for a learner: task and id. Limits that belong to the station stay: force, rate, gaps.
///
/// # Errors
/// No learner has the id.
pub fn seating(roll: &Roll, learner: &str, folder: &StateFolder) -> Result<Seating, ClassError> {
    if roll.learner(learner).is_none() {
        let why = format!("no learner here has the id `{}`", told(learner));
        return Err(ClassError::Unknown(why));
    }
    let mut change = PlanChange {
        learner: Some(learner.to_owned()),
        ..PlanChange::default()
    };
    let Some(task) = roll.task_of(learner) else {
        return Ok(Seating {
            change,
            exams: true,
        });
    };
    // The whole task is the learner's; nothing of another learner's task remains.
    change.clear = [
        "exercise",
        "scene",
        "patient_seed",
        "mode",
        "rubric",
        "time_limit_s",
        "detail_budget_us",
    ]
    .map(str::to_owned)
    .to_vec();
    if task.mode == Mode::Exam {
        // The station's plan of practice may permit ticks at the hand, which show the mouth to the client.
        change.clear.push("tick_at_hand".to_owned());
    }
    change.exercise = Some(task.exercise.clone());
    change.scene = task.case.as_ref().map(|case| scene(folder, case));
    change.mode = Some(task.mode);
    change.time_limit_s = task.time_limit_s;
    Ok(Seating {
        change,
        exams: task.mode == Mode::Exam,
    })
}
