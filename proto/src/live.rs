//! Pipes between a server and its child process that draws a station live for instructors.
//!
//! A message is the length of its body (u32, little-endian), one byte of kind, and the body. Server and child are of
//! the same release, so that a message has no version of its own.
//!
//! | to the child | body |
//! |---|---|
//! | [`Kind::Scene`] | [`crate::display::DisplayScene`], encoded |
//! | [`Kind::Hands`] | [`Hands`], encoded |
//!
//! | from the child | body |
//! |---|---|
//! | [`Kind::Begin`] | everything that a viewer needs first |
//! | [`Kind::Further`] | one instant |
//! | [`Kind::File`] | [`ViewerFile`], encoded |
//!
//! [`Hands`] hold hidden truth. A display never gets them.

use std::io::{ErrorKind, Read, Write};

use serde::{Deserialize, Serialize};

use crate::TOOLS;
use crate::codec::{self, CodecError};
use crate::datagram::WirePose;
use crate::display::{SCENE_BYTES, SITES};
use crate::limits::NAME_BYTES;

/// Length of a message's length and kind, bytes.
pub const HEAD: usize = 5;
/// Largest file of the viewer, bytes. Chosen as twice the largest one, 42 MB.
pub const FILE_BYTES: usize = 84 << 20;
/// Largest first message of the child, bytes: a whole mouth has some 10 MB.
const BEGIN_BYTES: usize = 128 << 20;
/// Largest message of one instant, bytes.
const FURTHER_BYTES: usize = 256 << 10;
/// Largest state of the tools, bytes.
const HANDS_BYTES: usize = 1 << 10;

/// Kind of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Scene of a session, to the child.
    Scene,
    /// State of the tools, to the child.
    Hands,
    /// First part of a stream, from the child.
    Begin,
    /// Further part of a stream, from the child.
    Further,
    /// File of the viewer, from the child.
    File,
}

impl Kind {
    const ALL: [Self; 5] = [
        Self::Scene,
        Self::Hands,
        Self::Begin,
        Self::Further,
        Self::File,
    ];

    const fn byte(self) -> u8 {
        match self {
            Self::Scene => 0x31,
            Self::Hands => 0x32,
            Self::Begin => 0x41,
            Self::Further => 0x42,
            Self::File => 0x43,
        }
    }

    /// Largest body, bytes.
    pub const fn limit(self) -> usize {
        match self {
            Self::Scene => SCENE_BYTES,
            Self::Hands => HANDS_BYTES,
            Self::Begin => BEGIN_BYTES,
            Self::Further => FURTHER_BYTES,
            Self::File => FILE_BYTES,
        }
    }
}

/// Head of a message.
///
/// # Errors
/// The body is longer than its kind allows.
pub fn head(kind: Kind, found: usize) -> Result<[u8; HEAD], CodecError> {
    let limit = kind.limit();
    let too_long = CodecError::TooLong { found, limit };
    let length = u32::try_from(found).map_err(|_| too_long.clone())?;
    if found > limit {
        return Err(too_long);
    }
    let [a, b, c, d] = length.to_le_bytes();
    Ok([a, b, c, d, kind.byte()])
}

/// Reads a head: kind and length of the body. The check precedes any allocation for the body.
///
/// # Errors
/// The kind is unknown, or the body is longer than the kind allows.
pub fn content(head: [u8; HEAD]) -> Result<(Kind, usize), CodecError> {
    let [a, b, c, d, found] = head;
    let kind = Kind::ALL.into_iter().find(|kind| kind.byte() == found);
    let kind = kind.ok_or(CodecError::Kind {
        found,
        expected: Kind::Hands.byte(),
    })?;
    let (found, limit) = (u32::from_le_bytes([a, b, c, d]) as usize, kind.limit());
    if found > limit {
        return Err(CodecError::TooLong { found, limit });
    }
    Ok((kind, found))
}

/// Error of a pipe.
#[derive(Debug, thiserror::Error)]
pub enum PipeError {
    /// The system cannot read or write the pipe.
    #[error("the pipe fails: {0}")]
    Io(#[from] std::io::Error),
    /// A message is not valid.
    #[error("a message on the pipe is not valid: {0}")]
    Codec(#[from] CodecError),
}

/// Writes a message.
///
/// # Errors
/// The body is too long, or the pipe is closed.
pub fn write(pipe: &mut impl Write, kind: Kind, body: &[u8]) -> Result<(), PipeError> {
    pipe.write_all(&head(kind, body.len())?)?;
    pipe.write_all(body)?;
    Ok(pipe.flush()?)
}

/// Reads a message; `None` at the end of the pipe.
///
/// # Errors
/// The pipe ends within a message, or the message is not valid.
pub fn read(pipe: &mut impl Read) -> Result<Option<(Kind, Vec<u8>)>, PipeError> {
    let mut head = [0; HEAD];
    let mut filled = 0;
    while filled < HEAD {
        match pipe.read(&mut head[filled..]) {
            Ok(0) if filled == 0 => return Ok(None),
            Ok(0) => return Err(std::io::Error::from(ErrorKind::UnexpectedEof).into()),
            Ok(more) => filled += more,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error.into()),
        }
    }
    let (kind, length) = content(head)?;
    let mut body = Vec::new();
    // Grows with the bytes that come, so that an announced length alone allocates little.
    let read = pipe.take(length as u64).read_to_end(&mut body)?;
    if read < length {
        return Err(std::io::Error::from(ErrorKind::UnexpectedEof).into());
    }
    Ok(Some((kind, body)))
}

/// Tip of a probe in a pocket.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InPocket {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Number of the site, 0 to 5, in the order of `DisplayObject::sites`.
    pub site: u8,
    /// Depth of the tip below the margin, millimetres.
    pub depth_mm: f32,
    /// Depth of the site by the scene, millimetres. A student never gets this value.
    pub true_depth_mm: f32,
    /// Force on the pocket's floor, newtons.
    pub floor_n: f32,
    /// Zone of that force: 0 light, 1 too heavy, 2 trauma, 3 damage.
    pub zone: u8,
}

/// State of a tool for instructors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Hand {
    /// Whether a hand holds the tool.
    pub held: bool,
    /// Graphic pose, `world_from_tool`.
    pub graphic: WirePose,
    /// Haptic pose, `world_from_tool`.
    pub haptic: WirePose,
    /// Force on the hand, world axes, newtons.
    pub force_n: [f32; 3],
    /// Reading of the pocket; `None` with the tip outside of pockets.
    pub pocket: Option<InPocket>,
}

/// State of all tools at an instant, for instructors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Hands {
    /// Tick of this instant.
    pub tick: u64,
    /// Whether the session is paused.
    pub paused: bool,
    /// Tools by slot.
    pub tools: [Hand; TOOLS],
}

impl Hands {
    /// Encodes the state.
    ///
    /// # Errors
    /// A number is not finite, or a site has no such number.
    pub fn to_bytes(&self) -> Result<Vec<u8>, CodecError> {
        self.check()?;
        let mut bytes = Vec::new();
        codec::encode_onto(self, &mut bytes)?;
        Ok(bytes)
    }

    /// Decodes a state.
    ///
    /// # Errors
    /// The bytes are no valid state; the error names the violated rule.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CodecError> {
        let hands: Self = codec::decode::<_, HANDS_BYTES>(bytes)?;
        hands.check()?;
        Ok(hands)
    }

    fn check(&self) -> Result<(), CodecError> {
        for tool in &self.tools {
            let poses = [&tool.graphic, &tool.haptic].into_iter();
            let mut numbers = poses
                .flat_map(|pose| pose.position.iter().chain(&pose.orientation))
                .chain(&tool.force_n);
            if !numbers.all(|x| x.is_finite()) {
                return Err(CodecError::NotFinite("a number of a hand"));
            }
            let Some(pocket) = &tool.pocket else { continue };
            let numbers = [pocket.depth_mm, pocket.true_depth_mm, pocket.floor_n];
            if !numbers.iter().all(|x| x.is_finite()) {
                return Err(CodecError::NotFinite("a number of a pocket"));
            }
            if usize::from(pocket.site) >= SITES || pocket.zone > 3 {
                return Err(CodecError::NotCanonical(
                    "a pocket has no such site or zone",
                ));
            }
        }
        Ok(())
    }
}

/// File of the viewer's page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ViewerFile {
    /// Version of the viewer.
    pub version: String,
    /// Name of the file.
    pub name: String,
    /// Content, compressed by gzip.
    pub gzip: Vec<u8>,
}

impl ViewerFile {
    /// Encodes the file.
    ///
    /// # Errors
    /// A name is not valid, or the file is too long.
    pub fn to_bytes(&self) -> Result<Vec<u8>, CodecError> {
        self.check()?;
        let mut bytes = Vec::new();
        codec::encode_onto(self, &mut bytes)?;
        Ok(bytes)
    }

    /// Decodes a file.
    ///
    /// # Errors
    /// The bytes are no valid file; the error names the violated rule.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CodecError> {
        let file: Self = codec::decode::<_, FILE_BYTES>(bytes)?;
        file.check()?;
        Ok(file)
    }

    /// Names are parts of paths.
    fn check(&self) -> Result<(), CodecError> {
        let is_plain = |text: &str| {
            let mut letters = text.bytes();
            (1..=NAME_BYTES).contains(&text.len())
                && letters.all(|c| c.is_ascii_alphanumeric() || b"._-".contains(&c))
        };
        if is_plain(&self.version) && is_plain(&self.name) {
            return Ok(());
        }
        Err(CodecError::NotCanonical(
            "a file of the viewer has a name with other letters than a-z, 0-9, `.`, `_`, `-`",
        ))
    }
}
