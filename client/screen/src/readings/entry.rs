//! Findings of a site: while they are typed, and as an event of the recording.

use serde_json::{Value, json};

use super::site::Stop;

/// Kind of the event, the same as of a finding called or typed on a line.
pub const READING_CALLED: &str = "reading_called";
/// Largest depth, mm: the limit of the recording's reader.
pub const MOST_DEPTH_MM: u8 = 20;
/// Largest recession, mm.
pub const MOST_RECESSION_MM: u8 = 20;
/// Largest height of the margin above the cemento-enamel junction, mm.
pub const MOST_ABOVE_MM: u8 = 10;
/// Largest grade of a furcation (Hamp 1975).
pub const MOST_FURCATION: u8 = 3;

/// Findings of a site before they are confirmed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Draft {
    /// Probing depth, whole millimetres, 0 to 20.
    pub depth_mm: Option<u8>,
    /// Distance of the margin below the cemento-enamel junction, whole millimetres, -10 to 20, negative above it.
    pub recession_mm: Option<i8>,
    /// Whether the site bleeds; `None` if not said.
    pub bleeding: Option<bool>,
    /// Grade of the furcation, 0 to 3, in the middle of a side.
    pub furcation: Option<u8>,
    /// Whether pus was seen.
    pub suppuration: bool,
}

impl Draft {
    /// Whether nothing was typed.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Findings at `stop`; `None` without a depth.
    pub fn at(&self, stop: Stop) -> Option<Entry> {
        Some(Entry {
            stop,
            depth_mm: self.depth_mm?,
            recession_mm: self.recession_mm,
            bleeding: self.bleeding,
            furcation: self.furcation,
            suppuration: self.suppuration.then_some(true),
        })
    }
}

/// Confirmed findings of a site.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Tooth and site.
    pub stop: Stop,
    /// Probing depth, whole millimetres, 0 to 20.
    pub depth_mm: u8,
    /// Distance of the margin below the cemento-enamel junction, whole millimetres, -10 to 20; `None` if not said.
    pub recession_mm: Option<i8>,
    /// Whether the site bleeds; `None` if not said.
    pub bleeding: Option<bool>,
    /// Grade of the furcation, 0 to 3; `None` if not said.
    pub furcation: Option<u8>,
    /// Whether pus was seen; `None` if not said. Lines of typed findings have no word for suppuration.
    pub suppuration: Option<bool>,
}

impl Entry {
    /// Data of the event [`READING_CALLED`]. A finding that was not said has no key.
    pub fn data(&self) -> Value {
        let Stop { tooth, site } = self.stop;
        let mut data = json!({ "tooth": tooth, "site": site.name(), "depth_mm": self.depth_mm });
        let more = [
            ("recession_mm", self.recession_mm.map(Value::from)),
            ("bleeding", self.bleeding.map(Value::from)),
            ("furcation", self.furcation.map(Value::from)),
            ("suppuration", self.suppuration.map(Value::from)),
        ];
        for (key, value) in more {
            if let Some(value) = value {
                data[key] = value;
            }
        }
        data
    }

    /// Data of the event as JSON.
    pub fn json(&self) -> String {
        self.data().to_string()
    }

    /// Findings after `earlier` ones of the same site were sent.
    ///
    /// A reader of the log keeps an earlier finding that a later event does not name. Bleeding and suppuration that
    /// were taken back are therefore denied. The log has no word for a recession or a furcation taken back.
    pub fn after(self, earlier: Option<&Self>) -> Self {
        let denied = |said: Option<bool>| said.map(|_| false);
        Self {
            bleeding: self
                .bleeding
                .or(denied(earlier.and_then(|entry| entry.bleeding))),
            suppuration: self
                .suppuration
                .or(denied(earlier.and_then(|entry| entry.suppuration))),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::site::Site;
    use super::*;

    fn entry(site: Site) -> Entry {
        Entry {
            stop: Stop { tooth: 36, site },
            depth_mm: 5,
            recession_mm: None,
            bleeding: None,
            furcation: None,
            suppuration: None,
        }
    }

    #[test]
    fn the_event_is_that_of_a_typed_line() {
        assert_eq!(
            entry(Site::MesioBuccal).json(),
            r#"{"depth_mm":5,"site":"mesiobuccal","tooth":36}"#
        );
        let full = Entry {
            recession_mm: Some(-2),
            bleeding: Some(true),
            furcation: Some(1),
            ..entry(Site::Buccal)
        };
        let json = r#"{"bleeding":true,"depth_mm":5,"furcation":1,"recession_mm":-2,"site":"buccal","tooth":36}"#;
        assert_eq!(full.json(), json);
        assert_eq!(READING_CALLED, "reading_called");
    }

    #[test]
    fn suppuration_is_one_more_key_only_where_it_was_said() {
        let pus = Entry {
            suppuration: Some(true),
            ..entry(Site::Lingual)
        };
        let mut data = pus.data();
        assert_eq!(data["suppuration"], true);
        data.as_object_mut()
            .expect("an object")
            .remove("suppuration");
        assert_eq!(data, entry(Site::Lingual).data());
    }

    #[test]
    fn a_finding_taken_back_is_denied_because_silence_keeps_it() {
        let first = Entry {
            bleeding: Some(true),
            suppuration: Some(true),
            ..entry(Site::Buccal)
        };
        let second = entry(Site::Buccal).after(Some(&first));
        assert_eq!(
            (second.bleeding, second.suppuration),
            (Some(false), Some(false))
        );
        assert_eq!(first.after(Some(&second)), first);
        assert_eq!(entry(Site::Buccal).after(None), entry(Site::Buccal));
        let unsaid = entry(Site::Buccal).after(Some(&entry(Site::Buccal)));
        assert_eq!(unsaid.bleeding, None);
    }

    #[test]
    fn without_a_depth_there_is_no_entry() {
        let stop = Stop {
            tooth: 11,
            site: Site::Buccal,
        };
        let mut draft = Draft {
            bleeding: Some(true),
            ..Draft::default()
        };
        assert!(!draft.is_empty() && draft.at(stop).is_none());
        draft.depth_mm = Some(3);
        let entry = draft.at(stop).expect("a depth");
        assert_eq!(
            (entry.depth_mm, entry.bleeding, entry.suppuration),
            (3, Some(true), None)
        );
    }
}
