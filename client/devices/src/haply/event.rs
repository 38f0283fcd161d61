//! Event of the service: what it means for a hand.

use serde_json::Value;

/// Meaning of an event.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Meaning {
    /// The service took the force away. `holds`: until an event [`Meaning::Released`].
    Safety {
        /// Cause, as the service names it.
        cause: String,
        /// Whether a brake holds.
        holds: bool,
    },
    /// The brake is released.
    Released,
    /// A device is not connected any more.
    Disconnected,
    /// A grip sleeps.
    Asleep,
    /// The channel of events ended; a brake may be released without an event.
    Ended,
}

/// Event of one device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Event {
    /// Id of the device; empty if the event names none, and for an event of all devices.
    pub(super) device: String,
    /// Meaning.
    pub(super) meaning: Meaning,
}

/// Words of causes; a cause may be a field of the data or a part of the message.
const CAUSES: [&str; 5] = [
    "ebrake_released",
    "ebrake_triggered",
    "fod_stage_changed",
    "stall_detected",
    "stability_ceiling",
];

impl Event {
    /// Reads an event. `None` for an event without a meaning for a hand.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let value: Value = serde_json::from_str(text).ok()?;
        let name = value.get("name")?.as_str()?;
        let meaning = if name.ends_with("safety-triggered") {
            match cause(text) {
                Some("ebrake_released") => Meaning::Released,
                cause => Meaning::Safety {
                    cause: cause.unwrap_or("no cause given").into(),
                    holds: cause == Some("ebrake_triggered"),
                },
            }
        } else if name.ends_with("-disconnected") {
            Meaning::Disconnected
        } else if name.ends_with("-sleep") {
            Meaning::Asleep
        } else {
            return None;
        };
        let places = ["/data/device_id", "/device_id", "/data/device", "/data/id"];
        let device = places
            .iter()
            .find_map(|place| value.pointer(place)?.as_str());
        Some(Self {
            device: device.unwrap_or_default().into(),
            meaning,
        })
    }

    /// Whether the event is one of the device `id`, or of all devices.
    pub(super) fn is_of(&self, id: &str) -> bool {
        self.device.is_empty() || self.device == id
    }
}

fn cause(text: &str) -> Option<&'static str> {
    CAUSES.into_iter().find(|cause| text.contains(cause))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn read(name: &str, data: &str) -> Option<Event> {
        Event::parse(&format!(
            "{{\"name\":\"{name}\",\"level\":\"error\",\"data\":{data},\"message\":\"m\"}}"
        ))
    }

    #[test]
    fn events_have_their_meaning() {
        let data = r#"{"device_id":"049D","reason":"ebrake_triggered"}"#;
        let brake = read("device-safety-triggered", data).unwrap();
        assert_eq!(brake.device, "049D");
        assert!(matches!(brake.meaning, Meaning::Safety { holds: true, .. }));
        assert!(brake.is_of("049D") && !brake.is_of("04A1"));
        let released = read("device-safety-triggered", r#"{"reason":"ebrake_released"}"#).unwrap();
        assert_eq!(released.meaning, Meaning::Released);
        assert!(released.is_of("04A1"));
        let stall = read("device-safety-triggered", r#"{"reason":"stall_detected"}"#).unwrap();
        assert!(matches!(
            stall.meaning,
            Meaning::Safety { holds: false, .. }
        ));
        let unknown = read("device-safety-triggered", "null").unwrap();
        assert!(matches!(
            unknown.meaning,
            Meaning::Safety { holds: false, .. }
        ));
        assert_eq!(
            read("device-disconnected", "{}").unwrap().meaning,
            Meaning::Disconnected
        );
        assert_eq!(read("device-sleep", "{}").unwrap().meaning, Meaning::Asleep);
        for name in [
            "device-connected",
            "system-rate-report",
            "command-deprecated",
        ] {
            assert_eq!(read(name, "{}"), None);
        }
    }

    proptest! {
        #[test]
        fn no_text_panics(text in ".{0,80}", name in "[a-z-]{0,30}") {
            let _ = Event::parse(&text);
            let _ = read(&name, &format!("{text:?}"));
        }
    }
}
