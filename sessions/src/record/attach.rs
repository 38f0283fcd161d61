//! Gaps of the connection in the log: events when the student is gone and back, and the absences that they mark.

use serde::Serialize;
use serde_json::json;

use crate::record::message::Message;
use crate::record::occurrence::Occurrence;
use crate::record::read::{ReadError, Recording};

/// Kind: the student is gone. The tick is the first one without the student. Data: `reason` ([`Detached`]).
pub const DETACHED: &str = "detached";
/// Kind: the student is back. The tick is the first one with the student. Data: `epoch`, the new session epoch;
/// `gap_ticks`, the ticks of the clock's grid without the student.
pub const ATTACHED: &str = "attached";
/// Kinds of the events at both ends of a gap.
pub const ATTACHMENTS: [&str; 2] = [DETACHED, ATTACHED];

/// Reason of a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detached {
    /// No packet came for longer than the connection lasts.
    ConnectionLost,
    /// The client closed the connection.
    Closed,
    /// The same student attached again, over another connection.
    Replaced,
    /// The client broke the protocol.
    Protocol,
    /// The station stopped for a while, or closed the connection.
    Station,
}

impl Detached {
    /// All reasons.
    pub const ALL: [Self; 5] = [
        Self::ConnectionLost,
        Self::Closed,
        Self::Replaced,
        Self::Protocol,
        Self::Station,
    ];

    /// Name in the data of the event.
    pub fn name(self) -> &'static str {
        match self {
            Self::ConnectionLost => "connection_lost",
            Self::Closed => "closed",
            Self::Replaced => "replaced",
            Self::Protocol => "protocol",
            Self::Station => "station",
        }
    }
}

impl Occurrence {
    /// Event [`DETACHED`] at the first tick without the student.
    pub fn detached(tick: u64, reason: Detached) -> Self {
        Self {
            kind: DETACHED.into(),
            tick,
            data: json!({ "reason": reason.name() }),
        }
    }

    /// Event [`ATTACHED`] at the first tick with the student.
    pub fn attached(tick: u64, epoch: u32, gap_ticks: u64) -> Self {
        Self {
            kind: ATTACHED.into(),
            tick,
            data: json!({ "epoch": epoch, "gap_ticks": gap_ticks }),
        }
    }
}

/// Time without the student, in ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Absence {
    /// First tick without the student.
    pub from: u64,
    /// First tick with the student again; `None` if the session ended before.
    pub to: Option<u64>,
}

impl Absence {
    /// Whether the tick is without the student.
    pub fn contains(&self, tick: u64) -> bool {
        tick >= self.from && self.to.is_none_or(|to| tick < to)
    }

    /// Takes a line of the log. A second `detached` in a gap and an `attached` without a gap change nothing.
    pub(crate) fn hear(all: &mut Vec<Self>, text: &str) {
        let said = Occurrence::parse(text);
        let Some(Occurrence { kind, tick, .. }) = said else {
            return;
        };
        let open = all.last_mut().filter(|last| last.to.is_none());
        match (kind.as_str(), open) {
            (DETACHED, None) => all.push(Self {
                from: tick,
                to: None,
            }),
            (ATTACHED, Some(gap)) => gap.to = Some(tick.max(gap.from)),
            _ => {}
        }
    }

    /// Absences in the log of a recording, in their order.
    ///
    /// # Errors
    /// The file has changed since it was opened.
    pub fn all(recording: &Recording) -> Result<Vec<Self>, ReadError> {
        let mut all = Vec::new();
        for message in recording.messages() {
            if let Message::Event(event) = message? {
                Self::hear(&mut all, &event.text);
            }
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(lines: &[Occurrence]) -> Vec<Absence> {
        let mut all = Vec::new();
        for line in lines {
            Absence::hear(&mut all, &line.to_string());
        }
        all
    }

    #[test]
    fn two_lines_of_the_log_are_a_gap() {
        let gone = |tick| Occurrence::detached(tick, Detached::ConnectionLost);
        let back = |tick| Occurrence::attached(tick, 3, 200);
        assert_eq!(
            (gone(100).to_string(), back(300).to_string()),
            (
                r#"detached at tick 100: {"reason":"connection_lost"}"#.to_owned(),
                r#"attached at tick 300: {"epoch":3,"gap_ticks":200}"#.to_owned()
            )
        );
        let gap = |from, to| Absence { from, to };
        let found = heard(&[
            back(5),
            gone(100),
            gone(110),
            back(300),
            back(310),
            gone(400),
        ]);
        assert_eq!(found, [gap(100, Some(300)), gap(400, None)]);
        let holds = |tick| found.iter().any(|gap| gap.contains(tick));
        let ticks = [99, 100, 299, 300, 399, 400, 1 << 40];
        let expected = [false, true, true, false, false, true, true];
        assert_eq!(ticks.map(holds), expected);
        // An end before its beginning, as by damage, is no gap.
        assert!(!heard(&[gone(9), back(3)])[0].contains(9));
    }

    #[test]
    fn every_reason_has_a_name_of_its_own() {
        let mut names = Detached::ALL.map(Detached::name).to_vec();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), Detached::ALL.len());
    }
}
