//! Records of the daemon: eight native-endian `i32` each.
//!
//! The first number is the kind.
//!
//! | kind | numbers |
//! |---|---|
//! | 0 | motion: x, y, z, rx, ry, rz, then the time since the motion before, ms |
//! | 1 | press of a button: its number from 0 on |
//! | 2 | release of a button: its number from 0 on |
//!
//! Source: spacenavd and libspnav, protocol version 0.

/// Length of a record, bytes.
pub const RECORD: usize = 32;

/// Event of a 3D mouse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// Deflection of the cap.
    Motion {
        /// x, y, z, rx, ry, rz in the daemon's axes and units, some -350 to 350.
        axes: [i32; 6],
        /// Time since the motion before, ms; 0 if unknown.
        period_ms: i32,
    },
    /// A button went down: its number from 0 on.
    Press(i32),
    /// A button went up: its number from 0 on.
    Release(i32),
}

/// Parser of a stream of records.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parser {
    record: [u8; RECORD],
    /// Number of bytes of the record so far, below [`RECORD`].
    filled: usize,
    unknown: u64,
}

impl Default for Parser {
    fn default() -> Self {
        Self::new()
    }
}

impl Parser {
    /// Parser at the start of a stream.
    pub fn new() -> Self {
        Self {
            record: [0; RECORD],
            filled: 0,
            unknown: 0,
        }
    }

    /// Takes in bytes, and adds the events of all records that are complete to `events`. The rest waits for the next
    /// bytes. Records of an unknown kind are skipped.
    pub fn feed(&mut self, bytes: &[u8], events: &mut Vec<Event>) {
        for byte in bytes {
            self.record[self.filled] = *byte;
            self.filled += 1;
            if self.filled == RECORD {
                self.filled = 0;
                match self.event() {
                    Some(event) => events.push(event),
                    None => self.unknown = self.unknown.saturating_add(1),
                }
            }
        }
    }

    /// Number of records of an unknown kind.
    pub fn unknown(&self) -> u64 {
        self.unknown
    }

    fn event(&self) -> Option<Event> {
        let (words, _) = self.record.as_chunks::<4>();
        let number = |k: usize| words.get(k).map_or(0, |word| i32::from_ne_bytes(*word));
        match number(0) {
            0 => Some(Event::Motion {
                axes: std::array::from_fn(|k| number(k + 1)),
                period_ms: number(7),
            }),
            1 => Some(Event::Press(number(1))),
            2 => Some(Event::Release(number(1))),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn bytes(records: &[[i32; 8]]) -> Vec<u8> {
        records
            .iter()
            .flatten()
            .flat_map(|number| number.to_ne_bytes())
            .collect()
    }

    #[test]
    fn records_become_events() {
        let records = [
            [0, 12, -34, 350, -1, 2, -350, 16],
            [1, 1, 0, 0, 0, 0, 0, 0],
            [7, 1, 2, 3, 4, 5, 6, 7],
            [2, 1, 9, 9, 9, 9, 9, 9],
        ];
        let (mut parser, mut events) = (Parser::new(), Vec::new());
        parser.feed(&bytes(&records), &mut events);
        let axes = [12, -34, 350, -1, 2, -350];
        let motion = Event::Motion {
            axes,
            period_ms: 16,
        };
        assert_eq!(events, [motion, Event::Press(1), Event::Release(1)]);
        assert_eq!(parser.unknown(), 1);
    }

    proptest! {
        #[test]
        fn any_bytes_in_any_parts_give_the_same_events(
            bytes in proptest::collection::vec(any::<u8>(), 0..400),
            cuts in proptest::collection::vec(1usize..70, 1..40),
        ) {
            let (mut whole, mut expected) = (Parser::new(), Vec::new());
            whole.feed(&bytes, &mut expected);
            let (mut parser, mut events, mut rest) = (Parser::new(), Vec::new(), &bytes[..]);
            for cut in cuts.iter().cycle() {
                if rest.is_empty() {
                    break;
                }
                let (part, after) = rest.split_at((*cut).min(rest.len()));
                parser.feed(part, &mut events);
                rest = after;
            }
            prop_assert_eq!(&events, &expected);
            prop_assert_eq!(&parser, &whole);
            prop_assert_eq!(events.len() + parser.unknown() as usize, bytes.len() / RECORD);
        }

        #[test]
        fn any_motion_comes_back(axes in any::<[i32; 6]>(), period_ms in any::<i32>()) {
            let [x, y, z, rx, ry, rz] = axes;
            let (mut parser, mut events) = (Parser::new(), Vec::new());
            parser.feed(&bytes(&[[0, x, y, z, rx, ry, rz, period_ms]]), &mut events);
            prop_assert_eq!(events, [Event::Motion { axes, period_ms }]);
        }
    }
}
