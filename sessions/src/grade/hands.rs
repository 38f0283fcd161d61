//! Both hands together: sight of the target past the tongue, and the mirror that holds the tongue while the probe
//! works.

use std::collections::VecDeque;

use sulcus_core::Vec3;
use sulcus_core::math::norm;

/// Time over which the motion of a steady mirror is measured, seconds.
const BEFORE: f64 = 0.5;

/// Steadiness of a tool.
#[derive(Clone, Debug, Default)]
pub struct Steady {
    past: VecDeque<Vec3>,
}

impl Steady {
    /// Takes in the place of the tool after a tick of `dt` seconds; None without a hand that holds the tool.
    /// Returns whether the tool is within `within` metres of its place half a second before.
    /// A tool that a hand has held for a shorter time is not steady.
    pub fn observe(&mut self, at: Option<Vec3>, dt: f64, within: f64) -> bool {
        let Some(at) = at else {
            self.past.clear();
            return false;
        };
        let ticks = (BEFORE / dt).round() as usize;
        let before = (self.past.len() >= ticks)
            .then(|| self.past.pop_front())
            .flatten();
        self.past.push_back(at);
        before.is_some_and(|before| norm(&(at - before)) <= within)
    }
}

/// Sight and coordination.
#[derive(Clone, Debug, Default)]
pub struct Hands {
    /// Time of the probe in a pocket, seconds.
    working: f64,
    /// Part of that time with the target visible and the mirror holding, seconds.
    together: f64,
    /// Working time, and its part with the target visible, seconds. Working time ends with the last moment in a pocket.
    /// Without zones: time in which a hand holds a tool.
    span: [f64; 2],
    /// The same two times since the last moment in a pocket, seconds.
    since: [f64; 2],
    /// Time in gaps of the connection while the clock ran: before the last moment in a pocket, and since then, seconds.
    waited: [f64; 2],
}

/// State of both hands in a tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Whether a probe is in a pocket. None for an exercise without zones.
    pub in_pocket: Option<bool>,
    /// Whether any hand holds a tool.
    pub held: bool,
    /// Whether the target is visible.
    pub visible: bool,
    /// Whether the mirror is steady and bears on the tongue.
    pub holds: bool,
}

impl Hands {
    /// Takes in a tick of `dt` seconds.
    pub fn observe(&mut self, now: &Moment, dt: f64) {
        let seen = if now.visible { dt } else { 0.0 };
        match now.in_pocket {
            None if now.held => {
                self.waited[0] += std::mem::take(&mut self.waited[1]);
                self.span[0] += dt;
                self.span[1] += seen;
            }
            None => {}
            Some(true) => {
                self.working += dt;
                if now.visible && now.holds {
                    self.together += dt;
                }
                // Time between two pockets counts, too.
                self.span[0] += self.since[0] + dt;
                self.span[1] += self.since[1] + seen;
                self.since = [0.0; 2];
                self.waited[0] += std::mem::take(&mut self.waited[1]);
            }
            Some(false) if self.span[0] > 0.0 => {
                self.since[0] += dt;
                self.since[1] += seen;
            }
            Some(false) => {}
        }
    }

    /// Takes in `dt` seconds of a gap of the connection while the clock of the session runs. Only the working time has
    /// them.
    pub fn waits(&mut self, dt: f64) {
        if self.span[0] > 0.0 {
            self.waited[1] += dt;
        }
    }

    /// Share of the working time with the target visible, percent. Gaps of the connection are left out.
    pub fn visible_percent(&self) -> Option<f64> {
        (self.span[0] > 0.0).then(|| 100.0 * self.span[1] / self.span[0])
    }

    /// Share of the time in a pocket with the target visible and the mirror holding, percent.
    pub fn together_percent(&self) -> Option<f64> {
        (self.working > 0.0).then(|| 100.0 * self.together / self.working)
    }

    /// Working time, seconds.
    pub fn span_s(&self) -> Option<f64> {
        (self.span[0] > 0.0).then_some(self.span[0] + self.waited[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(in_pocket: Option<bool>, visible: bool, holds: bool) -> Moment {
        Moment {
            in_pocket,
            held: true,
            visible,
            holds,
        }
    }

    #[test]
    fn sight_counts_from_the_first_pocket_to_the_last() {
        let mut hands = Hands::default();
        let mut all = |in_pocket: bool, visible: bool, holds: bool, seconds: f64| {
            hands.observe(&moment(Some(in_pocket), visible, holds), seconds);
        };
        all(false, true, true, 7.0); // before: nothing
        all(true, true, true, 3.0);
        all(true, true, false, 1.0);
        all(false, false, true, 2.0); // between two pockets
        all(true, false, true, 2.0);
        all(false, true, true, 9.0); // after: nothing
        assert_eq!(hands.span_s(), Some(8.0));
        assert_eq!(hands.visible_percent(), Some(50.0));
        assert_eq!(hands.together_percent(), Some(50.0));
    }

    #[test]
    fn a_running_clock_counts_a_gap_as_time_and_not_as_lost_sight() {
        let mut hands = Hands::default();
        hands.waits(9.0);
        hands.observe(&moment(Some(true), true, true), 3.0);
        hands.waits(5.0);
        assert_eq!(hands.span_s(), Some(3.0));
        hands.observe(&moment(Some(true), true, true), 1.0);
        hands.waits(7.0);
        assert_eq!(hands.span_s(), Some(9.0));
        assert_eq!(hands.visible_percent(), Some(100.0));
    }

    #[test]
    fn without_zones_all_the_time_of_a_hand_counts() {
        let mut hands = Hands::default();
        hands.observe(&moment(None, true, false), 1.0);
        hands.observe(&moment(None, false, false), 3.0);
        let away = Moment {
            held: false,
            ..moment(None, true, false)
        };
        hands.observe(&away, 5.0);
        assert_eq!(
            (hands.visible_percent(), hands.span_s()),
            (Some(25.0), Some(4.0))
        );
        assert_eq!(hands.together_percent(), None);
    }

    #[test]
    fn steady_is_against_half_a_second_before() {
        let mut steady = Steady::default();
        // 4 mm/s is 2 mm in half a second; 2 mm/s is 1 mm.
        let mut at = 0.0;
        let mut run = |speed: f64, ticks: u32| {
            let mut last = false;
            for _ in 0..ticks {
                at += speed * 1e-3;
                last = steady.observe(Some(Vec3::new(at, 0.0, 0.0)), 1e-3, 1.5e-3);
            }
            last
        };
        assert!(!run(0.0, 499));
        assert!(run(0.0, 2));
        assert!(!run(4e-3, 500));
        assert!(run(2e-3, 500));
        assert!(!steady.observe(None, 1e-3, 1.5e-3));
        assert!(!steady.observe(Some(Vec3::zeros()), 1e-3, 1.5e-3));
    }
}
