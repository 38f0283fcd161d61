//! Status and events of all stations, encoded once for all pages.

use std::collections::BTreeMap;
use std::future::pending;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use serde_json::{Value, json};
use sulcus_proto::alert::{Alerts, urgency};
use sulcus_proto::station::{StationEvent, StationStatus};
use tokio::sync::broadcast;
use tokio::sync::broadcast::error::RecvError;

use crate::house::{House, Station};

/// Number of messages that a slow page may lag behind: some six seconds of thirty stations.
const MESSAGES: usize = 1024;
/// Number of last events that a page gets at its start, for each station.
const LAST_EVENTS: usize = 50;
/// Largest number of sites with a called reading: those of all teeth.
const SITES: usize = 52 * 6;
/// Kind of the event with a called reading.
const READING_CALLED: &str = "reading_called";

/// Kind of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Newest status of a station, with alerts.
    Status,
    /// Event of a session.
    Event,
}

impl Kind {
    /// Name of the event in the stream.
    pub fn name(self) -> &'static str {
        match self {
            Self::Status => "status",
            Self::Event => "event",
        }
    }
}

/// Message for all pages that show a station.
#[derive(Clone, Debug)]
pub struct Sent {
    /// Name of the station.
    pub station: Arc<str>,
    /// Kind.
    pub kind: Kind,
    /// JSON.
    pub text: Arc<str>,
}

/// Newest data of a station.
#[derive(Clone, Debug)]
struct Newest {
    status: Value,
    events: Vec<Value>,
    /// Last reading called at each site of the session.
    called: BTreeMap<(u64, String), Value>,
}

/// Newest data of all stations, and the messages about changes.
pub struct Hub {
    begin: Instant,
    names: Vec<Arc<str>>,
    newest: Mutex<BTreeMap<Arc<str>, Newest>>,
    sender: broadcast::Sender<Sent>,
}

impl Hub {
    /// Hub of a server's stations. The tasks that follow them run on the present runtime until its end.
    pub fn start(house: &Arc<dyn House>) -> Arc<Self> {
        let stations = house.stations();
        let (sender, _) = broadcast::channel(MESSAGES);
        let hub = Arc::new(Self {
            begin: Instant::now(),
            names: stations
                .iter()
                .map(|station| station.name.clone())
                .collect(),
            newest: Mutex::default(),
            sender,
        });
        for mut station in stations {
            // At once, so that the first page finds every station.
            let mut shown = Shown::default();
            hub.newest(&mut station, &mut shown);
            tokio::spawn(hub.clone().follow(house.clone(), station, shown));
        }
        hub
    }

    /// Messages from now on.
    pub fn subscribe(&self) -> broadcast::Receiver<Sent> {
        self.sender.subscribe()
    }

    /// Newest data of the stations that `may_see` admits, in the order of the configuration.
    pub fn snapshot(&self, may_see: impl Fn(&str) -> bool) -> Value {
        let newest = self.newest.lock().unwrap_or_else(PoisonError::into_inner);
        let seen = self.names.iter().filter(|name| may_see(name));
        let stations: Vec<Value> = seen
            .filter_map(|name| {
                let mut of = newest.get(name)?.clone();
                of.status["events"] = of.events.into();
                Some(of.status)
            })
            .collect();
        json!({ "stations": stations })
    }

    /// Last reading that the student of a station has called at each site of the session.
    pub fn called(&self, station: &str) -> Vec<Value> {
        let newest = self.newest.lock().unwrap_or_else(PoisonError::into_inner);
        let called = newest
            .get(station)
            .into_iter()
            .flat_map(|of| of.called.values());
        called.cloned().collect()
    }

    /// Whether the server has a station of this name.
    pub fn has(&self, station: &str) -> bool {
        self.names.iter().any(|name| &**name == station)
    }

    /// Follows a station until the end of the server.
    async fn follow(
        self: Arc<Self>,
        house: Arc<dyn House>,
        mut station: Station,
        mut shown: Shown,
    ) {
        let name = station.name.clone();
        // The look at the key table runs beside the statuses: a slow disk delays the name alone.
        let mut asked = String::new();
        let mut looking = None;
        loop {
            let learner = station.status.borrow().learner.clone();
            if learner != asked {
                looking = Some(Box::pin(name_of(house.clone(), learner.clone())));
                asked = learner;
            }
            let name_found = async {
                match looking.as_mut() {
                    Some(found) => found.await,
                    None => pending().await,
                }
            };
            tokio::select! {
                found = name_found => {
                    looking = None;
                    (shown.name, shown.learner) = (found, asked.clone());
                    self.newest(&mut station, &mut shown);
                }
                changed = station.status.changed() => {
                    if changed.is_err() {
                        return;
                    }
                    self.newest(&mut station, &mut shown);
                }
                event = station.events.recv() => match event {
                    Ok(event) => {
                        let is_called = shown.called.event(&event);
                        self.publish(&name, Kind::Event, encoded(&event));
                        if is_called {
                            self.keep(&name, &shown.called.reading);
                            self.newest(&mut station, &mut shown);
                        }
                    }
                    Err(RecvError::Lagged(missed)) => {
                        let text = format!("events_missed at tick 0: {{\"count\":{missed}}}");
                        let event = StationEvent { station: name.to_string(), tick: 0, text };
                        self.publish(&name, Kind::Event, encoded(&event));
                    }
                    Err(RecvError::Closed) => return,
                },
            }
        }
    }

    /// Publishes the newest status of a station.
    fn newest(&self, station: &mut Station, shown: &mut Shown) {
        let status = station.status.borrow_and_update().clone();
        if shown.called.session(&status) {
            self.forget(&station.name);
        }
        let encoded = self.status(&status, shown);
        self.publish(&station.name, Kind::Status, encoded);
    }

    fn status(&self, status: &StationStatus, shown: &mut Shown) -> Value {
        let now_ms = u64::try_from(self.begin.elapsed().as_millis()).unwrap_or(u64::MAX);
        let alerts = shown.alerts.take(status, now_ms);
        // The name is that of another learner until the next look at the key table.
        let is_own = !status.learner.is_empty() && status.learner == shown.learner;
        json!({
            "station": status.station,
            "name": if is_own { shown.name.as_str() } else { "" },
            "status": status,
            "alerts": alerts,
            "urgency": urgency(&alerts),
            "called": shown.called.reading,
        })
    }

    /// Keeps a called reading for the chart.
    fn keep(&self, name: &Arc<str>, reading: &Value) {
        let (Some(tooth), Some(site)) = (reading["tooth"].as_u64(), reading["site"].as_str())
        else {
            return;
        };
        let mut newest = self.newest.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(of) = newest.get_mut(name)
            && (of.called.len() < SITES || of.called.contains_key(&(tooth, site.to_owned())))
        {
            of.called.insert((tooth, site.to_owned()), reading.clone());
        }
    }

    /// Forgets the called readings of an earlier session.
    fn forget(&self, name: &Arc<str>) {
        let mut newest = self.newest.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(of) = newest.get_mut(name) {
            of.called.clear();
        }
    }

    fn publish(&self, name: &Arc<str>, kind: Kind, content: Value) {
        let text: Arc<str> = content.to_string().into();
        let mut newest = self.newest.lock().unwrap_or_else(PoisonError::into_inner);
        let of = newest.entry(name.clone()).or_insert_with(|| Newest {
            status: Value::Null,
            events: Vec::new(),
            called: BTreeMap::new(),
        });
        match kind {
            Kind::Status => of.status = content,
            Kind::Event => {
                if of.events.len() == LAST_EVENTS {
                    of.events.remove(0);
                }
                of.events.push(content);
            }
        }
        drop(newest);
        // An error means that no page is open.
        let _ = self.sender.send(Sent {
            station: name.clone(),
            kind,
            text,
        });
    }
}

/// Event as pages take it: kind and data apart.
fn encoded(event: &StationEvent) -> Value {
    let StationEvent {
        station,
        tick,
        text,
    } = event;
    let (head, data) = text.split_once(": ").unwrap_or((text, ""));
    let kind = head.split_once(" at tick ").map_or(head, |(kind, _)| kind);
    let data: Value = serde_json::from_str(data).unwrap_or(Value::Null);
    json!({ "station": station, "tick": tick, "kind": kind, "data": data })
}

/// Data of a station that its statuses alone do not hold.
#[derive(Default)]
struct Shown {
    alerts: Alerts,
    called: Called,
    /// Learner of the name.
    learner: String,
    /// Name of the learner; empty where the key table is closed.
    name: String,
}

/// Name of a learner; empty where the key table is closed. The table is a file, so the look at it is no work of the
/// requests' thread.
async fn name_of(house: Arc<dyn House>, learner: String) -> String {
    if learner.is_empty() {
        return String::new();
    }
    let asked = tokio::task::spawn_blocking(move || house.register().name_of(&learner)).await;
    // A closed or damaged table leaves the id, which every tile has.
    asked
        .ok()
        .and_then(Result::ok)
        .flatten()
        .unwrap_or_default()
}

/// Reading that the student of a station called last.
#[derive(Default)]
struct Called {
    recording: String,
    reading: Value,
}

impl Called {
    /// Forgets the reading of an earlier session. Returns whether this is another session.
    fn session(&mut self, status: &StationStatus) -> bool {
        let is_other = self.recording != status.recording;
        if is_other {
            self.recording.clone_from(&status.recording);
            self.reading = Value::Null;
        }
        is_other
    }

    /// Takes an event. Returns whether it is a called reading.
    fn event(&mut self, event: &StationEvent) -> bool {
        let event = encoded(event);
        let is_called = event["kind"] == READING_CALLED;
        if is_called {
            self.reading = event["data"].clone();
        }
        is_called
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_event_of_the_log_has_kind_and_data_and_nonsense_keeps_its_text() {
        let event = |text: &str| StationEvent {
            station: "a".into(),
            tick: 7,
            text: text.into(),
        };
        let found = encoded(&event("force_zone at tick 7: {\"zone\":\"trauma\"}"));
        assert_eq!(found["kind"], "force_zone");
        assert_eq!(found["data"]["zone"], "trauma");
        let found = encoded(&event("recording began"));
        assert_eq!(
            (&found["kind"], &found["data"]),
            (&json!("recording began"), &Value::Null)
        );
    }

    #[test]
    fn a_called_reading_belongs_to_its_session() {
        let mut called = Called::default();
        let mut status = StationStatus {
            recording: "a.mcap".into(),
            ..StationStatus::default()
        };
        called.session(&status);
        called.event(&StationEvent {
            station: "a".into(),
            tick: 1,
            text: "reading_called at tick 1: {\"tooth\":36,\"depth_mm\":5}".into(),
        });
        called.session(&status);
        assert_eq!(called.reading["depth_mm"], 5);
        status.recording = "b.mcap".into();
        called.session(&status);
        assert_eq!(called.reading, Value::Null);
    }
}
