//! Framing of control messages on a stream: u32 little-endian length of the body, then the body:
//! protocol version, then the message.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::PROTOCOL_VERSION;
use crate::codec::{self, CodecError};
use crate::control::{ClientMessage, ServerMessage};
use crate::limits::CONTROL_BYTES;

/// Bytes of the length.
pub const LENGTH_BYTES: usize = 4;

/// A message that travels in frames.
pub trait Message: Serialize + DeserializeOwned {}
impl Message for ClientMessage {}
impl Message for ServerMessage {}

/// Length and body, ready to be written.
///
/// # Errors
/// If the message is longer than [`CONTROL_BYTES`].
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

/// Length of the body that follows; checked before anything is allocated for it.
///
/// # Errors
/// If it is zero or above [`CONTROL_BYTES`].
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

/// Reads a body.
///
/// # Errors
/// Says which rule the bytes break; another protocol version is named as such.
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
