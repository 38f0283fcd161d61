//! Happenings of a session: commands, and faults of network and machines.

use sulcus_proto::control::Command;
use sulcus_relay::Network;
use sulcus_server::stepped::Taken;

use super::{REMEMBERED, Run};
use crate::control::Down;
use crate::faults::Happening;
use crate::seen::{Seen, Side};

impl Run {
    pub(super) fn happen(&mut self) {
        let Some((_, happening)) = self.schedule.pop_front() else {
            return;
        };
        self.say(format!("{happening:?}"));
        match happening {
            Happening::Order(Side::Station, command) => self.order(Side::Station, command),
            Happening::Order(Side::Student, command) => self.hands.commands.push(command),
            Happening::Network(network) => self.network(network),
            Happening::Cut(ns) => self.cut([true, true], ns),
            Happening::HalfCut(is_up, ns) => self.cut([is_up, !is_up], ns),
            Happening::Replace => self.replace(),
            Happening::Stall(part, ns) => {
                let until = &mut self.stalled[part as usize];
                *until = (*until).max(self.now_ns + ns);
            }
            Happening::Garbage(count) => {
                for _ in 0..count {
                    let bytes: Vec<u8> = (0..self.rng.usize(0..400))
                        .map(|_| self.rng.u8(..))
                        .collect();
                    self.received(&bytes);
                }
            }
            Happening::Repeat(count) => {
                for _ in 0..count {
                    if let Some(bytes) = self.former.get(self.rng.usize(0..REMEMBERED)).cloned() {
                        self.received(&bytes);
                    }
                }
            }
            Happening::Press(tool, button) => self.session.press(tool, button),
            Happening::Uncut(way) => {
                if self.now_ns >= self.cut_until[way] {
                    [&mut self.up, &mut self.down][way].path().cut(false);
                }
            }
        }
    }

    pub(super) fn network(&mut self, network: Network) {
        self.up.path().change(network.up());
        self.down.path().change(network.down());
    }

    pub(super) fn cut(&mut self, ways: [bool; 2], ns: u64) {
        for way in [0, 1] {
            if ways[way] {
                let until = self.now_ns + ns;
                self.cut_until[way] = self.cut_until[way].max(until);
                [&mut self.up, &mut self.down][way].path().cut(true);
                let at = self.schedule.partition_point(|(at_ns, _)| *at_ns <= until);
                self.schedule.insert(at, (until, Happening::Uncut(way)));
            }
        }
    }

    pub(super) fn order(&mut self, side: Side, command: Command) {
        let taken = match side {
            Side::Station => self.session.instructor(command),
            Side::Student => self.session.student(command),
        };
        if !matches!(taken, Taken::NoForce(_)) {
            self.see(Seen::Ordered(side, command));
        }
        if taken == Taken::Lifted {
            // Poses from before the end of the pause must not move a tool.
            self.begin_epoch();
            if let Some(connection) = self.at_server {
                self.tell_client(connection, Down::Epoch(self.epoch));
            }
        }
    }

    pub(super) fn begin_epoch(&mut self) {
        self.epoch += 1;
        self.session.begin_epoch(self.epoch);
        let text = format!("epoch {}", self.epoch);
        self.say(text);
        self.see(Seen::Epoch(self.epoch));
    }
}
