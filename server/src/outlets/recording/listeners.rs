//! Finder of a session's events, and the listeners besides the recording.

use std::sync::{Arc, Mutex, PoisonError};

use sulcus_core::{Scene, TickOutput};
use sulcus_proto::control::Event;
use sulcus_proto::device::DEVICE_EVENT;
use sulcus_proto::station::StationEvent;
use sulcus_sessions::exercise::events::Look;
use sulcus_sessions::exercise::events::call::READING_CALLED;
use sulcus_sessions::{Events, Exercise, Moved, Occurrence};
use tokio::sync::broadcast;

use crate::outlets::feed::{FeedPublisher, SessionFeed};
use crate::outlets::hands::hands;
use crate::outlets::status::StatusOutlet;
use crate::station::config::SessionPlan;

/// Listeners besides the recording: status and events for instructors. No listener blocks.
pub(crate) struct Listeners {
    pub station: String,
    pub status: StatusOutlet,
    pub events: broadcast::Sender<StationEvent>,
    /// Feed of this session, if the plan has a scene for displays.
    pub session: Option<SessionFeed>,
    pub feed: Arc<Mutex<FeedPublisher>>,
}

impl Listeners {
    /// Publishes the frame of a tick for displays, if it is due.
    pub fn frame(&mut self, output: &TickOutput, paused: bool, moved: &Moved, events: &Events) {
        let Some(session) = &mut self.session else {
            return;
        };
        let mut feed = self.feed.lock().unwrap_or_else(PoisonError::into_inner);
        if session.tick(&mut feed, output, paused, moved) {
            let hands = hands(output, paused, self.status.depths(), events);
            feed.hands(hands);
        }
        self.status.frames_dropped(feed.dropped());
    }

    /// Sends a reading that the student calls to all instructors, and takes the state of a device. Other events of a
    /// client are for the recording alone: they must not pass for events that the server has found.
    pub fn said(&mut self, event: &Event, text: &str) {
        if event.kind == DEVICE_EVENT {
            self.status.device(&event.json);
        }
        if event.kind == READING_CALLED {
            // An error means that nobody listens.
            let _ = self.events.send(StationEvent {
                station: self.station.clone(),
                tick: event.tick,
                text: text.to_owned(),
            });
        }
    }

    /// Sends an event to displays and to all instructors. A slow instructor misses the oldest ones.
    pub fn event(&mut self, occurrence: &Occurrence) {
        if let Some(session) = &mut self.session {
            session.occurred(occurrence);
        }
        // An error means that nobody listens.
        let _ = self.events.send(StationEvent {
            station: self.station.clone(),
            tick: occurrence.tick,
            text: occurrence.to_string(),
        });
    }
}

/// Finder of a session's events.
pub(crate) struct Narrator {
    pub scene: Arc<Scene>,
    pub events: Events,
}

impl Narrator {
    /// Finder of the events of a plan's exercise. The log names what the scene lacks.
    pub fn new(plan: &SessionPlan) -> Self {
        let exercise = Exercise::recorded(&plan.exercise.definition);
        let events = Events::new(&plan.scene, &exercise);
        for what in events.missing() {
            tracing::warn!(
                "exercise `{}` needs {what}, which scene `{}` lacks",
                plan.exercise.name,
                plan.scene.name
            );
        }
        Self {
            scene: plan.scene.clone(),
            events,
        }
    }

    /// Reader of the shapes that events need.
    pub fn look(&self) -> &Look {
        self.events.look()
    }
}
