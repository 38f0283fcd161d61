//! Interface of the console to the server.

pub mod cases;
mod feeds;
mod grades;
pub mod register;

use std::future::Future;
use std::path::PathBuf;
use std::pin::Pin;
use std::sync::Arc;

use sulcus_proto::Role;
use sulcus_proto::control::{Answer, Instruction};
use sulcus_proto::station::{StationEvent, StationStatus};
use tokio::sync::{broadcast, watch};

pub use cases::Cases;
pub use feeds::{
    Feeds, Glance, Live, Outlines, QUEUE, Segment, SiteDepth, ToolOutline, ToothOutline, Viewer,
};
pub use grades::{Erased, Grades, Grading, Recorded, Revised};
pub use register::Register;

/// Rights of a signed-in person.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Holder {
    /// Opaque id of the token, for logs and recordings.
    pub id: String,
    /// Role.
    pub role: Role,
    /// Station to which the rights are limited; `None`: every station.
    pub station: Option<String>,
}

impl Holder {
    /// Whether the rights include a station.
    pub fn includes(&self, station: &str) -> bool {
        self.station.as_deref().is_none_or(|own| own == station)
    }
}

/// Room for recordings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// Free space of the disk, or rest of a smaller quota, gigabytes.
    pub free_gb: f64,
    /// Hours of a station with two hands that fit.
    pub station_hours: f64,
}

impl Room {
    /// Sentence for a person.
    pub fn sentence(self) -> String {
        format!(
            "Room for recordings: {:.0} GB, some {:.0} hours of a station with two hands.",
            self.free_gb, self.station_hours
        )
    }
}

/// Live data of a station.
pub struct Station {
    /// Name.
    pub name: Arc<str>,
    /// Newest status.
    pub status: watch::Receiver<StationStatus>,
    /// Events from now on.
    pub events: broadcast::Receiver<StationEvent>,
}

/// Instruction of a signed-in person to a station.
#[derive(Clone, Debug, PartialEq)]
pub struct Instructed {
    /// Name of the station.
    pub station: String,
    /// Opaque id of the person's token.
    pub by: String,
    /// Content.
    pub instruction: Instruction,
    /// Whether the person may set plans of exams.
    pub exams: bool,
}

/// Answer that is still to come.
pub type Answering = Pin<Box<dyn Future<Output = Answer> + Send>>;

/// The server behind a console.
pub trait House: Send + Sync + 'static {
    /// Live data of all stations, in the order of the configuration.
    fn stations(&self) -> Vec<Station>;

    /// Holder of the token with this secret. The time of the answer does not depend on the secret.
    ///
    /// # Errors
    /// A sentence for the person: the token is unknown, revoked or expired.
    fn find(&self, secret: &str) -> Result<Holder, String>;

    /// Holder of a name and a password. Takes some 50 ms of CPU time, also for a wrong name.
    ///
    /// # Errors
    /// A sentence for the person, which does not say whether the name is right.
    fn person(&self, login: &str, password: &str) -> Result<Holder, String>;

    /// Changes the password of a signed-in person. Takes some 100 ms of CPU time.
    ///
    /// # Errors
    /// A sentence for the person: the old password is wrong, or the new one too short.
    fn set_password(&self, id: &str, old: &str, new: &str) -> Result<(), String>;

    /// Whether nobody can sign in yet who may watch a station.
    fn is_without_teachers(&self) -> bool;

    /// Makes the first administrator, with a name and a password.
    ///
    /// # Errors
    /// A sentence for the person: a name or a password that is not valid.
    fn make_first(&self, login: &str, password: &str) -> Result<Holder, String>;

    /// Whether the token of a signed-in person is still valid.
    ///
    /// # Errors
    /// A sentence for the person: the token was revoked or has expired.
    fn still(&self, id: &str) -> Result<(), String>;

    /// Carries out an instruction. The answer names the first tick that obeys it.
    fn instruct(&self, instructed: Instructed) -> Answering;

    /// Reasons why no further session can begin now; empty: the server is ready.
    fn obstacles(&self) -> Vec<String>;

    /// Folder with clients of this release for download; `None`: no client is offered.
    fn clients(&self) -> Option<PathBuf>;

    /// Room for recordings; `None`: the disk cannot be asked.
    fn room(&self) -> Option<Room>;

    /// Learners, classes, seats and plans for them.
    fn register(&self) -> &dyn Register;

    /// Patients and their compiled scenes.
    fn cases(&self) -> &dyn Cases;

    /// Recorded sessions and their grades.
    fn grades(&self) -> &dyn Grades;

    /// Motion of the tools, live.
    fn feeds(&self) -> &dyn Feeds;
}
