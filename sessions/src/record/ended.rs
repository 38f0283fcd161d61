//! Reason for the end of a session, in the last line of its log.

use sulcus_proto::control::EndReason;

/// First words of the line.
const BEGINS: &str = "session ended: ";

/// All reasons. The `match` in [`words`] fails to compile with a new reason.
const ALL: [EndReason; 9] = [
    EndReason::Stopped,
    EndReason::TimeUp,
    EndReason::Shutdown,
    EndReason::ConnectionLost,
    EndReason::Protocol,
    EndReason::Recording,
    EndReason::Simulation,
    EndReason::Instructor,
    EndReason::Diverged,
];

/// Line of the log for a reason.
pub fn line(reason: EndReason) -> String {
    format!("{BEGINS}{reason:?}")
}

/// Reason of an early end, in words; `None` for any other line of the log and for an end on request.
pub fn early(line: &str) -> Option<&'static str> {
    let said = line.strip_prefix(BEGINS)?;
    let found = ALL.iter().find(|reason| said == format!("{reason:?}"));
    found.and_then(|reason| words(*reason))
}

/// Text for a reason of an early end; `None` for an end on request.
fn words(reason: EndReason) -> Option<&'static str> {
    match reason {
        EndReason::Stopped | EndReason::TimeUp => None,
        EndReason::Shutdown => Some("the station was shut down"),
        EndReason::ConnectionLost => {
            Some("the connection to the client was lost, or closed by the client")
        }
        EndReason::Protocol => Some("the client broke the protocol"),
        EndReason::Recording => Some("the recording could not be written"),
        EndReason::Simulation => Some("the simulation could not go on"),
        EndReason::Instructor => Some("an instructor ended the session"),
        EndReason::Diverged => Some("the ticks at the hand and those of the station differ"),
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
        assert_eq!(early_ones.count(), 7);
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
