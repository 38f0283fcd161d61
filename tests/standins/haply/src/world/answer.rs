//! Answer of the service to one message.

use super::World;
use super::pending::take;
use crate::log::{Violation, What};
use crate::message::{ClientMessage, parse};

/// What goes to the client after a message.
#[derive(Debug, Default)]
pub(crate) struct Answer {
    /// Texts in order.
    pub(crate) texts: Vec<String>,
    /// A close message comes instead.
    pub(crate) close: bool,
}

impl World {
    /// Handles one message of a connection; exactly one text comes back unless a fault is in wait.
    pub(crate) fn message(&mut self, number: u64, text: &str, pipelined: bool) -> Answer {
        let now = self.advance();
        self.messages += 1;
        if let Some(link) = self.links.get_mut(&number) {
            link.messages += 1;
        }
        if pipelined {
            self.violation(number, Violation::Pipelined, "");
        }
        let message = parse(text).unwrap_or_else(|error| {
            self.violation(number, Violation::BadJson, &error);
            ClientMessage::default()
        });
        self.check_profile(number, &message);
        let commands = self.carry_out(number, &message.orders, now);
        let messages = self.links.get(&number).map_or(0, |link| link.messages);
        self.log.add(
            now,
            What::Message {
                connection: number,
                number: messages,
                commands,
            },
        );
        if self
            .links
            .get_mut(&number)
            .is_some_and(|link| std::mem::take(&mut link.close))
        {
            return Answer {
                texts: Vec::new(),
                close: true,
            };
        }
        if take(&mut self.pending.silence) {
            return Answer::default();
        }
        self.answer(number, message.full_state)
    }

    fn check_profile(&mut self, number: u64, message: &ClientMessage) {
        let Some(link) = self.links.get_mut(&number) else {
            return;
        };
        let named = link.profile;
        link.profile |= message.profile.is_some();
        if message.profile.is_none() && link.messages == 1 {
            self.violation(number, Violation::ProfileMissing, "");
        } else if message.profile.is_some() && named {
            self.violation(number, Violation::ProfileRepeated, "");
        }
    }

    /// Inventory or reply, with the faults of replies in wait.
    pub(super) fn answer(&mut self, number: u64, full: bool) -> Answer {
        let mut text = self.reply(number, full);
        self.pending.count_down();
        take(&mut self.pending.twice_device);
        if take(&mut self.pending.malformed) {
            text = format!("{{\"inverse3\": [{{\"device_id\" {}", text.len());
        } else if take(&mut self.pending.truncated) {
            // The text is plain ASCII but for ids of the test: the cut falls on a border of a character.
            let cut = (0..=text.len() / 2)
                .rev()
                .find(|cut| text.is_char_boundary(*cut))
                .unwrap_or(0);
            text.truncate(cut);
        }
        let mut texts = vec![text];
        if take(&mut self.pending.twice_reply) {
            texts.push(texts[0].clone());
        }
        Answer {
            texts,
            close: false,
        }
    }
}
