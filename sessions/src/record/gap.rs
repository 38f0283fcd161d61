//! Places in a recovered recording where a part of the exact record is missing.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Largest number of gaps in a valid recording.
pub(crate) const MOST: usize = 4096;

/// Place where exact messages are missing, because recovery left out a damaged stretch of the file.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gap {
    /// Messages of the exact channels before the gap.
    pub messages: u64,
    /// First missing tick; `None` without a tick before the gap, or if no tick is missing.
    pub from_tick: Option<u64>,
    /// Last missing tick; `None` if no later message tells it, or if no tick is missing.
    pub to_tick: Option<u64>,
    /// Length of the left out stretch of the damaged file, bytes.
    pub bytes: u64,
    /// First byte of the stretch in the damaged file.
    pub at_byte: u64,
}

impl Gap {
    /// Number of missing ticks; `None` if unknown.
    pub fn ticks(&self) -> Option<u64> {
        match (self.from_tick, self.to_tick) {
            (Some(from), Some(to)) => Some((to + 1).saturating_sub(from)),
            (None, None) if self.messages > 0 => Some(0),
            _ => None,
        }
    }

    /// Gaps in a recovery's note; `None` if the text is no valid list of gaps.
    pub(crate) fn parse(text: &str) -> Option<Vec<Self>> {
        let gaps: Vec<Self> = serde_json::from_str(text).ok()?;
        let in_order = gaps
            .windows(2)
            .all(|two| two[0].messages <= two[1].messages);
        let sane = |gap: &Self| {
            let most = crate::record::message::MAX_TICK;
            gap.from_tick.unwrap_or(0) <= most && gap.to_tick.unwrap_or(0) <= most
        };
        (in_order && gaps.len() <= MOST && gaps.iter().all(sane)).then_some(gaps)
    }

    /// Text for [`Gap::parse`].
    pub(crate) fn list(gaps: &[Self]) -> String {
        // Integers always serialise.
        serde_json::to_string(gaps).unwrap_or_default()
    }
}

impl fmt::Display for Gap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.from_tick, self.to_tick) {
            (Some(from), Some(to)) if from == to => write!(f, "tick {from}")?,
            (Some(from), Some(to)) => write!(
                f,
                "ticks {from} to {to} ({} ticks)",
                self.ticks().unwrap_or_default()
            )?,
            (Some(from), None) => write!(f, "ticks from {from} on")?,
            (None, Some(to)) => write!(f, "ticks up to {to}")?,
            (None, None) => f.write_str("no tick, perhaps lines of the log or a signature")?,
        }
        if self.bytes > 0 {
            write!(f, ", {} bytes at byte {}", self.bytes, self.at_byte)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_list_of_gaps_survives_the_note_and_nothing_else_is_one() {
        let gap = |messages| Gap {
            messages,
            from_tick: Some(7),
            to_tick: Some(9),
            bytes: 120,
            at_byte: 4000,
        };
        let gaps = vec![gap(3), gap(12)];
        assert_eq!(Gap::parse(&Gap::list(&gaps)), Some(gaps.clone()));
        assert_eq!(gaps[0].ticks(), Some(3));
        assert_eq!(
            gaps[0].to_string(),
            "ticks 7 to 9 (3 ticks), 120 bytes at byte 4000"
        );
        assert_eq!(Gap::parse(&Gap::list(&[gap(12), gap(3)])), None);
        assert_eq!(Gap::parse("[{}]"), None);
    }

    proptest! {
        #[test]
        fn any_text_is_a_list_or_none(text in "\\PC{0,60}", to in any::<u64>()) {
            let _ = Gap::parse(&text);
            let far = format!(r#"[{{"messages":0,"from_tick":0,"to_tick":{to},"bytes":0,"at_byte":0}}]"#);
            if let Some(gaps) = Gap::parse(&far) {
                let _ = (gaps[0].ticks(), gaps[0].to_string());
            }
        }
    }
}
