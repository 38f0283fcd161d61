//! Learners, classes, seats and plans for them, as the console sees them.

use super::Holder;

/// Reason why a question has no answer, or a change is not made: a sentence for the person.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Denied {
    /// No class, learner or exam has the id.
    Unknown(String),
    /// A value is not valid.
    Invalid(String),
    /// The person may not do this.
    Forbidden(String),
    /// The classes are no longer as the page showed them.
    Changed(String),
    /// The server has a fault; the details are in its log.
    Fault(String),
}

/// A class in the list of classes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ClassRow {
    /// Short id, such as `c-3`.
    pub id: String,
    /// Name.
    pub name: String,
    /// Number of learners.
    pub learners: usize,
    /// Task of the class; `None`: each station's own plan.
    pub task: Option<Task>,
}

/// A class with its learners.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Class {
    /// The class.
    pub row: ClassRow,
    /// Learners, by name, or by id without the key table.
    pub learners: Vec<Learner>,
    /// Whether the key table is on this machine.
    pub has_names: bool,
}

/// A learner of a class.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Learner {
    /// Opaque id, as recordings have it.
    pub id: String,
    /// Name; empty without the key table, and for a learner without a name.
    pub name: String,
    /// Name of the class.
    pub class: String,
    /// Task of this learner alone; `None`: that of the class.
    pub task: Option<Task>,
    /// Date and time until which the code is valid; empty without a code.
    pub code_until: String,
    /// Station at which the learner sits; empty: none.
    pub station: String,
}

/// Time of a learner in a class, for the pages of results. Classes whose school year has ended count, too.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Member {
    /// Opaque id, as recordings have it.
    pub learner: String,
    /// Name; empty without the key table, and for a learner without a name.
    pub name: String,
    /// Name of the class; with a day for one whose school year has ended.
    pub class: String,
    /// Begin: sessions from this time on belong to the class, seconds since 1970.
    pub from_unix_s: u64,
    /// End: sessions from this time on do not belong to the class, seconds since 1970.
    pub until_unix_s: u64,
}

/// Task of a class or a learner.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Task {
    /// Name of the exercise.
    pub exercise: String,
    /// Name of the case; empty: the scene of the exercise.
    pub case: String,
    /// Purpose: `practice`, `self-assessment` or `exam`.
    pub mode: String,
    /// Longest session, seconds; `None`: no limit.
    pub time_limit_s: Option<u32>,
}

/// Exercises and cases from which a task is made.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Choices {
    /// Names of the exercises.
    pub exercises: Vec<String>,
    /// Names of the cases.
    pub cases: Vec<String>,
}

/// A class or a single learner, by its id.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// All learners of a class.
    Class(String),
    /// Learner with this id.
    Learner(String),
}

/// A change of classes, seats or exams.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// A new class.
    Make {
        /// Name.
        name: String,
    },
    /// Another name of a class.
    Rename {
        /// Id of the class.
        class: String,
        /// Name.
        name: String,
    },
    /// End of a class, with its list of learners.
    Remove {
        /// Id of the class.
        class: String,
    },
    /// A learner comes into a class.
    Add {
        /// Id of the class.
        class: String,
        /// The learner.
        learner: NewLearner,
    },
    /// A learner leaves a class.
    Drop {
        /// Id of the class.
        class: String,
        /// Id of the learner.
        learner: String,
    },
    /// A task, or none.
    Assign {
        /// Class or learner.
        target: Target,
        /// Task; `None`: that of the class, or of the station.
        task: Option<Task>,
    },
    /// A learner sits at a station, whose plan is set.
    Seated {
        /// Name of the station.
        station: String,
        /// Id of the learner.
        learner: String,
    },
    /// The session of a recording was that of another learner.
    Reassign {
        /// File name of the recording.
        recording: String,
        /// Id of the learner.
        learner: String,
        /// Reason.
        why: String,
    },
    /// Seal of an exam: until then, instructors see only that the exam exists.
    Seal {
        /// Id of the exam.
        exam: String,
        /// Day such as `2026-12-01`; empty: until the release.
        until: String,
    },
    /// Release of the results of an exam to its learners.
    Release {
        /// Id of the exam.
        exam: String,
    },
}

/// A learner who comes into a class. Values may be empty; the id or the username is needed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NewLearner {
    /// Opaque id; empty: one is made.
    pub id: String,
    /// Given name.
    pub given: String,
    /// Family name.
    pub family: String,
    /// Username in the school's own system.
    pub username: String,
}

/// Line of a roster, with its verdict.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Line {
    /// Line in the roster, from 1.
    pub line: u64,
    /// Opaque id; empty where an id is still to be made.
    pub learner: String,
    /// Name as given.
    pub name: String,
    /// Name of the class.
    pub class: String,
    /// `new`, `kept`, `renamed`, `moved` or `refused`.
    pub verdict: String,
    /// Reason of a refusal, or the state before; may be empty.
    pub details: String,
}

/// Report of an import or of its dry run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Lines of the roster.
    pub lines: Vec<Line>,
    /// Names of the classes that are made.
    pub new_classes: Vec<String>,
    /// Learners of the same classes who are not in the roster. They stay.
    pub absent: usize,
    /// Hash of the roster and its effect.
    pub hash: String,
}

/// A code on paper.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Card {
    /// Opaque id.
    pub learner: String,
    /// Name; may be empty.
    pub name: String,
    /// Code in two groups of digits.
    pub code: String,
}

/// Plan for a learner at a station.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Seating {
    /// Parts of the plan that change, as TOML.
    pub text: String,
    /// Whether the plan may touch an exam, because a person with that right has set it.
    pub exams: bool,
}

/// A learner at a station.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Seat {
    /// Name of the station.
    pub station: String,
    /// Opaque id of the learner.
    pub learner: String,
    /// Name of the learner; may be empty.
    pub name: String,
    /// Id of the token, or `code`.
    pub by: String,
    /// Date and time.
    pub since: String,
}

/// An exam.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Exam {
    /// Short id, such as `e-4`.
    pub id: String,
    /// Name of the class, or id of the learner.
    pub of: String,
    /// Exercise and case.
    pub title: String,
    /// Number of learners.
    pub learners: usize,
    /// Date and time of the begin.
    pub begun: String,
    /// Date and time of the end; empty: the exam is the present plan.
    pub ended: String,
    /// Day until which the exam is sealed; empty: until the release.
    pub sealed_until: String,
    /// Whether the seal holds now.
    pub is_sealed: bool,
    /// Date and time of the release; empty: not released.
    pub released: String,
}

/// A session that was that of another learner.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Reassigned {
    /// Date and time of the entry.
    pub when: String,
    /// Id of the token.
    pub by: String,
    /// File name of the recording.
    pub recording: String,
    /// Opaque id of the learner.
    pub learner: String,
    /// Reason.
    pub why: String,
}

/// A recording about which a person asks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Seen {
    /// File name.
    pub recording: String,
    /// Opaque id of the learner in the recording.
    pub learner: String,
    /// Whether the mode is exam.
    pub is_exam: bool,
    /// Time of the begin, seconds since 1970.
    pub began_unix_s: u64,
}

/// Part of a recording that a person may see.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sight {
    /// Nothing, not even that the recording exists.
    Nothing,
    /// The existence of the exam and of its sessions: neither the patient nor a result.
    Existence,
    /// Everything.
    All,
}

/// Entry of the audit log.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Entry {
    /// Date and time.
    pub when: String,
    /// Id of the token.
    pub by: String,
    /// Action.
    pub action: String,
    /// Object of the action.
    pub object: String,
}

/// Learners, classes, seats and plans for them. Calls read and write files: never on the thread of the requests.
///
/// `by` is the id of a token. Every change is in the audit log. A call that fails gives a [`Denied`].
pub trait Register: Send + Sync + 'static {
    /// Present classes.
    fn classes(&self) -> Result<Vec<ClassRow>, Denied>;

    /// A class with its learners, and their names where the key table is on this machine.
    fn class(&self, id: &str) -> Result<Class, Denied>;

    /// Learners of the present classes, by class and name.
    fn learners(&self) -> Result<Vec<Learner>, Denied>;

    /// Members of all classes, with those of former school years.
    fn members(&self) -> Result<Vec<Member>, Denied>;

    /// Exercises and cases from which a task is made.
    fn choices(&self) -> Result<Choices, Denied>;

    /// Carries out a change. `exams`: the person may set plans of exams. Returns the id of a new class or learner.
    fn change(&self, by: &str, exams: bool, change: &Change) -> Result<String, Denied>;

    /// Effect of a roster, without a change. `class` is the name of the class for lines without one.
    fn examine(&self, roster: &str, class: &str) -> Result<Report, Denied>;

    /// Imports a roster with exactly the effect of the report with `hash`.
    fn import(&self, by: &str, roster: &str, class: &str, hash: &str) -> Result<Report, Denied>;

    /// Makes new codes for some hours from now.
    fn make_codes(&self, by: &str, target: &Target, hours: u32) -> Result<Vec<Card>, Denied>;

    /// Plan for a learner at a station: the own task, else that of the class, else the learner's id alone.
    fn seating(&self, learner: &str) -> Result<Seating, Denied>;

    /// Learners at stations.
    fn seats(&self) -> Result<Vec<Seat>, Denied>;

    /// Exams, newest first.
    fn exams(&self) -> Result<Vec<Exam>, Denied>;

    /// Sessions that were those of other learners, newest first.
    fn reassigned(&self) -> Result<Vec<Reassigned>, Denied>;

    /// Learner to whom a recording belongs by the newest entry; `None`: the recording itself says so.
    fn learner_of(&self, recording: &str) -> Result<Option<String>, Denied>;

    /// Name of a learner; `None` without the key table, and for a learner without a name.
    fn name_of(&self, learner: &str) -> Result<Option<String>, Denied>;

    /// Opaque learner id of a signed-in person; empty for a person who is no learner.
    fn learner_of_token(&self, id: &str) -> Result<String, Denied>;

    /// Parts of recordings that a person may see now, in the same order.
    fn may_see(&self, holder: &Holder, recordings: &[Seen]) -> Result<Vec<Sight>, Denied>;

    /// Erases a person from the classes and from the key table: nothing joins the id to a name any more. Returns
    /// whether anything was known of the id.
    fn forget(&self, by: &str, learner: &str) -> Result<bool, Denied>;

    /// Adds an entry to the audit log. A log that cannot be written is a fault in the server's log.
    fn record(&self, by: &str, action: &str, object: &str);

    /// Newest entries of the audit log, newest first.
    fn audit(&self, most: usize) -> Result<Vec<Entry>, Denied>;
}
