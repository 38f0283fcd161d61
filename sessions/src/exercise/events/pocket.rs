//! Pockets of a scene: gingivae with their teeth, and the distance of a point from the tooth.

use sulcus_core::math::norm;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::Gingiva;
use sulcus_core::{Object, Scene, Sphere, Vec3};

/// A gingiva and the tooth that it surrounds.
#[derive(Clone, Debug)]
pub struct Pocket {
    /// Index of the gingiva among the scene's objects.
    pub object: u16,
    /// FDI number of the tooth, 0 without a tooth.
    pub fdi: u8,
    /// Spheres of the tooth at the touched level; empty without a tooth.
    spheres: Vec<Sphere>,
}

/// All pockets of a scene, in the order of its objects.
pub fn all(scene: &Scene) -> Vec<Pocket> {
    let of = |(k, object): (usize, &Object)| {
        let gingiva = gingiva_of(object)?;
        let tooth = tooth_of(scene, object, gingiva);
        Some(Pocket {
            object: u16::try_from(k).ok()?,
            fdi: tooth.map_or(object.fdi, |tooth| tooth.fdi),
            spheres: tooth.map_or_else(Vec::new, |tooth| {
                let shape = tooth.tree.shape_at(tooth.level);
                shape.map(|(_, node)| node.sphere()).collect()
            }),
        })
    };
    scene.objects.iter().enumerate().filter_map(of).collect()
}

fn gingiva_of(object: &Object) -> Option<&Gingiva> {
    match &object.tissue {
        TissueModel::Gingiva(gingiva) => Some(gingiva),
        _ => None,
    }
}

/// Tooth with the gingiva's number, else the nearest tooth.
fn tooth_of<'a>(scene: &'a Scene, object: &Object, gingiva: &Gingiva) -> Option<&'a Object> {
    let teeth = || {
        let tooth = |other: &&Object| other.fdi != 0 && other.tissue.is_rigid();
        scene.objects.iter().filter(tooth)
    };
    let named = teeth().find(|tooth| object.fdi != 0 && tooth.fdi == object.fdi);
    named.or_else(|| {
        teeth().min_by(|a, b| {
            let from = |o: &Object| norm(&(o.tree.nodes()[0].centre - gingiva.tooth.origin));
            from(a).total_cmp(&from(b))
        })
    })
}

impl Pocket {
    /// Model of the gingiva; `None` if `scene` is another scene.
    pub fn gingiva<'a>(&self, scene: &'a Scene) -> Option<&'a Gingiva> {
        gingiva_of(scene.objects.get(usize::from(self.object))?)
    }

    /// Distance from a point to the tooth's surface, metres, negative inside; 0 without a tooth.
    pub fn tooth_distance(&self, point: &Vec3) -> f64 {
        let distances = self
            .spheres
            .iter()
            .map(|sphere| norm(&(point - sphere.centre)) - sphere.radius);
        distances
            .reduce(|a, b| if b < a { b } else { a })
            .unwrap_or(0.0)
    }

    /// Spheres of the tooth.
    pub fn spheres(&self) -> &[Sphere] {
        &self.spheres
    }
}
