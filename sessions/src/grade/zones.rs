//! Zones as the tip was in them: time, depth at a correct force and at any, force, and tilt at the deepest place.

use std::collections::BTreeMap;

use sulcus_core::math::fmax;
use sulcus_core::tissue::gingiva::Site;

use super::tolerances::{PROBED_S, TIE, TREMOR_N};
use crate::exercise::ProbingTask;
use crate::exercise::events::Standing;

/// Distance below the prescribed floor from which the tip is no longer in the pocket, metres. Chosen: taught forces
/// press 0.1 mm too deep, and 0.6 N press 0.8 mm too deep.
pub const BEYOND: f64 = 1e-3;
/// Longest interruption of a force that stands on the floor, seconds.
pub const LAPSE: f64 = 0.05;
/// Height of the deepest place above the largest depth, metres. The tilt is judged there.
pub const AT_FLOOR: f64 = 3e-4;
/// Width of a bin of depth, metres.
const BIN: f64 = 5e-5;

/// Measures of one zone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ZoneSeen {
    /// Time below the margin, seconds.
    pub seconds: f64,
    /// Tick in which that time reached [`PROBED_S`].
    pub stayed_at: Option<u64>,
    /// Largest depth of the tip, metres.
    pub deepest: f64,
    /// Reached depth, metres: the largest with a force on the floor inside the target band.
    pub measured: Option<f64>,
    /// Largest force on the floor, newtons.
    pub max_force: f64,
    /// Longest time with a force of the target band or more, seconds. Interruptions up to [`LAPSE`] are part of it.
    pub held: f64,
    /// Longest time with a force more than [`TREMOR_N`] above the band, seconds, by the same rule.
    pub pressed: f64,
}

/// Tick with its length. A tick after skipped ticks is longer than one period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Number of the tick.
    pub tick: u64,
    /// End of the tick, seconds.
    pub to: f64,
    /// Length of the tick, seconds.
    pub dt: f64,
}

/// Tilt of the working end and reading of its bands, as integrals over some time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stood {
    seconds: f64,
    /// Time with the right tilt, seconds.
    right: f64,
    /// Integral of the tilt, radian seconds.
    tilt: f64,
    /// Integral of the tilt's part into the col, radian seconds.
    into: f64,
    /// Integral of the depth that the bands showed, metre seconds.
    shown: f64,
}

impl Stood {
    fn add(&mut self, more: &Self) {
        self.seconds += more.seconds;
        self.right += more.right;
        self.tilt += more.tilt;
        self.into += more.into;
        self.shown += more.shown;
    }

    /// Mean tilt against the tooth's axis, radians.
    pub fn tilt(&self) -> f64 {
        self.tilt / self.seconds
    }

    /// Mean of the tilt's part into the col, radians.
    pub fn towards_col(&self) -> f64 {
        self.into / self.seconds
    }

    /// Mean depth that the bands showed below the margin, metres.
    pub fn shown(&self) -> f64 {
        self.shown / self.seconds
    }

    /// Whether the tilt was right for at least half of the time.
    pub fn is_right(&self) -> bool {
        2.0 * self.right >= self.seconds - TIE
    }
}

/// Interval in which a force has stood on the floor, seconds. None before the first such force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Stands(Option<[f64; 2]>);

impl Stands {
    /// Extends the interval by a tick that ends at `to` and lasts `dt`. Returns the length of the interval, seconds.
    fn goes_on(&mut self, to: f64, dt: f64) -> f64 {
        let still = |[_, until]: &[f64; 2]| to - dt - until <= LAPSE + TIE;
        let from = self.0.filter(still).map_or(to - dt, |[from, _]| from);
        self.0 = Some([from, to]);
        to - from
    }
}

/// Zone with the time in it by depth.
#[derive(Clone, Debug, Default, PartialEq)]
struct Zone {
    seen: ZoneSeen,
    /// Intervals of a force of the band or more, and of a force above the band.
    stands: [Stands; 2],
    /// Tilt by bin of depth: at a correct force, and at any force.
    stood: [BTreeMap<u32, Stood>; 2],
}

/// Zones by tooth and site.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Zones(BTreeMap<(u8, Site), Zone>);

impl Zones {
    /// Takes in a tick. `band` is the target band of force, newtons; `task` has the bands of tilt; `floor` is the
    /// prescribed depth of the zone, metres.
    pub fn observe(
        &mut self,
        at: &Standing,
        Span { tick, to, dt }: Span,
        band: [f64; 2],
        task: &ProbingTask,
        floor: Option<f64>,
    ) {
        if at.depth <= 0.0 {
            return;
        }
        let zone = self.0.entry((at.tooth, at.site)).or_default();
        let seen = &mut zone.seen;
        seen.seconds += dt;
        if seen.stayed_at.is_none() && seen.seconds >= PROBED_S - TIE {
            seen.stayed_at = Some(tick);
        }
        seen.max_force = fmax(seen.max_force, at.force);
        seen.deepest = fmax(seen.deepest, at.depth);
        // A tip that was forced through the wall is beside the pocket, and reads no depth.
        let inside = floor.is_none_or(|floor| at.depth <= floor + BEYOND);
        let correct = inside && (band[0]..=band[1]).contains(&at.force);
        if correct {
            seen.measured = Some(seen.measured.map_or(at.depth, |deep| fmax(deep, at.depth)));
        }
        let [bears, presses] = &mut zone.stands;
        if at.force >= band[0] {
            seen.held = fmax(seen.held, bears.goes_on(to, dt));
        }
        if at.force > band[1] + TREMOR_N {
            seen.pressed = fmax(seen.pressed, presses.goes_on(to, dt));
        }
        let right = at.tilt.is_right(at.site, task);
        let now = Stood {
            seconds: dt,
            right: if right { dt } else { 0.0 },
            tilt: at.tilt.total * dt,
            into: at.tilt.into_col(at.site).0 * dt,
            shown: at.shown * dt,
        };
        let bin = (at.depth / BIN) as u32;
        for (k, stood) in zone.stood.iter_mut().enumerate() {
            if k == 1 || correct {
                stood.entry(bin).or_default().add(&now);
            }
        }
    }

    /// Measures of a zone. None if the tip was never in it.
    pub fn of(&self, tooth: u8, site: Site) -> Option<&ZoneSeen> {
        self.0.get(&(tooth, site)).map(|zone| &zone.seen)
    }

    /// Tilt and reading at the deepest place ([`AT_FLOOR`]): at a correct force if there was one, else at any force.
    pub fn stood(&self, tooth: u8, site: Site) -> Option<Stood> {
        let zone = self.0.get(&(tooth, site))?;
        let [correct, any] = &zone.stood;
        let (bins, deepest) = match zone.seen.measured {
            Some(measured) => (correct, measured),
            None => (any, zone.seen.deepest),
        };
        let from = (fmax(deepest - AT_FLOOR, 0.0) / BIN) as u32;
        let mut all = Stood::default();
        for stood in bins.range(from..).map(|(_, stood)| stood) {
            all.add(stood);
        }
        Some(all)
    }

    /// Zones that the tip was in, by tooth, then in the order of [`Site::ALL`].
    pub fn all(&self) -> impl Iterator<Item = (u8, Site)> + '_ {
        self.0.keys().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grade::test_help::standing;

    #[test]
    fn the_deepest_at_a_correct_force_counts() {
        let (mut zones, mut tick) = (Zones::default(), 0);
        let mut see = |mm: f64, force: f64, shown: f64| {
            let mut at = standing(36, Site::Buccal, 90.0, mm, force);
            at.shown = shown * 1e-3;
            tick += 1;
            let task = ProbingTask::default();
            let dt = 0.15;
            let now = Span {
                tick,
                to: tick as f64 * dt,
                dt,
            };
            zones.observe(&at, now, [0.1, 0.25], &task, Some(2e-3));
        };
        see(-1.0, 0.0, 0.0); // above the margin
        see(1.0, 0.0, 1.0); // no force yet
        see(2.0, 0.2, 2.2);
        see(2.5, 0.6, 2.6); // deeper, too heavy
        see(1.9, 0.2, 3.3); // correct, shallower, tilted
        see(3.1, 0.2, 3.2); // out through the wall, beside the pocket
        let seen = zones.of(36, Site::Buccal).expect("it was there");
        assert!((seen.seconds - 0.75).abs() < 1e-12);
        assert_eq!((seen.stayed_at, seen.max_force), (Some(3), 0.6));
        assert!((seen.deepest - 3.1e-3).abs() < 1e-12);
        // Mean reading of the bands at 2.0 and 1.9 mm.
        let stood = zones.stood(36, Site::Buccal).expect("it stood");
        assert!((stood.shown() - 2.75e-3).abs() < 1e-12);
        assert!((seen.measured.expect("correct") - 2e-3).abs() < 1e-12);
        assert_eq!(zones.of(36, Site::Lingual), None);
        assert_eq!(zones.all().collect::<Vec<_>>(), [(36, Site::Buccal)]);
    }

    #[test]
    fn a_force_stands_that_lapses_for_no_longer_than_a_tremor() {
        let (mut zones, mut tick) = (Zones::default(), 0);
        let mut hold = |force: f64, ticks: u32| {
            for _ in 0..ticks {
                tick += 1;
                let at = standing(36, Site::Buccal, 90.0, 2.0, force);
                let task = ProbingTask::default();
                let now = Span {
                    tick,
                    to: tick as f64 * 1e-3,
                    dt: 1e-3,
                };
                zones.observe(&at, now, [0.1, 0.25], &task, Some(2e-3));
            }
            zones.of(36, Site::Buccal).map_or(0.0, |seen| seen.held)
        };
        // Milliseconds. An interruption counts after its end. A force above the band stands, too.
        for (force, ms, held) in [
            (0.09, 100, 0.0),
            (0.1, 100, 0.1),
            (0.05, 50, 0.1),
            (0.6, 200, 0.35),
            (0.05, 51, 0.35),
            (0.2, 300, 0.35),
            (0.2, 100, 0.4),
        ] {
            let found = hold(force, ms);
            assert!((found - held).abs() < 1e-9, "{found}, not {held}");
        }
        // 0.6 N was above the band for 200 ms.
        let pressed = zones.of(36, Site::Buccal).map_or(0.0, |seen| seen.pressed);
        assert!((pressed - 0.2).abs() < 1e-9, "{pressed}");
        // Half a second of skipped ticks belongs to the tick after them, here after an interruption.
        let at = standing(36, Site::Buccal, 90.0, 2.0, 0.2);
        let now = Span {
            tick: 1451,
            to: 1.451,
            dt: 0.5,
        };
        let task = ProbingTask::default();
        zones.observe(&at, now, [0.1, 0.25], &task, Some(2e-3));
        let held = zones.of(36, Site::Buccal).map_or(0.0, |seen| seen.held);
        assert!((held - 0.95).abs() < 1e-9, "{held}");
    }

    #[test]
    fn one_tick_at_the_deepest_does_not_decide_how_the_probe_stood() {
        let mut zones = Zones::default();
        let see = |zones: &mut Zones, mm: f64, force: f64, degrees: f64, ticks: u32| {
            let mut at = standing(36, Site::Buccal, 90.0, mm, force);
            at.tilt.total = f64::to_radians(degrees);
            for _ in 0..ticks {
                let task = ProbingTask::default();
                let now = Span {
                    tick: 1,
                    to: 1e-3,
                    dt: 1e-3,
                };
                zones.observe(&at, now, [0.1, 0.25], &task, Some(4e-3));
            }
        };
        see(&mut zones, 2.0, 0.2, 60.0, 500); // above the deepest place
        see(&mut zones, 4.0, 0.05, 60.0, 500); // too light
        see(&mut zones, 3.95, 0.2, 5.0, 300);
        see(&mut zones, 4.01, 0.2, 40.0, 100);
        let stood = zones.stood(36, Site::Buccal).expect("it was there");
        // 300 ticks at 5 degrees and 100 at 40 degrees: 13.75 degrees in the mean, right for three quarters of the
        // time.
        assert!((stood.tilt().to_degrees() - 13.75).abs() < 1e-9);
        assert!(stood.is_right());
        see(&mut zones, 3.9, 0.2, 40.0, 250);
        assert!(!zones.stood(36, Site::Buccal).expect("there").is_right());
        assert_eq!(zones.stood(36, Site::Lingual), None);
    }
}
