//! A session while it runs: state of the tools in, parts of a stream for the viewer out.
//!
//! The server starts `sulcus-review live` as a child process for each watched session. The pipes carry the messages of
//! [`sulcus_proto::live`]. The first part has layout, mouth and tools; each further part has one instant. Every part is
//! a complete file for the viewer, and so are any parts one behind the other.
//!
//! The mouth is at rest. A part of one instant stays below [`INSTANT_BYTES`].

mod instant;
mod layout;
mod picture;
mod viewer;

use std::io::{Read, Write};

use rerun::external::re_log_encoding::rrd::Encoder;
use rerun::sink::MemorySinkStorage;
use rerun::{RecordingStream, RecordingStreamBuilder};
use sulcus_proto::CodecError;
use sulcus_proto::display::DisplayScene;
use sulcus_proto::live::{self, Hands, Kind, PipeError};

use crate::error::Refusal;
use crate::review::begin::{APPLICATION, constant};
use crate::review::write::at_rest;
use instant::Instants;

pub use viewer::{VIEWER_FILES, write_viewer};

/// Usual largest size of one instant, bytes.
pub const INSTANT_BYTES: usize = 10_000;
/// Time in which Rerun writes a part.
const FLUSH: std::time::Duration = std::time::Duration::from_secs(10);

/// Reason why a stream ends before its input.
#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    /// Standard input is no valid message.
    #[error("standard input: {0}")]
    Input(PipeError),
    /// The content of a message is not valid.
    #[error("standard input: message of kind {kind:?}: {source}")]
    Content {
        /// Kind of the message.
        kind: Kind,
        /// Violated rule.
        source: CodecError,
    },
    /// A message comes at the wrong place.
    #[error("standard input: found a message of kind {found:?}, expected {expected}")]
    Order {
        /// Kind found.
        found: Kind,
        /// Text about the kinds expected.
        expected: &'static str,
    },
    /// Standard output cannot be written.
    #[error("standard output: {0}")]
    Output(PipeError),
    /// Rerun refuses the content.
    #[error("Rerun refuses the content: {0}")]
    Rerun(#[from] Refusal),
    /// The viewer's files are missing from this program.
    #[error("this program holds no viewer: {0}")]
    Viewer(String),
}

/// Draws a session from `input` to `output` until the end of the input.
///
/// # Errors
/// A message is not valid or at the wrong place, or the output is closed.
pub fn draw(mut input: impl Read, mut output: impl Write) -> Result<(), LiveError> {
    let Some((kind, body)) = live::read(&mut input).map_err(LiveError::Input)? else {
        return Ok(());
    };
    if kind != Kind::Scene {
        return Err(LiveError::Order {
            found: kind,
            expected: "a scene first",
        });
    }
    let content = |kind| move |source| LiveError::Content { kind, source };
    let scene = DisplayScene::from_bytes(&body).map_err(content(kind))?;
    let (mut drawing, begin) = Drawing::begin(&scene)?;
    drop((scene, body));
    live::write(&mut output, Kind::Begin, &begin).map_err(LiveError::Output)?;
    drop(begin);
    while let Some((kind, body)) = live::read(&mut input).map_err(LiveError::Input)? {
        if kind != Kind::Hands {
            return Err(LiveError::Order {
                found: kind,
                expected: "the state of the tools after the scene",
            });
        }
        let hands = Hands::from_bytes(&body).map_err(content(kind))?;
        let part = drawing.further(&hands)?;
        live::write(&mut output, Kind::Further, &part).map_err(LiveError::Output)?;
    }
    Ok(())
}

/// Stream of a session.
struct Drawing {
    stream: RecordingStream,
    written: MemorySinkStorage,
    instants: Instants,
}

impl Drawing {
    /// Begins the stream of a scene. Returns the first part.
    fn begin(scene: &DisplayScene) -> Result<(Self, Vec<u8>), Refusal> {
        let picture = picture::of(scene);
        let (stream, written) = RecordingStreamBuilder::new(APPLICATION)
            // The stream is written whatever the environment variables of Rerun are.
            .enabled(true)
            .memory()?;
        constant(&stream, &picture, &layout::of(&picture))?;
        layout::styles(&stream)?;
        for part in &picture.parts {
            at_rest(&stream, part)?;
        }
        // Columns do not wait for what was logged before.
        stream.flush_with_timeout(FLUSH)?;
        let mut instants = Instants::new(scene, &picture);
        instants.parked(&stream)?;
        let mut drawing = Self {
            stream,
            written,
            instants,
        };
        let begin = drawing.part()?;
        Ok((drawing, begin))
    }

    /// Part of one instant.
    fn further(&mut self, hands: &Hands) -> Result<Vec<u8>, Refusal> {
        self.instants.write(&self.stream, hands)?;
        self.part()
    }

    fn part(&mut self) -> Result<Vec<u8>, Refusal> {
        self.stream.flush_with_timeout(FLUSH)?;
        let mut encoder = Encoder::local()?;
        // The footer is an index of a whole file, larger than an instant. Readers do without.
        encoder.do_not_emit_footer();
        for message in self.written.take() {
            encoder.append(&message)?;
        }
        encoder.finish()?;
        Ok(encoder.into_inner()?)
    }
}
