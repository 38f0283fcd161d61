//! Register of a test: one class with one learner, whose names are HTML. Changes and entries are kept.

use std::sync::Mutex;

use sulcus_console::house::register::{
    Card, Change, Choices, Class, ClassRow, Denied, Entry, Exam, Learner, Line, Member, Reassigned,
    Report, Seat, Seating, Seen, Sight, Target, Task,
};
use sulcus_console::house::{Holder, Register};
use sulcus_proto::Role;

use crate::house::Fake;

/// Name that a page must show as text.
pub const NAME: &str = "<img src=x> O'Neill & \"Zoë\"";

/// Calls that a test looks at.
#[derive(Default)]
pub struct Calls {
    /// Changes, with the person and whether exams are permitted.
    pub changes: Mutex<Vec<(String, bool, Change)>>,
    /// Entries of the audit log: person, action, object.
    pub log: Mutex<Vec<[String; 3]>>,
    /// Rosters that were imported: table, class, hash.
    pub imported: Mutex<Vec<[String; 3]>>,
    /// Refusal of the next change.
    pub denies: Mutex<Option<Denied>>,
}

pub fn task(mode: &str) -> Task {
    Task {
        exercise: "probing".into(),
        case: "case3".into(),
        mode: mode.into(),
        time_limit_s: Some(1800),
    }
}

fn row() -> ClassRow {
    ClassRow {
        id: "c-1".into(),
        name: NAME.into(),
        learners: 2,
        task: Some(task("exam")),
    }
}

fn learner() -> Learner {
    Learner {
        id: "s-1".into(),
        name: NAME.into(),
        class: NAME.into(),
        task: None,
        code_until: "2026-12-01 12:00 UTC".into(),
        station: "b".into(),
    }
}

impl Register for Fake {
    fn classes(&self) -> Result<Vec<ClassRow>, Denied> {
        Ok(vec![row()])
    }

    fn class(&self, id: &str) -> Result<Class, Denied> {
        if id != "c-1" {
            return Err(Denied::Unknown(format!("no class has the id `{id}`")));
        }
        Ok(Class {
            row: row(),
            learners: vec![learner()],
            has_names: true,
        })
    }

    fn learners(&self) -> Result<Vec<Learner>, Denied> {
        Ok(vec![learner()])
    }

    fn members(&self) -> Result<Vec<Member>, Denied> {
        let Learner {
            id, name, class, ..
        } = learner();
        Ok(vec![Member {
            learner: id,
            name,
            class,
            from_unix_s: 0,
            until_unix_s: u64::MAX,
        }])
    }

    fn choices(&self) -> Result<Choices, Denied> {
        Ok(Choices {
            exercises: vec!["crown".into(), "probing".into()],
            cases: vec!["case3".into()],
        })
    }

    fn change(&self, by: &str, exams: bool, change: &Change) -> Result<String, Denied> {
        if let Some(denied) = self.registered.denies.lock().unwrap().take() {
            return Err(denied);
        }
        let mut changes = self.registered.changes.lock().unwrap();
        changes.push((by.into(), exams, change.clone()));
        Ok("c-1".into())
    }

    fn examine(&self, roster: &str, class: &str) -> Result<Report, Denied> {
        if roster == "no table" {
            return Err(Denied::Invalid("line 1: header is `no table`".into()));
        }
        let line = |verdict: &str, details: &str| Line {
            line: 2,
            learner: String::new(),
            name: NAME.into(),
            class: class.into(),
            verdict: verdict.into(),
            details: details.into(),
        };
        Ok(Report {
            lines: vec![line("new", ""), line("refused", "learner is `<b>`")],
            new_classes: vec![NAME.into()],
            absent: 3,
            hash: "h".into(),
        })
    }

    fn import(&self, _: &str, roster: &str, class: &str, hash: &str) -> Result<Report, Denied> {
        if hash != "h" {
            return Err(Denied::Changed("the classes have changed".into()));
        }
        let mut imported = self.registered.imported.lock().unwrap();
        imported.push([roster.into(), class.into(), hash.into()]);
        self.examine(roster, class)
    }

    fn make_codes(&self, _: &str, target: &Target, hours: u32) -> Result<Vec<Card>, Denied> {
        if hours == 0 {
            return Err(Denied::Invalid("hours is 0, expected 1 to 8784".into()));
        }
        let Target::Class(_) = target else {
            return Ok(Vec::new());
        };
        Ok(vec![Card {
            learner: "s-1".into(),
            name: NAME.into(),
            code: "123 456".into(),
        }])
    }

    fn seating(&self, learner: &str) -> Result<Seating, Denied> {
        match learner {
            "s-1" | "s-exam-1" => Ok(Seating {
                text: format!("learner = \"{learner}\""),
                exams: learner == "s-exam-1",
            }),
            other => Err(Denied::Unknown(format!(
                "no learner here has the id `{other}`"
            ))),
        }
    }

    fn seats(&self) -> Result<Vec<Seat>, Denied> {
        let seat = |station: &str| Seat {
            station: station.into(),
            learner: "s-1".into(),
            name: format!("{NAME} at {station}"),
            by: "t-1".into(),
            since: "2026-11-27 10:00 UTC".into(),
        };
        Ok(vec![seat("a"), seat("b")])
    }

    fn exams(&self) -> Result<Vec<Exam>, Denied> {
        Ok(vec![Exam {
            id: "e-1".into(),
            of: NAME.into(),
            title: "probing, case secret7".into(),
            learners: 2,
            is_sealed: true,
            ..Exam::default()
        }])
    }

    fn reassigned(&self) -> Result<Vec<Reassigned>, Denied> {
        Ok(vec![Reassigned {
            why: NAME.into(),
            ..Reassigned::default()
        }])
    }

    fn learner_of(&self, _: &str) -> Result<Option<String>, Denied> {
        Ok(None)
    }

    fn name_of(&self, learner: &str) -> Result<Option<String>, Denied> {
        Ok((learner == "learner-of-a-1").then(|| NAME.to_owned()))
    }

    fn learner_of_token(&self, _: &str) -> Result<String, Denied> {
        Ok("s-1".into())
    }

    fn may_see(&self, holder: &Holder, recordings: &[Seen]) -> Result<Vec<Sight>, Denied> {
        let sight = |seen: &Seen| match holder.role {
            Role::Display => Sight::Nothing,
            Role::Student if seen.learner != "s-1" || seen.is_exam => Sight::Nothing,
            Role::Instructor if seen.is_exam => Sight::Existence,
            _ => Sight::All,
        };
        Ok(recordings.iter().map(sight).collect())
    }

    fn forget(&self, _: &str, _: &str) -> Result<bool, Denied> {
        Ok(true)
    }

    fn record(&self, by: &str, action: &str, object: &str) {
        let entry = [by, action, object].map(str::to_owned);
        self.registered.log.lock().unwrap().push(entry);
    }

    fn audit(&self, _: usize) -> Result<Vec<Entry>, Denied> {
        Ok(vec![Entry {
            object: NAME.into(),
            ..Entry::default()
        }])
    }
}
