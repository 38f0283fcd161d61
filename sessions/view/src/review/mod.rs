//! A recorded session for the viewer: the mouth and the tools in space, forces as arrows, what was measured as plots,
//! what happened as a log, all on the session's time.

mod begin;
mod layout;
mod normals;
mod patches;
mod picture;
mod waiting;
mod write;

pub use picture::{
    Arrow, Eye, FramePicture, Label, Lane, MeshPicture, Moment, Numbers, PartKind, PartPicture,
    ReviewPicture, Slider, Standing, ToolPicture, ToolStanding, Weight,
};
pub use write::ReviewFile;
