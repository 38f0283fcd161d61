//! The server as the console sees it.

mod cases;
mod feeds;
mod grades;
mod register;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use sulcus_console::house::{
    Answering, Cases, Feeds, Grades, Holder, House, Instructed, Register, Room, Station,
};
use sulcus_proto::Role;
use sulcus_proto::control::Answer;
use sulcus_sessions::ViewersPolicy;

use crate::commands::person;
use crate::net::tokens::Tokens;
use crate::state::date::now_s;
use crate::state::people::{Password, People};
use crate::state::tokens::TokenStore;
use crate::state::{Grant, Place, StateError, StateFolder};
use crate::station::door::{Door, ToStation};
use crate::station::quota::{Quota, bytes_per_hour};

/// Free space of the disk of recordings below which the server is not ready, mebibytes.
const DISK_MIB: u64 = 256;
/// Days for which the first administrator is valid.
const FIRST_DAYS: u16 = 3650;

/// Stations and tokens of a running server.
pub(crate) struct Doors {
    doors: Vec<Door>,
    tokens: Arc<dyn Tokens>,
    recordings: PathBuf,
    /// Policy of the recordings about the channels for viewers, for the forecast of the disk.
    viewers: ViewersPolicy,
    /// Folder of clients for download.
    clients: Option<PathBuf>,
    /// Quota of the folder of recordings; `None`: the disk is the only limit.
    quota: Option<Arc<Quota>>,
    /// Folder of the persons; `None`: there are none.
    state: Option<StateFolder>,
    register: register::OwnRegister,
    cases: cases::OwnCases,
    grades: grades::OwnGrades,
    feeds: feeds::OwnFeeds,
}

/// Parts of a running server behind a console.
pub(crate) struct Parts<'a> {
    /// Stations.
    pub doors: Vec<Door>,
    /// Tokens.
    pub tokens: Arc<dyn Tokens>,
    /// Folder of recordings.
    pub recordings: PathBuf,
    /// Policy of the recordings about the channels for viewers.
    pub viewers: ViewersPolicy,
    /// Quota of the folder of recordings.
    pub quota: Option<Arc<Quota>>,
    /// File of the key that signs recordings.
    pub key: Option<&'a Path>,
    /// Folder of persons, classes and grades.
    pub state: Option<&'a StateFolder>,
    /// Folder of clients for download.
    pub clients: Option<PathBuf>,
}

impl Doors {
    pub fn new(parts: Parts<'_>) -> Self {
        let Parts {
            doors,
            tokens,
            recordings,
            viewers,
            quota,
            key,
            state,
            clients,
        } = parts;
        let grades = grades::OwnGrades::start(&recordings, key, state, &doors);
        Self {
            feeds: feeds::OwnFeeds::new(&doors),
            doors,
            tokens,
            recordings,
            viewers,
            clients,
            quota,
            state: state.cloned(),
            register: register::OwnRegister::of(state),
            cases: cases::OwnCases::of(state),
            grades,
        }
    }

    /// Free space of the disk of recordings, bytes.
    fn free(&self) -> rustix::io::Result<u64> {
        let disk = rustix::fs::statvfs(&self.recordings)?;
        Ok(disk.f_bavail * disk.f_frsize)
    }

    fn people(&self) -> Result<People, String> {
        let state = self.state.as_ref().ok_or("this server knows no persons")?;
        Ok(People::of(state))
    }
}

/// Sentence for a person about a fault of a file, whose details are for the log.
fn fault(error: &StateError) -> String {
    tracing::error!("console: {error}");
    "the server cannot read its list of persons; tell an administrator".to_owned()
}

fn holder(grant: Grant) -> Holder {
    Holder {
        id: grant.id,
        role: grant.role,
        station: match grant.station {
            Place::Any => None,
            Place::Station(name) => Some(name),
        },
    }
}

impl House for Doors {
    fn stations(&self) -> Vec<Station> {
        let station = |door: &Door| Station {
            name: door.name.clone(),
            status: door.statuses(),
            events: door.events(),
        };
        self.doors.iter().map(station).collect()
    }

    fn find(&self, secret: &str) -> Result<Holder, String> {
        let found = self.tokens.find(secret);
        found.map(holder).map_err(|denied| denied.to_string())
    }

    fn still(&self, id: &str) -> Result<(), String> {
        self.tokens.still(id).map_err(|denied| denied.to_string())
    }

    fn person(&self, login: &str, password: &str) -> Result<Holder, String> {
        let wrong = || "name or password is wrong".to_owned();
        let people = self.people().map_err(|_| wrong())?;
        let token = people
            .find(login, password)
            .map_err(|error| fault(&error))?;
        let grant = self.tokens.holder(&token.ok_or_else(wrong)?);
        grant.map(holder).map_err(|denied| denied.to_string())
    }

    fn set_password(&self, id: &str, old: &str, new: &str) -> Result<(), String> {
        let people = self.people()?;
        let login = people.login_of(id).map_err(|error| fault(&error))?;
        let login = login.ok_or("this sign-in is by a ticket and has no password")?;
        let found = people.find(&login, old).map_err(|error| fault(&error))?;
        if found.as_deref() != Some(id) {
            return Err("the old password is wrong".into());
        }
        let new = Password::new(new)?;
        people
            .set_password(&login, &new, now_s())
            .map_err(|error| fault(&error))
    }

    fn is_without_teachers(&self) -> bool {
        let Some(state) = &self.state else {
            return false;
        };
        let now = now_s();
        // A list that cannot be read may have teachers.
        TokenStore::of(state).list().is_ok_and(|tokens| {
            let teachers = tokens
                .iter()
                .filter(|token| !token.role.is_of_one_station());
            teachers.filter(|token| token.is_valid(now)).count() == 0
        })
    }

    fn make_first(&self, login: &str, password: &str) -> Result<Holder, String> {
        let state = self.state.as_ref().ok_or("this server knows no persons")?;
        let password = Password::new(password)?;
        let token = person::made(
            state,
            login,
            Role::Admin,
            None,
            FIRST_DAYS,
            &password,
            now_s(),
        );
        let token = token.map_err(|error| format!("{error:#}"))?;
        self.tokens
            .holder(&token)
            .map(holder)
            .map_err(|denied| denied.to_string())
    }

    fn instruct(&self, instructed: Instructed) -> Answering {
        let Instructed {
            station,
            by,
            instruction,
            exams,
        } = instructed;
        let door = self
            .doors
            .iter()
            .find(|door| *door.name == *station)
            .cloned();
        Box::pin(async move {
            let refused = |text: &str| Answer {
                number: 0,
                taken: false,
                tick: 0,
                text: text.to_owned(),
            };
            let Some(door) = door else {
                return refused("the server has no such station");
            };
            let answer = door.ask(|reply| ToStation::Instruct {
                by,
                instruction,
                exams,
                reply,
            });
            answer
                .await
                .unwrap_or_else(|| refused("the station is ending"))
        })
    }

    fn obstacles(&self) -> Vec<String> {
        let mut all = Vec::new();
        match self.free() {
            Ok(free) if free >> 20 < DISK_MIB => {
                all.push(format!(
                    "the disk of recordings has {} MiB left",
                    free >> 20
                ));
            }
            Ok(_) => {}
            Err(error) => all.push(format!("the folder of recordings cannot be asked: {error}")),
        }
        all.extend(self.quota.as_ref().and_then(|quota| quota.obstacle()));
        all
    }

    fn room(&self) -> Option<Room> {
        let free = self.free().ok()?;
        // The quota of the folder may be tighter than the disk.
        let left = self.quota.as_ref().map(|quota| quota.left());
        let free = left.map_or(free, |left| free.min(left)) as f64;
        Some(Room {
            free_gb: free / 1e9,
            station_hours: free / bytes_per_hour(self.viewers, 2, 1000),
        })
    }

    fn clients(&self) -> Option<PathBuf> {
        self.clients.clone()
    }

    fn register(&self) -> &dyn Register {
        &self.register
    }

    fn cases(&self) -> &dyn Cases {
        &self.cases
    }

    fn grades(&self) -> &dyn Grades {
        &self.grades
    }

    fn feeds(&self) -> &dyn Feeds {
        &self.feeds
    }
}
