//! Shapes of what yields, when they have changed enough to be seen.

use sulcus_core::{DisplaySkin, Scene, Vec3, Workspace};
use sulcus_view::{Moment, ReviewFile, ViewError};

/// A shape is shown anew when a vertex has gone farther than this since, mm.
const SEEN: f32 = 0.02;
/// Steps of a millimetre that vertices are rounded to: bytes of what has not moved stay the same, and pack well.
const STEPS: f32 = 256.0;

/// All that yields.
pub(super) struct Tissues {
    parts: Vec<Tissue>,
    shapes: u64,
}

struct Tissue {
    object: usize,
    /// What carries its vertices; made when it first moves.
    skin: Option<DisplaySkin>,
    rest: Vec<Vec3>,
    moved: Vec<Vec3>,
    /// As shown last, mm; none yet.
    shown: Option<Vec<[f32; 3]>>,
    /// Whether it was shown at rest last.
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
                shown: None,
                at_rest: true,
            }
        });
        Self {
            parts: parts.collect(),
            shapes: 0,
        }
    }

    /// Shapes shown.
    pub fn shapes(&self) -> u64 {
        self.shapes
    }

    /// Shows what has moved since the last frame.
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
    /// Its vertices, if they are not where they were shown last.
    fn changed(&mut self, scene: &Scene, ws: &Workspace) -> Option<&[[f32; 3]]> {
        let rests = ws.shape_of(self.object).iter().all(|x| *x == 0.0);
        if rests && self.at_rest && self.shown.is_some() {
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
        let now = at.map(|(rest, moved)| {
            let mm = (rest + moved) * 1e3;
            [mm.x, mm.y, mm.z].map(|x| (x as f32 * STEPS).round() / STEPS)
        });
        let now: Vec<[f32; 3]> = now.collect();
        if let Some(before) = &self.shown
            && !rests
            && !differ(before, &now)
        {
            return None;
        }
        Some(self.shown.insert(now))
    }
}

fn differ(before: &[[f32; 3]], now: &[[f32; 3]]) -> bool {
    let apart = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).any(|k| (a[k] - b[k]).abs() > SEEN);
    before.iter().zip(now).any(apart)
}
