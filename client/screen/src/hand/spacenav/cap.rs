//! Meaning of a 3D mouse: axes of the picture, dead zone and curve of its cap, and its buttons.
//!
//! The daemon's x points to the right, y upwards, and z away from the person (libspnav, `spnav_posrot_moveobj`). The
//! picture's z points towards the eye, so that z and rz change their sign.

use super::record::Event;
use crate::hand::board::Board;
use crate::hand::hands::Hands;
use crate::hand::keys::Control;
use crate::hand::motion::Motion;

/// Rule of a cap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapRule {
    /// Reading of a full deflection. Devices reach 350 to 400.
    pub full: f64,
    /// Share of the full deflection below which the cap counts as released.
    pub dead: f64,
    /// Exponent of the speed over the deflection.
    pub power: f64,
}

impl Default for CapRule {
    /// Full scale 350, dead zone 5 %, quadratic: fine motions near the middle.
    fn default() -> Self {
        Self {
            full: 350.0,
            dead: 0.05,
            power: 2.0,
        }
    }
}

impl CapRule {
    /// Rule of the sticks of a gamepad: dead zone 12 %, which worn sticks need, and quadratic.
    pub fn sticks() -> Self {
        Self {
            full: 1.0,
            dead: 0.12,
            power: 2.0,
        }
    }

    /// Share of the greatest speed for a reading, -1 to 1.
    pub fn share(&self, reading: i32) -> f64 {
        self.curve(f64::from(reading) / self.full)
    }

    /// Share of the greatest speed for a share of the full deflection, -1 to 1.
    pub fn curve(&self, share: f64) -> f64 {
        let beyond = (share.abs() - self.dead) / (1.0 - self.dead);
        beyond.clamp(0.0, 1.0).powf(self.power).copysign(share)
    }

    /// Deflection in the axes of the picture, each number -1 to 1.
    pub fn deflection(&self, axes: &[i32; 6]) -> Motion {
        let [x, y, z, rx, ry, rz] = axes.map(|reading| self.share(reading));
        Motion::shift(x, y, -z).and(&Motion::turn(rx, ry, -rz))
    }

    /// Passes an event on. Buttons beyond the second do nothing.
    pub fn act(&self, event: &Event, board: &mut Board, hands: &mut Hands) {
        let control = |number: i32| match number {
            0 => Some(Control::CapFirst),
            1 => Some(Control::CapSecond),
            _ => None,
        };
        match event {
            Event::Motion { axes, .. } => board.cap(&self.deflection(axes), hands),
            Event::Press(number) => {
                if let Some(control) = control(*number) {
                    board.press(control, hands);
                }
            }
            Event::Release(number) => {
                if let Some(control) = control(*number) {
                    board.release(control, hands);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Vector;

    #[test]
    fn the_dead_zone_is_still_and_the_curve_rises_to_the_full_speed() {
        let rule = CapRule::default();
        for reading in [0, 17, -17] {
            assert_eq!(rule.share(reading), 0.0, "{reading}");
        }
        assert!(
            rule.share(18) > 0.0 && rule.share(18) < 1e-4,
            "no step at the edge"
        );
        assert_eq!(
            [350, 400, i32::MAX].map(|reading| rule.share(reading)),
            [1.0; 3]
        );
        assert_eq!(
            [-350, i32::MIN].map(|reading| rule.share(reading)),
            [-1.0; 2]
        );
        // Half way between dead zone and full scale: a quarter of the speed.
        let half = (0.525f64 * 350.0).round() as i32;
        assert!(
            (rule.share(half) - 0.25).abs() < 2e-3,
            "{}",
            rule.share(half)
        );
    }

    #[test]
    fn axes_away_from_the_person_change_their_sign() {
        let rule = CapRule::default();
        let motion = rule.deflection(&[350, -350, 350, 0, 350, 350]);
        assert_eq!(motion.shift, Vector::new(1.0, -1.0, -1.0));
        assert_eq!(motion.turn, Vector::new(0.0, 1.0, -1.0));
    }
}
