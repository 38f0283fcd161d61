//! Whether a recording is what a station signed.

use std::ops::Range;

use serde::Serialize;

use crate::record::chain::Chain;
use crate::record::key::PublicKey;
use crate::record::message::Message;
use crate::record::read::{Ending, ReadError, Recording};
use crate::record::statement::{SignedStatement, Statement};

/// What the signatures in a recording say.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Signature {
    /// All of it is what the holder of this key signed, the end included.
    Valid {
        /// Public key of the signer, hexadecimal.
        fingerprint: String,
    },
    /// Nothing is wrong, but it has no end, so the last stretch is not signed.
    Unsigned {
        /// Public key of the signer, hexadecimal.
        fingerprint: String,
        /// Up to and with this tick it is signed; `None`: nowhere.
        last_valid_tick: Option<u64>,
    },
    /// It is not what was signed, or not signed by the key that is trusted.
    Invalid {
        /// In words.
        reason: String,
        /// Tick of the first statement that does not hold; `None` when it is about the key.
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
            Self::Unsigned { .. } => f.write_str("none: it was cut off before the first signature"),
            Self::Invalid {
                reason,
                at: Some(tick),
            } => write!(f, "INVALID at tick {tick}: {reason}"),
            Self::Invalid { reason, at: None } => write!(f, "INVALID: {reason}"),
        }
    }
}

/// What was found about chain and signatures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// The signatures.
    pub signature: Signature,
    /// Whether every recorded head of the chain is the one that the messages before it give.
    pub chain_ok: bool,
}

/// Follows the messages of a recording and checks every statement among them.
pub(crate) struct Verifier<'a> {
    recording: &'a Recording,
    chain: Chain,
    chain_ok: bool,
    last_valid_tick: Option<u64>,
    first_problem: Option<(String, u64)>,
    /// Exact messages so far.
    messages: u64,
    /// Gaps that were come to.
    passed: usize,
    /// Numbers of the gaps that no valid statement follows yet.
    pending: Range<usize>,
    /// Numbers of the gaps over which the chain goes on: nothing exact is missing there.
    bridged: Vec<usize>,
    /// Ticks between two valid statements with no gap between them, or from the beginning to a valid statement.
    signed: Vec<Signed>,
}

/// Ticks that the station's signatures cover without a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Signed {
    /// The rows behind this tick are covered; 0 from the beginning on.
    pub after_tick: u64,
    /// Up to and with the rows of this tick.
    pub to_tick: u64,
}

impl<'a> Verifier<'a> {
    pub fn new(recording: &'a Recording) -> Self {
        Self {
            recording,
            chain: Chain::new(recording.header_digest),
            chain_ok: true,
            last_valid_tick: None,
            first_problem: None,
            messages: 0,
            passed: 0,
            pending: 0..0,
            bridged: Vec::new(),
            signed: Vec::new(),
        }
    }

    pub fn message(&mut self, message: &Message) {
        let gaps = self.recording.gaps();
        while gaps
            .get(self.passed)
            .is_some_and(|gap| gap.messages <= self.messages)
        {
            self.passed += 1;
            self.pending.end = self.passed;
        }
        self.messages += 1;
        if let Some((link, tick, bytes)) = message.chained() {
            self.chain.add(link, tick, &bytes);
        }
        let Message::Signed(signed) = message else {
            return;
        };
        match self.check(signed) {
            Ok(()) if self.first_problem.is_none() => self.holds(&signed.statement),
            Ok(()) => {}
            Err(reason) => {
                self.first_problem
                    .get_or_insert((reason, signed.statement.tick));
            }
        }
    }

    /// Takes in a statement that holds: the chain came to it, or goes on from it behind a gap.
    fn holds(&mut self, says: &Statement) {
        if self.follows(says) {
            self.bridged.extend(self.pending.clone());
            match self.signed.last_mut() {
                Some(signed) => signed.to_tick = says.tick,
                None => self.signed.push(Signed {
                    after_tick: 0,
                    to_tick: says.tick,
                }),
            }
            // Of the stretch that begins the recording.
            if self.signed.len() == 1 && self.signed[0].after_tick == 0 {
                self.last_valid_tick = Some(self.chain.tick());
            }
        } else {
            self.chain = Chain::from_statement(says);
            self.signed.push(Signed {
                after_tick: says.tick,
                to_tick: says.tick,
            });
        }
        self.pending = self.passed..self.passed;
    }

    fn follows(&self, says: &Statement) -> bool {
        says.head == *self.chain.head()
            && says.rows == self.chain.rows()
            && says.tick == self.chain.tick()
    }

    fn check(&mut self, signed: &SignedStatement) -> Result<(), String> {
        let (says, header) = (&signed.statement, &self.recording.header);
        // Behind a gap a chain that does not follow is no sign of a forgery.
        let follows = self.follows(says) || !self.pending.is_empty();
        self.chain_ok &= follows;
        if !signed.is_signed_by(&self.recording.signer) {
            return Err(
                "the signature is not the station's: this statement was forged or altered"
                    .to_owned(),
            );
        }
        let not_signed = |what| Err(format!("the {what} is not the one that was signed"));
        if says.scene != header.scene_hash() {
            return not_signed("scene");
        }
        if says.exercise != header.exercise_hash() {
            return not_signed("exercise");
        }
        if says.header != self.recording.header_digest {
            return not_signed("header (learner, station, patient, rubric, ...)");
        }
        if !follows {
            let stretch = match self.last_valid_tick {
                Some(good) => format!("between ticks {good} and {}", says.tick),
                None => format!("up to tick {}", says.tick),
            };
            return Err(format!(
                "{stretch}: a row, snapshot or event is not what was signed"
            ));
        }
        Ok(())
    }

    /// Numbers of the recording's gaps at which nothing exact is missing.
    pub fn bridged_gaps(&self) -> &[usize] {
        &self.bridged
    }

    /// Ticks that signatures cover, stretch by stretch.
    pub fn signed(&self) -> &[Signed] {
        &self.signed
    }

    pub fn finish(self, trust: Option<&PublicKey>) -> Verdict {
        let signer = self.recording.signer;
        let fingerprint = signer.fingerprint();
        let signature = if let Some((reason, tick)) = self.first_problem {
            Signature::Invalid {
                reason,
                at: Some(tick),
            }
        } else if let Some(trusted) = trust.filter(|trusted| **trusted != signer) {
            let reason = format!("signed by {signer}, which is not the trusted key {trusted}");
            Signature::Invalid { reason, at: None }
        } else if *self.recording.ending() == Ending::Finished {
            Signature::Valid { fingerprint }
        } else {
            Signature::Unsigned {
                fingerprint,
                last_valid_tick: self.last_valid_tick,
            }
        };
        Verdict {
            signature,
            chain_ok: self.chain_ok,
        }
    }
}

/// Checks chain and signatures without running a tick.
///
/// # Errors
/// When the file changes meanwhile.
pub fn verify(recording: &Recording, trust: Option<&PublicKey>) -> Result<Verdict, ReadError> {
    let mut verifier = Verifier::new(recording);
    for message in recording.messages() {
        verifier.message(&message?);
    }
    Ok(verifier.finish(trust))
}
