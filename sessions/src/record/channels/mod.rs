//! What a recording holds for people, beside the exact rows: channels that viewers open unaided. Protobuf throughout, of
//! Foxglove's types where there is one, else of `sulcus.v1` ([`v1`]); topics are entity paths; all messages of a tick have
//! its row's time.
//!
//! | topic | type | when |
//! |---|---|---|
//! | `/tf` | `foxglove.FrameTransforms` | [`FRAMES_HZ`]: frames `tools/NAME/haptic` and `tools/NAME/graphic` in `world` |
//! | `/tools/NAME/haptic`, `/tools/NAME/graphic` | `foxglove.PoseInFrame` | [`FRAMES_HZ`] |
//! | `/tools/NAME/spheres` | `foxglove.PointCloud` | once, in the frame `tools/NAME/graphic` |
//! | `/tools/NAME/wrench` | `sulcus.v1.Wrench` | [`WRENCHES_HZ`] |
//! | `/tools/NAME/contacts` | `sulcus.v1.Contacts` | [`FRAMES_HZ`] while something bears load |
//! | `/tools/NAME/metrics` | `sulcus.v1.ToolMetrics` | [`FRAMES_HZ`] |
//! | `/objects/NAME/spheres` | `foxglove.PointCloud` | once at rest, then at [`FRAMES_HZ`] while the tissue is touched or moves |
//! | `/session/metrics` | `sulcus.v1.SessionMetrics` | [`FRAMES_HZ`] |
//! | `/log` | `foxglove.Log` | every line of `/events` |
//!
//! Nothing is said of a tool that nobody holds.
//!
//! # Rates
//! A screen shows 60 frames a second, and a hand's tremor ends below 20 Hz: poses at 62.5 Hz lose nothing that is seen. A
//! force is plotted, and contact makes it faster than the hand: it has 125 Hz, and each message says how large the force
//! became in between, so that decimation hides no peak. Every tick stands in the exact rows.
//!
//! # Precision
//! Poses are rounded to nanometres, clouds to 8 um: beyond what is seen digits are noise, which does not pack. The exact numbers
//! come from a replay.
//!
//! # Where it runs
//! In the thread that ticks, [`Sampler`] copies numbers into a buffer made beforehand ([`Shapes`]): which tissue is awake, its
//! configuration, the contacts that bear load. Where spheres are is worked out by [`Views`], in the recorder's thread.

mod cadence;
mod clouds;
mod foxglove_types;
mod names;
mod own_types;
mod shapes;
mod tool;
mod views;

pub use cadence::{FRAMES_HZ, WRENCHES_HZ};
pub use foxglove_types::Schema;
pub(crate) use foxglove_types::{log, schema_of};
pub(crate) use names::paths;
pub(crate) use own_types::exact;
pub use own_types::v1;
pub use shapes::{Sampler, Shapes};
pub(crate) use tool::is_held;
pub use views::Views;

/// Topic of the session's log for viewers.
pub const LOG: &str = "/log";
/// Topic of the frames.
pub const TRANSFORMS: &str = "/tf";
/// Topic of [`v1::SessionMetrics`].
pub const SESSION_METRICS: &str = "/session/metrics";
/// Frame of everything that does not move with a tool.
pub const WORLD: &str = "world";
