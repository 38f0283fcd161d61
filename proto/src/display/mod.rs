//! Content of a student's screen: the scene once, then a frame for each picture.
//!
//! A [`DisplayScene`] has meshes, skins, bands and colours. A [`DisplayFrame`] has the shapes of one instant. Neither
//! has a field for hidden truth:
//!
//! - no prescribed depth, no floor of a pocket, no furcation
//! - no bleeding before it shows
//! - no parameter of a tissue, no text of a patient, no seed
//!
//! Two patients with the same visible mouth have the same bytes.
//!
//! Scene and frames travel on a QUIC connection of their own. Each is one unidirectional stream with a [`stream`] head.
//! A frame is complete in itself: its numbers are differences from the scene at rest, never from another frame. A lost
//! frame therefore needs no answer.
//!
//! All lengths are in metres, world axes, except where a field names another frame.

#[cfg(test)]
mod fields;
mod frame;
mod mesh;
mod scene;
mod skin;
pub mod stream;

pub use frame::{DisplayFrame, FrameTool, Moved, MovedHandle, STEP_M, Spot};
pub use mesh::{DisplayMesh, Finish, Triangles};
pub use scene::{
    DisplayBand, DisplayGlass, DisplayObject, DisplayScene, DisplayTool, Kind, SceneHash,
};
pub use skin::{Skin, WEIGHT};

use crate::CodecError;

/// Largest encoded scene, bytes. Chosen as six times a whole mouth, which has 5.3 MB.
pub const SCENE_BYTES: usize = 32 << 20;
/// Largest encoded frame, bytes: every handle of a whole mouth moves.
pub const FRAME_BYTES: usize = 128 << 10;
/// Largest number of objects of a scene.
pub const OBJECTS: usize = 256;
/// Largest number of handles of a skin: the spheres of a tongue in contact.
pub const HANDLES: usize = 512;
/// Number of charted sites round a tooth.
pub const SITES: usize = 6;

/// Returns an error for a number that is NaN or infinite.
fn finite<'a>(
    what: &'static str,
    numbers: impl IntoIterator<Item = &'a f32>,
) -> Result<(), CodecError> {
    if numbers.into_iter().all(|x| x.is_finite()) {
        Ok(())
    } else {
        Err(CodecError::NotFinite(what))
    }
}

/// Returns an error if a rule is broken.
fn rule(holds: bool, rule: &'static str) -> Result<(), CodecError> {
    if holds {
        Ok(())
    } else {
        Err(CodecError::NotCanonical(rule))
    }
}
