//! Return to a session after a lost connection.

use std::collections::VecDeque;
use std::time::Duration;

use sulcus_proto::ClientMessage;
use sulcus_proto::control::ServerHello;
use tokio::sync::mpsc::Receiver;
use tokio::time::Instant;

use super::handshake::{Welcome, shake};
use super::{LinkConfig, LinkError};
use crate::at_hand::TickPlace;

/// Timeout of one attempt.
const ATTEMPT: Duration = Duration::from_millis(1500);
/// Pause between two attempts.
const PAUSE: Duration = Duration::from_millis(200);
/// Time for further attempts after a stop by this client.
const AFTER_STOP: Duration = Duration::from_secs(3);
/// Largest number of messages that wait for the return. A person calls a few readings in that time.
const PENDING: usize = 64;

/// Facts of the session, and the messages that wait for a return.
pub(super) struct Returning {
    config: LinkConfig,
    /// Hash of the scene and period of the tick, which must be the same after a return.
    scene_hash: [u8; 32],
    tick_ns: u64,
    /// Whether the ticks run at the hand. A server that has restarted has lost their beginning.
    at_hand: bool,
    /// Time that the server grants for a return.
    within: Duration,
    /// Whether the session was started.
    started: bool,
    /// Whether the session was stopped by this client.
    stopped: bool,
    pending: VecDeque<ClientMessage>,
}

impl Returning {
    pub fn new(config: LinkConfig, hello: &ServerHello) -> Self {
        Self {
            config: LinkConfig {
                timeout: ATTEMPT,
                // The place of the ticks stays, on whatever path the client returns.
                tick: if hello.plan.tick_at_hand {
                    TickPlace::Hand
                } else {
                    TickPlace::Server
                },
                ..config
            },
            scene_hash: hello.scene_hash,
            tick_ns: hello.tick_ns,
            at_hand: hello.plan.tick_at_hand,
            within: Duration::from_millis(u64::from(hello.plan.resume_within_ms)),
            started: false,
            stopped: false,
            pending: VecDeque::new(),
        }
    }

    /// Notes a message that goes to the server.
    pub fn sent(&mut self, message: &ClientMessage) {
        match message {
            ClientMessage::Start => self.started = true,
            ClientMessage::Stop => self.stopped = true,
            _ => {}
        }
    }

    /// Excludes a return: the link was dropped.
    pub fn forbid(&mut self) {
        self.within = Duration::ZERO;
    }

    /// Whether a return after this error makes sense.
    pub fn is_possible(&self, error: &LinkError) -> bool {
        self.started && !self.within.is_zero() && matches!(error, LinkError::Lost(_))
    }

    /// Next message that waited for the return.
    pub fn next_pending(&mut self) -> Option<ClientMessage> {
        self.pending.pop_front()
    }

    /// Connects again until the session goes on. Messages of the link wait, at most 64; further ones are dropped.
    ///
    /// # Errors
    /// The server refuses, simulates another scene, or does not come back in time.
    pub async fn come_back(
        &mut self,
        epoch: u32,
        messages: &mut Receiver<ClientMessage>,
    ) -> Result<Welcome, LinkError> {
        self.config.follows = epoch;
        let mut until = Instant::now() + self.within;
        let mut hurried = false;
        loop {
            // Inputs of ticks at the hand wait for the return as long as the server does.
            if self.stopped && !hurried && !self.at_hand {
                (hurried, until) = (true, until.min(Instant::now() + AFTER_STOP));
            }
            let config = self.config.clone();
            let attempt = shake(&config);
            tokio::pin!(attempt);
            let result = loop {
                tokio::select! {
                    result = &mut attempt => break result,
                    message = messages.recv() => self.wait(message)?,
                }
            };
            match result {
                Ok(welcome) => return self.check(welcome),
                Err(error) if !error.may_pass() => return Err(error),
                Err(error) if Instant::now() >= until => return Err(error),
                Err(_) => {}
            }
            let pause = tokio::time::sleep(PAUSE);
            tokio::pin!(pause);
            loop {
                tokio::select! {
                    () = &mut pause => break,
                    message = messages.recv() => self.wait(message)?,
                }
            }
        }
    }

    /// Keeps a message for the time after the return. The error means that the link was dropped.
    fn wait(&mut self, message: Option<ClientMessage>) -> Result<(), LinkError> {
        match message {
            None => Err(LinkError::Lost("closed by this client".into())),
            // An edge of a button has no meaning seconds later.
            Some(ClientMessage::Button(_)) => Ok(()),
            Some(message) => {
                self.sent(&message);
                if self.pending.len() < PENDING {
                    self.pending.push_back(message);
                } else {
                    tracing::warn!("a message is dropped: {PENDING} wait for the return");
                }
                Ok(())
            }
        }
    }

    /// Checks the hello of the server. A server that has restarted does not know the session: it is started again.
    fn check(&mut self, welcome: Welcome) -> Result<Welcome, LinkError> {
        let hello = &welcome.hello;
        if hello.scene_hash != self.scene_hash || hello.tick_ns != self.tick_ns {
            let text = "the server simulates another scene after the return";
            return Err(LinkError::Refused(text.into()));
        }
        if hello.plan.tick_at_hand != self.at_hand {
            let text = "the server has restarted, and the ticks would run at the other end";
            return Err(LinkError::Refused(text.into()));
        }
        if !hello.resumed && !self.stopped {
            self.pending.push_front(ClientMessage::Start);
        }
        Ok(welcome)
    }
}
