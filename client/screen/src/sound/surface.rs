//! Surface that a tip touches, by the nearest vertex of the scene at rest.

use sulcus_proto::display::{DisplayScene, Kind};

use crate::camera::Vector;

/// Surface of a touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// Tooth. Enamel and root sound alike.
    Enamel,
    /// Soft tissue.
    Soft,
}

impl Surface {
    /// Surface nearest to a place, mm; `None` in a scene without objects. The wall of a pocket has no vertices of its
    /// own: a tip within counts as on the tooth or on the gingiva, whichever is nearer.
    pub fn at(scene: &DisplayScene, place: &Vector) -> Option<Self> {
        let nearest = |object: &sulcus_proto::display::DisplayObject| {
            let away = object.mesh.vertices().map(|at| {
                let at = Vector::from(at.map(|x| f64::from(x) * 1e3));
                (at - place).norm_squared()
            });
            away.fold(f64::INFINITY, f64::min)
        };
        let objects = scene.objects.iter().map(|one| (one.kind, nearest(one)));
        let nearest = objects.min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(match nearest.0 {
            Kind::Tooth => Self::Enamel,
            _ => Self::Soft,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_proto::display::{DisplayMesh, DisplayObject};

    #[test]
    fn the_nearest_object_is_touched() {
        let object = |kind, x: f32| DisplayObject {
            kind,
            fdi: 36,
            mesh: DisplayMesh::new(&[[x, 0.0, 0.0], [x, 0.01, 0.0]], &[], [255; 4], &[])
                .expect("a mesh"),
            skin: None,
            sites: vec![],
        };
        let mut scene = DisplayScene {
            tick_ns: 1_000_000,
            tools: vec![],
            objects: vec![object(Kind::Tooth, 0.0), object(Kind::Gingiva, 0.004)],
        };
        let at = |scene: &DisplayScene, x| Surface::at(scene, &Vector::new(x, 9.0, 0.0));
        assert_eq!(at(&scene, 1.0), Some(Surface::Enamel));
        assert_eq!(at(&scene, 3.0), Some(Surface::Soft));
        scene.objects.clear();
        assert_eq!(at(&scene, 1.0), None);
    }
}
