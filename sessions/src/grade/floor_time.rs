//! Time on the floor of pockets, by zone of force.

use serde::Serialize;
use sulcus_core::output::ForceZone;

use super::tolerances::TOUCH_N;
use crate::exercise::events::Standing;

/// Time with a force on a floor, by the size of the force, seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FloorTime {
    /// Below the target band, 0.02 N or more.
    pub light_s: f64,
    /// Inside the target band.
    pub in_band_s: f64,
    /// Above the target band, below the scene's zone of trauma.
    pub heavy_s: f64,
    /// In the scene's zone of trauma.
    pub trauma_s: f64,
    /// In the scene's zone of damage.
    pub damage_s: f64,
}

impl FloorTime {
    /// Takes in a tick of `dt` seconds. `band` is the target band, newtons.
    pub fn observe(&mut self, at: &Standing, dt: f64, band: [f64; 2]) {
        if at.force < TOUCH_N {
            return;
        }
        *match at.zone {
            ForceZone::Damage => &mut self.damage_s,
            ForceZone::Trauma => &mut self.trauma_s,
            _ if at.force < band[0] => &mut self.light_s,
            _ if at.force <= band[1] => &mut self.in_band_s,
            _ => &mut self.heavy_s,
        } += dt;
    }

    /// Sum of all five times, seconds.
    pub fn whole(&self) -> f64 {
        self.light_s + self.in_band_s + self.heavy_s + self.trauma_s + self.damage_s
    }

    /// Share of the time inside the target band, percent. None if the floor was never touched.
    pub fn in_band_percent(&self) -> Option<f64> {
        let whole = self.whole();
        (whole > 0.0).then(|| 100.0 * self.in_band_s / whole)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grade::test_help::standing;
    use sulcus_core::tissue::gingiva::Site;

    #[test]
    fn time_goes_to_the_zone_of_its_force() {
        let mut time = FloorTime::default();
        let mut hold = |force: f64, zone: ForceZone, seconds: f64| {
            let mut at = standing(36, Site::Buccal, 90.0, 2.0, force);
            at.zone = zone;
            time.observe(&at, seconds, [0.1, 0.25]);
        };
        hold(0.019, ForceZone::Light, 9.0);
        hold(0.05, ForceZone::Light, 1.0);
        hold(0.2, ForceZone::Light, 4.0);
        hold(0.3, ForceZone::TooHeavy, 2.0);
        hold(0.6, ForceZone::Trauma, 0.75);
        hold(2.5, ForceZone::Damage, 0.25);
        let FloorTime {
            light_s,
            in_band_s,
            heavy_s,
            trauma_s,
            damage_s,
        } = time;
        assert_eq!(
            [light_s, in_band_s, heavy_s, trauma_s, damage_s],
            [1.0, 4.0, 2.0, 0.75, 0.25]
        );
        assert_eq!(time.in_band_percent(), Some(50.0));
        assert_eq!(FloorTime::default().in_band_percent(), None);
    }
}
