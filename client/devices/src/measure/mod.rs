//! Measurement of a haptic device: rate, resolution, friction, latency, mass, largest stable stiffness, static force.
//!
//! A [`Measurement`] stands at the loop's end of a door: it reads samples and orders forces, once per millisecond. The
//! door in front of the device keeps all of its limits. [`run`] drives a measurement with the clock of the machine; a
//! test drives it with a clock of its own. The result is a [`Measured`] report and, by [`Measured::model`], the model
//! file of the device.
//!
//! No force exceeds 1 N, except on the scale, and no force exceeds the continuous force of the device. Every stage ends
//! after a number of samples. A trip of the door ends its stage.

mod fit;
mod friction;
mod holder;
mod machine;
mod model;
mod plan;
mod prompt;
mod rate;
mod report;
mod resolution;
mod run;
mod scale;
mod shake;
mod steps;
mod stiffness;
mod task;
mod tip;

pub use machine::{Measurement, Order};
pub use plan::{LOOP_NS, MOST_N, MOST_SCALE_N, Part, Plan};
pub use prompt::{Answer, Ask, Progress, Prompt};
pub use report::{
    FrictionFigures, Measured, Outcome, RateFigures, ScalePoint, StepFigures, StiffnessFigures,
    Value,
};
pub use run::run;

#[cfg(test)]
mod tests;
