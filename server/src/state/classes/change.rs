//! Changes of classes: names, learners, tasks, codes, seats.

use super::codes;
use super::import::{self, Line, Row};
use super::record::{Class, LONGEST_CLASS, MOST_CLASSES, Seat};
use super::task::Wanted;
use super::{Book, ClassError, Classes, told};
use crate::state::error::StateError;

/// A class or a single learner.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Target {
    /// All learners of the class with this id.
    Class(String),
    /// The learner with this id.
    Learner(String),
}

impl Target {
    /// Id of the class or the learner.
    pub fn id(&self) -> &str {
        match self {
            Self::Class(id) | Self::Learner(id) => id,
        }
    }

    /// Checks that the class or the learner exists.
    pub(super) fn check(&self, book: &Book) -> Result<(), ClassError> {
        let is_there = match self {
            Self::Class(id) => book.roll.class(id).is_some(),
            Self::Learner(id) => book.roll.learner(id).is_some(),
        };
        match (is_there, self) {
            (true, _) => Ok(()),
            (false, Self::Class(id)) => Err(no_class(id)),
            (false, Self::Learner(id)) => Err(no_learner(id)),
        }
    }

    fn words(&self) -> String {
        match self {
            Self::Class(id) => format!("class {id}"),
            Self::Learner(id) => format!("learner {id}"),
        }
    }
}

/// A code, shown once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Made {
    /// Opaque id of the learner.
    pub learner: String,
    /// Six digits.
    pub code: String,
}

impl Classes {
    /// Makes a class and returns its id.
    ///
    /// # Errors
    /// The name is taken or not valid, or there are too many classes.
    pub fn make(&self, name: &str, now_s: u64) -> Result<String, ClassError> {
        self.change(|book| {
            let id = make(book, name, now_s)?;
            let act = ("make class", format!("{id} {}", name.trim()));
            Ok((id, vec![act]))
        })
    }

    /// Gives a class another name.
    ///
    /// # Errors
    /// No class has the id, or the name is taken or not valid.
    pub fn rename(&self, class: &str, name: &str) -> Result<(), ClassError> {
        let name = class_name(name)?;
        self.change(|book| {
            if book
                .roll
                .class_named(name)
                .is_some_and(|other| other.id != class)
            {
                return Err(taken(name));
            }
            let found = book.roll.classes.iter_mut().find(|other| other.id == class);
            found.ok_or_else(|| no_class(class))?.name = name.to_owned();
            Ok(((), vec![("rename class", format!("{class} {name}"))]))
        })
    }

    /// Removes a class with its learners, tasks and codes. Names stay in the key table, recordings stay as they are.
    /// `exams`: the person may set plans of exams.
    ///
    /// # Errors
    /// No class has the id, or the class has an exam and the person may not end it.
    pub fn remove(&self, class: &str, exams: bool, now_s: u64) -> Result<(), ClassError> {
        self.change(|book| {
            let mut own = book.roll.exams.iter().filter(|exam| exam.of == class);
            if !exams && own.any(|exam| exam.ended_unix_s.is_none()) {
                let why = "the class has an exam; its removal needs the role examiner or admin";
                return Err(ClassError::Forbidden(why.into()));
            }
            let name = book
                .roll
                .class(class)
                .ok_or_else(|| no_class(class))?
                .name
                .clone();
            let ids: Vec<String> = book
                .roll
                .of_class(class)
                .map(|one| one.id.clone())
                .collect();
            for id in &ids {
                drop_learner(book, id, now_s);
            }
            book.roll.end_exams(class, now_s);
            book.roll.classes.retain(|other| other.id != class);
            let object = format!("{class} {name}, {} learners", ids.len());
            Ok(((), vec![("remove class", object)]))
        })
    }

    /// Adds a learner to a class, or moves a known one there.
    ///
    /// # Errors
    /// No class has the id, or the row is refused: the reason.
    pub fn add(&self, class: &str, row: &Row, now_s: u64) -> Result<Line, ClassError> {
        self.change(|book| {
            let found = book.roll.class(class).ok_or_else(|| no_class(class))?;
            let row = Row {
                class: found.name.clone(),
                ..row.clone()
            };
            let lines = import::apply(book, &[row], "", &mut import::draw, now_s)?;
            let line = lines.into_iter().next();
            let line = line.ok_or_else(|| ClassError::Invalid("no learner is given".into()))?;
            if let import::Verdict::Refused { why } = &line.verdict {
                return Err(ClassError::Invalid(why.clone()));
            }
            let act = ("add learner", format!("{} to {class}", line.learner));
            Ok((line, vec![act]))
        })
    }

    /// Removes a learner from its class, with task and code. The name stays in the key table.
    ///
    /// # Errors
    /// The learner is not in the class.
    pub fn drop_from(&self, class: &str, learner: &str, now_s: u64) -> Result<(), ClassError> {
        self.change(|book| {
            let found = book.roll.learner(learner).filter(|one| one.class == class);
            found.ok_or_else(|| no_learner(learner))?;
            drop_learner(book, learner, now_s);
            Ok((
                (),
                vec![("remove learner", format!("{learner} from {class}"))],
            ))
        })
    }

    /// Erases a person from the classes and from the key table: afterwards nothing joins the id to a name. Returns
    /// whether anything was known of the id.
    ///
    /// # Errors
    /// A file cannot be written, or the key table is not here.
    pub fn forget(&self, learner: &str, now_s: u64) -> Result<bool, ClassError> {
        self.change(|book| {
            if book.roll.has_names && !book.names.is_open {
                return Err(import::closed());
            }
            let is_known = book.roll.learner(learner).is_some()
                || book.roll.was_learner(learner)
                || book.names.of(learner).is_some();
            drop_learner(book, learner, now_s);
            for class in &mut book.roll.archived {
                class.learners.retain(|id| id != learner);
            }
            book.names.people.retain(|person| person.learner != learner);
            Ok((is_known, vec![("erase learner", learner.to_owned())]))
        })
    }

    /// Gives a class or a learner a task, or takes it away with `None`. A task of mode exam begins an exam, sealed
    /// until its release. `exams`: the person may set plans of exams.
    ///
    /// # Errors
    /// No class or learner has the id, a part of the task is not valid, or an exam needs another role.
    pub fn assign(
        &self,
        target: &Target,
        wanted: Option<&Wanted>,
        exams: bool,
        now_s: u64,
    ) -> Result<(), ClassError> {
        if let Some(wanted) = wanted {
            wanted.check(&self.folder)?;
        }
        self.change(|book| {
            target.check(book)?;
            let is_running =
                |exam: &super::Exam| exam.of == target.id() && exam.ended_unix_s.is_none();
            let ends_exam = book.roll.exams.iter().any(is_running);
            let begins_exam = wanted.is_some_and(Wanted::is_exam);
            // The own task of a learner takes the learner out of the exam of the class.
            let is_in_exam = match target {
                Target::Learner(id) => book
                    .roll
                    .task_of(id)
                    .is_some_and(|task| task.exam.is_some()),
                Target::Class(_) => false,
            };
            if (ends_exam || begins_exam || is_in_exam) && !exams {
                let why = "a plan of an exam needs the role examiner or admin";
                return Err(ClassError::Forbidden(why.into()));
            }
            let same = |task: &super::Task| wanted.is_some_and(|wanted| wanted.is(task));
            let present = match target {
                Target::Class(id) => book.roll.class(id).and_then(|class| class.task.clone()),
                Target::Learner(id) => book.roll.learner(id).and_then(|one| one.task.clone()),
            };
            if present.as_ref().is_some_and(same) {
                return Ok(((), Vec::new()));
            }
            book.roll.end_exams(target.id(), now_s);
            let exam = match wanted {
                Some(wanted) if begins_exam => {
                    Some(
                        book.roll
                            .begin_exam(target, &wanted.title(), &self.by, now_s),
                    )
                }
                _ => None,
            };
            let task = wanted.map(|wanted| wanted.task(exam, &self.by, now_s));
            match target {
                Target::Class(id) => {
                    let class = book.roll.classes.iter_mut().find(|class| class.id == *id);
                    class.ok_or_else(|| no_class(id))?.task = task;
                }
                Target::Learner(id) => {
                    let learner = book.roll.learners.iter_mut().find(|one| one.id == *id);
                    learner.ok_or_else(|| no_learner(id))?.task = task;
                }
            }
            let what = wanted.map_or("none".to_owned(), Wanted::words);
            Ok((
                (),
                vec![("assign plan", format!("{}: {what}", target.words()))],
            ))
        })
    }

    /// Makes new codes, valid for some hours from now. Former codes of the same learners end.
    ///
    /// # Errors
    /// No class or learner has the id, or `hours` is out of range.
    pub fn make_codes(
        &self,
        target: &Target,
        hours: u32,
        now_s: u64,
    ) -> Result<Vec<Made>, ClassError> {
        if !(1..=codes::MOST_HOURS).contains(&hours) {
            let most = codes::MOST_HOURS;
            return Err(ClassError::Invalid(format!(
                "hours is {hours}, expected 1 to {most}"
            )));
        }
        self.change(|book| {
            target.check(book)?;
            let ids: Vec<String> = match target {
                Target::Class(id) => book.roll.of_class(id).map(|one| one.id.clone()).collect(),
                Target::Learner(id) => vec![id.clone()],
            };
            let until = now_s.saturating_add(u64::from(hours) * 3600);
            let made = codes::give(&mut book.roll, &ids, until, now_s)?;
            let made = ids.into_iter().zip(made);
            let made = made.map(|(learner, code)| Made { learner, code }).collect();
            let act = ("make codes", format!("{}, {hours} h", target.words()));
            Ok((made, vec![act]))
        })
    }

    /// Learner with a code that is valid now.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn of_code(&self, code: &str, now_s: u64) -> Result<Option<String>, StateError> {
        Ok(codes::find(&self.roll()?, code, now_s).map(str::to_owned))
    }

    /// Ends the seat of a learner at a station, after a session. Returns whether the learner had a task when seated;
    /// `None`: the learner had no seat there.
    ///
    /// # Errors
    /// A file cannot be read or written.
    pub fn leave(&self, station: &str, learner: &str) -> Result<Option<bool>, ClassError> {
        let is_it = |seat: &Seat| seat.station == station && seat.learner == learner;
        // Most sessions have no seat: a look without the lock is enough.
        if !self.roll()?.seats.iter().any(is_it) {
            return Ok(None);
        }
        self.change(|book| {
            let seat = book.roll.seats.iter().find(|seat| is_it(seat)).cloned();
            book.roll.seats.retain(|seat| !is_it(seat));
            let acts = seat
                .iter()
                .map(|_| ("leave", format!("{learner} at {station}")));
            Ok((seat.as_ref().map(|seat| seat.had_task), acts.collect()))
        })
    }

    /// Notes that a learner sits at a station for the next session.
    ///
    /// # Errors
    /// No learner has the id, or the file cannot be written.
    pub fn seat(&self, station: &str, learner: &str, now_s: u64) -> Result<(), ClassError> {
        self.change(|book| {
            Target::Learner(learner.to_owned()).check(book)?;
            book.roll.seats.retain(|seat| seat.station != station);
            let had_task = book.roll.task_of(learner).is_some();
            book.roll.seats.push(Seat {
                station: station.to_owned(),
                learner: learner.to_owned(),
                had_task,
                by: self.by.clone(),
                since_unix_s: now_s,
            });
            Ok(((), vec![("seat", format!("{learner} at {station}"))]))
        })
    }
}

/// Makes a class and returns its id.
pub(super) fn make(book: &mut Book, name: &str, now_s: u64) -> Result<String, ClassError> {
    let name = class_name(name)?;
    if book.roll.class_named(name).is_some() {
        return Err(taken(name));
    }
    if book.roll.classes.len() >= MOST_CLASSES {
        return Err(ClassError::Invalid(format!(
            "{MOST_CLASSES} classes exist, expected at most {MOST_CLASSES}; remove one first"
        )));
    }
    book.roll.last_class += 1;
    let id = format!("c-{}", book.roll.last_class);
    book.roll.classes.push(Class {
        id: id.clone(),
        name: name.to_owned(),
        made_unix_s: now_s,
        task: None,
        keep_recordings_days: None,
    });
    Ok(id)
}

/// Removes a learner from the classes; the exams of the learner's own end.
fn drop_learner(book: &mut Book, learner: &str, now_s: u64) {
    book.roll.end_exams(learner, now_s);
    book.roll.learners.retain(|one| one.id != learner);
    book.roll.seats.retain(|seat| seat.learner != learner);
}

/// Name of a class without blanks at its ends.
pub(crate) fn class_name(name: &str) -> Result<&str, ClassError> {
    let name = name.trim();
    let is_long = name.chars().count() > LONGEST_CLASS;
    if name.is_empty() || is_long || name.contains(char::is_control) {
        return Err(ClassError::Invalid(format!(
            "class is `{}`, expected a name of 1 to {LONGEST_CLASS} characters on one line",
            told(name)
        )));
    }
    Ok(name)
}

fn taken(name: &str) -> ClassError {
    ClassError::Invalid(format!(
        "the name `{}` is taken by another class",
        told(name)
    ))
}

pub(super) fn no_class(id: &str) -> ClassError {
    ClassError::Unknown(format!("no class has the id `{}`", told(id)))
}

fn no_learner(id: &str) -> ClassError {
    ClassError::Unknown(format!("no learner here has the id `{}`", told(id)))
}
