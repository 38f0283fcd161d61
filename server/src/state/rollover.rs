//! End of a school year: a backup, then the archiving of classes with the end of tokens, plans, codes and seats.
//!
//! The order of a class is chosen for a crash: tokens are revoked first, the class is archived last. A second call then
//! does what is left, and a class that is archived needs nothing more. Every action has an entry in the audit log.

use std::path::Path;

use super::audit::Audit;
use super::backup::{self, BackupError};
use super::classes::{Act, Class, ClassError, Classes, Roll};
use super::error::StateError;
use super::folder::StateFolder;
use super::tokens::TokenStore;

/// Reason why a school year cannot be ended.
#[derive(Debug, thiserror::Error)]
pub enum RolloverError {
    /// A class is unknown, or cannot be archived now: one sentence.
    #[error("{0}")]
    Refused(String),
    /// The classes cannot be changed.
    #[error(transparent)]
    Class(#[from] ClassError),
    /// The backup cannot be made; nothing has changed then.
    #[error(transparent)]
    Backup(#[from] BackupError),
    /// A file of the state folder cannot be used.
    #[error(transparent)]
    State(#[from] StateError),
    /// The stations cannot be asked, or a plan cannot be changed: one sentence.
    #[error("{0}")]
    Stations(String),
}

/// A learner at a station.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sitting {
    /// Name of the station.
    pub station: String,
    /// Opaque id of the learner.
    pub learner: String,
}

/// Stations of a server: by its control socket while it runs, else by the kept plans.
pub trait Stations {
    /// Learners who have a session, or are about to begin one.
    ///
    /// # Errors
    /// A running server does not answer: one sentence.
    fn sessions(&self) -> Result<Vec<Sitting>, String>;

    /// Stations whose plan names a learner.
    ///
    /// # Errors
    /// The plans cannot be read: one sentence.
    fn plans(&self) -> Result<Vec<Sitting>, String>;

    /// Ends the plan of a learner at a station. `whole`: the plan was the learner's task, and the station gets that of
    /// its file again. Otherwise the learner alone leaves the plan.
    ///
    /// # Errors
    /// The plan cannot be changed: one sentence.
    fn end_plan(&self, station: &str, whole: bool) -> Result<(), String>;
}

/// Classes of a call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Chosen {
    /// All present classes.
    All,
    /// Classes of these names or ids.
    Named(Vec<String>),
}

/// A class that is to be archived, and everything that ends with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// The class.
    pub class: Class,
    /// Ends of tokens and of plans of stations, as they stand in the audit log.
    before: Vec<Act>,
    /// Actions of the archiving, as they stand in the audit log.
    archiving: Vec<Act>,
    /// Ids of the tokens that are revoked.
    tokens: Vec<String>,
    /// Stations whose plans end, and whether each plan was the learner's own task.
    stations: Vec<(String, bool)>,
}

impl Step {
    /// All actions in their order, as they stand in the audit log.
    pub fn acts(&self) -> impl Iterator<Item = &Act> {
        self.before.iter().chain(&self.archiving)
    }
}

/// Report of a call, before its changes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Classes that are to be archived.
    pub steps: Vec<Step>,
    /// Ids and names of classes that are archived already.
    pub already: Vec<(String, String)>,
}

/// The end of a school year in a state folder.
pub struct Rollover<'a> {
    folder: &'a StateFolder,
    by: &'a str,
    stations: &'a dyn Stations,
}

impl<'a> Rollover<'a> {
    /// End of a school year by the person `by`.
    pub fn of(folder: &'a StateFolder, by: &'a str, stations: &'a dyn Stations) -> Self {
        Self {
            folder,
            by,
            stations,
        }
    }

    /// All actions for the chosen classes. Nothing is changed, and no file is made.
    ///
    /// # Errors
    /// A class is unknown, a session of a learner runs, an exam is undecided, or a file cannot be read.
    pub fn report(&self, chosen: &Chosen, now_s: u64) -> Result<Report, RolloverError> {
        let roll = Classes::of(self.folder, self.by).roll()?;
        let mut report = Report::default();
        let named: Vec<&Class> = match chosen {
            Chosen::All => roll.classes.iter().collect(),
            Chosen::Named(names) => {
                let mut found: Vec<&Class> = Vec::new();
                for name in names {
                    match present(&roll, name) {
                        Some(class) if found.contains(&class) => {}
                        Some(class) => found.push(class),
                        None => report.already.push(archived(&roll, name)?),
                    }
                }
                found
            }
        };
        for class in named {
            report.steps.push(self.step(&roll, class, now_s)?);
        }
        Ok(report)
    }

    fn step(&self, roll: &Roll, class: &Class, now_s: u64) -> Result<Step, RolloverError> {
        let is_of = |id: &str| roll.learner(id).is_some_and(|one| one.class == class.id);
        let refused = |why: String| {
            let name = super::classes::plain(&class.name);
            RolloverError::Refused(format!("class {} {name}: {why}", class.id))
        };
        let sessions = self.stations.sessions().map_err(RolloverError::Stations)?;
        if let Some(Sitting { station, learner }) =
            sessions.into_iter().find(|one| is_of(&one.learner))
        {
            return Err(refused(format!(
                "a session of learner {learner} runs at station {station}; end the session first"
            )));
        }
        if let Some(why) = roll.exam_in_the_way(&class.id, now_s) {
            return Err(refused(why));
        }
        let mut before: Vec<Act> = Vec::new();
        let mut tokens = Vec::new();
        for token in TokenStore::of(self.folder).list()? {
            if token.is_valid(now_s) && is_of(&token.learner) {
                before.push(("revoke token", format!("{} of {}", token.id, token.learner)));
                tokens.push(token.id);
            }
        }
        let mut stations = Vec::new();
        let plans = self.stations.plans().map_err(RolloverError::Stations)?;
        for Sitting { station, learner } in plans.into_iter().filter(|one| is_of(&one.learner)) {
            let mut seats = roll.seats.iter();
            let seat = seats.find(|seat| seat.station == station && seat.learner == learner);
            let object = format!("station {station} of {learner}");
            before.push(("end plan", object));
            stations.push((station, seat.is_some_and(|seat| seat.had_task)));
        }
        Ok(Step {
            class: class.clone(),
            before,
            archiving: roll.acts_of_archiving(class),
            tokens,
            stations,
        })
    }

    /// Makes the backup `to`, then archives the chosen classes. Without a class to archive nothing is made. Returns the
    /// report of what was done.
    ///
    /// # Errors
    /// The errors of [`Rollover::report`], or a file cannot be written. A class is either whole as before, or the next
    /// call does what is left.
    pub fn carry_out(
        &self,
        chosen: &Chosen,
        to: &Path,
        now_s: u64,
    ) -> Result<Report, RolloverError> {
        let report = self.report(chosen, now_s)?;
        if report.steps.is_empty() {
            return Ok(report);
        }
        backup::write(self.folder, to)?;
        let audit = Audit::of(self.folder);
        let name = to.file_name().unwrap_or_default().to_string_lossy();
        audit.record(self.by, "backup", &name)?;
        // The backup takes its time: a session may have begun, or a code may have been made.
        let report = self.report(chosen, now_s)?;
        let store = TokenStore::of(self.folder);
        let classes = Classes::of(self.folder, self.by);
        for step in &report.steps {
            for (action, object) in &step.before {
                audit.record(self.by, action, object)?;
            }
            for id in &step.tokens {
                store.revoke(id, now_s)?;
            }
            for (station, whole) in &step.stations {
                let ended = self.stations.end_plan(station, *whole);
                ended.map_err(RolloverError::Stations)?;
            }
            classes.archive(&step.class.id, now_s)?;
        }
        Ok(report)
    }
}

/// Present class of a name or an id.
fn present<'a>(roll: &'a Roll, name: &str) -> Option<&'a Class> {
    roll.class_named(name).or_else(|| roll.class(name))
}

/// Id and name of the archived class of a name or an id.
fn archived(roll: &Roll, name: &str) -> Result<(String, String), RolloverError> {
    let mut named = roll.archived_named(name);
    let found = named.next().or_else(|| roll.archived_class(name));
    let found = found.ok_or_else(|| {
        let names: Vec<&str> = roll.classes.iter().map(|one| one.name.as_str()).collect();
        let expected = match names.is_empty() {
            true => "no class exists".to_owned(),
            false => format!("expected one of {}", names.join(", ")),
        };
        let name = name.escape_debug();
        RolloverError::Refused(format!("class `{name}` is unknown, {expected}"))
    })?;
    Ok((found.id.clone(), found.label()))
}

#[cfg(test)]
mod tests;
