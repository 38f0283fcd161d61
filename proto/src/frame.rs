//! Framing of control messages on a stream.
//!
//! A frame is the body's length (u32, little-endian) and the body: one byte of protocol version, then the message.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::PROTOCOL_VERSION;
use crate::codec::{self, CodecError};
use crate::control::{ClientMessage, Refused, ServerMessage};
use crate::limits::CONTROL_BYTES;

/// Size of the length field, bytes.
pub const LENGTH_BYTES: usize = 4;

/// Message that travels in frames.
pub trait Message: Serialize + DeserializeOwned {}
impl Message for ClientMessage {}
impl Message for ServerMessage {}

/// Encodes a message as a frame: length field and body.
///
/// # Errors
/// The body is longer than [`CONTROL_BYTES`].
pub fn encode<T: Message>(message: &T) -> Result<Vec<u8>, CodecError> {
    let mut bytes = vec![0; LENGTH_BYTES];
    bytes.push(PROTOCOL_VERSION);
    codec::encode_onto(message, &mut bytes)?;
    let found = bytes.len() - LENGTH_BYTES;
    let too_long = CodecError::TooLong {
        found,
        limit: CONTROL_BYTES,
    };
    if found > CONTROL_BYTES {
        return Err(too_long);
    }
    let length = u32::try_from(found).map_err(|_| too_long)?;
    bytes[..LENGTH_BYTES].copy_from_slice(&length.to_le_bytes());
    Ok(bytes)
}

/// Encodes a refusal for a client of another release: the frame has the client's version. Kind and layout of a refusal
/// are the same in all versions, so that every client can show the sentence.
///
/// # Errors
/// The body is longer than [`CONTROL_BYTES`].
pub fn refusal(version: u8, refused: &Refused) -> Result<Vec<u8>, CodecError> {
    let mut bytes = encode(&ServerMessage::Refused(refused.clone()))?;
    bytes[LENGTH_BYTES] = version;
    Ok(bytes)
}

/// Returns the length of the body, bytes, from the length field. The check precedes any allocation for the body.
///
/// # Errors
/// The length is zero or above [`CONTROL_BYTES`].
pub fn body_length(length: [u8; LENGTH_BYTES]) -> Result<usize, CodecError> {
    match u32::from_le_bytes(length) as usize {
        0 => Err(CodecError::Length {
            found: 0,
            expected: 1,
        }),
        found if found > CONTROL_BYTES => Err(CodecError::TooLong {
            found,
            limit: CONTROL_BYTES,
        }),
        found => Ok(found),
    }
}

/// Decodes a body.
///
/// # Errors
/// The bytes are no valid body; the error names the violated rule. Another protocol version is [`CodecError::Version`].
pub fn decode<T: Message>(body: &[u8]) -> Result<T, CodecError> {
    let (&version, message) = body.split_first().ok_or(CodecError::Length {
        found: 0,
        expected: 1,
    })?;
    if version != PROTOCOL_VERSION {
        return Err(CodecError::Version { found: version });
    }
    codec::decode::<T, CONTROL_BYTES>(message)
}
