//! Looks of teeth and instruments: meshes, colours and finishes for a display alone.
//!
//! Everything here depends on shapes and numbers of teeth and instruments alone. No value of a chart is read.

mod colour;
mod cut;
mod enamel;
mod flip;
mod quadric;
mod sheet;
mod steel;
mod teeth;
mod thin;
mod trace;

pub use steel::tool;
pub use teeth::prepare;

use sulcus_proto::CodecError;
use sulcus_proto::display::DisplayMesh;
use sulcus_scene::anatomy::mouth::DrawnTooth;

/// Returns the display mesh of a tooth. A tooth that is not of a `[mouth]` keeps its `compiled` mesh and colour.
///
/// # Errors
/// The mesh is beyond the limits of a display.
pub fn tooth(compiled: DisplayMesh, drawn: Option<&DrawnTooth>) -> Result<DisplayMesh, CodecError> {
    match drawn {
        Some(drawn) => teeth::tooth(drawn),
        None => {
            let finishes = vec![enamel::plain(); compiled.len()];
            compiled.with_finishes(finishes)
        }
    }
}
