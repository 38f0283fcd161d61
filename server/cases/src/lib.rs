//! The table of hard cases, and the one definition of every measure.
//!
//! The same table feeds the tests, the report and the demo (`--exercise hard/NAME`); the same
//! measures judge a case, a demo run and a recording.

mod bearing;
pub mod bounded;
pub mod chart;
pub mod comparison;
pub mod device_loop;
pub mod fuzz;
pub mod inside;
pub mod linked;
pub mod measure;
pub mod mouth;
pub mod multi_rate;
pub mod one_dof;
pub mod pocket;
mod residual;
pub mod rest;
pub mod ripple;
pub mod run;
pub mod scenes;
mod shake;
pub mod statistics;
mod sway;
pub mod table;
pub mod timing;
pub mod tissue_scenes;
pub mod toured;

pub use chart::Chart;
pub use measure::{Measures, Observer};
pub use run::{CaseReport, Played, Seen, record, run, run_at, run_on};
pub use table::{Bounds, Case, Check, TABLE, find};
