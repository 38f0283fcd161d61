//! Lower teeth at their places on the arch, made once per process.

use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

use sulcus_core::Vec3;
use sulcus_core::tissue::gingiva::ToothFrame;

use crate::anatomy::arch;
use crate::anatomy::arch::{Footprint, Stance};
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

/// Half the breadth of a gingiva that reaches down to the jaw, mm. The base of a leaning gingiva is as much lower as
/// one of its sides rises.
const HALF: f64 = 6.5;

impl Standing {
    /// Frame in the world, mm.
    pub(crate) fn frame_mm(&self) -> ToothFrame {
        ToothFrame {
            origin: self.frame.origin * 1e3,
            ..self.frame
        }
    }

    /// Point of the axis at the top of the jaw, world, mm.
    pub(crate) fn at_jaw(&self) -> Vec3 {
        let frame = self.frame_mm();
        frame.origin + frame.axis * ((JAW_TOP - frame.origin.z) / frame.axis.z)
    }

    /// Distances of the gingiva's outer faces from the axis at the top of the jaw, buccally and lingually, mm, level.
    pub(crate) fn faces(&self, wall: f64) -> [f64; 2] {
        let frame = self.frame_mm();
        let middle = (JAW_TOP - frame.origin.z) / frame.axis.z;
        // Sine and cosine of the lean: a leaning side meets the jaw farther up or down the axis.
        let (sine, cosine) = (frame.buccal.z, frame.axis.z);
        [1.0, -1.0].map(|side| {
            let of = |z: f64| outer_face(&self.sections, wall, FRAC_PI_2 * side, z);
            let z = middle - side * of(middle) * sine / cosine;
            of(z) / cosine
        })
    }

    /// Height of the base of its gingiva in the tooth's frame, mm: everywhere under the top of the jaw.
    pub(crate) fn base(&self) -> f64 {
        base(&self.frame_mm())
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

/// Height of the base of a gingiva in its tooth's frame, mm.
fn base(frame_mm: &ToothFrame) -> f64 {
    let lean = (1.0 - frame_mm.axis.z * frame_mm.axis.z).max(0.0).sqrt();
    (JAW_TOP - frame_mm.origin.z - HALF * lean) / frame_mm.axis.z
}

/// A tooth before it is placed: shape, surface, and its footprint on the left side.
struct Made {
    shape: Tooth,
    mesh: TriMesh,
    footprint: Footprint,
}

/// Makes all lower teeth. The shapes of the right side are those of the left side.
fn stand() -> Vec<Standing> {
    let teeth: Vec<Tooth> = (31..=37).filter_map(Tooth::lower).collect();
    let made: Vec<Made> = crate::parallel::map(teeth.len(), |k| {
        let shape = teeth[k].clone();
        let mesh = shape.mesh();
        let stance = Stance::of(shape.fdi());
        let leaned = stance.leaned();
        let tops = mesh.vertices.iter().map(|v| (leaned * v).z * 1e3);
        let footprint = Footprint {
            fdi: shape.fdi(),
            stance,
            contacts: shape.contacts_leaned(&leaned),
            top: tops.fold(f64::NEG_INFINITY, f64::max),
        };
        Made {
            shape,
            mesh,
            footprint,
        }
    });
    let footprints = |side: u8| -> Vec<Footprint> {
        let of = |made: &Made| {
            let fdi = 10 * side + made.footprint.fdi % 10;
            Footprint {
                fdi,
                stance: Stance::of(fdi),
                ..made.footprint
            }
        };
        made.iter().map(of).collect()
    };
    let frames = [3, 4].map(|side| arch::quadrant(&footprints(side)));
    let sections = crate::parallel::map(made.len(), |k| {
        let (shape, low) = (&made[k].shape, base(&frames[0][k]) - 1.0);
        Sections::of(&made[k].mesh, low, shape.crown_height_mm() + 0.5)
    });
    LOWER
        .into_iter()
        .map(|fdi| {
            let k = usize::from(fdi % 10 - 1);
            let mut frame = frames[usize::from(fdi / 10 - 3)][k];
            frame.origin *= 1e-3;
            Standing {
                fdi,
                mesh: made[k].mesh.clone(),
                frame,
                shape: made[k].shape.clone(),
                contacts: made[k].footprint.contacts,
                sections: sections[k].clone(),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests;
