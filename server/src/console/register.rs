//! Learners, classes, seats and plans for them, for the console.

use sulcus_console::house::Holder;
use sulcus_console::house::Register;
use sulcus_console::house::register::{
    Card, Change, Choices, Class, ClassRow, Denied, Entry, Exam, Learner, Line, Member, NewLearner,
    Reassigned, Report, Seat, Seating, Seen, Sight, Target, Task,
};
use sulcus_sessions::Mode;

use crate::state::classes::archive::Membership;
use crate::state::classes::change::Target as OwnTarget;
use crate::state::classes::import::{Report as OwnReport, Row};
use crate::state::classes::seal::{Asked, Sight as OwnSight, may_see};
use crate::state::classes::task::Wanted;
use crate::state::classes::{self, Book, ClassError, Classes, codes, task};
use crate::state::date::{day, minute, now_s, parse_day};
use crate::state::tokens::TokenStore;
use crate::state::{StateError, StateFolder};

/// Learners, classes, seats and plans for them, of a running server.
#[derive(Debug)]
pub(super) struct OwnRegister {
    /// State folder; `None`: the server has none.
    state: Option<StateFolder>,
}

impl OwnRegister {
    /// Register of a state folder.
    pub fn of(state: Option<&StateFolder>) -> Self {
        Self {
            state: state.cloned(),
        }
    }

    fn state(&self) -> Result<&StateFolder, Denied> {
        let none = || Denied::Fault("this server has no state folder and knows no classes".into());
        self.state.as_ref().ok_or_else(none)
    }

    fn classes_by(&self, by: &str) -> Result<Classes, Denied> {
        Ok(Classes::of(self.state()?, by))
    }

    fn book(&self) -> Result<Book, Denied> {
        self.classes_by("")?.load().map_err(|error| fault(&error))
    }
}

/// Sentence for a person about a fault of a file, whose details are for the log.
fn fault(error: &StateError) -> Denied {
    tracing::error!("console: {error}");
    Denied::Fault("the server cannot use its list of classes; tell an administrator".into())
}

fn denied(error: ClassError) -> Denied {
    match error {
        ClassError::Unknown(why) => Denied::Unknown(why),
        ClassError::Invalid(why) => Denied::Invalid(why),
        ClassError::Forbidden(why) => Denied::Forbidden(why),
        ClassError::Changed(why) => Denied::Changed(why),
        ClassError::State(error) => fault(&error),
    }
}

fn own_target(target: &Target) -> OwnTarget {
    match target {
        Target::Class(id) => OwnTarget::Class(id.clone()),
        Target::Learner(id) => OwnTarget::Learner(id.clone()),
    }
}

fn shown_task(task: &classes::Task) -> Task {
    Task {
        exercise: task.exercise.clone(),
        case: task.case.clone().unwrap_or_default(),
        mode: task.mode.name().to_owned(),
        time_limit_s: task.time_limit_s,
    }
}

fn wanted(task: &Task) -> Result<Wanted, Denied> {
    let mode = Mode::from_name(&task.mode).ok_or_else(|| {
        let found: String = task.mode.escape_debug().take(40).collect();
        let expected = "practice, self-assessment or exam";
        Denied::Invalid(format!("mode is `{found}`, expected {expected}"))
    })?;
    Ok(Wanted {
        exercise: task.exercise.clone(),
        case: Some(task.case.clone()).filter(|case| !case.is_empty()),
        mode,
        time_limit_s: task.time_limit_s,
    })
}

fn shown_row(book: &Book, class: &classes::Class) -> ClassRow {
    ClassRow {
        id: class.id.clone(),
        name: class.name.clone(),
        learners: book.roll.of_class(&class.id).count(),
        task: class.task.as_ref().map(shown_task),
    }
}

fn shown_learner(book: &Book, learner: &classes::Learner, now_s: u64) -> Learner {
    let code = learner
        .code
        .as_ref()
        .filter(|code| now_s < code.until_unix_s);
    let seat = book
        .roll
        .seats
        .iter()
        .find(|seat| seat.learner == learner.id);
    Learner {
        id: learner.id.clone(),
        name: book.names.name_of(&learner.id).unwrap_or_default(),
        class: book
            .roll
            .class(&learner.class)
            .map_or(String::new(), |class| class.name.clone()),
        task: learner.task.as_ref().map(shown_task),
        code_until: code.map_or(String::new(), |code| minute(code.until_unix_s)),
        station: seat.map_or(String::new(), |seat| seat.station.clone()),
    }
}

fn shown_report(report: OwnReport) -> Report {
    let line = |line: crate::state::classes::import::Line| Line {
        line: line.line,
        verdict: line.verdict.word().to_owned(),
        details: line.verdict.details(),
        learner: line.learner,
        name: line.name,
        class: line.class,
    };
    Report {
        lines: report.lines.into_iter().map(line).collect(),
        new_classes: report.new_classes,
        absent: report.absent,
        hash: report.hash,
    }
}

/// Order of learners for people: by name, then by id.
fn by_name(one: &Learner) -> (String, String) {
    (one.name.to_lowercase(), one.id.clone())
}

impl Register for OwnRegister {
    fn classes(&self) -> Result<Vec<ClassRow>, Denied> {
        let roll = self.classes_by("")?.roll().map_err(|error| fault(&error))?;
        let book = Book {
            roll,
            ..Book::default()
        };
        let all = book.roll.classes.iter();
        let mut rows: Vec<ClassRow> = all.map(|class| shown_row(&book, class)).collect();
        rows.sort_by_key(|row| row.name.to_lowercase());
        Ok(rows)
    }

    fn class(&self, id: &str) -> Result<Class, Denied> {
        let (book, now) = (self.book()?, now_s());
        let class = book.roll.class(id).ok_or_else(|| {
            let id: String = id.escape_debug().take(40).collect();
            Denied::Unknown(format!("no class has the id `{id}`"))
        })?;
        let learners = book.roll.of_class(id);
        let mut learners: Vec<Learner> = learners
            .map(|learner| shown_learner(&book, learner, now))
            .collect();
        learners.sort_by_cached_key(by_name);
        Ok(Class {
            row: shown_row(&book, class),
            learners,
            has_names: book.names.is_open,
        })
    }

    fn learners(&self) -> Result<Vec<Learner>, Denied> {
        let (book, now) = (self.book()?, now_s());
        let all = book.roll.learners.iter();
        let mut all: Vec<Learner> = all.map(|one| shown_learner(&book, one, now)).collect();
        all.sort_by_cached_key(|one| (one.class.to_lowercase(), by_name(one)));
        Ok(all)
    }

    fn members(&self) -> Result<Vec<Member>, Denied> {
        let book = self.book()?;
        let member = |one: Membership| Member {
            name: book.names.name_of(&one.learner).unwrap_or_default(),
            learner: one.learner,
            class: one.class_name,
            from_unix_s: one.from_unix_s,
            until_unix_s: one.until_unix_s,
        };
        Ok(book.roll.memberships().into_iter().map(member).collect())
    }

    fn choices(&self) -> Result<Choices, Denied> {
        Ok(Choices {
            exercises: task::exercises(),
            cases: task::cases(self.state()?).map_err(|error| fault(&error))?,
        })
    }

    fn change(&self, by: &str, exams: bool, change: &Change) -> Result<String, Denied> {
        let (classes, now) = (self.classes_by(by)?, now_s());
        let done = |done: Result<(), ClassError>| done.map(|()| String::new());
        let made = match change {
            Change::Make { name } => classes.make(name, now),
            Change::Rename { class, name } => done(classes.rename(class, name)),
            Change::Remove { class } => done(classes.remove(class, exams, now)),
            Change::Add { class, learner } => {
                let NewLearner {
                    id,
                    given,
                    family,
                    username,
                } = learner.clone();
                let row = Row {
                    learner: id,
                    given,
                    family,
                    username,
                    ..Row::default()
                };
                classes.add(class, &row, now).map(|line| line.learner)
            }
            Change::Drop { class, learner } => done(classes.drop_from(class, learner, now)),
            Change::Assign { target, task } => {
                let wanted = task.as_ref().map(wanted).transpose()?;
                done(classes.assign(&own_target(target), wanted.as_ref(), exams, now))
            }
            Change::Seated { station, learner } => done(classes.seat(station, learner, now)),
            Change::Reassign {
                recording,
                learner,
                why,
            } => done(classes.reassign(recording, learner, why, now)),
            Change::Seal { .. } | Change::Release { .. } if !exams => {
                let why = "the seal of an exam needs the role examiner or admin";
                return Err(Denied::Forbidden(why.into()));
            }
            Change::Seal { exam, until } => {
                let until = match until.trim() {
                    "" => None,
                    text => Some(parse_day(text).ok_or_else(|| {
                        let found: String = text.escape_debug().take(40).collect();
                        Denied::Invalid(format!(
                            "until is `{found}`, expected a day such as 2026-12-01"
                        ))
                    })?),
                };
                done(classes.seal(exam, until))
            }
            Change::Release { exam } => done(classes.release(exam, now)),
        };
        made.map_err(denied)
    }

    fn examine(&self, roster: &str, class: &str) -> Result<Report, Denied> {
        let report = self
            .classes_by("")?
            .examine(roster.as_bytes(), class, now_s());
        report.map(shown_report).map_err(denied)
    }

    fn import(&self, by: &str, roster: &str, class: &str, hash: &str) -> Result<Report, Denied> {
        let classes = self.classes_by(by)?;
        let report = classes.import(roster.as_bytes(), class, Some(hash), now_s());
        report.map(shown_report).map_err(denied)
    }

    fn make_codes(&self, by: &str, target: &Target, hours: u32) -> Result<Vec<Card>, Denied> {
        let classes = self.classes_by(by)?;
        let made = classes.make_codes(&own_target(target), hours, now_s());
        let made = made.map_err(denied)?;
        let names = self.book()?.names;
        let card = |made: crate::state::classes::change::Made| Card {
            name: names.name_of(&made.learner).unwrap_or_default(),
            code: codes::shown(&made.code),
            learner: made.learner,
        };
        let mut cards: Vec<Card> = made.into_iter().map(card).collect();
        cards.sort_by_cached_key(|card| (card.name.to_lowercase(), card.learner.clone()));
        Ok(cards)
    }

    fn seating(&self, learner: &str) -> Result<Seating, Denied> {
        let state = self.state()?;
        let roll = self.classes_by("")?.roll().map_err(|error| fault(&error))?;
        let seating = task::seating(&roll, learner, state).map_err(denied)?;
        Ok(Seating {
            text: seating.text().map_err(denied)?,
            exams: seating.exams,
        })
    }

    fn seats(&self) -> Result<Vec<Seat>, Denied> {
        let book = self.book()?;
        let seat = |seat: &classes::record::Seat| Seat {
            station: seat.station.clone(),
            learner: seat.learner.clone(),
            name: book.names.name_of(&seat.learner).unwrap_or_default(),
            by: seat.by.clone(),
            since: minute(seat.since_unix_s),
        };
        Ok(book.roll.seats.iter().map(seat).collect())
    }

    fn exams(&self) -> Result<Vec<Exam>, Denied> {
        let roll = self.classes_by("")?.roll().map_err(|error| fault(&error))?;
        let now = now_s();
        let exam = |exam: &classes::Exam| Exam {
            id: exam.id.clone(),
            of: roll.class_label(&exam.of).unwrap_or(exam.of.clone()),
            title: exam.title.clone(),
            learners: exam.learners.len(),
            begun: minute(exam.begun_unix_s),
            ended: exam.ended_unix_s.map_or(String::new(), minute),
            sealed_until: exam.sealed_until_unix_s.map_or(String::new(), day),
            is_sealed: exam.is_sealed(now),
            released: exam
                .released
                .as_ref()
                .map_or(String::new(), |one| minute(one.unix_s)),
        };
        Ok(roll.exams.iter().rev().map(exam).collect())
    }

    fn reassigned(&self) -> Result<Vec<Reassigned>, Denied> {
        let all = self
            .classes_by("")?
            .reassigned()
            .map_err(|error| fault(&error))?;
        let entry = |entry: classes::reassigned::Entry| Reassigned {
            when: minute(entry.unix_s),
            by: entry.by,
            recording: entry.recording,
            learner: entry.learner,
            why: entry.why,
        };
        Ok(all.into_iter().rev().map(entry).collect())
    }

    fn learner_of(&self, recording: &str) -> Result<Option<String>, Denied> {
        let found = self.classes_by("")?.learner_of(recording);
        found.map_err(|error| fault(&error))
    }

    fn name_of(&self, learner: &str) -> Result<Option<String>, Denied> {
        Ok(self.book()?.names.name_of(learner))
    }

    fn learner_of_token(&self, id: &str) -> Result<String, Denied> {
        let tokens = TokenStore::of(self.state()?).list();
        let tokens = tokens.map_err(|error| fault(&error))?;
        let own = tokens.into_iter().find(|token| token.id == id);
        Ok(own.map_or(String::new(), |token| token.learner))
    }

    fn may_see(&self, holder: &Holder, recordings: &[Seen]) -> Result<Vec<Sight>, Denied> {
        let classes = self.classes_by("")?;
        let roll = classes.roll().map_err(|error| fault(&error))?;
        let own = self.learner_of_token(&holder.id)?;
        // Later entries replace earlier ones.
        let entries = classes.reassigned().map_err(|error| fault(&error))?;
        let entries = entries
            .into_iter()
            .map(|entry| (entry.recording, entry.learner));
        let moved: std::collections::BTreeMap<String, String> = entries.collect();
        let now = now_s();
        let sight = |seen: &Seen| {
            let learner = moved.get(&seen.recording).unwrap_or(&seen.learner);
            // The seal is that of both learners: an entry must not open a sealed exam.
            let exams = [&seen.learner, learner].map(|id| roll.exam_of(id, seen.began_unix_s));
            let sights = exams.map(|exam| {
                let asked = Asked {
                    is_own: !own.is_empty() && *learner == own,
                    is_exam: seen.is_exam,
                    exam: exam.or(exams[1]).or(exams[0]),
                };
                may_see(holder.role, asked, now)
            });
            match sights[0].min(sights[1]) {
                OwnSight::Nothing => Sight::Nothing,
                OwnSight::Existence => Sight::Existence,
                OwnSight::All => Sight::All,
            }
        };
        Ok(recordings.iter().map(sight).collect())
    }

    fn forget(&self, by: &str, learner: &str) -> Result<bool, Denied> {
        let classes = self.classes_by(by)?;
        classes.forget(learner, now_s()).map_err(denied)
    }

    fn record(&self, by: &str, action: &str, object: &str) {
        let Ok(classes) = self.classes_by(by) else {
            return;
        };
        if let Err(error) = classes.audit().record(by, action, object) {
            tracing::error!("console: {by} {action} {object}, but: {error}");
        }
    }

    fn audit(&self, most: usize) -> Result<Vec<Entry>, Denied> {
        let classes = self.classes_by("")?;
        let all = classes
            .audit()
            .newest(most)
            .map_err(|error| fault(&error))?;
        let entry = |entry: crate::state::audit::Entry| Entry {
            when: minute(entry.unix_s),
            by: entry.by,
            action: entry.action,
            object: entry.object,
        };
        Ok(all.into_iter().map(entry).collect())
    }
}

#[cfg(test)]
mod tests;
