//! Raw reports of a 3D mouse (USB HID), for systems without the daemon.
//!
//! The first byte is the number of the report. Numbers are little-endian.
//!
//! | report | content |
//! |---|---|
//! | 1, 7 bytes | x, y, z, `i16` each |
//! | 1, 13 bytes | x, y, z, rx, ry, rz |
//! | 2, 7 bytes | rx, ry, rz |
//! | 3 | a bit for each button |
//!
//! The length tells both layouts apart; newer mice send one report, older ones two. The device's x points to the right,
//! y towards the person, z downwards. Events have the axes of the daemon, which takes the device's y and z as its own
//! -z and -y (spacenavd, default axis map).

use super::record::Event;

/// Largest number of buttons.
const BUTTONS: usize = 32;

/// Reader of raw reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reports {
    /// Last deflections in the device's axes.
    raw: [i16; 6],
    /// Buttons that are down, a bit each.
    buttons: u32,
}

impl Reports {
    /// Reader of a mouse at rest.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes in a report with its number, and adds its events to `events`. An unknown or short report is skipped.
    pub fn feed(&mut self, report: &[u8], events: &mut Vec<Event>) {
        let Some((id, content)) = report.split_first() else {
            return;
        };
        match id {
            1 => self.deflect(0, content, events),
            2 => self.deflect(3, content, events),
            3 => self.press(content, events),
            _ => {}
        }
    }

    /// Takes in whole triples of numbers from axis `first` on.
    fn deflect(&mut self, first: usize, content: &[u8], events: &mut Vec<Event>) {
        let (words, _) = content.as_chunks::<2>();
        let whole = words.len() / 3 * 3;
        if whole == 0 {
            return;
        }
        for (axis, word) in self.raw[first..].iter_mut().zip(&words[..whole]) {
            *axis = i16::from_le_bytes(*word);
        }
        let [x, y, z, rx, ry, rz] = self.raw.map(i32::from);
        events.push(Event::Motion {
            axes: [x, -z, -y, rx, -rz, -ry],
            period_ms: 0,
        });
    }

    fn press(&mut self, content: &[u8], events: &mut Vec<Event>) {
        let bytes = content.iter().take(BUTTONS / 8).enumerate();
        let down = bytes.fold(0, |sum, (k, byte)| sum | u32::from(*byte) << (8 * k));
        let changed = down ^ self.buttons;
        self.buttons = down;
        for number in (0..BUTTONS).filter(|k| changed >> k & 1 == 1) {
            let is_down = down >> number & 1 == 1;
            let event = if is_down {
                Event::Press
            } else {
                Event::Release
            };
            events.push(event(number as i32));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Vector;
    use crate::hand::spacenav::CapRule;
    use proptest::prelude::*;

    fn events(reports: &mut Reports, bytes: &[u8]) -> Vec<Event> {
        let mut events = Vec::new();
        reports.feed(bytes, &mut events);
        events
    }

    #[test]
    fn both_layouts_say_the_same() {
        let numbers: [i16; 6] = [100, -200, 300, -1, 2, -350];
        let bytes = |part: &[i16]| {
            part.iter()
                .flat_map(|x| x.to_le_bytes())
                .collect::<Vec<u8>>()
        };
        let mut one = Reports::new();
        let whole = [&[1], &bytes(&numbers)[..]].concat();
        let found = events(&mut one, &whole);
        let axes = [100, -300, 200, -1, 350, -2];
        assert_eq!(found, [Event::Motion { axes, period_ms: 0 }]);
        let mut two = Reports::new();
        let first = events(&mut two, &[&[1], &bytes(&numbers[..3])[..]].concat());
        let axes_first = [100, -300, 200, 0, 0, 0];
        assert_eq!(
            first,
            [Event::Motion {
                axes: axes_first,
                period_ms: 0
            }]
        );
        assert_eq!(
            events(&mut two, &[&[2], &bytes(&numbers[3..])[..]].concat()),
            found
        );
        assert_eq!(one, two);
    }

    #[test]
    fn a_cap_pulled_towards_the_person_moves_towards_the_eye() {
        // y = 350, all others 0.
        let mut reports = Reports::new();
        let found = events(&mut reports, &[1, 0, 0, 0x5e, 0x01, 0, 0]);
        let [Event::Motion { axes, .. }] = found[..] else {
            panic!("{found:?}");
        };
        let motion = CapRule::default().deflection(&axes);
        assert_eq!((motion.shift, motion.turn), (Vector::z(), Vector::zeros()));
    }

    #[test]
    fn buttons_are_told_when_they_change() {
        let mut reports = Reports::new();
        assert_eq!(
            events(&mut reports, &[3, 0b10, 1]),
            [Event::Press(1), Event::Press(8)]
        );
        assert_eq!(events(&mut reports, &[3, 0b10, 1]), []);
        assert_eq!(
            events(&mut reports, &[3, 0b11, 0]),
            [Event::Press(0), Event::Release(8)]
        );
        assert_eq!(
            events(&mut reports, &[3, 0]),
            [Event::Release(0), Event::Release(1)]
        );
    }

    proptest! {
        #[test]
        fn any_reports_are_read(
            reports in proptest::collection::vec(proptest::collection::vec(any::<u8>(), 0..40), 0..20),
        ) {
            let mut reader = Reports::new();
            let mut held = 0i64;
            for report in &reports {
                let found = events(&mut reader, report);
                prop_assert!(found.len() <= BUTTONS);
                for event in found {
                    held += match event {
                        Event::Press(_) => 1,
                        Event::Release(_) => -1,
                        Event::Motion { .. } => 0,
                    };
                }
                prop_assert_eq!(held, i64::from(reader.buttons.count_ones()));
            }
        }
    }
}
