//! Levels that were told to a hand, by the number of commands that they contain.

use std::collections::VecDeque;

use crate::session::levels::InForce;

/// Largest number of levels that a hand may have to obey yet.
const MOST: usize = 4096;

/// Levels told to a hand, oldest first.
#[derive(Debug, Default)]
pub(super) struct Told(VecDeque<(u64, InForce)>);

impl Told {
    /// Takes the levels of a packet to the hand, which contain `commands` commands of the station's side. `false`:
    /// other levels have this number, because a command is being counted just now. The packet must not be sent.
    pub fn take(&mut self, commands: u64, in_force: InForce) -> bool {
        if let Some((last, levels)) = self.0.back()
            && *last >= commands
        {
            return *last == commands && *levels == in_force;
        }
        if self.0.len() == MOST {
            self.0.pop_front();
        }
        self.0.push_back((commands, in_force));
        true
    }

    /// Levels whose number of commands ends in the 32 bits `wrapped`. Older ones are forgotten: a hand does not go
    /// back. `None`: the hand was never told this number, or has obeyed a newer one.
    pub fn at(&mut self, wrapped: u32) -> Option<(u64, InForce)> {
        let place = self
            .0
            .iter()
            .position(|(commands, _)| *commands as u32 == wrapped)?;
        self.0.drain(..place);
        self.0.front().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hand_obeys_what_it_was_told_and_does_not_go_back() {
        let limited = |plan_limit_n| InForce {
            plan_limit_n,
            ..InForce::default()
        };
        let mut told = Told::default();
        assert_eq!(told.at(0), None);
        let many = u64::from(u32::MAX);
        for (commands, limit, sent) in [
            (many - 1, 1.0, true),
            (many - 1, 1.0, true),
            // The levels have changed, and their number has not yet.
            (many - 1, 9.0, false),
            (many, 2.0, true),
            (many + 1, 3.0, true),
        ] {
            assert_eq!(told.take(commands, limited(limit)), sent, "{limit}");
        }
        assert_eq!(told.at(u32::MAX - 1), Some((many - 1, limited(1.0))));
        assert_eq!(told.at(0), Some((many + 1, limited(3.0))));
        assert_eq!(told.at(0), Some((many + 1, limited(3.0))));
        assert_eq!(told.at(u32::MAX), None, "obeyed before");
        assert_eq!(told.at(7), None, "never told");
    }
}
