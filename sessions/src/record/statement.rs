//! Signed statements of a station about a recording: the head of the chain, every ten seconds and at the end.

use serde::Serialize;

use crate::record::bytes::Cut;
use crate::record::key::{PublicKey, StationKey};

/// Counters of the recording program over the whole session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SessionEnd {
    /// Ticks run; equal to the recorded rows if no row was dropped.
    pub ticks: u64,
    /// Ticks of the clock's grid that were missed and skipped.
    pub skipped: u64,
    /// Rows that the recorder's queue could not take. With one such row the session is not graded.
    pub dropped_rows: u64,
    /// Ticks that took longer than a millisecond.
    pub deadline_misses: u64,
    /// Ticks that needed more than the available substeps.
    pub exhausted: u64,
    /// Poses lost on the network.
    pub lost: u64,
    /// Poses that came late, twice or out of order, and were dropped.
    pub late: u64,
}

impl SessionEnd {
    fn words(&self) -> [u64; 7] {
        [
            self.ticks,
            self.skipped,
            self.dropped_rows,
            self.deadline_misses,
            self.exhausted,
            self.lost,
            self.late,
        ]
    }

    fn from_words(
        [
            ticks,
            skipped,
            dropped_rows,
            deadline_misses,
            exhausted,
            lost,
            late,
        ]: [u64; 7],
    ) -> Self {
        Self {
            ticks,
            skipped,
            dropped_rows,
            deadline_misses,
            exhausted,
            lost,
            late,
        }
    }
}

/// Statement of a station about a recording so far.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Statement {
    /// Tick of the last row or snapshot covered.
    pub tick: u64,
    /// Rows covered.
    pub rows: u64,
    /// Head of the chain over all rows, snapshots and events so far.
    pub head: [u8; 32],
    /// Digest of the header: versions, learner, station, signer, hashes of all attachments.
    pub header: [u8; 32],
    /// blake3 of the compiled scene.
    pub scene: [u8; 32],
    /// blake3 of the exercise's text.
    pub exercise: [u8; 32],
    /// The session's counters, in the last statement only.
    pub end: Option<SessionEnd>,
}

/// Statement with its signature: the message of `/exact/chain`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignedStatement {
    /// Signed statement.
    pub statement: Statement,
    /// ed25519 over the domain prefix and the statement's bytes.
    pub signature: [u8; 64],
}

/// Prefix of the signed bytes, so that a signature cannot be used in another protocol.
const DOMAIN: &[u8; 16] = b"sulcus chain v1\0";
const BODY: usize = 1 + 8 + 8 + 4 * 32 + 7 * 8;

impl Statement {
    fn body(&self) -> [u8; BODY] {
        let mut bytes = Vec::with_capacity(BODY);
        bytes.push(u8::from(self.end.is_some()));
        bytes.extend_from_slice(&self.tick.to_le_bytes());
        bytes.extend_from_slice(&self.rows.to_le_bytes());
        for hash in [&self.head, &self.header, &self.scene, &self.exercise] {
            bytes.extend_from_slice(hash);
        }
        for word in self.end.unwrap_or_default().words() {
            bytes.extend_from_slice(&word.to_le_bytes());
        }
        let mut body = [0; BODY];
        body.copy_from_slice(&bytes);
        body
    }

    fn signed_bytes(&self) -> Vec<u8> {
        [&DOMAIN[..], &self.body()].concat()
    }

    /// Signs with the station's key.
    pub fn sign(self, key: &StationKey) -> SignedStatement {
        let signature = key.sign(&self.signed_bytes());
        SignedStatement {
            statement: self,
            signature,
        }
    }
}

impl SignedStatement {
    /// Length of [`SignedStatement::to_bytes`].
    pub const BYTES: usize = BODY + 64;

    /// Bytes in the layout of `proto/sulcus/v1/exact_statement.proto`.
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        bytes[..BODY].copy_from_slice(&self.statement.body());
        bytes[BODY..].copy_from_slice(&self.signature);
        bytes
    }

    /// Inverse of [`SignedStatement::to_bytes`]; `None` for other bytes.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let mut cut = Cut(bytes);
        let kind = cut.u8()?;
        let (tick, rows) = (cut.u64()?, cut.u64()?);
        let (head, header, scene, exercise) =
            (cut.array()?, cut.array()?, cut.array()?, cut.array()?);
        let mut words = [0; 7];
        for word in &mut words {
            *word = cut.u64()?;
        }
        let end = match kind {
            0 if words == [0; 7] => None,
            1 => Some(SessionEnd::from_words(words)),
            _ => return None,
        };
        let statement = Statement {
            tick,
            rows,
            head,
            header,
            scene,
            exercise,
            end,
        };
        let signed = Self {
            statement,
            signature: cut.array()?,
        };
        cut.0.is_empty().then_some(signed)
    }

    /// Whether the holder of `key` signed exactly this statement.
    pub fn is_signed_by(&self, key: &PublicKey) -> bool {
        key.verify(&self.statement.signed_bytes(), &self.signature)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn statement(end: Option<SessionEnd>) -> Statement {
        Statement {
            tick: 7,
            rows: 5,
            head: [1; 32],
            header: [2; 32],
            scene: [3; 32],
            exercise: [4; 32],
            end,
        }
    }

    #[test]
    fn a_signed_statement_survives_a_round_trip_and_no_bit_may_change() {
        let key = StationKey::from_seed([9; 32]);
        for end in [
            None,
            Some(SessionEnd {
                ticks: 3,
                dropped_rows: 1,
                ..SessionEnd::default()
            }),
        ] {
            let bytes = statement(end).sign(&key).to_bytes();
            let back = SignedStatement::from_bytes(&bytes).expect("own bytes");
            assert_eq!(back.to_bytes(), bytes);
            assert!(back.is_signed_by(&key.public()));
            assert!(!back.is_signed_by(&StationKey::from_seed([8; 32]).public()));
            for bit in 0..bytes.len() * 8 {
                let mut bad = bytes;
                bad[bit / 8] ^= 1 << (bit % 8);
                let accepted = SignedStatement::from_bytes(&bad)
                    .is_some_and(|s| s.is_signed_by(&key.public()));
                assert!(!accepted, "bit {bit}");
            }
        }
    }

    proptest! {
        #[test]
        fn any_bytes_give_a_statement_or_none(raw in proptest::collection::vec(any::<u8>(), 0..300)) {
            if let Some(signed) = SignedStatement::from_bytes(&raw) {
                prop_assert_eq!(&signed.to_bytes()[..], &raw[..]);
            }
        }
    }
}
