//! Latency, apparent mass and drag, from steps of the force.

use sulcus_core::Vec3;
use sulcus_core::math::{fmin, norm};

use super::fit::{fitted, onset, with};
use super::friction::{REST, RESTLESS, corrected};
use super::holder::Holder;
use super::plan::Plan;
use super::report::{FrictionFigures, Measured, Outcome, StepFigures, Value, quantile};
use super::task::{Next, Steplength, Task};
use super::tip::Tip;

/// Force of a step beyond the friction, newtons.
const STEP_N: f64 = 0.3;
/// Least force beyond the friction that gives a result, newtons.
const LEAST_N: f64 = 0.05;
/// Number of samples at the bias before the step.
const BASE: u32 = 100;
/// Number of samples of a step.
const TRACE: usize = 120;
/// Distance at which a step ends, metres.
const FAR: f64 = 5e-3;
/// Change of the displayed force that counts as the step, newtons.
const SEEN_N: f64 = 0.05;

/// Stage of the steps.
pub(super) struct Steps {
    holder: Holder,
    lengths: Steplength,
    friction: Vec3,
    excess: f64,
    slew_n_per_s: f64,
    period_s: f64,
    steps: usize,
    phase: Phase,
    traces: Vec<Trace>,
}

enum Phase {
    /// The handle comes to rest. Number of samples so far.
    Settling(u32),
    /// The force along the axis is the bias. Force and number of samples so far.
    Base(Vec3, u32),
    /// The step. Its force.
    Stepping(Vec3, Trace),
}

/// Recording of one step.
#[derive(Clone)]
struct Trace {
    axis: usize,
    sign: f64,
    /// Position along the axis before the step, metres.
    from: f64,
    /// Time of the last sample without the step, nanoseconds.
    before_ns: u64,
    /// Number of samples without the step since its order.
    waited: usize,
    /// Time and motion of each sample after it.
    points: Vec<(u64, f64)>,
    /// Force of the step, newtons.
    force: f64,
}

impl Steps {
    /// Creates the stage.
    ///
    /// # Errors
    /// The friction leaves no force for a step.
    pub fn new(
        holder: Holder,
        lengths: Steplength,
        plan: &Plan,
        friction: &FrictionFigures,
    ) -> Result<Self, String> {
        let of = |values: &[Value; 3]| Vec3::from(values.map(|value| value.value));
        let (friction, bias) = (of(&friction.axes_n), of(&friction.bias_n));
        let room = plan.most_n() - norm(&bias) - friction.max();
        if room < LEAST_N {
            return Err(format!(
                "friction and weight leave {room:.2} N, expected {LEAST_N} N or more"
            ));
        }
        let mut holder = holder;
        holder.bias = bias;
        Ok(Self {
            holder,
            lengths,
            friction,
            excess: fmin(STEP_N, room),
            slew_n_per_s: plan.slew_n_per_s(),
            period_s: plan.period_ns as f64 * 1e-9,
            steps: plan.steps.max(10),
            phase: Phase::Settling(0),
            traces: Vec::new(),
        })
    }

    fn axis(&self) -> usize {
        self.traces.len() % 3
    }

    fn settle(&mut self, tip: &Tip, samples: u32) -> Next {
        let force = self.holder.force(tip);
        if self.holder.is_lost(tip) {
            return Next::Fail(Holder::LOST.into());
        }
        if samples > RESTLESS {
            return Next::Fail("the free handle does not come to rest".into());
        }
        self.phase = if self.holder.is_there() && samples > REST && tip.is_still(REST) {
            let mut base = tip.displayed;
            base[self.axis()] = self.holder.bias[self.axis()];
            Phase::Base(base, 0)
        } else {
            Phase::Settling(samples + 1)
        };
        Next::Force(force)
    }

    fn base(&mut self, tip: &Tip, force: Vec3, samples: u32) -> Next {
        if samples < BASE {
            self.phase = Phase::Base(force, samples + 1);
            return Next::Force(force);
        }
        let axis = self.axis();
        // The handle comes to rest at that side of a step of the position from which it came, and the next reading
        // changes late in one direction and early in the other. Two steps in each direction balance both.
        let sign = if self.traces.len() / 3 % 4 < 2 {
            1.0
        } else {
            -1.0
        };
        let step = self.friction[axis] + self.excess;
        let mut stepped = force;
        stepped[axis] += sign * step;
        let trace = Trace {
            axis,
            sign,
            from: tip.position[axis],
            before_ns: tip.at_ns,
            waited: 0,
            points: Vec::with_capacity(TRACE),
            force: step,
        };
        self.phase = Phase::Stepping(stepped, trace);
        Next::Force(stepped)
    }

    /// Mean delay of the step by the slew limit of the door, seconds. The part of the force that friction takes counts
    /// as no force.
    fn slewing(&self, trace: &Trace) -> f64 {
        let friction = self.friction[trace.axis];
        let change = self.slew_n_per_s * self.period_s;
        let missing = |k: u32| {
            let moving = f64::from(k + 1) * change - friction;
            (1.0 - moving / (trace.force - friction)).clamp(0.0, 1.0)
        };
        let periods = (trace.force / change).ceil().clamp(0.0, 100.0) as u32;
        (0..periods).map(|k| missing(k) * self.period_s).sum()
    }

    /// Seconds since the force, and motion, of each sample of a step.
    fn points(&self, trace: &Trace) -> Vec<(f64, f64)> {
        // The first period with the force is the one after the last sample without it.
        let sent_ns = trace.before_ns as f64 + self.period_s * 1e9;
        let since = |at_ns: u64| (at_ns as f64 - sent_ns) * 1e-9;
        trace
            .points
            .iter()
            .map(|&(at_ns, x)| (since(at_ns), x))
            .collect()
    }

    /// Figures of one axis: all of its steps together give acceleration and drag, each of them an onset and a mass.
    fn axis_figures(&self, axis: usize, all: &mut Singles) -> Option<Value> {
        let traces: Vec<&Trace> = self
            .traces
            .iter()
            .filter(|trace| trace.axis == axis)
            .collect();
        let points: Vec<_> = traces.iter().map(|trace| self.points(trace)).collect();
        let motion = fitted(&points.concat())?;
        let mut masses = Vec::new();
        for (trace, points) in traces.iter().zip(&points) {
            let beyond = self.lengths.rests();
            let moved = points.iter().find(|(_, x)| x.abs() > beyond);
            all.first_ms.extend(moved.map(|(t, _)| t * 1e3));
            let onset = onset(points, &motion, 0.5 * self.lengths.step);
            all.late_ms.push((onset - self.slewing(trace)) * 1e3);
            if let Some(own) = with(points, motion.onset, motion.drag) {
                let mass = (trace.force - self.friction[axis]) / own.acceleration;
                masses.push(mass * 1e3);
                all.drags.push(motion.drag * mass);
            }
        }
        all.masses_g.extend(&masses);
        Value::of(&masses)
    }

    fn figures(&self) -> Option<StepFigures> {
        let mut all = Singles::default();
        let mut axis = |axis| self.axis_figures(axis, &mut all);
        let axes_g = [axis(0)?, axis(1)?, axis(2)?];
        Some(StepFigures {
            latency_ms: Value::of(&all.late_ms)?,
            latency_p99_ms: quantile(&all.late_ms, 0.99)?,
            first_motion_ms: Value::of(&all.first_ms)?,
            first_motion_p99_ms: quantile(&all.first_ms, 0.99)?,
            mass_g: Value::of(&all.masses_g)?,
            axes_g,
            drag_n_s_per_m: Value::of(&all.drags)?,
        })
    }
}

/// Results of single steps, of all axes.
#[derive(Default)]
struct Singles {
    late_ms: Vec<f64>,
    first_ms: Vec<f64>,
    masses_g: Vec<f64>,
    drags: Vec<f64>,
}

impl Task for Steps {
    fn step(&mut self, tip: &Tip) -> Next {
        if self.traces.len() == self.steps {
            return Next::Done;
        }
        let (force, mut trace) = match &self.phase {
            Phase::Settling(samples) => return self.settle(tip, *samples),
            Phase::Base(force, samples) => return self.base(tip, *force, *samples),
            Phase::Stepping(force, trace) => (*force, trace.clone()),
        };
        let change = (tip.displayed[trace.axis] - self.holder.bias[trace.axis]) * trace.sign;
        if trace.points.is_empty() && change < SEEN_N {
            trace.before_ns = tip.at_ns;
            trace.waited += 1;
            if trace.waited > TRACE {
                return Next::Fail("the step of the force did not arrive".into());
            }
        } else {
            let way = (tip.position[trace.axis] - trace.from) * trace.sign;
            trace.points.push((tip.at_ns, way));
            if way.abs() > FAR || trace.points.len() >= TRACE {
                self.traces.push(trace);
                self.phase = Phase::Settling(0);
                return Next::Force(self.holder.force(tip));
            }
        }
        self.phase = Phase::Stepping(force, trace);
        Next::Force(force)
    }

    fn share(&self) -> f64 {
        self.traces.len() as f64 / self.steps as f64
    }

    fn finish(self: Box<Self>, report: &mut Measured) {
        report.steps = match self.figures() {
            Some(figures) => Outcome::Measured(figures),
            None => {
                Outcome::NotMeasured("the handle did not move after a step of the force".into())
            }
        };
        corrected(report, &self.lengths);
    }
}
