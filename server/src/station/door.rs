//! Door of a station: messages to its task, its newest status, its levels. Connections hold doors and no station.

use std::net::SocketAddr;
use std::sync::{Arc, Mutex};

use sulcus_core::Coupling;
use sulcus_proto::control::{Answer, DeviceInfo, EndReason, Goodbye, Instruction, Refused, Say};
use sulcus_proto::ghost::GhostPart;
use sulcus_proto::station::{StationEvent, StationStatus};
use sulcus_proto::{PROTOCOL_VERSION, SessionSummary};
use sulcus_sessions::Detached;
use tokio::sync::{broadcast, mpsc, oneshot, watch};

use crate::outlets::feed::{Feed, FeedPublisher};
use crate::session::handoff::Provoked;
use crate::session::levels::Levels;
use crate::session::ports::Ports;
use crate::state::Grant;
use crate::station::at_hand::Wish;
use crate::station::config::SessionPlan;

/// Number of messages that wait for a station's task.
const MESSAGES: usize = 64;
/// Number of events that a slow instructor may lag behind before the oldest are dropped.
pub(crate) const EVENTS: usize = 1024;

/// Student at the door.
#[derive(Clone, Debug)]
pub(crate) struct Student {
    /// Holder of the token.
    pub grant: Grant,
    /// Opaque learner id; empty for an anonymous learner.
    pub learner: String,
    /// Version of the client program.
    pub program: String,
    /// Haptic devices, in the order of the tool slots.
    pub devices: Vec<DeviceInfo>,
    /// Requested exercise; empty for the station's choice.
    pub exercise: String,
    /// Epoch of the connection that this one follows; 0 for the first connection of a program.
    pub follows: u32,
    /// Wish about the place of the ticks.
    pub wish: Wish,
}

impl Student {
    /// Whether `next` is the same student: the same token and, where both are known, the same learner.
    pub fn is_same(&self, next: &Self) -> bool {
        let learners = [&self.learner, &next.learner];
        self.grant.id == next.grant.id
            && (learners.iter().any(|id| id.is_empty()) || self.learner == next.learner)
    }
}

/// An attached student's side of a station.
pub(crate) struct Attached {
    /// Attach epoch; number of this connection at the station.
    pub epoch: u32,
    /// Plan of the session.
    pub plan: Arc<SessionPlan>,
    /// Couplings in force, in the order of the tools.
    pub couplings: Vec<Coupling>,
    /// Hand-overs of the running session; `None` before its start.
    pub ports: Option<Arc<Ports>>,
    /// Whether the ticks run at the hand, or the reason against the client's wish.
    pub at_hand: Result<bool, &'static str>,
    /// Levels for the student's own pause and limit.
    pub levels: Levels,
    /// Messages for the student.
    pub hears: mpsc::Receiver<ToStudent>,
}

/// Message of a station to its attached student.
#[derive(Debug)]
pub(crate) enum ToStudent {
    /// New epoch after the end of a pause.
    Epoch(u32),
    /// Message of an instructor.
    Say(Say),
    /// Path of a ghost, in parts.
    Ghost(Vec<GhostPart>),
    /// End of the session; the connection closes.
    Goodbye(Box<Goodbye>),
    /// A newer connection of the same token has taken over.
    Replaced,
}

/// Message to the task of a station.
pub(crate) enum ToStation {
    /// A student attaches: begins a session, or returns to the one that waits.
    Attach {
        student: Box<Student>,
        reply: oneshot::Sender<Result<Attached, Refused>>,
    },
    /// The attached student starts the session. The error is the goodbye.
    Start {
        epoch: u32,
        reply: oneshot::Sender<Result<Arc<Ports>, Box<Goodbye>>>,
    },
    /// The attached student's session ends. The goodbye follows as [`ToStudent::Goodbye`].
    End { epoch: u32, reason: EndReason },
    /// The connection of the attached student is lost.
    Gone {
        epoch: u32,
        reason: Detached,
        why: String,
    },
    /// The attached student, or the station's side by [`Door::lifted`], has ended a pause: a new epoch begins.
    Lifted {
        /// Epoch of the student; `None`: the station's side.
        epoch: Option<u32>,
    },
    /// A plan for the next session, compiled and set.
    Plan(Box<SessionPlan>),
    /// An instructor instructs.
    Instruct {
        by: String,
        instruction: Instruction,
        /// Whether the instructor may set plans of exams.
        exams: bool,
        reply: oneshot::Sender<Answer>,
    },
    /// A test provokes a fault.
    Provoke(Provoked),
}

/// Door of a station. Clones lead to the same station.
#[derive(Clone)]
pub struct Door {
    /// Name of the station.
    pub(crate) name: Arc<str>,
    /// Levels of the station's side.
    pub(crate) levels: Levels,
    to_station: mpsc::Sender<ToStation>,
    status: watch::Receiver<StationStatus>,
    events: broadcast::Sender<StationEvent>,
    feed: Feed,
}

/// The station's ends of a door.
pub(crate) struct Behind {
    /// Messages.
    pub messages: mpsc::Receiver<ToStation>,
    /// Newest status.
    pub status: watch::Sender<StationStatus>,
    /// Events for instructors. Without listeners an event is dropped.
    pub events: broadcast::Sender<StationEvent>,
    /// Writer of the feed for displays; the recorder's thread of a session uses it.
    pub feed: Arc<Mutex<FeedPublisher>>,
}

impl Door {
    /// Door of the station `name`, and its ends.
    pub(crate) fn new(name: &str) -> (Self, Behind) {
        let (to_station, messages) = mpsc::channel(MESSAGES);
        let first = StationStatus {
            station: name.to_owned(),
            ..StationStatus::default()
        };
        let (status_in, status) = watch::channel(first);
        let (events, _) = broadcast::channel(EVENTS);
        let (publisher, feed) = FeedPublisher::new();
        let door = Self {
            name: name.into(),
            levels: Levels::default(),
            to_station,
            status,
            events: events.clone(),
            feed,
        };
        let behind = Behind {
            messages,
            status: status_in,
            events,
            feed: Arc::new(Mutex::new(publisher)),
        };
        (door, behind)
    }

    /// Newest status.
    pub fn status(&self) -> StationStatus {
        self.status.borrow().clone()
    }

    /// Newest status, and each later one.
    #[cfg(feature = "console")]
    pub(crate) fn statuses(&self) -> watch::Receiver<StationStatus> {
        self.status.clone()
    }

    /// Feed of the station, for one display.
    pub(crate) fn feed(&self) -> Feed {
        self.feed.clone()
    }

    /// Events from now on.
    pub(crate) fn events(&self) -> broadcast::Receiver<StationEvent> {
        self.events.subscribe()
    }

    /// Sends a message and waits for its reply. `None`: the station's task has ended.
    pub(crate) async fn ask<T>(
        &self,
        message: impl FnOnce(oneshot::Sender<T>) -> ToStation,
    ) -> Option<T> {
        let (reply, answer) = oneshot::channel();
        self.to_station.send(message(reply)).await.ok()?;
        answer.await.ok()
    }

    /// Sends a message and waits for its reply, on a thread without a runtime. `None`: the station's task has ended.
    pub(crate) fn ask_blocking<T>(
        &self,
        message: impl FnOnce(oneshot::Sender<T>) -> ToStation,
    ) -> Option<T> {
        let (reply, answer) = oneshot::channel();
        self.to_station.blocking_send(message(reply)).ok()?;
        answer.blocking_recv().ok()
    }

    /// Sends a message without a reply. The call waits while 64 messages wait.
    pub(crate) async fn tell(&self, message: ToStation) {
        // An error means that the station's task has ended; the server is ending then.
        let _ = self.to_station.send(message).await;
    }

    /// Sends a message at once. `false`: 64 messages wait, or the station's task has ended.
    pub(crate) fn try_tell(&self, message: ToStation) -> bool {
        self.to_station.try_send(message).is_ok()
    }

    /// Tells the station that its side has ended a pause. While 64 messages wait, the epoch goes on: poses from before
    /// the end of the pause are then used.
    pub(crate) fn lifted(&self) {
        self.try_tell(ToStation::Lifted { epoch: None });
    }

    /// Tells the station that a connection is lost, also from a destructor.
    pub(crate) fn gone(&self, epoch: u32, reason: Detached, why: &str) {
        let message = ToStation::Gone {
            epoch,
            reason,
            why: why.to_owned(),
        };
        if let Err(mpsc::error::TrySendError::Full(message)) = self.to_station.try_send(message) {
            let to_station = self.to_station.clone();
            tokio::spawn(async move { to_station.send(message).await });
        }
    }
}

/// Goodbye of a session without ticks.
pub(crate) fn goodbye(station: &str, reason: EndReason, text: &str) -> Box<Goodbye> {
    Box::new(Goodbye {
        text: text.to_owned(),
        summary: SessionSummary {
            station: station.to_owned(),
            ..SessionSummary::empty(reason)
        },
    })
}

/// Sentence about a client of another protocol version. `clients`: address of a console that offers the right one.
pub(crate) fn other_version(found: u8, clients: Option<SocketAddr>) -> String {
    let release = env!("CARGO_PKG_VERSION");
    let place = clients.map_or(String::new(), |console| {
        format!(" from https://{console}/clients")
    });
    format!(
        "this server has protocol version {PROTOCOL_VERSION}, the client {found}; install the client of release {release}{place}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_client_of_another_release_reads_where_the_right_one_lies() {
        let release = env!("CARGO_PKG_VERSION");
        let begin = format!(
            "this server has protocol version {PROTOCOL_VERSION}, the client 6; install the client of release {release}"
        );
        assert_eq!(other_version(6, None), begin);
        let console = "192.0.2.7:8443".parse().ok();
        let expected = format!("{begin} from https://192.0.2.7:8443/clients");
        assert_eq!(other_version(6, console), expected);
    }
}
