//! Result of a check of a recording's chain and signatures.

use serde::Serialize;

/// Result of the signatures in a recording.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Signature {
    /// The holder of the key has signed the whole recording, its end included.
    Valid {
        /// Public key of the signer, hexadecimal.
        fingerprint: String,
    },
    /// No fault was found, but the recording has no end. Its last stretch is not signed.
    Unsigned {
        /// Public key of the signer, hexadecimal.
        fingerprint: String,
        /// Last signed tick; `None` without any signature.
        last_valid_tick: Option<u64>,
    },
    /// The recording differs from the signed record, or the signer is not the trusted key.
    Invalid {
        /// Reason, as text.
        reason: String,
        /// Tick of the first invalid statement; `None` for a fault of the key.
        at: Option<u64>,
    },
}

impl std::fmt::Display for Signature {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Valid { fingerprint } => write!(f, "valid, by {fingerprint}"),
            Self::Unsigned {
                last_valid_tick: Some(tick),
                fingerprint,
            } => {
                write!(
                    f,
                    "none at the end; valid up to tick {tick}, by {fingerprint}"
                )
            }
            Self::Unsigned { .. } => {
                f.write_str("none: the recording was cut off before the first signature")
            }
            Self::Invalid {
                reason,
                at: Some(tick),
            } => write!(f, "INVALID at tick {tick}: {reason}"),
            Self::Invalid { reason, at: None } => write!(f, "INVALID: {reason}"),
        }
    }
}

/// Result of chain and signatures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Result of the signatures.
    pub signature: Signature,
    /// Whether every recorded head of the chain equals the head over the messages before it.
    pub chain_ok: bool,
}

/// Range of ticks that signatures cover without a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Signed {
    /// Tick before the first covered row; 0 from the beginning on.
    pub after_tick: u64,
    /// Last covered tick.
    pub to_tick: u64,
}
