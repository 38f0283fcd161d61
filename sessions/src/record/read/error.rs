//! Reasons why a file cannot be read as a recording.

use std::path::PathBuf;

use sulcus_core::SceneError;
use sulcus_core::scene::SCENE_VERSION;
use sulcus_program::PathText;

use crate::record::program::Program;

/// Reason why a file cannot be read as a recording.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The system cannot read the file.
    #[error("cannot read `{}`: {source}", path.shown())]
    Io {
        /// Path of the file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The file has no MCAP magic bytes.
    #[error("not an MCAP file: the first bytes are not the MCAP magic bytes")]
    NotMcap,
    /// The file is MCAP, but no recording.
    #[error("not a Sulcus recording: the MCAP file has no metadata `sulcus`")]
    NotSulcus,
    /// The file ends inside the header. Without its header no part of a recording can be used.
    #[error("recording ends inside its header, after {at} bytes: no part of it can be used")]
    HeaderCut {
        /// Length of the whole part, bytes.
        at: u64,
    },
    /// The format version is not read.
    #[error("recording has format version `{found}`, this program reads {expected}: {advice}")]
    Version {
        /// Version found.
        found: String,
        /// Versions that are read.
        expected: String,
        /// Meaning of the version, and advice.
        advice: String,
    },
    /// The header is invalid.
    #[error("recording's header is damaged: {what}")]
    Header {
        /// Fault, as text.
        what: String,
    },
    /// The recording has no rows.
    #[error("recording has no rows: the file ends before the first tick ({ending})")]
    NoRows {
        /// Ending of the file, as text.
        ending: String,
    },
    /// The file has changed since it was opened.
    #[error("recording changed during reading: {what}")]
    Changed {
        /// Present fault, as text.
        what: String,
    },
    /// The scene has another version.
    #[error(
        "recording's scene has version {found}, this program ({}) reads {SCENE_VERSION}: replay it with the program that recorded it, {recorded_by}",
        Program::this()
    )]
    SceneVersion {
        /// Program that can read the scene.
        recorded_by: Box<Program>,
        /// Version found.
        found: u16,
    },
    /// The scene is invalid.
    #[error(
        "recording's scene cannot be used by this program ({}), recorded by {recorded_by}: {source}",
        Program::this()
    )]
    Scene {
        /// Program that can read the scene.
        recorded_by: Box<Program>,
        /// Fault of the scene.
        source: Box<SceneError>,
    },
}
