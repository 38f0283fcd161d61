//! Touches of a tool, by its force and the way of its tip.

use crate::camera::Vector;
use crate::panel::CONTACT_N;

/// Share of the least force of a contact below which a tool touches nothing again.
const LET_GO: f64 = 0.5;
/// Shortest time between two sounds of a tool, seconds. Chosen: a tool that chatters is one sound.
const PAUSE_S: f64 = 0.12;
/// Longest time between two pictures whose places still give a speed, seconds.
const LONGEST_S: f64 = 0.5;

/// Ear for one tool.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ear {
    is_touching: bool,
    /// Time, seconds, and place of the tip, mm, of the picture before.
    before: Option<(f64, Vector)>,
    /// Speeds of the last two pictures, mm/s. The newer one may have been braked by the touch.
    speeds: [f64; 2],
    /// Time of the last sound, seconds.
    sounded: Option<f64>,
}

impl Ear {
    /// Takes a picture: its time, seconds, the force, newtons, and the place of the tip, mm. Returns the speed of a
    /// touch that begins, mm/s.
    pub fn hear(&mut self, now_s: f64, force_n: f64, tip: &Vector) -> Option<f64> {
        // A window may draw the same state twice.
        if self.before.is_some_and(|(then_s, _)| then_s == now_s) {
            return None;
        }
        let speed = self.before.and_then(|(then_s, place)| {
            let elapsed = now_s - then_s;
            let counts = elapsed > 0.0 && elapsed < LONGEST_S;
            counts.then(|| (tip - place).norm() / elapsed)
        });
        self.before = Some((now_s, *tip));
        self.speeds = [self.speeds[1], speed.unwrap_or(0.0)];
        if self.is_touching {
            self.is_touching = force_n >= LET_GO * CONTACT_N;
            return None;
        }
        self.is_touching = force_n >= CONTACT_N;
        let rested = self.sounded.is_none_or(|at| now_s - at >= PAUSE_S);
        let speed = self.speeds[0].max(self.speeds[1]);
        let begins = self.is_touching && rested && speed > 0.0;
        begins.then(|| {
            self.sounded = Some(now_s);
            speed
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sounds of forces at 60 pictures a second, with a tip at 20 mm/s.
    fn heard(forces: &[f64]) -> Vec<(usize, f64)> {
        let mut ear = Ear::default();
        let pictures = forces.iter().enumerate();
        let sounds = pictures.filter_map(|(k, force)| {
            let time = k as f64 / 60.0;
            let tip = Vector::new(20.0 * time, 0.0, 0.0);
            Some((k, ear.hear(time, *force, &tip)?))
        });
        sounds.collect()
    }

    #[test]
    fn a_touch_sounds_once_with_its_speed() {
        let found = heard(&[0.0, 0.0, 0.0, 0.2, 0.3, 0.2, 0.1]);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].0, 3);
        assert!((found[0].1 - 20.0).abs() < 1e-9);
        assert_eq!(heard(&[0.0, 0.009, 0.0]), []);
    }

    #[test]
    fn a_force_about_its_limit_and_a_chatter_are_one_sound() {
        let about: Vec<f64> = (0..60).map(|k| 0.009 + 0.002 * f64::from(k % 2)).collect();
        assert_eq!(heard(&about).len(), 1);
        let chatter: Vec<f64> = (0..60).map(|k| f64::from(k % 2)).collect();
        let found = heard(&chatter);
        assert!((2..=9).contains(&found.len()), "{}", found.len());
    }

    #[test]
    fn a_tool_that_appears_in_contact_or_rests_is_silent() {
        assert_eq!(heard(&[0.3, 0.3]), []);
        let mut ear = Ear::default();
        let rest = Vector::new(1.0, 2.0, 3.0);
        for (time, force) in [(0.0, 0.0), (0.02, 0.0), (0.04, 0.3)] {
            assert_eq!(ear.hear(time, force, &rest), None);
        }
    }
}
