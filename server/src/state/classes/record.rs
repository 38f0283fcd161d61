//! Classes, learners, tasks, codes, exams and seats as they are stored. No record holds a name of a learner.

use serde::{Deserialize, Serialize};
use sulcus_sessions::Mode;

use super::archive::Archived;

/// Version of the file's layout.
pub(super) const VERSION: u32 = 1;
/// Largest number of classes.
pub const MOST_CLASSES: usize = 200;
/// Largest number of learners of all classes.
pub const MOST_LEARNERS: usize = 5000;
/// Largest number of exams that are kept.
pub(super) const MOST_EXAMS: usize = 2000;
/// Longest name of a class, characters.
pub const LONGEST_CLASS: usize = 64;

/// Content of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Roll {
    pub(super) version: u32,
    /// Key of the hashes of codes, 64 hexadecimal digits; empty before the first code.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(super) key: String,
    /// Number of the last class that was made.
    pub(super) last_class: u32,
    /// Number of the last exam that was made.
    pub(super) last_exam: u32,
    /// Whether the key table has had names: an import then needs the table.
    pub has_names: bool,
    /// Classes, in the order of their making.
    pub classes: Vec<Class>,
    /// Learners, in the order of their making. Each has one class.
    pub learners: Vec<Learner>,
    /// Exams, oldest first.
    pub exams: Vec<Exam>,
    /// Learners at stations, by the instructor or by a code.
    pub seats: Vec<Seat>,
    /// Classes whose school year has ended, oldest first. Older programs refuse a file with such classes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub archived: Vec<Archived>,
}

impl Default for Roll {
    fn default() -> Self {
        Self {
            version: VERSION,
            key: String::new(),
            last_class: 0,
            last_exam: 0,
            has_names: false,
            classes: Vec::new(),
            learners: Vec::new(),
            exams: Vec::new(),
            seats: Vec::new(),
            archived: Vec::new(),
        }
    }
}

/// A class.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Class {
    /// Short id, such as `c-3`; never used again.
    pub id: String,
    /// Name, 1 to 64 characters; no other class has it, whatever its capitals.
    pub name: String,
    /// Time of the making, seconds since 1970.
    pub made_unix_s: u64,
    /// Task of the class; `None`: the station's own plan.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub task: Option<Task>,
    /// Days for which recordings of the learners are kept, by `class expire`; `None`: forever.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keep_recordings_days: Option<u32>,
}

/// A learner in a class.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Learner {
    /// Opaque id, as recordings have it.
    pub id: String,
    /// Id of the class.
    pub class: String,
    /// Task of this learner; `None`: the task of the class.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub task: Option<Task>,
    /// Code for a station; `None`: the learner has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub code: Option<Code>,
}

/// Task that a class or a learner gets at any station.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Task {
    /// Name of a built-in exercise, or `free`.
    pub exercise: String,
    /// Name of a case: a compiled scene in the folder `cases`; `None`: the scene of the exercise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<String>,
    /// Purpose of the sessions.
    #[serde(with = "mode")]
    pub mode: Mode,
    /// Longest session, seconds; `None`: no limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_limit_s: Option<u32>,
    /// Id of the exam, such as `e-4`, for a task of mode exam.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exam: Option<String>,
    /// Author: the id of a token, or `shell (uid N)`.
    pub by: String,
    /// Time of the assignment, seconds since 1970.
    pub given_unix_s: u64,
}

/// Code of a learner, as its hash.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Code {
    /// Keyed BLAKE3 hash, 64 hexadecimal digits.
    pub(super) hash: String,
    /// Time from which the code is no longer valid, seconds since 1970.
    pub until_unix_s: u64,
}

/// An exam: the task of a class or a learner, and the persons who may see its results.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exam {
    /// Short id, such as `e-4`; never used again.
    pub id: String,
    /// Id of the class, or of the learner, for which the exam was set.
    pub of: String,
    /// Exercise and case, for people.
    pub title: String,
    /// Learners who were in the exam's class at any time of the exam.
    pub learners: Vec<String>,
    /// Author: the id of a token, or `shell (uid N)`.
    pub by: String,
    /// Time from which recordings belong to the exam, seconds since 1970.
    pub begun_unix_s: u64,
    /// Time from which recordings no longer belong to the exam; `None`: the exam is the present task.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ended_unix_s: Option<u64>,
    /// Time until which instructors see only that the exam exists; `None`: until the release.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sealed_until_unix_s: Option<u64>,
    /// Release of the results to the learners; `None`: not yet.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub released: Option<Released>,
}

/// Release of the results of an exam.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Released {
    /// Time, seconds since 1970.
    pub unix_s: u64,
    /// Author: the id of a token, or `shell (uid N)`.
    pub by: String,
}

/// A learner at a station, for the next session there.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Seat {
    /// Name of the station.
    pub station: String,
    /// Opaque id of the learner.
    pub learner: String,
    /// Whether the learner had a task, which became the plan of the station.
    pub had_task: bool,
    /// Author: the id of a token, `code`, or `shell (uid N)`.
    pub by: String,
    /// Time, seconds since 1970.
    pub since_unix_s: u64,
}

impl Roll {
    /// Class of an id.
    pub fn class(&self, id: &str) -> Option<&Class> {
        self.classes.iter().find(|class| class.id == id)
    }

    /// Class of a name, whatever the capitals.
    pub fn class_named(&self, name: &str) -> Option<&Class> {
        let wanted = name.to_lowercase();
        self.classes
            .iter()
            .find(|class| class.name.to_lowercase() == wanted)
    }

    /// Learner of an id.
    pub fn learner(&self, id: &str) -> Option<&Learner> {
        self.learners.iter().find(|learner| learner.id == id)
    }

    /// Learners of a class.
    pub fn of_class<'a>(&'a self, class: &'a str) -> impl Iterator<Item = &'a Learner> {
        self.learners
            .iter()
            .filter(move |learner| learner.class == class)
    }

    /// Task of a learner: the own one, else that of the class.
    pub fn task_of(&self, learner: &str) -> Option<&Task> {
        let learner = self.learner(learner)?;
        let of_class = || self.class(&learner.class)?.task.as_ref();
        learner.task.as_ref().or_else(of_class)
    }

    /// Exam to which a recording of a learner belongs that began at a time, seconds since 1970. Of two, the later one.
    pub fn exam_of(&self, learner: &str, began_unix_s: u64) -> Option<&Exam> {
        self.exams.iter().rev().find(|exam| {
            exam.learners.iter().any(|id| id == learner)
                && exam.begun_unix_s <= began_unix_s
                && exam.ended_unix_s.is_none_or(|end| began_unix_s < end)
        })
    }
}

/// Mode by its name.
mod mode {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};
    use sulcus_sessions::Mode;

    pub fn serialize<S: Serializer>(mode: &Mode, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(mode.name())
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Mode, D::Error> {
        let name = String::deserialize(from)?;
        Mode::from_name(&name).ok_or_else(|| {
            let found = name.escape_debug();
            let expected = "practice, self-assessment or exam";
            D::Error::custom(format!("mode is `{found}`, expected {expected}"))
        })
    }
}
