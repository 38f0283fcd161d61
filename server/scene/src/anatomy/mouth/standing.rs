//! Lower teeth at their places on the arch, made once per process.

use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

use sulcus_core::Vec3;
use sulcus_core::tissue::gingiva::ToothFrame;

use crate::anatomy::arch;
use crate::anatomy::arch::Footprint;
use crate::anatomy::collar::outer_face;
use crate::anatomy::sections::Sections;
use crate::anatomy::tooth::Tooth;
use crate::file::LOWER;
use crate::mesh::TriMesh;

/// Height in the world at which the jaw begins, mm: below the deepest floor of any tooth.
pub const JAW_TOP: f64 = -13.5;

/// A tooth that stands in the mouth.
#[derive(Clone)]
pub(crate) struct Standing {
    /// FDI number.
    pub fdi: u8,
    /// Surface in the frame of a left tooth, metres.
    pub mesh: TriMesh,
    /// Frame in the world, metres.
    pub frame: ToothFrame,
    pub(super) shape: Tooth,
    /// Mesial and distal contact point, mm, the tooth's frame.
    pub(super) contacts: [Vec3; 2],
    pub(super) sections: Sections,
}

impl Standing {
    /// Distances of the gingiva's outer faces from the axis at the top of the jaw, buccally and lingually, mm.
    pub(crate) fn faces(&self, wall: f64) -> [f64; 2] {
        let z = JAW_TOP - self.frame.origin.z * 1e3;
        [1.0, -1.0].map(|side| outer_face(&self.sections, wall, FRAC_PI_2 * side, z))
    }

    /// Distances of the contact points from the axis, mesially and distally, mm.
    pub(crate) fn ends(&self) -> [f64; 2] {
        let [mesial, distal] = self.contacts;
        [mesial.x, -distal.x]
    }
}

/// Returns all lower teeth in the order of [`LOWER`], made once per process.
pub(crate) fn standing() -> &'static [Standing] {
    static STANDING: LazyLock<Vec<Standing>> = LazyLock::new(stand);
    &STANDING
}

/// Makes all lower teeth. The shapes of the right side are those of the left side.
fn stand() -> Vec<Standing> {
    let teeth: Vec<Tooth> = (31..=37).filter_map(Tooth::lower).collect();
    let shapes: Vec<(Tooth, TriMesh, Sections, [Vec3; 2])> =
        crate::parallel::map(teeth.len(), |k| {
            let shape = teeth[k].clone();
            let mesh = shape.mesh();
            let low = JAW_TOP - arch::OCCLUSAL + shape.crown_height_mm() - 1.0;
            let sections = Sections::of(&mesh, low, shape.crown_height_mm() + 0.5);
            let contacts = shape.contacts();
            (shape, mesh, sections, contacts)
        });
    let footprints = |side: u8| -> Vec<Footprint> {
        let all = shapes.iter().zip(1..);
        all.map(|((shape, _, _, contacts), k)| Footprint {
            fdi: 10 * side + k,
            contacts: *contacts,
            crown_height: shape.crown_height_mm(),
        })
        .collect()
    };
    let frames = [3, 4].map(|side| arch::quadrant(&footprints(side)));
    LOWER
        .into_iter()
        .map(|fdi| {
            let k = usize::from(fdi % 10 - 1);
            let (shape, mesh, sections, contacts) = &shapes[k];
            let mut frame = frames[usize::from(fdi / 10 - 3)][k];
            frame.origin *= 1e-3;
            Standing {
                fdi,
                mesh: mesh.clone(),
                frame,
                shape: shape.clone(),
                contacts: *contacts,
                sections: sections.clone(),
            }
        })
        .collect()
}
