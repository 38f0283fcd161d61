//! Codes and seats of learners, as the network asks for them at the hello of a student and at the end of a session.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use sulcus_proto::control::{Answer, Instruction, Refused, RefusedReason};
use sulcus_proto::station::Phase;

use crate::state::StateFolder;
use crate::state::classes::{Classes, task};
use crate::state::date::now_s;
use crate::station::door::{Door, ToStation};

/// Author of a plan and of a seat that a learner's code has set.
const BY: &str = "code";
/// Wrong codes of an address within [`WINDOW`] after which the address must wait.
const MOST_OF_ADDRESS: u32 = 5;
/// Wrong codes in all within [`WINDOW`] after which everybody must wait. A guess among a million codes of thirty
/// learners then takes a day on the average.
const MOST: u32 = 20;
/// Time after which wrong codes are forgotten.
const WINDOW: Duration = Duration::from_secs(60);
/// Largest number of addresses that are remembered.
const ADDRESSES: usize = 1024;
/// Delay before a wrong code is refused.
const WRONG: Duration = Duration::from_millis(500);

/// A learner whose code was right, and the plan for a station.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Admitted {
    /// Opaque id.
    pub learner: String,
    /// Parts of the plan that change, as TOML.
    pub plan: String,
    /// Whether the plan may touch an exam.
    pub exams: bool,
}

/// A seat that ended with its session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Left {
    /// Whether the learner had a task, which became the plan of the station.
    pub had_task: bool,
}

/// Store of codes and seats. Calls read and write files: never on the network's thread.
pub trait Codes: Send + Sync {
    /// Learner with a code that is valid now; `None`: there is none.
    ///
    /// # Errors
    /// The store cannot be read: a sentence without details.
    fn find(&self, code: &str) -> Result<Option<Admitted>, String>;

    /// Notes that the learner sits at a station, whose plan is set.
    fn seated(&self, station: &str, learner: &str);

    /// Ends the seat of a learner whose session has ended; `None`: the learner had no seat there.
    fn left(&self, station: &str, learner: &str) -> Option<Left>;
}

/// Codes of a server without classes: none is right.
pub struct NoCodes;

impl Codes for NoCodes {
    fn find(&self, _: &str) -> Result<Option<Admitted>, String> {
        Ok(None)
    }

    fn seated(&self, _: &str, _: &str) {}

    fn left(&self, _: &str, _: &str) -> Option<Left> {
        None
    }
}

impl Codes for StateFolder {
    fn find(&self, code: &str) -> Result<Option<Admitted>, String> {
        let fault = |error: &dyn std::fmt::Display| {
            tracing::error!("codes: {error}");
            "the server cannot read its list of classes; tell the instructor".to_owned()
        };
        let classes = Classes::of(self, BY);
        let learner = classes
            .of_code(code, now_s())
            .map_err(|error| fault(&error))?;
        let Some(learner) = learner else {
            return Ok(None);
        };
        let roll = classes.roll().map_err(|error| fault(&error))?;
        let seating = task::seating(&roll, &learner, self).map_err(|error| fault(&error))?;
        Ok(Some(Admitted {
            learner,
            plan: seating.text().map_err(|error| fault(&error))?,
            exams: seating.exams,
        }))
    }

    fn seated(&self, station: &str, learner: &str) {
        if let Err(error) = Classes::of(self, BY).seat(station, learner, now_s()) {
            tracing::error!("{learner} sits at {station}, but: {error}");
        }
    }

    fn left(&self, station: &str, learner: &str) -> Option<Left> {
        let left = Classes::of(self, "end of a session").leave(station, learner);
        match left {
            Ok(had_task) => had_task.map(|had_task| Left { had_task }),
            Err(error) => {
                tracing::error!("{learner} leaves {station}, but: {error}");
                None
            }
        }
    }
}

/// Counts of wrong codes.
#[derive(Default)]
pub(crate) struct WrongCodes(Mutex<BTreeMap<IpAddr, (Instant, u32)>>);

impl WrongCodes {
    /// Whether an address must wait.
    fn must_wait(&self, from: IpAddr, now: Instant) -> bool {
        let mut map = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        map.retain(|_, (since, _)| now.saturating_duration_since(*since) < WINDOW);
        let all: u32 = map.values().map(|(_, wrong)| wrong).sum();
        let own = map.get(&from).map_or(0, |(_, wrong)| *wrong);
        own >= MOST_OF_ADDRESS || all >= MOST
    }

    fn wrong(&self, from: IpAddr, now: Instant) {
        let mut map = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if map.len() < ADDRESSES || map.contains_key(&from) {
            map.entry(from).or_insert((now, 0)).1 += 1;
        }
    }
}

/// Student who comes with a code.
pub(super) struct Coming<'a> {
    pub code: &'a str,
    pub from: IpAddr,
    /// Opaque learner id of the student's token; may be empty.
    pub own: &'a str,
}

/// Judges a code, and sets the plan of the station for its learner. Returns the learner's id.
///
/// A station in use keeps its plan: its own learner returns, and any other is refused.
pub(super) async fn seat(
    coming: Coming<'_>,
    codes: &Arc<dyn Codes>,
    wrong: &WrongCodes,
    door: &Door,
) -> Result<String, Refused> {
    let Coming { code, from, own } = coming;
    if wrong.must_wait(from, Instant::now()) {
        let text = "too many wrong codes: wait a minute, or ask the instructor for a seat";
        return refused(RefusedReason::Token, text);
    }
    let (store, code) = (codes.clone(), code.to_owned());
    let found = tokio::task::spawn_blocking(move || store.find(&code)).await;
    let found = found.unwrap_or_else(|_| Err("the server is ending".into()));
    let admitted = match found {
        Ok(Some(admitted)) => admitted,
        Ok(None) => {
            wrong.wrong(from, Instant::now());
            tokio::time::sleep(WRONG).await;
            let text = "this code is wrong or no longer valid: ask the instructor for a new one";
            return refused(RefusedReason::Token, text);
        }
        Err(text) => return refused(RefusedReason::Server, &text),
    };
    let learner = admitted.learner;
    if !own.is_empty() && own != learner {
        let text = "the ticket of this station belongs to another learner than the code";
        return refused(RefusedReason::Role, text);
    }
    let status = door.status();
    if status.phase != Phase::Free {
        if status.learner == learner {
            return Ok(learner);
        }
        let text = "this station is in use by another learner; wait until the session ends";
        return refused(RefusedReason::Busy, text);
    }
    let answer = door.ask(|reply| ToStation::Instruct {
        by: BY.into(),
        instruction: Instruction::Plan(admitted.plan),
        exams: admitted.exams,
        reply,
    });
    match answer.await {
        Some(Answer { taken: true, .. }) => {}
        Some(Answer { text, .. }) => {
            tracing::warn!(
                "station {}: the plan of {learner} is refused: {text}",
                door.name
            );
            let text = "the station cannot take the plan of this learner; tell the instructor";
            return refused(RefusedReason::Server, text);
        }
        None => return refused(RefusedReason::Server, "the server is ending"),
    }
    let (store, station, seated) = (codes.clone(), door.name.clone(), learner.clone());
    let noted = tokio::task::spawn_blocking(move || store.seated(&station, &seated));
    // The session does not depend on the note; its failure is in the log.
    let _ = noted.await;
    Ok(learner)
}

fn refused<T>(reason: RefusedReason, text: &str) -> Result<T, Refused> {
    Err(Refused {
        reason,
        text: text.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::classes::change::Target;
    use crate::state::folder::fresh;

    #[test]
    fn wrong_codes_close_an_address_and_many_close_the_door_for_a_minute() {
        let (wrong, begin) = (WrongCodes::default(), Instant::now());
        let address = |k: u8| IpAddr::from([192, 0, 2, k]);
        for k in 0..MOST {
            let from = address((k / MOST_OF_ADDRESS) as u8);
            assert!(!wrong.must_wait(from, begin), "{k}");
            wrong.wrong(from, begin);
        }
        assert!(wrong.must_wait(address(0), begin) && wrong.must_wait(address(99), begin));
        assert!(!wrong.must_wait(address(0), begin + WINDOW));
    }

    #[test]
    fn a_right_code_brings_the_plan_of_its_learner() {
        let (_place, folder) = fresh();
        let classes = Classes::of(&folder, "t-1");
        classes
            .import(b"learner\ns-17\n", "B", None, now_s())
            .expect("imports");
        let target = Target::Learner("s-17".into());
        let made = classes
            .make_codes(&target, 1, now_s())
            .expect("makes")
            .remove(0);
        let found = Codes::find(&folder, &made.code)
            .expect("reads")
            .expect("right");
        assert_eq!((found.learner.as_str(), found.exams), ("s-17", true));
        assert!(found.plan.contains("learner = \"s-17\""), "{}", found.plan);
        let other = if made.code == "000000" {
            "000001"
        } else {
            "000000"
        };
        assert_eq!(Codes::find(&folder, other), Ok(None));
        folder.seated("room3-1", "s-17");
        assert_eq!(classes.roll().expect("reads").seats[0].by, "code");
        assert_eq!(folder.left("room3-1", "s-18"), None);
        assert_eq!(folder.left("room3-2", "s-17"), None);
        let had_task = Some(Left { had_task: false });
        assert_eq!(folder.left("room3-1", "s-17"), had_task);
        assert_eq!(folder.left("room3-1", "s-17"), None);
    }
}
