//! Grade of a replayed session, with its reasons. Wrenches that a recording claims do not count.
//!
//! A [`Watcher`] gathers the [`Evidence`] during a replay. [`finish`] makes the [`Grade`] from the evidence.
//! [`definitions`] defines the metrics, [`rubric`] their weights; a recording carries both.
//! A grade is the program's proposal. An instructor's score is stored beside the proposal: [`revision`].
//!
//! # Modules
//! Modules depend on each other in one direction, from the last line to the first:
//!
//! - `tolerances`, [`settings`], `stats`: thresholds and statistics
//! - [`parts`], [`felt`]: sessions in several recordings; the force that the hand felt
//! - `zones`, `touches`, [`floor_time`], `hands`, `pressed`, `crown`, `motion`: measures of one tick after another
//! - [`evidence`], [`watcher`], `patient`, [`sites`]: a whole session
//! - `measured`, [`definitions`], [`rubric`], [`unfelt`], `score`, [`report`], `advice`: metrics, weights, forces that
//!   the hand did not feel, the grade as data
//! - [`run`], `text`: from a recording to its grade, and to text
//! - [`names`] with its reader `sheet`, [`revision`], [`class`]: grades of a class
//!
//! # Gaps of the connection
//! Nothing counts in a gap, nor on the way back until graphic and haptic tool have met
//! ([`crate::exercise::events::away`]). Readings, touches and moves that lasted before the gap go on behind it. In the
//! ramp behind a gap the hand feels less than the force of the tick, so a heavy force does not count there. The time of
//! gaps is no session time, unless the plan says that the clock runs. Recordings before format 6 mark no gaps, and all
//! their ticks count as before.
//!
//! # Devices
//! A metric of force judges the hand only if the device displays that force: [`unfelt`].
//!
//! # Invariants
//! - No clock, no chance, no order of a hash map, functions by libm: a recording has the same grade on every machine.
//! - Printed numbers are rounded once, in this module, ties away from zero. Points are computed before rounding.
//! - Metrics: scores, percentages, seconds and `path_length` to 0.1, other lengths and forces to 0.01, numbers to
//!   0.001.
//! - Zones: lengths to 0.01 mm, forces and times to 0.001, angles to 0.1 degrees. Time on the floor: to 0.01 s.

mod advice;
pub mod class;
mod crown;
pub mod definitions;
pub mod evidence;
pub mod felt;
pub mod floor_time;
mod hands;
mod measured;
pub(crate) mod motion;
pub mod names;
pub mod parts;
pub(crate) mod patient;
mod pressed;
pub mod report;
pub mod revision;
pub mod rubric;
pub mod run;
mod score;
pub mod settings;
pub mod sheet;
pub mod sites;
pub(crate) mod stats;
#[cfg(test)]
pub(crate) mod test_help;
pub(crate) mod text;
mod tolerances;
mod touches;
pub mod unfelt;
pub mod watcher;
mod zones;

pub use evidence::{Evidence, Gone};
pub use felt::Felt;
pub use motion::series::{Point, STEP_S, Series};
pub use report::{Advice, CriticalError, Grade, MetricGrade, Migrated, RubricUsed, Standard};
pub use rubric::Rubric;
pub use run::{GradeError, Graded, Options, finish, grade, grade_session};
pub use settings::Settings;
pub use sites::{Finding, SiteGrade};
pub use unfelt::{Lack, Unfelt};
pub use watcher::Watcher;
