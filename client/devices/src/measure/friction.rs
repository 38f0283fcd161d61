//! Friction of the free handle, by slow ramps of the force in both directions.

use sulcus_core::Vec3;
use sulcus_core::math::{fmax, norm};

use super::holder::Holder;
use super::plan::Plan;
use super::report::{FrictionFigures, Measured, Outcome, Value};
use super::task::{Next, Steplength, Task};
use super::tip::Tip;

/// Change of the force, newtons per second.
const RAMP: f64 = 0.05;
/// Distance between the places, metres.
const APART: f64 = 0.01;
/// Number of samples at rest before a ramp.
pub(super) const REST: u32 = 300;
/// Largest number of samples until the handle is at rest.
pub(super) const RESTLESS: u32 = 15_000;

/// Stage of the friction.
pub(super) struct Friction {
    holder: Holder,
    centre: Vec3,
    lengths: Steplength,
    most_n: f64,
    ramps: usize,
    /// Number of the ramp: the direction changes first, then the axis, then the place.
    ramp: usize,
    phase: Phase,
    /// Force at the onset of the motion in the ramp before.
    upwards: f64,
    /// Friction and bias of each axis, one pair for each place.
    found: [Vec<(f64, f64)>; 3],
}

enum Phase {
    /// The handle moves to the place and comes to rest.
    Settling(u32),
    /// The force changes. Held force and position at its begin, change so far, force at the last sample at rest.
    Ramping(Vec3, Vec3, f64, f64),
}

impl Friction {
    /// Creates the stage.
    pub fn new(holder: Holder, lengths: Steplength, plan: &Plan) -> Self {
        Self {
            centre: holder.place,
            holder,
            lengths,
            most_n: plan.most_n(),
            ramps: plan.places.max(1) * 6,
            ramp: 0,
            phase: Phase::Settling(0),
            upwards: 0.0,
            found: [const { Vec::new() }; 3],
        }
    }

    fn axis(&self) -> usize {
        self.ramp / 2 % 3
    }

    fn sign(&self) -> f64 {
        if self.ramp.is_multiple_of(2) {
            1.0
        } else {
            -1.0
        }
    }

    /// Place of the present ramp: the middle, then 10 mm to both sides along the axis.
    fn place(&self) -> Vec3 {
        let aside = [0.0, APART, -APART][self.ramp / 6 % 3];
        let mut place = self.centre;
        place[self.axis()] += aside;
        place
    }

    fn settle(&mut self, tip: &Tip, samples: u32) -> Next {
        self.holder.place = self.place();
        let force = self.holder.force(tip);
        if self.holder.is_lost(tip) {
            return Next::Fail(Holder::LOST.into());
        }
        if samples > RESTLESS {
            return Next::Fail("the free handle does not come to rest".into());
        }
        self.phase = if self.holder.is_there() && samples > REST && tip.is_still(REST) {
            Phase::Ramping(tip.displayed, tip.position, 0.0, tip.displayed[self.axis()])
        } else {
            Phase::Settling(samples + 1)
        };
        Next::Force(force)
    }

    /// Takes the force at which the handle began to move, and begins the next ramp.
    fn moved(&mut self, force: f64) {
        let axis = self.axis();
        if self.sign() > 0.0 {
            self.upwards = force;
        } else {
            let bias = 0.5 * (self.upwards + force);
            self.found[axis].push((0.5 * (self.upwards - force), bias));
            self.holder.bias[axis] = bias;
        }
        self.ramp += 1;
        self.phase = Phase::Settling(0);
    }

    fn figures(&self) -> Option<FrictionFigures> {
        let of = |axis: usize, part: fn(&(f64, f64)) -> f64| {
            let all: Vec<f64> = self.found[axis].iter().map(part).collect();
            Value::of(&all)
        };
        let all: Vec<f64> = self.found.iter().flatten().map(|found| found.0).collect();
        Some(FrictionFigures {
            friction_n: Value::of(&all)?,
            axes_n: [of(0, |f| f.0)?, of(1, |f| f.0)?, of(2, |f| f.0)?],
            bias_n: [of(0, |f| f.1)?, of(1, |f| f.1)?, of(2, |f| f.1)?],
        })
    }
}

/// Force beyond the friction at which a ramp is seen to move a handle by `way` metres, newtons. `mass` is in kilograms,
/// `drag` in N s/m.
///
/// The handle comes to rest at the side of a step of the position from which it came. The next ramp goes back, over the
/// whole step.
fn beyond(mass: f64, drag: f64, way: f64) -> f64 {
    const DT: f64 = 1e-4;
    let (mut x, mut v, mut seconds) = (0.0, 0.0, 0.0);
    while x < way && seconds < 2.0 {
        seconds += DT;
        v = (v + DT * RAMP * seconds / mass) / (1.0 + DT * drag / mass);
        x += DT * v;
    }
    RAMP * seconds
}

/// Takes the force that moved the handle by one step of the position from the friction of `report`, once mass and drag
/// are known.
pub(super) fn corrected(report: &mut Measured, lengths: &Steplength) {
    let (Outcome::Measured(friction), Outcome::Measured(steps)) =
        (&mut report.friction, &report.steps)
    else {
        return;
    };
    let drag = steps.drag_n_s_per_m.value;
    let less = |mass_g: f64| beyond(mass_g * 1e-3, drag, lengths.step);
    let all = &mut friction.friction_n.value;
    *all = fmax(0.0, *all - less(steps.mass_g.value));
    for (axis, mass) in friction.axes_n.iter_mut().zip(&steps.axes_g) {
        axis.value = fmax(0.0, axis.value - less(mass.value));
    }
}

impl Task for Friction {
    fn step(&mut self, tip: &Tip) -> Next {
        if self.ramp == self.ramps {
            return Next::Done;
        }
        let (axis, sign) = (self.axis(), self.sign());
        let (held, place, change, last) = match self.phase {
            Phase::Settling(samples) => return self.settle(tip, samples),
            Phase::Ramping(held, place, change, last) => (held, place, change, last),
        };
        let way = (tip.position[axis] - place[axis]).abs();
        let last = if way <= self.lengths.rests() {
            tip.displayed[axis]
        } else {
            last
        };
        if way > self.lengths.moved() {
            self.moved(last);
            return Next::Force(self.holder.force(tip));
        }
        let change = change + RAMP * tip.seconds;
        let mut force = held;
        force[axis] += sign * change;
        if norm(&force) > self.most_n {
            return Next::Fail(format!(
                "the free handle did not move under {:.2} N",
                self.most_n
            ));
        }
        self.phase = Phase::Ramping(held, place, change, last);
        Next::Force(force)
    }

    fn share(&self) -> f64 {
        self.ramp as f64 / self.ramps as f64
    }

    fn finish(self: Box<Self>, report: &mut Measured) {
        report.friction = match self.figures() {
            Some(figures) => Outcome::Measured(figures),
            None => Outcome::NotMeasured("no ramps".into()),
        };
    }
}
