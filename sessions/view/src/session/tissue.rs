//! Shapes of soft tissues that are not at rest.

use crate::error::ViewError;
use crate::review::{Moment, ReviewFile};
use sulcus_core::{DisplaySkin, Scene, Vec3, Workspace};

use super::units::millimetres;

/// All soft tissues.
pub(super) struct Tissues {
    parts: Vec<Tissue>,
    shapes: u64,
}

struct Tissue {
    object: usize,
    /// Carriers of the vertices; made at the first motion.
    skin: Option<DisplaySkin>,
    rest: Vec<Vec3>,
    moved: Vec<Vec3>,
    /// Vertices, millimetres.
    shape: Vec<[f32; 3]>,
    /// Whether the tissue was at rest in the last frame.
    at_rest: bool,
}

impl Tissues {
    pub fn new(scene: &Scene) -> Self {
        let yielding = scene.objects.iter().enumerate();
        let yielding = yielding.filter(|(_, object)| !object.tissue.is_rigid());
        let parts = yielding.map(|(object, of)| {
            let vertices = of.mesh.vertices.iter();
            let rest: Vec<Vec3> = vertices.map(|v| Vec3::from(v.map(f64::from))).collect();
            Tissue {
                object,
                skin: None,
                moved: vec![Vec3::zeros(); rest.len()],
                rest,
                shape: Vec::new(),
                at_rest: true,
            }
        });
        Self {
            parts: parts.collect(),
            shapes: 0,
        }
    }

    /// Number of shapes.
    pub fn shapes(&self) -> u64 {
        self.shapes
    }

    /// Writes the shapes that have changed since the last frame.
    pub fn frame(
        &mut self,
        scene: &Scene,
        ws: &Workspace,
        at: Moment,
        file: &mut ReviewFile,
    ) -> Result<(), ViewError> {
        for part in &mut self.parts {
            let object = part.object;
            if let Some(shape) = part.changed(scene, ws) {
                file.part(at, object, shape)?;
                self.shapes += 1;
            }
        }
        Ok(())
    }
}

impl Tissue {
    /// Vertices of the tissue; `None` if it is at rest and was at rest before.
    fn changed(&mut self, scene: &Scene, ws: &Workspace) -> Option<&[[f32; 3]]> {
        let rests = ws.shape_of(self.object).iter().all(|x| *x == 0.0);
        if rests && self.at_rest {
            return None;
        }
        self.at_rest = rests;
        if rests {
            self.moved.fill(Vec3::zeros());
        } else {
            let skin = self
                .skin
                .get_or_insert_with(|| DisplaySkin::of(&scene.objects[self.object]));
            skin.displacements(&ws.carriers_moved(scene, self.object), &mut self.moved);
        }
        let at = self.rest.iter().zip(&self.moved);
        self.shape.clear();
        self.shape
            .extend(at.map(|(rest, moved)| millimetres(&(rest + moved))));
        Some(&self.shape)
    }
}
