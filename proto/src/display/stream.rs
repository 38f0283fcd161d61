//! Heads of the unidirectional streams of a display: protocol version, kind, then the content to the stream's end.

use super::{FRAME_BYTES, SCENE_BYTES, SceneHash};
use crate::{CodecError, PROTOCOL_VERSION};

/// Length of version and kind, bytes.
pub const HEAD: usize = 2;
/// Length of a scene's hash, bytes.
const HASH: usize = 32;
/// Kind of a stream with a scene.
const SCENE: u8 = 0x21;
/// Kind of a stream with a frame.
const FRAME: u8 = 0x22;

/// Content of a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Hash of a scene, then the encoded scene. No scene follows for a client that has it.
    Scene,
    /// Encoded frame.
    Frame,
}

impl Content {
    /// Largest number of bytes behind the head.
    pub const fn limit(self) -> usize {
        match self {
            Content::Scene => HASH + SCENE_BYTES,
            Content::Frame => FRAME_BYTES,
        }
    }
}

/// Head of a stream with a scene: kind and hash. The encoded scene follows, unless the client has it.
pub fn scene_head(hash: &SceneHash) -> [u8; HEAD + HASH] {
    let mut head = [0; HEAD + HASH];
    [head[0], head[1]] = [PROTOCOL_VERSION, SCENE];
    head[HEAD..].copy_from_slice(&hash.0);
    head
}

/// Head of a stream with a frame.
pub const fn frame_head() -> [u8; HEAD] {
    [PROTOCOL_VERSION, FRAME]
}

/// Reads the head of a stream.
///
/// # Errors
/// Another protocol version, or an unknown kind.
pub fn content(head: [u8; HEAD]) -> Result<Content, CodecError> {
    match head {
        [PROTOCOL_VERSION, SCENE] => Ok(Content::Scene),
        [PROTOCOL_VERSION, FRAME] => Ok(Content::Frame),
        [PROTOCOL_VERSION, found] => Err(CodecError::Kind {
            found,
            expected: FRAME,
        }),
        [found, _] => Err(CodecError::Version { found }),
    }
}

/// Splits the content of a scene's stream. `None` in place of the scene: the client has it.
///
/// # Errors
/// The hash is incomplete, or the scene has another hash.
pub fn scene(content: &[u8]) -> Result<(SceneHash, Option<&[u8]>), CodecError> {
    let Some((hash, scene)) = content.split_first_chunk::<HASH>() else {
        return Err(CodecError::Length {
            found: content.len(),
            expected: HASH,
        });
    };
    let hash = SceneHash(*hash);
    if scene.is_empty() {
        return Ok((hash, None));
    }
    if SceneHash::of(scene) != hash {
        return Err(CodecError::NotCanonical("a scene has another hash"));
    }
    Ok((hash, Some(scene)))
}
