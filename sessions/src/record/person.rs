//! Hand and finger rest of a student, as the screen of a session tells them in its log.

use serde::Serialize;

use crate::record::occurrence::Occurrence;

/// Kind of the events of a screen.
const SCREEN: &str = "screen";

/// Settings of a student at a screen. The student declares both; no device measures them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PersonFacts {
    /// Hand of the probe: `right` or `left`.
    pub hand: String,
    /// Finger rest: `none`, `tooth` or `chin`.
    pub finger_rest: String,
}

impl PersonFacts {
    /// Settings in a line of the log; `None` for any other line.
    pub(crate) fn hear(text: &str) -> Option<Self> {
        let said = Occurrence::parse(text).filter(|said| said.kind == SCREEN)?;
        let word = |key: &str| said.data.get(key)?.as_str().map(str::to_owned);
        Some(Self {
            hand: word("hand")?,
            finger_rest: word("finger_rest")?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn settings_are_heard_and_other_events_of_a_screen_are_none() {
        let line = |kind: &str, data| {
            let kind = kind.to_owned();
            let said = Occurrence {
                kind,
                tick: 3,
                data,
            };
            PersonFacts::hear(&said.to_string())
        };
        let data = json!({ "hand": "left", "finger_rest": "chin", "tools": [] });
        let facts = PersonFacts {
            hand: "left".into(),
            finger_rest: "chin".into(),
        };
        assert_eq!(line("screen", data.clone()), Some(facts));
        assert_eq!(line("other", data), None);
        assert_eq!(line("screen", json!({ "view": "front" })), None);
        assert_eq!(
            line("screen", json!({ "hand": 1, "finger_rest": "chin" })),
            None
        );
    }
}
