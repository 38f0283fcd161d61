//! Connections of a session and their control messages: loss, return, replacement.

use sulcus_connection::carrier::Carrier as _;
use sulcus_proto::ClientMessage;
use sulcus_sessions::Detached;

use super::{RETRY, Run, SILENT};
use crate::control::{Down, Up};
use crate::seen::{Seen, Side};

impl Run {
    pub(super) fn tell_server(&mut self, connection: u32, message: Up) {
        let (now_ns, open_ns) = (self.now_ns, self.cut_until[0]);
        self.control.up.send(now_ns, open_ns, (connection, message));
    }

    pub(super) fn tell_client(&mut self, connection: u32, message: Down) {
        let (now_ns, open_ns) = (self.now_ns, self.cut_until[1]);
        self.control
            .down
            .send(now_ns, open_ns, (connection, message));
    }

    pub(super) fn replace(&mut self) {
        if self.link.is_returning() {
            return;
        }
        self.link.leave();
        self.attempt_ns = Some(self.now_ns);
    }

    pub(super) fn attempt(&mut self) {
        self.attempt_ns = Some(self.now_ns + RETRY);
        if self.cut_until.iter().all(|until| *until <= self.now_ns) {
            self.newest += 1;
            self.tell_server(self.newest, Up::Attach);
        }
    }

    pub(super) fn lose(&mut self) {
        if self.at_server.is_some() && self.heard[0] + SILENT <= self.now_ns {
            self.at_server = None;
            self.session.let_go(Detached::ConnectionLost);
            self.say("the server has lost the connection".into());
            self.see(Seen::Gone);
        }
        if !self.link.is_returning() && self.heard[1] + SILENT <= self.now_ns {
            self.say("the client has lost the connection".into());
            self.link.leave();
            self.attempt_ns = Some(self.now_ns);
        }
    }

    pub(super) fn told_server(&mut self) {
        let Some((connection, message)) = self.control.up.receive(self.now_ns) else {
            return;
        };
        match message {
            Up::Attach => {
                if self.at_server.is_some_and(|present| present >= connection) {
                    return;
                }
                self.at_server = Some(connection);
                self.heard[0] = self.now_ns;
                self.begin_epoch();
                self.tell_client(connection, Down::Welcome(self.epoch));
            }
            Up::Message(message) if self.at_server == Some(connection) => match message {
                ClientMessage::Command(command) => self.order(Side::Student, command),
                ClientMessage::Event(event) => self.session.event(event),
                ClientMessage::Button(edge) if edge.pressed => {
                    self.session.press(edge.tool, edge.button)
                }
                _ => {}
            },
            Up::Message(_) => {}
        }
    }

    pub(super) fn told_client(&mut self) {
        let Some((connection, message)) = self.control.down.receive(self.now_ns) else {
            return;
        };
        match message {
            Down::Welcome(epoch) if connection == self.newest && self.link.is_returning() => {
                self.at_client = connection;
                self.heard[1] = self.now_ns;
                self.attempt_ns = None;
                self.link.come_back(epoch);
                self.say(format!("the client is back, epoch {epoch}"));
            }
            Down::Epoch(epoch) if connection == self.at_client => self.link.begin_epoch(epoch),
            Down::Welcome(_) | Down::Epoch(_) => {}
        }
    }
}
