//! Foot on a pedal: presses of a switch become keys of the readings.
//!
//! All times are arguments, milliseconds of any clock that never goes back. A window takes events between two pictures,
//! so that a slow picture delays several of them to one time. Three rules follow.
//!
//! - Press and release at one time are a short press; the electronics of a keyboard have removed the bounces.
//! - A release came at some time after the last [`Foot::wait`] that saw the pedal down. The middle of this stretch is
//!   taken: the error is at most half a picture.
//! - A group ends only in [`Foot::wait`], after all events that had come. A press after a slow picture never ends its
//!   own group.

use std::str::FromStr;

use super::key::Key;
use super::pedal::{Pedal, PedalRule};
use super::switch::Switch;

/// Use of a pedal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PedalUse {
    /// The pedal alone charts: [`PedalRule::alone`].
    #[default]
    Alone,
    /// The pedal stands beside a keyboard: [`PedalRule::beside_keyboard`].
    Beside,
}

impl FromStr for PedalUse {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "alone" => Ok(Self::Alone),
            "beside" => Ok(Self::Beside),
            _ => Err(format!(
                "`{text}` is no use of a pedal, expected one of: alone, beside"
            )),
        }
    }
}

/// Pedal with its switch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Foot {
    switch: Switch,
    pedal: Pedal,
    /// Time of the press that lasts, and the last time at which it was known to last.
    down: Option<[u64; 2]>,
}

impl Foot {
    /// Pedal that is up.
    pub fn new(switch: Switch, used: PedalUse) -> Self {
        let mut rule = match used {
            PedalUse::Alone => PedalRule::alone(),
            PedalUse::Beside => PedalRule::beside_keyboard(),
        };
        rule.bounce_ms = 0;
        Self {
            switch,
            pedal: Pedal::new(rule),
            down: None,
        }
    }

    /// Switch of the pedal.
    pub fn switch(&self) -> &Switch {
        &self.switch
    }

    /// Takes in a press, or a release, of a switch at `at_ms`. Returns whether the switch is the pedal's.
    pub fn change(&mut self, switch: &Switch, is_down: bool, at_ms: u64) -> bool {
        let is_ours = *switch == self.switch;
        match is_down {
            true if is_ours => {
                self.down.get_or_insert([at_ms; 2]);
                self.pedal.press(at_ms);
            }
            false if is_ours => {
                if let Some([since, seen]) = self.down.take() {
                    let released = u64::midpoint(seen, at_ms.max(seen));
                    self.pedal.up_after(at_ms, released - since);
                }
            }
            _ => {}
        }
        is_ours
    }

    /// Keys of a group that has ended by `at_ms`.
    pub fn wait(&mut self, at_ms: u64) -> Vec<Key> {
        if let Some([since, seen]) = &mut self.down {
            *seen = at_ms.max(*since);
        }
        self.pedal.wait(at_ms)
    }

    /// Forgets presses whose release would not come, as for a window that lost the focus.
    pub fn let_go(&mut self) {
        self.down = None;
        self.pedal.let_go();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::readings::{Heard, Readings, Site, Stop};

    #[test]
    fn a_pedal_that_types_charts_and_other_keys_are_not_its_own() {
        let pedal: Switch = "F13".parse().expect("a key");
        let other: Switch = "b".parse().expect("a key");
        let mut foot = Foot::new(pedal.clone(), PedalUse::Alone);
        let stop = Stop {
            tooth: 36,
            site: Site::Buccal,
        };
        let mut readings = Readings::new(vec![stop]);
        let mut now = 0;
        for held in [100, 100, 100, 800] {
            assert!(!foot.change(&other, true, now));
            assert!(foot.change(&pedal, true, now));
            // The system repeats a held key.
            foot.change(&pedal, true, now + 50);
            for picture in (0..held).step_by(16) {
                assert_eq!(foot.wait(now + picture), []);
            }
            assert!(foot.change(&pedal, false, now + held));
            now += held + 100;
        }
        let keys = foot.wait(now + 1000);
        assert_eq!(keys, [Key::Count(3), Key::Next]);
        let heard: Vec<Heard> = keys.into_iter().map(|key| readings.press(key)).collect();
        assert_eq!(heard[0], Heard::Taken);
        let Heard::Confirmed(entry) = heard[1] else {
            panic!("{heard:?}");
        };
        assert_eq!((entry.stop, entry.depth_mm), (stop, 3));
    }

    #[test]
    fn slow_pictures_change_no_count() {
        let pedal: Switch = "pad-start".parse().expect("a button");
        let mut foot = Foot::new(pedal.clone(), PedalUse::Alone);
        // Times at which the window takes events: two presses at once, then one over a picture of half a second.
        for (is_down, at) in [
            (true, 100),
            (false, 100),
            (true, 100),
            (false, 100),
            (true, 650),
            (false, 650),
        ] {
            foot.change(&pedal, is_down, at);
        }
        assert_eq!(foot.wait(900), []);
        foot.change(&pedal, true, 950);
        assert_eq!(foot.wait(1600), []);
        foot.change(&pedal, false, 1900);
        assert_eq!(foot.wait(2300), [Key::Count(3), Key::Next]);
    }

    #[test]
    fn a_short_press_whose_release_waits_behind_a_picture_is_no_long_one() {
        let pedal: Switch = "b".parse().expect("a key");
        let mut foot = Foot::new(pedal.clone(), PedalUse::Alone);
        foot.change(&pedal, true, 100);
        assert_eq!(foot.wait(101), []);
        // A picture of 880 ms; the pedal was up after 120 ms.
        foot.change(&pedal, false, 981);
        assert_eq!(foot.wait(2000), [Key::Count(1)]);
        // Held through a picture and a half: long.
        foot.change(&pedal, true, 3000);
        assert_eq!(foot.wait(3001), []);
        assert_eq!(foot.wait(3881), []);
        foot.change(&pedal, false, 4761);
        assert_eq!(foot.wait(5161), [Key::Next]);
    }

    #[test]
    fn a_lost_focus_forgets_the_group() {
        let pedal: Switch = "mouse-middle".parse().expect("a button");
        let mut foot = Foot::new(pedal.clone(), PedalUse::Beside);
        foot.change(&pedal, true, 0);
        foot.let_go();
        foot.change(&pedal, false, 900);
        assert_eq!(foot.wait(5000), []);
        foot.change(&pedal, true, 6000);
        foot.change(&pedal, false, 6100);
        assert_eq!(foot.wait(7000), [Key::Next]);
    }

    #[test]
    fn uses_have_names() {
        assert_eq!("alone".parse(), Ok(PedalUse::Alone));
        assert_eq!("beside".parse(), Ok(PedalUse::Beside));
        assert!("under".parse::<PedalUse>().is_err());
    }
}
