//! Channels of a recording for viewers, which other programs open without help. All messages are protobuf, of
//! Foxglove's types or of `sulcus.v1` ([`v1`]). Topics are entity paths. All messages of a tick have the time of its
//! row.
//!
//! | topic | type | rate |
//! |---|---|---|
//! | `/tf` | `foxglove.FrameTransforms` | [`FRAMES_HZ`]: frames `tools/NAME/haptic` and `tools/NAME/graphic` in `world` |
//! | `/tools/NAME/haptic`, `/tools/NAME/graphic` | `foxglove.PoseInFrame` | [`FRAMES_HZ`] |
//! | `/tools/NAME/spheres` | `foxglove.PointCloud` | once, in the frame `tools/NAME/graphic` |
//! | `/tools/NAME/wrench` | `sulcus.v1.Wrench` | [`WRENCHES_HZ`] |
//! | `/tools/NAME/contacts` | `sulcus.v1.Contacts` | [`FRAMES_HZ`] while a contact bears load |
//! | `/tools/NAME/metrics` | `sulcus.v1.ToolMetrics` | [`FRAMES_HZ`] |
//! | `/objects/NAME/spheres` | `foxglove.PointCloud` | once at rest, then at [`FRAMES_HZ`] while the tissue is touched or moves |
//! | `/session/metrics` | `sulcus.v1.SessionMetrics` | [`FRAMES_HZ`] |
//! | `/log` | `foxglove.Log` | every line of `/events` |
//!
//! A tool that no hand holds has no messages. The sequence number of a message is the number of rows before it.
//!
//! # Policy
//! With the policy `on-demand` ([`crate::ViewersPolicy`]) a recording has `/session/metrics` alone. A replay makes the
//! other channels byte for byte ([`crate::replay::viewers`]).
//!
//! # Rates
//! A screen shows 60 frames a second, and the tremor of a hand ends below 20 Hz, so poses at 62.5 Hz lose nothing
//! visible. Forces are plotted, and contacts make them change faster than the hand. Their rate is 125 Hz, and each
//! message has the largest force since the last message, so no peak is lost. The exact rows contain every tick.
//!
//! # Precision
//! Poses are rounded to f32, clouds to 8 um. Further digits are not visible and do not compress. A replay gives the
//! exact numbers.
//!
//! # Threads
//! [`Sampler`] runs in the thread that ticks. It copies numbers into memory that was allocated beforehand ([`Shapes`]):
//! awake tissues, their configurations, contacts under load. [`Views`] computes the places of spheres in the recorder's
//! thread ([`Moved`]). The feed for displays takes the same places: [`Views::follow`].

mod cadence;
mod clouds;
pub(crate) mod foxglove_types;
mod moved;
mod names;
pub(crate) mod own_types;
mod shapes;
mod tool;
pub(crate) mod topics;
mod views;

pub use cadence::{Cadence, FRAMES_HZ, WRENCHES_HZ};
pub use moved::{Moved, MovedTissue};
pub(crate) use names::paths;
pub use own_types::v1;
pub use shapes::{Sampler, Shapes};
pub(crate) use tool::is_held;
pub use views::Views;
