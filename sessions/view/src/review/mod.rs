//! Review of a recorded session for the viewer: mouth and tools in space, forces as arrows, measurements as plots,
//! events as a log, all on the session's time.

pub(crate) mod begin;
pub(crate) mod entity;
pub(crate) mod layout;
mod normals;
mod patches;
mod picture;
pub(crate) mod waiting;
pub(crate) mod write;

pub use picture::{
    Arrow, Eye, FramePicture, Label, Lane, MeshPicture, Moment, Numbers, PartKind, PartPicture,
    ReviewPicture, Slider, Standing, ToolPicture, ToolStanding, Weight,
};
pub use write::ReviewFile;
