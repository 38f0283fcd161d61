//! How a session ended, as the last line of its log says.

use sulcus_proto::control::EndReason;

/// What the line begins with.
const BEGINS: &str = "session ended: ";

/// The line.
pub fn line(reason: EndReason) -> String {
    format!("{BEGINS}{reason:?}")
}

/// In words, why a session ended before its time; none where a line of the log does not say so.
pub fn early(line: &str) -> Option<&'static str> {
    let said = line.strip_prefix(BEGINS)?;
    let all = [
        (EndReason::Shutdown, "the station was shut down"),
        (
            EndReason::ConnectionLost,
            "the connection to the client was lost",
        ),
        (EndReason::Protocol, "the client broke the protocol"),
        (EndReason::Recording, "the recording could not be written"),
        (EndReason::Simulation, "the simulation could not go on"),
    ];
    let found = all.iter().find(|(reason, _)| said == format!("{reason:?}"));
    found.map(|(_, words)| *words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_end_before_its_time_is_told_from_one_that_was_asked_for() {
        assert_eq!(line(EndReason::Stopped), "session ended: Stopped");
        let lost = early(&line(EndReason::ConnectionLost));
        assert_eq!(lost, Some("the connection to the client was lost"));
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
