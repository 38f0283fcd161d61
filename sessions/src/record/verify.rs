//! Check of a recording's chain and signatures.

use std::ops::Range;

use crate::record::chain::Chain;
use crate::record::key::PublicKey;
use crate::record::message::Message;
use crate::record::read::{Ending, ReadError, Recording};
use crate::record::signature::{Signature, Signed, Verdict};
use crate::record::statement::{SignedStatement, Statement};

/// Check of every statement in a recording, message by message.
pub(crate) struct Verifier<'a> {
    recording: &'a Recording,
    chain: Chain,
    chain_ok: bool,
    last_valid_tick: Option<u64>,
    first_problem: Option<(String, u64)>,
    /// Number of exact messages so far.
    messages: u64,
    /// Number of gaps before the present message.
    passed: usize,
    /// Numbers of the gaps without a valid statement behind them so far.
    pending: Range<usize>,
    /// Numbers of the gaps across which the chain continues. Nothing exact is missing there.
    bridged: Vec<usize>,
    /// Ranges of ticks between valid statements without a gap, and from the beginning to a valid statement.
    signed: Vec<Signed>,
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

    /// Accepts a valid statement: the chain reaches it, or continues from it behind a gap.
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
            // Only the stretch at the beginning of the recording counts.
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
        // Behind a gap a chain that does not continue is no sign of a forgery.
        let follows = self.follows(says) || !self.pending.is_empty();
        self.chain_ok &= follows;
        if !signed.is_signed_by(&self.recording.signer) {
            return Err(
                "the signature is not the station's: this statement was forged or altered"
                    .to_owned(),
            );
        }
        let not_signed = |what| Err(format!("the {what} differs from the signed one"));
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
                "{stretch}: a row, snapshot or event differs from the signed record"
            ));
        }
        Ok(())
    }

    /// Numbers of the recording's gaps at which nothing exact is missing.
    pub fn bridged_gaps(&self) -> &[usize] {
        &self.bridged
    }

    /// Ranges of ticks that signatures cover.
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
/// The file has changed since it was opened.
pub fn verify(recording: &Recording, trust: Option<&PublicKey>) -> Result<Verdict, ReadError> {
    let mut verifier = Verifier::new(recording);
    for message in recording.messages() {
        verifier.message(&message?);
    }
    Ok(verifier.finish(trust))
}
