//! A recorded session for the viewer: the mouth and the tools in space, forces as arrows, what was measured as plots,
//! what happened as a log, all on the session's time.
//!
//! [`ReviewFile`] takes one moment after the other and sends what has come together over a second as columns. Every entity:
//!
//! | entity | rows | what |
//! |---|---|---|
//! | `/mouth/teeth/*`, `/mouth/jaw/*` | one, constant | meshes, mm |
//! | `/mouth/gingiva/*`, `/mouth/tongue/*` | one, constant | meshes of what never moved |
//! | `/mouth/gingiva/*/*`, `/mouth/tongue/*/*` | one for each new shape | patches of the meshes of what did: vertices and normals |
//! | `/tools/*` | one a frame | graphic tool: where the instrument is |
//! | `/hands/*`, `/offsets/*` | one a frame | haptic tool: where the hand is, when that is not where the instrument is, and a line between the tips |
//! | `/contacts/*`, `/forces/on_*` | one a frame | what pushes on the tool: each contact, and all together, with newtons |
//! | `/close_up` | one a frame | the frame in which the close-up is seen: follows the tip |
//! | `/plots/*` | one a tick | numbers |
//! | `/lanes/*` | one a change | site, zone of force, whether the target is seen |
//! | `/labels/sites` | one a change | names beside the sites on the tip's side of its tooth |
//! | `/events` | one each | what happened |

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
