//! A single pedal, or any other single switch: groups of short and long presses become keys.
//!
//! All times are arguments, milliseconds of any clock that never goes back.

use super::entry::MOST_DEPTH_MM;
use super::key::Key;

/// Meaning of a group of presses: `long` long presses after `short` short ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PedalRow {
    /// Number of short presses.
    pub short: u8,
    /// Number of long presses.
    pub long: u8,
    /// Key that the group stands for.
    pub key: Key,
}

/// Rule of a pedal: times and meanings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PedalRule {
    /// Shortest press that counts, ms. A shorter one is the bounce of a switch.
    pub bounce_ms: u64,
    /// Shortest long press, ms.
    pub long_ms: u64,
    /// Shortest pause that ends a group, ms.
    pub gap_ms: u64,
    /// Whether short presses count the depth. Rows then apply to the long presses alone.
    pub counts_depth: bool,
    /// Meanings of groups. A group without a row changes nothing.
    pub rows: Vec<PedalRow>,
}

impl PedalRule {
    /// Rule of a pedal beside a keyboard: a press confirms, two say bleeding, three suppuration, a long one undoes.
    ///
    /// Times are chosen: presses of a foot last 0.1 to 0.3 s.
    pub fn beside_keyboard() -> Self {
        let row = |short, long, key| PedalRow { short, long, key };
        Self {
            bounce_ms: 20,
            long_ms: 500,
            gap_ms: 400,
            counts_depth: false,
            rows: vec![
                row(1, 0, Key::Next),
                row(2, 0, Key::Bleeding),
                row(3, 0, Key::Suppuration),
                row(0, 1, Key::Undo),
            ],
        }
    }

    /// Rule of a pedal alone: short presses count millimetres. Long presses confirm (1), undo (2) and say bleeding (3)
    /// or suppuration (4).
    ///
    /// Four short presses and a long one chart 4 mm and go on.
    pub fn alone() -> Self {
        let row = |long, key| PedalRow {
            short: 0,
            long,
            key,
        };
        Self {
            counts_depth: true,
            rows: vec![
                row(1, Key::Next),
                row(2, Key::Undo),
                row(3, Key::Bleeding),
                row(4, Key::Suppuration),
            ],
            ..Self::beside_keyboard()
        }
    }
}

/// State of a pedal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pedal {
    rule: PedalRule,
    down_since: Option<u64>,
    last_up: u64,
    short: u8,
    long: u8,
}

impl Pedal {
    /// Pedal that is up.
    pub fn new(rule: PedalRule) -> Self {
        Self {
            rule,
            down_since: None,
            last_up: 0,
            short: 0,
            long: 0,
        }
    }

    /// Takes in a press at `at_ms`, and returns the keys of the group before. Repeated presses of a held pedal count
    /// once.
    pub fn down(&mut self, at_ms: u64) -> Vec<Key> {
        let keys = self.wait(at_ms);
        self.press(at_ms);
        keys
    }

    /// Takes in a press at `at_ms` without an end of the group before. [`Pedal::wait`] alone then ends groups.
    pub fn press(&mut self, at_ms: u64) {
        self.down_since.get_or_insert(at_ms);
    }

    /// Takes in a release at `at_ms`. The keys of the group come from [`Pedal::wait`].
    pub fn up(&mut self, at_ms: u64) {
        let held = self.down_since.map(|since| at_ms.saturating_sub(since));
        self.up_after(at_ms, held.unwrap_or(0));
    }

    /// The same for a press of `held_ms`, however late press and release were noticed.
    pub fn up_after(&mut self, at_ms: u64, held_ms: u64) {
        if self.down_since.take().is_none() || held_ms < self.rule.bounce_ms {
            return;
        }
        self.last_up = at_ms;
        let count = if held_ms >= self.rule.long_ms {
            &mut self.long
        } else {
            &mut self.short
        };
        *count = count.saturating_add(1);
    }

    /// Keys of a group that has ended by `at_ms`, in their order. A screen asks once for each picture.
    pub fn wait(&mut self, at_ms: u64) -> Vec<Key> {
        let rested = at_ms.saturating_sub(self.last_up) >= self.rule.gap_ms;
        if self.down_since.is_some() || !rested {
            return Vec::new();
        }
        let (mut short, long) = (
            std::mem::take(&mut self.short),
            std::mem::take(&mut self.long),
        );
        let mut keys = Vec::new();
        if self.rule.counts_depth && short > 0 {
            if short > MOST_DEPTH_MM {
                return keys;
            }
            keys.push(Key::Count(short));
            short = 0;
        }
        let rows = self.rule.rows.iter();
        let mut meant = rows.filter(|row| (row.short, row.long) == (short, long));
        keys.extend(meant.next().map(|row| row.key));
        keys
    }

    /// Forgets the group of presses so far, as for a window that lost the focus.
    pub fn let_go(&mut self) {
        self.down_since = None;
        (self.short, self.long) = (0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Keys of presses, each a length and the pause behind it, ms.
    fn keys(rule: PedalRule, presses: &[(u64, u64)]) -> Vec<Key> {
        let (mut pedal, mut now, mut keys) = (Pedal::new(rule), 1000, Vec::new());
        for (held, pause) in presses {
            keys.extend(pedal.down(now));
            now += held;
            pedal.up(now);
            now += pause;
        }
        keys.extend(pedal.wait(now));
        keys
    }

    #[test]
    fn beside_a_keyboard_a_press_confirms_and_groups_mean_findings() {
        let rule = PedalRule::beside_keyboard;
        assert_eq!(keys(rule(), &[(150, 400)]), [Key::Next]);
        assert_eq!(keys(rule(), &[(150, 399)]), []);
        assert_eq!(keys(rule(), &[(150, 100), (150, 500)]), [Key::Bleeding]);
        assert_eq!(
            keys(rule(), &[(150, 600), (150, 500)]),
            [Key::Next, Key::Next]
        );
        assert_eq!(
            keys(rule(), &[(150, 90), (150, 90), (150, 500)]),
            [Key::Suppuration]
        );
        assert_eq!(keys(rule(), &[(500, 500)]), [Key::Undo]);
        assert_eq!(keys(rule(), &[(19, 500)]), []);
        assert_eq!(
            keys(rule(), &[(150, 100), (900, 500)]),
            [],
            "a group without a meaning"
        );
    }

    #[test]
    fn a_pedal_alone_charts_a_site() {
        let four = [(120, 150), (120, 150), (120, 150), (120, 150), (700, 500)];
        assert_eq!(keys(PedalRule::alone(), &four), [Key::Count(4), Key::Next]);
        let [_, _, _, a, long] = four;
        assert_eq!(
            keys(PedalRule::alone(), &[a, long]),
            [Key::Count(1), Key::Next]
        );
        assert_eq!(
            keys(PedalRule::alone(), &[(700, 100), (700, 500)]),
            [Key::Undo]
        );
        let many = [(100, 100); 21];
        assert_eq!(
            keys(PedalRule::alone(), &[&many[..], &[(700, 500)]].concat()),
            []
        );
    }

    #[test]
    fn a_held_pedal_that_repeats_is_one_press() {
        let mut pedal = Pedal::new(PedalRule::beside_keyboard());
        for at in [0, 250, 280, 310, 340] {
            assert_eq!(pedal.down(at), []);
        }
        pedal.up(520);
        pedal.up(530);
        assert_eq!(pedal.wait(919), []);
        assert_eq!(pedal.wait(920), [Key::Undo]);
        assert_eq!(pedal.wait(2000), []);
    }

    proptest! {
        #[test]
        fn any_times_give_no_more_keys_than_presses(
            times in proptest::collection::vec((0u64..2000, any::<bool>()), 0..300), alone in any::<bool>(),
        ) {
            let rule = if alone { PedalRule::alone() } else { PedalRule::beside_keyboard() };
            let mut pedal = Pedal::new(rule);
            let (mut presses, mut found) = (0, Vec::new());
            for (at, down) in times {
                if down {
                    presses += 1;
                    found.extend(pedal.down(at));
                } else {
                    pedal.up(at);
                    found.extend(pedal.wait(at));
                }
            }
            prop_assert!(found.len() <= presses);
            let in_range = |key: &Key| !matches!(key, Key::Count(mm) if *mm > MOST_DEPTH_MM || *mm == 0);
            prop_assert!(found.iter().all(in_range));
        }
    }
}
