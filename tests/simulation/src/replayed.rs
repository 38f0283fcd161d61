//! Replay of a session's recording, as an observation.

use std::path::Path;

use sulcus_sessions::{Ending, Message, Recording, ReplayOptions, Signature, replay};

use crate::seen::Seen;

/// Returns the observation of a recording's replay, and the hash of its file.
///
/// # Errors
/// The recording cannot be read or replayed: one sentence.
pub fn replayed(path: &Path) -> Result<(Seen, [u8; 32]), String> {
    let recording = Recording::open(path).map_err(|error| error.to_string())?;
    let (mut rows, mut gaps) = (0, 0);
    for message in recording.messages() {
        match message.map_err(|error| error.to_string())? {
            Message::Row(_) => rows += 1,
            Message::Event(event) if event.text.starts_with("detached ") => gaps += 1,
            _ => {}
        }
    }
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| {});
    let report = report.map_err(|error| error.to_string())?;
    let is_signed = matches!(report.signature, Signature::Valid { .. });
    let seen = Seen::Replayed {
        rows,
        is_equal: report.identical,
        is_whole: report.chain_ok && is_signed && *recording.ending() == Ending::Finished,
        gaps,
    };
    Ok((seen, recording.blake3()))
}
