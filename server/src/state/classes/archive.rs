//! Archived classes: the record of a class after the end of its school year, and the times of each membership.
//!
//! An archived class keeps its id, its name and its learners. Plans, codes and seats end with the class. Recordings,
//! grades, exams and names are in other places and stay as they are.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::change::no_class;
use super::record::{Class, Exam, Roll};
use super::{Act, ClassError, Classes};
use crate::state::date::day;

/// Largest number of archived classes.
pub(super) const MOST_ARCHIVED: usize = 2000;

/// A class whose school year has ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Archived {
    /// Id that the class had, such as `c-3`; never used again.
    pub id: String,
    /// Name that the class had. A new class may have the same name.
    pub name: String,
    /// Time of the making, seconds since 1970.
    pub made_unix_s: u64,
    /// Time of the archiving, seconds since 1970.
    pub archived_unix_s: u64,
    /// Author of the archiving: the id of a token, or `shell (uid N)`.
    pub by: String,
    /// Opaque ids of the learners at the time of the archiving.
    pub learners: Vec<String>,
    /// Days for which recordings are kept; `None`: forever.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keep_recordings_days: Option<u32>,
}

impl Archived {
    /// Name with the day of the archiving, which tells the classes of two years apart.
    pub fn label(&self) -> String {
        format!("{} (until {})", self.name, day(self.archived_unix_s))
    }
}

/// Time of a learner in a class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Membership {
    /// Opaque id of the learner.
    pub learner: String,
    /// Id of the class.
    pub class: String,
    /// Name of the class; with a day for an archived one.
    pub class_name: String,
    /// Begin: sessions from this time on belong to the class, seconds since 1970.
    pub from_unix_s: u64,
    /// End: sessions from this time on do not belong to the class, seconds since 1970.
    pub until_unix_s: u64,
    /// Days for which recordings of the class are kept; `None`: forever.
    pub keep_recordings_days: Option<u32>,
}

impl Roll {
    /// Archived class of an id.
    pub fn archived_class(&self, id: &str) -> Option<&Archived> {
        self.archived.iter().find(|class| class.id == id)
    }

    /// Archived classes of a name, whatever the capitals, the newest first.
    pub fn archived_named<'a>(&'a self, name: &str) -> impl Iterator<Item = &'a Archived> {
        let wanted = name.to_lowercase();
        let all = self.archived.iter().rev();
        all.filter(move |class| class.name.to_lowercase() == wanted)
    }

    /// Whether an archived class had a learner.
    pub fn was_learner(&self, learner: &str) -> bool {
        let mut all = self.archived.iter().flat_map(|class| &class.learners);
        all.any(|id| id == learner)
    }

    /// Name of a class for people; with a day for an archived one. `None`: no class has the id.
    pub fn class_label(&self, id: &str) -> Option<String> {
        let present = self.class(id).map(|class| class.name.clone());
        present.or_else(|| self.archived_class(id).map(Archived::label))
    }

    /// Memberships of all learners, in archived classes and in the present ones. Those of a learner do not overlap: an
    /// archived class has the sessions since the archive before it, the present class those since the last archive.
    pub fn memberships(&self) -> Vec<Membership> {
        let mut since: BTreeMap<&str, u64> = BTreeMap::new();
        let mut all = Vec::new();
        let mut archived: Vec<&Archived> = self.archived.iter().collect();
        archived.sort_by_key(|class| class.archived_unix_s);
        for class in archived {
            for learner in &class.learners {
                let until = class.archived_unix_s;
                let from = since.insert(learner, until).unwrap_or(0);
                all.push(Membership {
                    learner: learner.clone(),
                    class: class.id.clone(),
                    class_name: class.label(),
                    from_unix_s: from,
                    until_unix_s: until,
                    keep_recordings_days: class.keep_recordings_days,
                });
            }
        }
        for learner in &self.learners {
            let Some(class) = self.class(&learner.class) else {
                continue;
            };
            all.push(Membership {
                learner: learner.id.clone(),
                class: class.id.clone(),
                class_name: class.name.clone(),
                from_unix_s: since.get(learner.id.as_str()).copied().unwrap_or(0),
                until_unix_s: u64::MAX,
                keep_recordings_days: class.keep_recordings_days,
            });
        }
        all
    }

    /// Reason why a class cannot be archived now, because of its exams or those of its learners; `None`: it can.
    ///
    /// An exam that is the present plan may still be sat. An exam whose seal is over and whose results are not released
    /// is undecided: learners without tokens could no longer ask for a release.
    pub fn exam_in_the_way(&self, class: &str, now_s: u64) -> Option<String> {
        let is_of = |exam: &&Exam| {
            let of_learner = self.learner(&exam.of).is_some_and(|one| one.class == class);
            exam.of == class || of_learner
        };
        self.exams.iter().filter(is_of).find_map(|exam| {
            if exam.ended_unix_s.is_none() {
                return Some(format!(
                    "exam {} is still the present plan; give the class or the learner another plan first",
                    exam.id
                ));
            }
            let is_decided = exam.released.is_some() || exam.is_sealed(now_s);
            (!is_decided).then(|| {
                format!(
                    "exam {} is neither released nor sealed; run `sulcus-server class release {}` or `class seal {}` first",
                    exam.id, exam.id, exam.id
                )
            })
        })
    }

    /// Actions of the archiving of a class, in their order, as they stand in the audit log.
    pub fn acts_of_archiving(&self, class: &Class) -> Vec<Act> {
        let mut acts: Vec<Act> = Vec::new();
        let id = &class.id;
        if let Some(task) = &class.task {
            let words = task.wanted().words();
            acts.push(("end plan", format!("class {id}: {words}")));
        }
        for learner in self.of_class(id) {
            if let Some(task) = &learner.task {
                let words = task.wanted().words();
                acts.push(("end plan", format!("learner {}: {words}", learner.id)));
            }
            if learner.code.is_some() {
                acts.push(("end code", learner.id.clone()));
            }
            for seat in self.seats.iter().filter(|seat| seat.learner == learner.id) {
                acts.push(("end seat", format!("{} at {}", learner.id, seat.station)));
            }
        }
        let count = self.of_class(id).count();
        let noun = if count == 1 { "learner" } else { "learners" };
        acts.push((
            "archive class",
            format!("{id} {}, {count} {noun}", class.name),
        ));
        acts
    }

    /// Makes a present class an archived one: codes, seats and plans of its learners end.
    fn archive(&mut self, class: &Class, by: &str, now_s: u64) {
        let learners: Vec<String> = self.of_class(&class.id).map(|one| one.id.clone()).collect();
        for learner in &learners {
            self.end_exams(learner, now_s);
        }
        self.end_exams(&class.id, now_s);
        self.seats.retain(|seat| !learners.contains(&seat.learner));
        self.learners.retain(|one| one.class != class.id);
        self.classes.retain(|one| one.id != class.id);
        self.archived.push(Archived {
            id: class.id.clone(),
            name: class.name.clone(),
            made_unix_s: class.made_unix_s,
            archived_unix_s: now_s,
            by: by.to_owned(),
            learners,
            keep_recordings_days: class.keep_recordings_days,
        });
    }
}

impl Classes {
    /// Archives a class. A class that is archived already stays as it is.
    ///
    /// # Errors
    /// No class has the id, an exam is in the way, or there are too many archived classes.
    pub fn archive(&self, class: &str, now_s: u64) -> Result<(), ClassError> {
        self.change(|book| {
            let roll = &mut book.roll;
            if roll.archived_class(class).is_some() {
                return Ok(((), Vec::new()));
            }
            let found = roll.class(class).cloned().ok_or_else(|| no_class(class))?;
            if let Some(why) = roll.exam_in_the_way(class, now_s) {
                return Err(ClassError::Invalid(why));
            }
            let count = roll.archived.len();
            if count >= MOST_ARCHIVED {
                return Err(ClassError::Invalid(format!(
                    "{count} archived classes exist, expected at most {MOST_ARCHIVED}"
                )));
            }
            let acts = roll.acts_of_archiving(&found);
            roll.archive(&found, &self.by, now_s);
            Ok(((), acts))
        })
    }

    /// Sets for how many days the recordings of a class are kept; `None`: forever. The class may be archived.
    ///
    /// # Errors
    /// No class has the id.
    pub fn keep_recordings(&self, class: &str, days: Option<u32>) -> Result<(), ClassError> {
        self.change(|book| {
            let roll = &mut book.roll;
            let present = roll.classes.iter_mut().find(|one| one.id == class);
            let present = present.map(|one| &mut one.keep_recordings_days);
            let archived = roll.archived.iter_mut().find(|one| one.id == class);
            let archived = archived.map(|one| &mut one.keep_recordings_days);
            *present.or(archived).ok_or_else(|| no_class(class))? = days;
            let object = format!("class {class}: {}", kept_words(days));
            Ok(((), vec![("keep recordings", object)]))
        })
    }
}

/// Time for which recordings are kept, for people.
pub fn kept_words(days: Option<u32>) -> String {
    match days {
        None => "forever".into(),
        Some(1) => "1 day".into(),
        Some(days) => format!("{days} days"),
    }
}

#[cfg(test)]
mod tests;
