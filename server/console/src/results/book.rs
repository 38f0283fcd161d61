//! Sessions that a person may see, with the names and classes of their learners: read once for each request.

use std::collections::{BTreeMap, BTreeSet};

use axum::http::StatusCode;
use axum::response::Response;
use sulcus_proto::Role;

use super::access::{Sight, sight};
use super::filter::Filter;
use super::reading;
use crate::App;
use crate::guard::Caller;
use crate::house::register::{Denied, Seen as Asked};
use crate::house::{Holder, Recorded};
use crate::pages::problem;

/// Session with the extent to which a person may see it.
#[derive(Clone, Debug)]
pub struct Seen {
    /// Session, with the learner to whom it belongs now.
    pub one: Recorded,
    /// Extent; never [`Sight::Nothing`].
    pub sight: Sight,
}

/// Names and classes of learners, as far as they are open on this machine and to this person.
#[derive(Clone, Debug, Default)]
pub struct People {
    names: BTreeMap<String, String>,
    /// Learners of each class, with the begin and the end of the time in it.
    classes: BTreeMap<String, BTreeMap<String, (u64, u64)>>,
}

impl People {
    /// Name and id of a learner; the id alone where the key table is closed.
    pub fn label(&self, learner: &str) -> String {
        match self.names.get(learner) {
            Some(name) => format!("{name} ({learner})"),
            None if learner.is_empty() => "(no id)".into(),
            None => learner.to_owned(),
        }
    }

    /// Name of a learner; empty where the key table is closed.
    pub fn name(&self, learner: &str) -> &str {
        self.names.get(learner).map_or("", String::as_str)
    }

    /// Whether a session belongs to a class: the learner was in it at the begin, seconds since 1970.
    pub fn is_member(&self, class: &str, learner: &str, began_unix_s: u64) -> bool {
        let members = self.classes.get(class);
        let time = members.and_then(|members| members.get(learner));
        time.is_some_and(|(from, until)| (*from..*until).contains(&began_unix_s))
    }

    /// Names of the classes.
    pub fn classes(&self) -> Vec<String> {
        self.classes.keys().cloned().collect()
    }
}

/// Sessions and learners of a person.
#[derive(Clone, Debug, Default)]
pub struct Book {
    /// Sessions, the newest first.
    pub sessions: Vec<Seen>,
    /// Learners.
    pub people: People,
}

impl Book {
    /// Sessions that pass a filter, the newest first.
    pub fn filtered(&self, filter: &Filter) -> Vec<&Seen> {
        let all = self.sessions.iter();
        all.filter(|seen| filter.admits(&seen.one, &self.people))
            .collect()
    }

    /// Session with this id.
    pub fn find(&self, id: &str) -> Option<&Seen> {
        self.sessions.iter().find(|seen| seen.one.id == id)
    }

    /// Exercises of the sessions.
    pub fn exercises(&self) -> Vec<String> {
        let all = self.sessions.iter().map(|seen| seen.one.exercise.clone());
        all.collect::<BTreeSet<String>>().into_iter().collect()
    }
}

/// Reads the book of a signed-in person, beside the requests.
///
/// # Errors
/// The page with the reason.
pub async fn opened(app: &App, caller: &Caller) -> Result<Book, Response> {
    let (app, holder) = (app.clone(), caller.holder.clone());
    let read = reading(move || read(&app, &holder)).await?;
    read.map_err(|denied| problem(StatusCode::INTERNAL_SERVER_ERROR, &words(denied)))
}

/// Sentence of a denial.
pub fn words(denied: Denied) -> String {
    let (Denied::Unknown(why)
    | Denied::Invalid(why)
    | Denied::Forbidden(why)
    | Denied::Changed(why)
    | Denied::Fault(why)) = denied;
    why
}

fn read(app: &App, holder: &Holder) -> Result<Book, Denied> {
    let register = app.house.register();
    let all = app.house.grades().all();
    let asked: Vec<Asked> = all
        .iter()
        .map(|one| Asked {
            recording: file(&one.id),
            learner: one.learner.clone(),
            is_exam: one.is_exam(),
            began_unix_s: one.started_unix_s,
        })
        .collect();
    let sights = register.may_see(holder, &asked)?;
    let mut moved = BTreeMap::new();
    for entry in register.reassigned()? {
        // The newest entry comes first.
        moved.entry(entry.recording).or_insert(entry.learner);
    }
    let mut people = People::default();
    // A student needs no other person's name.
    if holder.role != Role::Student {
        for one in register.members()? {
            let members = people.classes.entry(one.class).or_default();
            members.insert(one.learner.clone(), (one.from_unix_s, one.until_unix_s));
            if !one.name.is_empty() {
                people.names.insert(one.learner, one.name);
            }
        }
    }
    let seen = all.iter().zip(sights).filter_map(|(one, register)| {
        let mut one = one.clone();
        if let Some(learner) = moved.get(&file(&one.id)) {
            one.learner.clone_from(learner);
        }
        let sight = sight(holder, &one, register);
        (sight != Sight::Nothing).then_some(Seen { one, sight })
    });
    Ok(Book {
        sessions: seen.collect(),
        people,
    })
}

/// Name of a session's file.
pub fn file(id: &str) -> String {
    format!("{id}.mcap")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_belongs_to_the_class_of_its_time() {
        let member = |from, until| BTreeMap::from([("s-1".to_owned(), (from, until))]);
        let former = "Year 4 (until 2026-07-15)";
        let people = People {
            names: BTreeMap::new(),
            classes: BTreeMap::from([
                (former.to_owned(), member(0, 100)),
                ("Year 4".to_owned(), member(100, u64::MAX)),
            ]),
        };
        for (began_unix_s, is_former) in [(0, true), (99, true), (100, false), (500, false)] {
            assert_eq!(people.is_member(former, "s-1", began_unix_s), is_former);
            assert_eq!(people.is_member("Year 4", "s-1", began_unix_s), !is_former);
        }
        assert!(!people.is_member(former, "s-2", 1) && !people.is_member("Year 5", "s-1", 1));
    }
}
