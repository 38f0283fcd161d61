//! Part of a crown's circumference that the probe touched.

use sulcus_core::{Scene, Vec3};

use super::tolerances::{TIE, TOUCH_N};

/// Number of sectors about the crown's middle.
const SECTORS: usize = 12;
/// Distance from the middle, seen from above, below which the tip is on top of the crown and in no sector, metres.
pub const OFF_AXIS: f64 = 3e-3;
/// Time in contact from which a sector counts, seconds.
pub const LEAST_S: f64 = 0.02;
/// Height of a crown from its highest cusp down, metres.
pub const CROWN: f64 = 7e-3;
/// Distance outside the crown's box up to which a touch is one of the tip, metres. Farther out, the shaft touches.
pub const BESIDE: f64 = 2e-3;

/// Time in contact by sector of a crown.
#[derive(Clone, Debug, PartialEq)]
pub struct Crown {
    middle: Vec3,
    /// Half of the box around the crown, with the room for a tip beside it, metres.
    half: Vec3,
    seconds: [f64; SECTORS],
}

impl Crown {
    /// Crown of the scene's first tooth. None for a scene without a tooth.
    pub fn of(scene: &Scene) -> Option<Self> {
        let tooth = scene
            .objects
            .iter()
            .find(|object| object.fdi != 0 && object.tissue.is_rigid())?;
        let (_, [low, high]) = tooth.top(CROWN);
        let half = (high - low) * 0.5 + Vec3::repeat(BESIDE);
        Some(Self::about((low + high) * 0.5, half))
    }

    pub(super) fn about(middle: Vec3, half: Vec3) -> Self {
        Self {
            middle,
            half,
            seconds: [0.0; SECTORS],
        }
    }

    /// Takes in a tick of `dt` seconds: place of the tip, world axes, metres, and force on the probe, newtons.
    pub fn observe(&mut self, tip: &Vec3, force: f64, dt: f64) {
        let off = tip - self.middle;
        let away = (off.x * off.x + off.y * off.y).sqrt();
        let beside = off
            .iter()
            .zip(self.half.iter())
            .all(|(x, half)| x.abs() <= *half);
        // A NaN touches nothing.
        if force >= TOUCH_N && away >= OFF_AXIS && beside {
            let turn = libm::atan2(off.y, off.x) / std::f64::consts::TAU + 0.5;
            self.seconds[((turn * SECTORS as f64) as usize).min(SECTORS - 1)] += dt;
        }
    }

    /// Share of the sectors that count, percent.
    pub fn covered_percent(&self) -> f64 {
        let touched = self.seconds.iter().filter(|s| **s >= LEAST_S - TIE);
        100.0 * touched.count() as f64 / SECTORS as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_way_round_is_half_and_resting_on_one_place_is_a_twelfth() {
        let middle = Vec3::new(0.02, -0.03, 0.01);
        let mut crown = Crown::about(middle, Vec3::repeat(6e-3));
        let at = |degrees: f64, mm: f64| {
            let (sin, cos) = (
                libm::sin(degrees.to_radians()),
                libm::cos(degrees.to_radians()),
            );
            middle + Vec3::new(cos, sin, 0.1) * (mm * 1e-3)
        };
        for _ in 0..5000 {
            crown.observe(&at(45.0, 5.0), 0.1, 1e-3);
        }
        assert!((crown.covered_percent() - 100.0 / 12.0).abs() < 1e-9);
        // Tips in the air, too near to the middle, and with a force that is not finite.
        for _ in 0..100 {
            crown.observe(&at(100.0, 5.0), 0.01, 1e-3);
            crown.observe(&at(130.0, 2.9), 0.3, 1e-3);
            crown.observe(&at(160.0, 5.0), f64::NAN, 1e-3);
            // Tips beside the tooth and below it: the shaft touches.
            crown.observe(&at(190.0, 9.0), 0.3, 1e-3);
            crown.observe(&(at(220.0, 5.0) - Vec3::z() * 8e-3), 0.3, 1e-3);
        }
        // 19 ms are a passage.
        (0..19).for_each(|_| crown.observe(&at(-100.0, 5.0), 0.3, 1e-3));
        assert!((crown.covered_percent() - 100.0 / 12.0).abs() < 1e-9);
        for degrees in [5.0, 75.0, 105.0, 135.0, 165.0] {
            (0..20).for_each(|_| crown.observe(&at(degrees, 5.0), 0.3, 1e-3));
        }
        assert!((crown.covered_percent() - 50.0).abs() < 1e-9);
    }
}
