//! Touches of the floor: how heavy each was, and how far along the tooth they lie apart.

use std::collections::BTreeMap;

use crate::events::Standing;

/// Force at which a touch begins, newtons; and under which it ends, when it lasts so many seconds.
pub const BEGINS: f64 = 0.02;
const ENDS: f64 = 0.01;
const FOR: f64 = 0.05;
/// Places of touch nearer to each other along the tooth are one, metres.
const ONE: f64 = 0.4e-3;

/// One touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Whether on the cheek's side.
    pub buccal: bool,
    /// Angle about the tooth where the force was largest, radians, and distance from its axis there, metres.
    pub around: f64,
    /// See `around`.
    pub from_axis: f64,
    /// Largest force, newtons.
    pub peak: f64,
}

/// Follows one probe.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Touches {
    now: Option<Touch>,
    /// How long the force has been as good as none, seconds.
    light: f64,
    all: Vec<Touch>,
}

impl Touches {
    /// Takes in a tick of `dt` seconds; none where the tip is in no pocket.
    pub fn observe(&mut self, at: Option<&Standing>, dt: f64) {
        let Some(at) = at else {
            self.end();
            return;
        };
        if self.now.is_some_and(|touch| touch.tooth != at.tooth) {
            self.end();
        }
        let here = Touch {
            tooth: at.tooth,
            buccal: at.site.is_buccal(),
            around: at.around,
            from_axis: at.from_axis,
            peak: at.force,
        };
        match &mut self.now {
            None if at.force >= BEGINS => (self.now, self.light) = (Some(here), 0.0),
            None => {}
            Some(touch) => {
                if at.force > touch.peak {
                    *touch = here;
                }
                self.light = if at.force < ENDS {
                    self.light + dt
                } else {
                    0.0
                };
                if self.light >= FOR {
                    self.end();
                }
            }
        }
    }

    fn end(&mut self) {
        self.all.extend(self.now.take());
    }

    /// All touches, the one under way included.
    pub fn all(&self) -> Vec<Touch> {
        self.all.iter().copied().chain(self.now).collect()
    }
}

/// Distances along the tooth between neighbouring places of touch, for each side of each tooth, metres, sorted.
pub fn steps(touches: &[Touch]) -> Vec<f64> {
    let mut sides: BTreeMap<(u8, bool), Vec<(f64, f64)>> = BTreeMap::new();
    for touch in touches {
        let side = sides.entry((touch.tooth, touch.buccal)).or_default();
        side.push((touch.around, touch.from_axis));
    }
    let mut steps = Vec::new();
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

    #[test]
    fn steps_are_arcs_between_neighbours_whatever_the_order() {
        let at = |degrees: f64, buccal: bool| Touch {
            tooth: 36,
            buccal,
            around: degrees.to_radians(),
            from_axis: 4e-3,
            peak: 0.2,
        };
        // 20 and 40 degrees at 4 mm are 1.396 and 2.793 mm; 2 degrees (0.14 mm) are the same place.
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
