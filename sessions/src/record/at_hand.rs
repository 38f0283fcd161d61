//! Ticks at the hand in the log: that a session had them, and why they and the station's ticks are not the same.

use serde_json::json;

use crate::record::attach::Detached;
use crate::record::occurrence::Occurrence;

/// Kind: the ticks of this session ran at the hand, and the station computed them again.
pub const AT_HAND: &str = "ticks_at_hand";
/// Kind: the ticks at the hand are not those of the station, or broke a rule. The session cannot be graded. Data:
/// `why`.
pub const DIVERGED: &str = "diverged";
/// Kind: the connection is lost, and the ticks at the hand go on. The tick is the newest recorded one. Data: `reason`.
pub const HAND_AWAY: &str = "hand_away";
/// Kind: the connection is back. Data: `epoch`.
pub const HAND_RETURNED: &str = "hand_returned";
/// Kinds about ticks at the hand.
pub const OF_HAND: [&str; 4] = [AT_HAND, DIVERGED, HAND_AWAY, HAND_RETURNED];

impl Occurrence {
    /// Event [`AT_HAND`] before the first tick.
    pub fn ticks_at_hand() -> Self {
        Self {
            kind: AT_HAND.into(),
            tick: 0,
            data: json!({}),
        }
    }

    /// Event [`HAND_AWAY`].
    pub fn hand_away(tick: u64, reason: Detached) -> Self {
        Self {
            kind: HAND_AWAY.into(),
            tick,
            data: json!({ "reason": reason.name() }),
        }
    }

    /// Event [`HAND_RETURNED`].
    pub fn hand_returned(tick: u64, epoch: u32) -> Self {
        Self {
            kind: HAND_RETURNED.into(),
            tick,
            data: json!({ "epoch": epoch }),
        }
    }

    /// Event [`DIVERGED`] at a tick.
    pub fn diverged(tick: u64, why: &str) -> Self {
        Self {
            kind: DIVERGED.into(),
            tick,
            data: json!({ "why": why }),
        }
    }
}

/// Sentence of a line of the log about a divergence; `None` for any other line.
pub(crate) fn divergence(text: &str) -> Option<String> {
    // Most lines are no such line, and parsing takes time.
    if !text.starts_with(DIVERGED) {
        return None;
    }
    let said = Occurrence::parse(text).filter(|said| said.kind == DIVERGED)?;
    let why = said.data["why"].as_str().unwrap_or_default();
    Some(format!(
        "the ticks at the hand differ from the station's at tick {}: {why}",
        said.tick
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_divergence_is_read_back_and_nothing_else_is_one() {
        let line = Occurrence::diverged(7, "the state differs").to_string();
        assert_eq!(
            divergence(&line).as_deref(),
            Some("the ticks at the hand differ from the station's at tick 7: the state differs")
        );
        for other in [
            Occurrence::ticks_at_hand().to_string(),
            "diverged".into(),
            "note at tick 1: {\"text\":\"diverged\"}".into(),
        ] {
            assert_eq!(divergence(&other), None, "{other}");
        }
    }
}
