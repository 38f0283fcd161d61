//! Smallest step of the position, in slow motion.

use sulcus_core::Vec3;

use super::holder::Holder;
use super::report::{Measured, Outcome, Value};
use super::task::{Next, Task};
use super::tip::Tip;

/// Distance to which the holder moves its place on both sides, metres: 0.75 N against friction.
const SWING: f64 = 0.015;
/// Speed of the place, m/s.
const SPEED: f64 = 0.01;
/// Time for one axis: to one side, to the other and back, seconds.
const AXIS_S: f64 = 4.0 * SWING / SPEED;
/// Change of a position that is the rounding of its transfer, metres.
const ROUNDING: f64 = 5e-8;
/// Least number of equal steps.
const ALIKE: usize = 3;
/// Largest number of steps that are kept.
const MOST: usize = 60_000;

/// Stage of the resolution.
pub(super) struct Resolution {
    holder: Holder,
    centre: Vec3,
    seconds: f64,
    before: Option<Vec3>,
    steps: Vec<f64>,
}

impl Resolution {
    /// Creates the stage.
    pub fn new(holder: Holder) -> Self {
        Self {
            centre: holder.place,
            holder,
            seconds: 0.0,
            before: None,
            steps: Vec::with_capacity(MOST),
        }
    }
}

/// Smallest step that occurs several times.
pub(super) fn smallest(mut steps: Vec<f64>) -> Option<Value> {
    let count = steps.len();
    steps.sort_by(f64::total_cmp);
    let alike = |x: f64| 1.1 * x + 2.0 * ROUNDING;
    let first = steps
        .windows(ALIKE)
        .position(|some| some[ALIKE - 1] <= alike(some[0]))?;
    let least = steps[first];
    let group: Vec<f64> = steps[first..]
        .iter()
        .copied()
        .take_while(|&x| x <= alike(least))
        .collect();
    let value = Value::of(&group)?;
    Some(Value {
        value: value.value * 1e3,
        spread: value.spread * 1e3,
        count,
    })
}

impl Task for Resolution {
    fn step(&mut self, tip: &Tip) -> Next {
        if self.holder.is_lost(tip) {
            return Next::Fail(Holder::LOST.into());
        }
        if let Some(before) = self.before.replace(tip.position) {
            let ways = (tip.position - before).map(f64::abs);
            let room = MOST.saturating_sub(self.steps.len());
            self.steps
                .extend(ways.iter().filter(|&&way| way > ROUNDING).take(room));
        }
        self.seconds += tip.seconds;
        let axis = (self.seconds / AXIS_S) as usize;
        if axis > 2 {
            return Next::Done;
        }
        let x = self.seconds % AXIS_S * SPEED;
        let way = if x < SWING {
            x
        } else if x < 3.0 * SWING {
            2.0 * SWING - x
        } else {
            x - 4.0 * SWING
        };
        self.holder.place = self.centre;
        self.holder.place[axis] += way;
        Next::Force(self.holder.force(tip))
    }

    fn share(&self) -> f64 {
        self.seconds / (3.0 * AXIS_S)
    }

    fn finish(self: Box<Self>, report: &mut Measured) {
        report.resolution_mm = match smallest(self.steps) {
            Some(step) => Outcome::Measured(step),
            None => Outcome::NotMeasured("the handle did not move under 0.75 N".into()),
        };
    }
}
