//! What the tip did in each zone: how long, how deep at a correct force and at any, how heavy, and how it stood there.

use std::collections::BTreeMap;

use sulcus_core::tissue::gingiva::Site;

use crate::events::Standing;
use crate::events::angle::Tilt;

/// A tip farther below the prescribed floor is not in the pocket any more, metres. Chosen: forces that are taught press 0.1 mm too
/// deep, 0.6 N 0.8 mm.
const BEYOND: f64 = 1e-3;
/// Time in a zone from which it was probed, not passed, seconds.
pub const STAYED: f64 = 0.2;
/// What rounding may take off it.
const TIE: f64 = 1e-9;

/// What was seen of one zone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ZoneSeen {
    /// Time below the margin, seconds.
    pub seconds: f64,
    /// Tick in which that came to [`STAYED`].
    pub stayed_at: Option<u64>,
    /// Deepest that the tip was, metres.
    pub deepest: f64,
    /// Deepest with a force on the floor inside the target band, metres.
    pub measured: Option<f64>,
    /// Largest force on the floor, newtons.
    pub max_force: f64,
    /// How the working end stood at the deepest place: at a correct force where there was one, else at any.
    pub tilt: Option<Tilt>,
}

/// Zones by tooth and site.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Zones(BTreeMap<(u8, Site), ZoneSeen>);

impl Zones {
    /// Takes in a tick by its number, of `dt` seconds; `band` is the target band of force, newtons, `floor` the depth prescribed there, metres.
    pub fn observe(
        &mut self,
        at: &Standing,
        (tick, dt): (u64, f64),
        band: [f64; 2],
        floor: Option<f64>,
    ) {
        if at.depth <= 0.0 {
            return;
        }
        let zone = self.0.entry((at.tooth, at.site)).or_default();
        zone.seconds += dt;
        if zone.stayed_at.is_none() && zone.seconds >= STAYED - TIE {
            zone.stayed_at = Some(tick);
        }
        if at.force > zone.max_force {
            zone.max_force = at.force;
        }
        // A tip that was forced out through the wall is beside the pocket, whatever it presses on.
        let inside = floor.is_none_or(|floor| at.depth <= floor + BEYOND);
        let correct = inside && (band[0]..=band[1]).contains(&at.force);
        if correct && zone.measured.is_none_or(|before| at.depth > before) {
            zone.measured = Some(at.depth);
            zone.tilt = Some(at.tilt);
        }
        if at.depth > zone.deepest {
            zone.deepest = at.depth;
            if zone.measured.is_none() {
                zone.tilt = Some(at.tilt);
            }
        }
    }

    /// What was seen of a zone; none where the tip never was.
    pub fn of(&self, tooth: u8, site: Site) -> Option<&ZoneSeen> {
        self.0.get(&(tooth, site))
    }

    /// The zones that the tip was in, by tooth, then in the order of [`Site::ALL`].
    pub fn all(&self) -> impl Iterator<Item = (u8, Site)> + '_ {
        self.0.keys().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grade::test_help::standing;

    #[test]
    fn the_deepest_at_a_correct_force_counts_and_its_tilt() {
        let (mut zones, mut tick) = (Zones::default(), 0);
        let mut see = |mm: f64, force: f64, degrees: f64| {
            let mut at = standing(36, Site::Buccal, 90.0, mm, force);
            at.tilt.total = degrees.to_radians();
            tick += 1;
            zones.observe(&at, (tick, 0.15), [0.1, 0.25], Some(2e-3));
        };
        see(-1.0, 0.0, 1.0); // above the margin
        see(1.0, 0.0, 2.0); // no force yet
        see(2.0, 0.2, 3.0);
        see(2.5, 0.6, 4.0); // deeper, too heavy
        see(1.9, 0.2, 5.0); // correct, shallower
        see(3.1, 0.2, 6.0); // out through the wall, beside the pocket
        let seen = zones.of(36, Site::Buccal).expect("it was there");
        assert!((seen.seconds - 0.75).abs() < 1e-12);
        assert_eq!((seen.stayed_at, seen.max_force), (Some(3), 0.6));
        assert!((seen.deepest - 3.1e-3).abs() < 1e-12);
        assert!((seen.measured.expect("correct") - 2e-3).abs() < 1e-12);
        assert!((seen.tilt.expect("a tilt").total.to_degrees() - 3.0).abs() < 1e-9);
        assert_eq!(zones.of(36, Site::Lingual), None);
        assert_eq!(zones.all().collect::<Vec<_>>(), [(36, Site::Buccal)]);
    }
}
