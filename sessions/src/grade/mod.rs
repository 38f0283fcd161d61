//! A grade with its reasons, from a replayed session and nothing else: what a recording's rows claim of wrenches buys nothing,
//! and a recording that is not sound gets no grade.
//!
//! A [`Watcher`] gathers the [`Evidence`] while a replay runs; [`finish`] makes the [`Grade`] of it. [`definitions`] has what
//! is measured, [`rubric`] what counts how much; both travel in the recording. The program *proposes*: what an instructor
//! says instead is kept beside the proposal ([`revision`]).
//!
//! # Invariants
//! - No clock, no chance, no order of a hash map, functions by libm: the same recording gives the same bytes on every machine.
//! - Printed numbers are rounded once, here, ties away from zero: scores and percentages to 0.1, millimetres to 0.01,
//!   newtons to 0.001, seconds to 0.01, smoothness to 0.001. Points are made of the values before rounding.

mod advice;
pub mod class;
mod crown;
pub mod definitions;
pub mod evidence;
pub mod floor;
mod hands;
pub(crate) mod motion;
pub mod names;
pub(crate) mod patient;
pub mod report;
pub mod revision;
pub mod rubric;
pub mod run;
mod score;
mod sheet;
pub mod sites;
pub(crate) mod stats;
pub(crate) mod table;
#[cfg(test)]
pub(crate) mod test_help;
mod touches;
mod values;
mod zones;

pub use evidence::{Evidence, Watcher};
pub use motion::series::{Point, STEP_S, Series};
pub use report::{Advice, CriticalError, Grade, MetricGrade, Migrated, RubricUsed, Standard};
pub use rubric::Rubric;
pub use run::{GradeError, Graded, Options, finish, grade};
pub use sites::{Finding, SiteGrade};
