//! The one place that knows bincode (2.0.1, unmaintained): fixed-width little-endian integers, a
//! limit on what is read, nothing left over.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Why bytes are not a message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CodecError {
    /// Not as long as this kind of message always is.
    #[error("message has {found} bytes, expected {expected}")]
    Length {
        /// Bytes found.
        found: usize,
        /// Bytes expected.
        expected: usize,
    },
    /// Longer than any message may be.
    #[error("message has {found} bytes, at most {limit} are allowed")]
    TooLong {
        /// Bytes found or announced.
        found: usize,
        /// Most bytes allowed.
        limit: usize,
    },
    /// Spoken by another version of the protocol.
    #[error(
        "message has protocol version {found}, this program speaks {}",
        crate::PROTOCOL_VERSION
    )]
    Version {
        /// Version found.
        found: u8,
    },
    /// A message, but not of the kind expected here.
    #[error("message is of kind {found}, expected {expected}")]
    Kind {
        /// Kind found.
        found: u8,
        /// Kind expected.
        expected: u8,
    },
    /// A field holds what encoding never writes.
    #[error("message is not canonical: {0}")]
    NotCanonical(&'static str),
    /// A number that must be finite is not.
    #[error("{0} is not a finite number")]
    NotFinite(&'static str),
    /// The bytes do not decode, or some are left over.
    #[error("message is malformed: {0}")]
    Malformed(String),
}

/// Encodes into `out` and returns the length; allocates nothing.
pub(crate) fn encode_into<T: Serialize>(value: &T, out: &mut [u8]) -> Result<usize, CodecError> {
    let config = bincode::config::standard().with_fixed_int_encoding();
    bincode::serde::encode_into_slice(value, out, config).map_err(malformed)
}

/// Encodes behind whatever `out` already holds.
pub(crate) fn encode_onto<T: Serialize>(value: &T, out: &mut Vec<u8>) -> Result<(), CodecError> {
    let config = bincode::config::standard().with_fixed_int_encoding();
    let body = bincode::serde::encode_to_vec(value, config).map_err(malformed)?;
    out.extend_from_slice(&body);
    Ok(())
}

/// Decodes all of `bytes`, reading (and so allocating) at most `LIMIT` bytes.
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
