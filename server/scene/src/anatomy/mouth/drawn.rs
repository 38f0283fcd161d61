//! The gingivae of a mouth as a student sees them: meshes that show nothing hidden.
//!
//! Recession is visible, so the margin is the patient's. Depth, furcation, bleeding and inflammation are hidden: every
//! pocket is drawn [`DEPTH_MM`] deep, and no other input of the chart reaches a mesh. Two patients with the same teeth
//! and the same recession have the same meshes, bit for bit.
//!
//! The drawn margin lies within 0.3 mm of the simulated one, which depends a little on the depth.
//!
//! The mesh of an [`Object`](sulcus_core::Object) is not suited. Wall and floor show the depth. The crest under a
//! contact and the angles of the sites depend on the depth, too.

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, Site, ToothFrame};
use sulcus_core::{Scene, Vec3};

use super::{JAW_TOP, Standing, UNDER_CONTACT, faces, placed_mesh, standing};
use crate::anatomy::arch::to_world;
use crate::anatomy::collar::{Collar, CollarSizes, SulcusProfile, skin};
use crate::file::MouthEntry;
use crate::mesh::TriMesh;

/// Depth of every drawn pocket, mm. Chosen: an eye cannot look farther into a gap of 0.4 mm.
pub const DEPTH_MM: f64 = 3.0;
/// Depth at which the angles of the sites are taken, mm. On a tapered root they depend on the depth, and the junction's
/// height depends on them. Chosen between healthy and deep pockets.
const USUAL_MM: f64 = 4.0;
/// Largest difference between a tooth's frame and its place on the arch, metres and dimensionless.
const SAME: f64 = 1e-9;

/// Gingiva of a mouth without hidden truth.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnGingiva {
    /// Mesh, world axes, metres.
    pub mesh: TriMesh,
    /// Places of the six sites at the margin, in the order of [`Site::ALL`], world axes, metres.
    pub sites: [Vec3; 6],
}

/// Returns the drawn gingivae of a compiled scene, by object. `None`: the object is no gingiva of a `[mouth]`.
///
/// Sizes of the collar that a scene file sets are not in the compiled scene. The drawing has the default sizes.
pub fn drawn_gingivae(scene: &Scene) -> Vec<Option<DrawnGingiva>> {
    let models: Vec<Option<(u8, &Gingiva)>> = scene.objects.iter().map(of_mouth).collect();
    if models.iter().all(Option::is_none) {
        return models.iter().map(|_| None).collect();
    }
    let there = |tooth: &&Standing| {
        let mut all = models.iter().flatten();
        all.any(|(fdi, model)| *fdi == tooth.fdi && same(&model.tooth, &tooth.frame))
    };
    let all: Vec<Standing> = standing().iter().filter(there).cloned().collect();
    crate::parallel::map(models.len(), |k| {
        let (fdi, model) = models[k]?;
        let tooth = all.iter().position(|tooth| tooth.fdi == fdi)?;
        Some(drawn(&all, tooth, model))
    })
}

fn of_mouth(object: &sulcus_core::Object) -> Option<(u8, &Gingiva)> {
    match &object.tissue {
        TissueModel::Gingiva(model) => Some((object.fdi, model)),
        _ => None,
    }
}

fn same(a: &ToothFrame, b: &ToothFrame) -> bool {
    let of = |f: &ToothFrame| [f.origin, f.axis, f.mesial, f.buccal];
    let mut pairs = of(a).into_iter().zip(of(b));
    pairs.all(|(a, b)| (a - b).norm() <= SAME)
}

fn drawn(all: &[Standing], k: usize, model: &Gingiva) -> DrawnGingiva {
    let (tooth, entry) = (&all[k], MouthEntry::default());
    let recession = model.sites.map(|site| site.recession * 1e3);
    let usual = [USUAL_MM; 6];
    let nearly = recession.map(|recession| -recession);
    let angles = SulcusProfile::new(&tooth.sections, usual, nearly).sites();
    let margins = Site::ALL.map(|site| {
        let k = site as usize;
        let margin = tooth.shape.cej(angles[k]) - recession[k];
        // A papilla has room under the contact point only.
        let contact = site.is_mesial().map(|mesial| usize::from(!mesial));
        contact.map_or(margin, |end| {
            margin.min(tooth.contacts[end].z - UNDER_CONTACT)
        })
    });
    let mut sulcus = SulcusProfile::new(&tooth.sections, usual, margins);
    sulcus.depths = [DEPTH_MM; 6];
    let collar = Collar {
        tooth: tooth.shape.clone(),
        sections: tooth.sections.clone(),
        entrances: Vec::new(),
        sulcus,
        sizes: CollarSizes {
            width: entry.width_mm,
            crest: entry.crest_mm,
            wall: entry.wall_mm,
            base: JAW_TOP - tooth.frame.origin.z * 1e3,
            sink: 0.0,
        },
        neighbours: faces::neighbours(all, k, entry.wall_mm),
    };
    DrawnGingiva {
        mesh: placed_mesh(&skin(&collar), &tooth.frame),
        sites: collar.sulcus.sites().map(|around| {
            let crest = collar.crest(around);
            let r = collar.inner(around, crest) + 0.5 * collar.sizes.crest;
            let place = Vec3::new(r * libm::cos(around), r * libm::sin(around), crest);
            to_world(&tooth.frame, &(place * 1e-3))
        }),
    }
}
