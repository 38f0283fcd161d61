//! Wrapper of bincode (2.0.1, unmaintained); no other module uses bincode.
//!
//! Integers are little-endian of fixed width. Decoding limits the number of bytes read and refuses trailing bytes.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Reason why bytes are not a valid message, or a message cannot be encoded.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CodecError {
    /// The length differs from the fixed length of this kind of message.
    #[error("message has {found} bytes, expected {expected}")]
    Length {
        /// Length found, bytes.
        found: usize,
        /// Length expected, bytes.
        expected: usize,
    },
    /// The message is longer than the limit.
    #[error("message has {found} bytes, at most {limit} are allowed")]
    TooLong {
        /// Length found or announced, bytes.
        found: usize,
        /// Largest length allowed, bytes.
        limit: usize,
    },
    /// The message belongs to another protocol version.
    #[error(
        "message has protocol version {found}, this program speaks {}",
        crate::PROTOCOL_VERSION
    )]
    Version {
        /// Version found.
        found: u8,
    },
    /// The message is of another kind than expected.
    #[error("message is of kind {found}, expected {expected}")]
    Kind {
        /// Kind found.
        found: u8,
        /// Kind expected.
        expected: u8,
    },
    /// A field holds a value that encoding never writes.
    #[error("message is not canonical: {0}")]
    NotCanonical(&'static str),
    /// A number is NaN or infinite.
    #[error("{0} is not a finite number")]
    NotFinite(&'static str),
    /// The bytes do not decode, or trailing bytes remain.
    #[error("message is malformed: {0}")]
    Malformed(String),
}

/// Encodes `value` into `out` and returns the length in bytes. Allocates nothing.
pub(crate) fn encode_into<T: Serialize>(value: &T, out: &mut [u8]) -> Result<usize, CodecError> {
    let config = bincode::config::standard().with_fixed_int_encoding();
    bincode::serde::encode_into_slice(value, out, config).map_err(malformed)
}

/// Encodes `value` and appends the bytes to `out`.
pub(crate) fn encode_onto<T: Serialize>(value: &T, out: &mut Vec<u8>) -> Result<(), CodecError> {
    let config = bincode::config::standard().with_fixed_int_encoding();
    let body = bincode::serde::encode_to_vec(value, config).map_err(malformed)?;
    out.extend_from_slice(&body);
    Ok(())
}

/// Decodes all of `bytes`. Reads at most `LIMIT` bytes, which also limits allocation.
pub(crate) fn decode<T: DeserializeOwned, const LIMIT: usize>(
    bytes: &[u8],
) -> Result<T, CodecError> {
    let config = bincode::config::standard()
        .with_fixed_int_encoding()
        .with_limit::<LIMIT>();
    let (value, used) = bincode::serde::decode_from_slice(bytes, config).map_err(malformed)?;
    match bytes.len() - used {
        0 => Ok(value),
        left => Err(CodecError::Malformed(format!("{left} trailing bytes"))),
    }
}

fn malformed(error: impl std::fmt::Display) -> CodecError {
    CodecError::Malformed(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trailing_and_missing_bytes_are_refused() {
        let mut bytes = Vec::new();
        encode_onto(&7u32, &mut bytes).expect("encodes");
        assert_eq!(bytes, [7, 0, 0, 0]);
        assert_eq!(decode::<u32, 16>(&bytes), Ok(7));
        assert!(matches!(
            decode::<u32, 16>(&bytes[..3]),
            Err(CodecError::Malformed(_))
        ));
        bytes.push(0);
        assert_eq!(
            decode::<u32, 16>(&bytes),
            Err(CodecError::Malformed("1 trailing bytes".into()))
        );
    }

    #[test]
    fn an_announced_length_above_the_limit_is_refused_before_it_is_read() {
        let mut bytes = u64::MAX.to_le_bytes().to_vec();
        bytes.extend_from_slice(b"text");
        assert!(decode::<String, 64>(&bytes).is_err());
        let many = (1u64 << 40).to_le_bytes();
        assert!(decode::<Vec<u64>, 64>(&many).is_err());
    }
}
