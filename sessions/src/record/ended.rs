//! How a session ended, as the last line of its log says.

use sulcus_proto::control::EndReason;

/// What the line begins with.
const BEGINS: &str = "session ended: ";

/// Every reason ([`words`] knows of a new one).
const ALL: [EndReason; 7] = [
    EndReason::Stopped,
    EndReason::TimeUp,
    EndReason::Shutdown,
    EndReason::ConnectionLost,
    EndReason::Protocol,
    EndReason::Recording,
    EndReason::Simulation,
];

/// The line.
pub fn line(reason: EndReason) -> String {
    format!("{BEGINS}{reason:?}")
}

/// In words, why a session ended before its time; none where a line of the log does not say so.
pub fn early(line: &str) -> Option<&'static str> {
    let said = line.strip_prefix(BEGINS)?;
    let found = ALL.iter().find(|reason| said == format!("{reason:?}"));
    found.and_then(|reason| words(*reason))
}

/// Why that was before its time; none where it was as asked for.
fn words(reason: EndReason) -> Option<&'static str> {
    match reason {
        EndReason::Stopped | EndReason::TimeUp => None,
        EndReason::Shutdown => Some("the station was shut down"),
        EndReason::ConnectionLost => Some("the connection to the client was lost, or it closed it"),
        EndReason::Protocol => Some("the client broke the protocol"),
        EndReason::Recording => Some("the recording could not be written"),
        EndReason::Simulation => Some("the simulation could not go on"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_end_before_its_time_is_told_from_one_that_was_asked_for() {
        assert_eq!(line(EndReason::Stopped), "session ended: Stopped");
        let lost = early(&line(EndReason::ConnectionLost));
        assert_eq!(lost, words(EndReason::ConnectionLost));
        let early_ones = ALL.iter().filter(|reason| early(&line(**reason)).is_some());
        assert_eq!(early_ones.count(), 5);
        for other in [
            line(EndReason::Stopped),
            line(EndReason::TimeUp),
            "session ended: ConnectionLost!".into(),
            "ConnectionLost".into(),
        ] {
            assert_eq!(early(&other), None, "{other}");
        }
    }
}
