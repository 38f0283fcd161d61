//! Touches of the floor: largest force of each, and distances between them along the tooth.
//!
//! A walking hand need not unload the tip fully. A touch ends if the force falls far below its peak. The next touch
//! begins if the force rises as far above the least force since. A tip that is dragged without lifting makes one
//! touch, and its way along the tooth is a step.

use std::collections::BTreeMap;

use sulcus_core::math::{fmax, fmin};

use super::tolerances::TOUCH_N;
use crate::exercise::events::Standing;

/// Share of its peak below which a touch ends; its inverse is the rise over the least force that begins the next touch.
/// Chosen, as the release of the floor in the session's events.
pub const LET_GO: f64 = 0.5;
/// Time below that share after which a touch ends, seconds. Chosen: half a period of the fastest tremor.
pub const LET_GO_S: f64 = 0.05;
/// Distance along the tooth below which two places of touch are one place, metres.
pub const ONE: f64 = 0.4e-3;
/// Way along the tooth from which a touch is dragged, metres. Chosen: the longest step that is taught.
pub const DRAGGED: f64 = 2e-3;

/// Touch of the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Whether the touch is on the buccal side.
    pub buccal: bool,
    /// Angle about the tooth at the largest force, radians.
    pub around: f64,
    /// Distance from the tooth's axis at the largest force, metres.
    pub from_axis: f64,
    /// Largest force, newtons.
    pub peak: f64,
    /// Way along the tooth between the two ends of the touch, metres.
    pub way: f64,
}

/// Touch that has not ended.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Now {
    touch: Touch,
    /// Present place along the tooth from the beginning of the touch, metres.
    along: f64,
    /// Ends of the way, metres.
    ends: [f64; 2],
    /// Angle about the tooth in the last tick, radians.
    around: f64,
    /// Time of the force below the share of its peak, seconds.
    light: f64,
    /// Least force in that time, newtons.
    least: f64,
}

/// Touches of one probe.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Touches {
    now: Option<Now>,
    /// Least force since the last touch of the tooth, newtons. None before the first touch in a pocket: no force.
    least: Option<f64>,
    all: Vec<Touch>,
}

impl Touches {
    /// Takes in a tick of `dt` seconds. None: the tip is in no pocket.
    pub fn observe(&mut self, at: Option<&Standing>, dt: f64) {
        let Some(at) = at else {
            self.end();
            self.least = None;
            return;
        };
        if self.now.is_some_and(|now| now.touch.tooth != at.tooth) {
            self.end();
            self.least = None;
        }
        let Some(now) = &mut self.now else {
            let least = self.least.map_or(0.0, |least| fmin(least, at.force));
            self.least = Some(least);
            if at.force >= TOUCH_N && LET_GO * at.force >= least {
                self.now = Some(Now::at(at));
            }
            return;
        };
        now.goes_on(at);
        (now.light, now.least) = if at.force < LET_GO * now.touch.peak {
            (now.light + dt, fmin(now.least, at.force))
        } else {
            (0.0, at.force)
        };
        if now.light >= LET_GO_S {
            self.least = Some(now.least);
            self.end();
        }
    }

    fn end(&mut self) {
        self.all.extend(self.now.take().map(|now| now.touch));
    }

    /// All touches, with the one that has not ended.
    pub fn all(&self) -> Vec<Touch> {
        let now = self.now.map(|now| now.touch);
        self.all.iter().copied().chain(now).collect()
    }
}

impl Now {
    fn at(at: &Standing) -> Self {
        Self {
            touch: Touch {
                tooth: at.tooth,
                buccal: at.site.is_buccal(),
                around: at.around,
                from_axis: at.from_axis,
                peak: at.force,
                way: 0.0,
            },
            along: 0.0,
            ends: [0.0; 2],
            around: at.around,
            light: 0.0,
            least: at.force,
        }
    }

    fn goes_on(&mut self, at: &Standing) {
        // Angles jump at half a turn; the way does not.
        let turn = libm::remainder(at.around - self.around, std::f64::consts::TAU);
        self.around = at.around;
        self.along += turn * at.from_axis;
        // Motion of a lifted tip is no drag.
        if at.force >= TOUCH_N {
            let [from, to] = self.ends;
            self.ends = [fmin(from, self.along), fmax(to, self.along)];
            self.touch.way = self.ends[1] - self.ends[0];
        }
        if at.force > self.touch.peak {
            self.touch = Touch {
                way: self.touch.way,
                ..Self::at(at).touch
            };
        }
    }
}

/// Steps, metres, sorted: distances along the tooth between neighbouring places of touch on a side of a tooth, and
/// the ways of dragged touches.
pub fn steps(touches: &[Touch]) -> Vec<f64> {
    let mut sides: BTreeMap<(u8, bool), Vec<(f64, f64)>> = BTreeMap::new();
    for touch in touches {
        let side = sides.entry((touch.tooth, touch.buccal)).or_default();
        side.push((touch.around, touch.from_axis));
    }
    let dragged = touches.iter().map(|touch| touch.way);
    let mut steps: Vec<f64> = dragged.filter(|way| *way >= DRAGGED).collect();
    for side in sides.values_mut() {
        side.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut last: Option<(f64, f64)> = None;
        for place in side.iter() {
            match last {
                None => last = Some(*place),
                Some(before) => {
                    let step = (place.0 - before.0) * 0.5 * (place.1 + before.1);
                    if step >= ONE {
                        steps.push(step);
                        last = Some(*place);
                    }
                }
            }
        }
    }
    steps.sort_by(f64::total_cmp);
    steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grade::test_help::standing;
    use sulcus_core::tissue::gingiva::Site;

    #[test]
    fn a_touch_has_its_largest_force_and_a_short_slack_does_not_end_it() {
        let mut touches = Touches::default();
        let mut hold = |force: f64, ticks: u32| {
            for _ in 0..ticks {
                let at = standing(36, Site::Buccal, 90.0, 2.0, force);
                touches.observe(Some(&at), 1e-3);
            }
        };
        hold(0.015, 100); // not yet
        hold(0.15, 100);
        hold(0.0, 40); // slack
        hold(0.22, 10);
        hold(0.005, 60); // the end
        hold(0.06, 10);
        touches.observe(None, 1e-3); // out of the pocket
        touches.observe(None, 1e-3);
        let peaks: Vec<f64> = touches.all().iter().map(|touch| touch.peak).collect();
        assert_eq!(peaks, [0.22, 0.06]);
    }

    /// Touches of a hand on the buccal side with these forces, newtons, and angles, degrees, each for 100 ms.
    fn made(path: &[(f64, f64)]) -> Vec<Touch> {
        let mut touches = Touches::default();
        for (force, degrees) in path {
            for _ in 0..100 {
                let at = standing(36, Site::Buccal, *degrees, 2.0, *force);
                touches.observe(Some(&at), 1e-3);
            }
        }
        touches.all()
    }

    #[test]
    fn a_hand_that_bobs_without_unloading_makes_a_touch_of_each_bob() {
        let bobs: Vec<(f64, f64)> = (0..9)
            .map(|k| {
                (
                    if k % 2 == 0 { 0.6 } else { 0.05 },
                    60.0 + f64::from(k) * 5.0,
                )
            })
            .collect();
        let touches = made(&bobs);
        assert_eq!(touches.len(), 5);
        assert!(touches.iter().all(|touch| touch.peak == 0.6));
        // Four steps of ten degrees at 4 mm.
        let found = steps(&touches);
        assert_eq!(found.len(), 4);
        let ten = 4e-3 * 10f64.to_radians();
        assert!(
            found.iter().all(|step| (step - ten).abs() < 1e-9),
            "{found:?}"
        );
        // A force that falls to a third and stays there is one touch. A force that falls to two thirds and rises
        // again is one touch, too.
        let peaks = |path: &[(f64, f64)]| {
            let touches = made(path);
            touches.iter().map(|touch| touch.peak).collect::<Vec<_>>()
        };
        assert_eq!(
            peaks(&[(0.3, 90.0), (0.1, 90.0), (0.15, 90.0), (0.1, 90.0)]),
            [0.3]
        );
        assert_eq!(peaks(&[(0.3, 90.0), (0.2, 90.0), (0.3, 90.0)]), [0.3]);
        // Twice the least force begins another touch.
        assert_eq!(peaks(&[(0.3, 90.0), (0.1, 90.0), (0.2, 90.0)]), [0.3, 0.2]);
    }

    #[test]
    fn a_drag_is_a_step_of_its_whole_way() {
        // Half a turn at 4 mm across the jump of the angle, in steps of 5 degrees.
        let drag: Vec<(f64, f64)> = (0..=36)
            .map(|k| 90.0 + f64::from(k) * 5.0)
            .map(|degrees| {
                (
                    0.2,
                    if degrees > 180.0 {
                        degrees - 360.0
                    } else {
                        degrees
                    },
                )
            })
            .collect();
        let touches = made(&drag);
        assert_eq!(touches.len(), 1);
        let found = steps(&touches);
        assert_eq!(found.len(), 1);
        assert!(
            (found[0] - 4e-3 * std::f64::consts::PI).abs() < 1e-9,
            "{found:?}"
        );
        // A slip of 20 degrees is 1.4 mm, and no drag.
        assert!(steps(&made(&[(0.2, 60.0), (0.2, 80.0)])).is_empty());
    }

    #[test]
    fn steps_are_arcs_between_neighbours_whatever_the_order() {
        let at = |degrees: f64, buccal: bool| Touch {
            tooth: 36,
            buccal,
            around: degrees.to_radians(),
            from_axis: 4e-3,
            peak: 0.2,
            way: 0.0,
        };
        // 20 and 40 degrees at 4 mm are 1.396 and 2.793 mm. Places 2 degrees apart, 0.14 mm, are one place.
        let touches = [
            at(120.0, true),
            at(60.0, true),
            at(80.0, true),
            at(82.0, true),
            at(-90.0, false),
        ];
        let found: Vec<f64> = steps(&touches).iter().map(|step| step * 1e3).collect();
        assert_eq!(found.len(), 2);
        assert!((found[0] - 1.396_263).abs() < 1e-6 && (found[1] - 2.792_527).abs() < 1e-6);
    }
}
