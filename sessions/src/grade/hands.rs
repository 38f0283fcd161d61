//! What the hands do together: the target seen past the tongue while the probe works, the mirror holding meanwhile, and how hard
//! a tool is pressed.

use std::collections::VecDeque;

use sulcus_core::Vec3;
use sulcus_core::math::{fmax, norm};

/// A mirror is steady against where it was so long before, seconds.
const BEFORE: f64 = 0.5;

/// Whether a tool stays where it is.
#[derive(Clone, Debug, Default)]
pub struct Steady {
    past: VecDeque<Vec3>,
}

impl Steady {
    /// Takes in where the tool is after a tick of `dt` seconds (none: no hand holds it); whether it has stayed within
    /// `within` metres of where it was half a second before. A tool that has not been there for so long is not steady.
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
    /// Time in a pocket, and of it with the target visible and the mirror holding, seconds.
    working: f64,
    together: f64,
    /// Time since the probe was first in a pocket (or, without zones, that a hand held a tool), seen of it; up to the last
    /// moment in a pocket, and since then.
    span: [f64; 2],
    since: [f64; 2],
}

/// What one tick shows of the hands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Whether a probe is in a pocket; none where the exercise has no zones.
    pub in_pocket: Option<bool>,
    /// Whether any hand holds a tool.
    pub held: bool,
    /// Whether the target is visible.
    pub visible: bool,
    /// Whether the mirror holds: it is steady, and bears on the tongue.
    pub holds: bool,
}

impl Hands {
    /// Takes in a tick of `dt` seconds.
    pub fn observe(&mut self, now: &Moment, dt: f64) {
        let seen = if now.visible { dt } else { 0.0 };
        match now.in_pocket {
            None if now.held => {
                self.span[0] += dt;
                self.span[1] += seen;
            }
            None => {}
            Some(true) => {
                self.working += dt;
                if now.visible && now.holds {
                    self.together += dt;
                }
                // What lay between two pockets counts too.
                self.span[0] += self.since[0] + dt;
                self.span[1] += self.since[1] + seen;
                self.since = [0.0; 2];
            }
            Some(false) if self.span[0] > 0.0 => {
                self.since[0] += dt;
                self.since[1] += seen;
            }
            Some(false) => {}
        }
    }

    /// Share of the span in which the target was visible, percent.
    pub fn visible_percent(&self) -> Option<f64> {
        (self.span[0] > 0.0).then(|| 100.0 * self.span[1] / self.span[0])
    }

    /// Share of the time in a pocket with the target visible and the mirror holding, percent.
    pub fn together_percent(&self) -> Option<f64> {
        (self.working > 0.0).then(|| 100.0 * self.together / self.working)
    }

    /// Length of the span, seconds.
    pub fn span_s(&self) -> Option<f64> {
        (self.span[0] > 0.0).then_some(self.span[0])
    }
}

/// How hard a tool is pressed: a histogram of force while it touches, and for how long it does, seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct Pressed {
    bins: Vec<u64>,
    seconds: f64,
    /// Forces of the last ticks, [`PEAK_S`] together, newtons.
    last: VecDeque<f64>,
    peak: f64,
}

/// Time over which the largest push is a mean, seconds: a knock of a tick or two is none.
pub const PEAK_S: f64 = 0.05;

/// Width of a bin, newtons, and how many there are: up to 20 N.
const BIN: f64 = 0.01;
const BINS: usize = 2000;

impl Default for Pressed {
    fn default() -> Self {
        Self {
            bins: vec![0; BINS],
            seconds: 0.0,
            last: VecDeque::new(),
            peak: 0.0,
        }
    }
}

impl Pressed {
    /// Takes in the force of a tick, newtons. It stands for `dt` seconds, with the ticks that were missed before it; a push lasts as
    /// long as a tick, `tick_s`.
    pub fn observe(&mut self, force: f64, dt: f64, tick_s: f64) {
        if force >= super::touches::BEGINS && force.is_finite() {
            let bin = ((force / BIN) as usize).min(BINS - 1);
            self.bins[bin] += 1;
            self.seconds += dt;
        }
        let force = if force.is_finite() { force } else { 0.0 };
        let ticks = fmax((PEAK_S / tick_s).round(), 1.0);
        self.last.push_back(force);
        if self.last.len() > ticks as usize {
            self.last.pop_front();
        }
        // What is shorter is that much less.
        self.peak = fmax(self.peak, self.last.iter().sum::<f64>() / ticks);
    }

    /// Largest mean force over [`PEAK_S`], newtons; none where it never touched anything.
    pub fn peak(&self) -> Option<f64> {
        (self.seconds > 0.0).then_some(self.peak)
    }

    /// How long it touched something, seconds.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// The force that 95 % of the ticks in touch stay under, newtons, to a hundredth; none without touch.
    pub fn p95(&self) -> Option<f64> {
        let all: u64 = self.bins.iter().sum();
        let mut sum = 0;
        let bin = self.bins.iter().position(|count| {
            sum += count;
            all > 0 && sum * 100 >= all * 95
        })?;
        Some((bin + 1) as f64 * BIN)
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

    #[test]
    fn a_stab_shows_in_the_peak_where_the_percentile_hides_it() {
        let mut pressed = Pressed::default();
        assert_eq!(pressed.peak(), None);
        (0..9600).for_each(|_| pressed.observe(1.0, 1e-3, 1e-3));
        assert!((pressed.peak().expect("a touch") - 1.0).abs() < 1e-9);
        // 25 ms of 7 N after 25 ms of 1 N: 4 N in the mean.
        (0..25).for_each(|_| pressed.observe(7.0, 1e-3, 1e-3));
        assert!((pressed.peak().expect("a touch") - 4.0).abs() < 1e-9);
        (0..375).for_each(|_| pressed.observe(20.0, 1e-3, 1e-3));
        pressed.observe(f64::NAN, 1e-3, 1e-3);
        assert!((pressed.peak().expect("a touch") - 20.0).abs() < 1e-9);
        assert!((pressed.p95().expect("a touch") - 1.01).abs() < 1e-9);
    }

    #[test]
    fn the_95th_percentile_of_a_hundred_ticks_is_the_95th() {
        let mut pressed = Pressed::default();
        assert_eq!(pressed.p95(), None);
        for k in 1..=100 {
            // 0.105, 0.205 ... 10.005: the 95th is in the bin up to 9.51.
            pressed.observe(0.1 * f64::from(k) + 0.005, 1e-3, 1e-3);
        }
        pressed.observe(0.01, 1e-3, 1e-3);
        pressed.observe(f64::NAN, 1e-3, 1e-3);
        let p95 = pressed.p95().expect("touches");
        assert!((p95 - 9.51).abs() < 1e-9, "{p95}");
    }
}
