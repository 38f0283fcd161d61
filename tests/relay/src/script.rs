//! Changes of a relay over time.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use crate::Network;

/// Change of a relay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// Both directions get the conditions of a network.
    Network(Network),
    /// Both directions get a rate, bits per second.
    Rate(u64),
    /// Both directions are cut for a time.
    Outage(Duration),
    /// The relay goes on from another port towards the server, as a NAT does.
    Rebind,
}

/// Changes in the order of their times, each with the time since the start of the relay.
///
/// A change as text is `SECONDS=CHANGE`: `10=lte`, `20=rate:0.8` in Mbit/s, `30=outage:0.5` in seconds, `40=rebind`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script(Vec<(Duration, Change)>);

impl Script {
    /// Script of `changes` in any order.
    pub fn new(mut changes: Vec<(Duration, Change)>) -> Self {
        changes.sort_by_key(|(at, _)| *at);
        Self(changes)
    }

    /// Reads one text for each change.
    ///
    /// # Errors
    /// A text without a time or with an unknown change.
    pub fn read<'a>(texts: impl IntoIterator<Item = &'a str>) -> Result<Self, ScriptError> {
        let changes: Result<Vec<_>, _> = texts.into_iter().map(change_at).collect();
        Ok(Self::new(changes?))
    }

    /// Changes in the order of their times.
    pub fn changes(&self) -> &[(Duration, Change)] {
        &self.0
    }
}

/// A text that is no change.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScriptError {
    text: String,
    expected: &'static str,
}

impl fmt::Display for ScriptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "change {:?}: expected {}", self.text, self.expected)
    }
}

impl std::error::Error for ScriptError {}

/// Longest time in a script, seconds.
const LONGEST_S: f64 = 1e6;

fn seconds(text: &str) -> Option<Duration> {
    let value: f64 = text.parse().ok()?;
    (0.0..=LONGEST_S)
        .contains(&value)
        .then(|| Duration::from_secs_f64(value))
}

fn change_at(text: &str) -> Result<(Duration, Change), ScriptError> {
    let refuse = |expected| ScriptError {
        text: text.to_owned(),
        expected,
    };
    let (at, change) = text
        .split_once('=')
        .ok_or_else(|| refuse("SECONDS=CHANGE"))?;
    let at = seconds(at).ok_or_else(|| refuse("a time of 0 to 1,000,000 seconds before the ="))?;
    let change = match change.split_once(':') {
        None if change == "rebind" => Change::Rebind,
        None => Change::Network(Network::from_str(change).map_err(|_| {
            refuse("a network, `rate:MBIT`, `outage:SECONDS` or `rebind` after the =")
        })?),
        Some(("outage", length)) => Change::Outage(
            seconds(length).ok_or_else(|| refuse("a length of 0 to 1,000,000 seconds"))?,
        ),
        Some(("rate", rate)) => {
            let rate: Option<f64> = rate.parse().ok();
            let rate = rate.filter(|rate| (0.001..=100_000.0).contains(rate));
            let rate = rate.ok_or_else(|| refuse("a rate of 0.001 to 100,000 Mbit/s"))?;
            Change::Rate((rate * 1e6) as u64)
        }
        Some(_) => return Err(refuse("`rate:MBIT` or `outage:SECONDS` after the =")),
    };
    Ok((at, change))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_read_and_sorted() {
        let script = Script::read(["20=rate:0.8", "1.5=lte", "30=outage:0.5", "40=rebind"]);
        let s = Duration::from_secs_f64;
        let expected = vec![
            (s(1.5), Change::Network(Network::Lte)),
            (s(20.0), Change::Rate(800_000)),
            (s(30.0), Change::Outage(s(0.5))),
            (s(40.0), Change::Rebind),
        ];
        assert_eq!(script, Ok(Script(expected)));
    }

    #[test]
    fn a_text_that_is_no_change_is_refused_with_what_was_expected() {
        for text in [
            "",
            "lte",
            "=lte",
            "-1=lte",
            "nan=lte",
            "inf=rebind",
            "1=moon",
            "1=rate:0",
            "1=rate:",
            "1=outage:-1",
            "1=outage:NaN",
            "1=rebind:1",
            "1e9=lte",
        ] {
            let error = Script::read([text]).expect_err(text);
            assert!(error.to_string().contains("expected"), "{error}");
        }
    }
}
