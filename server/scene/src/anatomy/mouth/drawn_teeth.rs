//! The teeth of a mouth, with the shapes from which a display draws them.

use sulcus_core::Scene;
use sulcus_core::tissue::gingiva::ToothFrame;

use super::{Standing, placed_mesh, standing};
use crate::anatomy::tooth::Tooth;
use crate::mesh::TriMesh;

/// Tooth of a `[mouth]`: its shape and its place.
#[derive(Clone, Copy, Debug)]
pub struct DrawnTooth {
    /// Two-digit FDI number.
    pub fdi: u8,
    /// Shape, drawn for the left side.
    pub shape: &'static Tooth,
    /// Surface in the frame of a left tooth, metres.
    pub mesh: &'static TriMesh,
    /// Frame in the world, metres. The frame of a right tooth is left-handed.
    pub frame: ToothFrame,
}

/// Returns the teeth of a compiled `[mouth]`, by object. `None`: the object is another one, or its mesh is its own.
pub fn drawn_teeth(scene: &Scene) -> Vec<Option<DrawnTooth>> {
    let of = |object: &sulcus_core::Object| {
        let is_tooth = object.fdi != 0 && object.tissue.is_rigid();
        // Only a mouth's object has this name, so that a scene without a mouth needs no shapes.
        if !is_tooth || object.name != format!("tooth {}", object.fdi) {
            return None;
        }
        let tooth = standing().iter().find(|tooth| tooth.fdi == object.fdi)?;
        let placed = placed_mesh(&tooth.mesh, &tooth.frame).to_display(object.mesh.colour);
        (placed == object.mesh).then(|| drawn(tooth))
    };
    scene.objects.iter().map(of).collect()
}

fn drawn(tooth: &'static Standing) -> DrawnTooth {
    DrawnTooth {
        fdi: tooth.fdi,
        shape: &tooth.shape,
        mesh: &tooth.mesh,
        frame: tooth.frame,
    }
}
