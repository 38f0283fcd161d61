//! Planes between the gingivae of neighbours: a plane through their contact point, and on it a common outer face.

use sulcus_core::Vec3;

use super::standing::{JAW_TOP, Standing};
use crate::anatomy::arch::{to_world, turned};
use crate::anatomy::collar::{Face, Neighbour, outer_face};

/// Depth of the face between two teeth, relative to the face beside them, mm. Roots stand out under the gingiva.
const DIP: f64 = 0.7;
/// Highest place of the faces, mm: above every margin.
const TOP: f64 = 8.0;
/// Largest distance between the contact points of neighbours, mm.
const NEAR: f64 = 1.0;

/// Mesial and distal neighbour of the tooth at `k`, in its frame.
pub(super) fn neighbours(all: &[Standing], k: usize, wall: f64) -> [Option<Neighbour>; 2] {
    [0, 1].map(|side| {
        let own = contact(&all[k], side);
        // The next tooth on the arch stands beside this one in the list. Its side here is found by distance.
        let beside = [k.wrapping_sub(1), k + 1];
        let found = beside
            .into_iter()
            .filter_map(|j| Some((j, all.get(j)?)))
            .flat_map(|(_, other)| [(other, 0), (other, 1)])
            .find(|(other, theirs)| (contact(other, *theirs) - own).xy().norm() < NEAR)?;
        Some(neighbour(&all[k], side, found, wall))
    })
}

/// Contact point of a side (0 mesial, 1 distal) in the world, mm.
fn contact(tooth: &Standing, side: usize) -> Vec3 {
    let mut frame = tooth.frame;
    frame.origin *= 1e3;
    to_world(&frame, &tooth.contacts[side])
}

/// Returns the unit vector out of a side, in the world.
fn outwards(tooth: &Standing, side: usize) -> Vec3 {
    let [mesial, distal] = tooth.contacts;
    let mut along = turned(&tooth.frame, &(mesial - distal));
    along.z = 0.0;
    along.normalize() * if side == 0 { 1.0 } else { -1.0 }
}

fn neighbour(
    tooth: &Standing,
    side: usize,
    (other, theirs): (&Standing, usize),
    wall: f64,
) -> Neighbour {
    let at = (contact(tooth, side) + contact(other, theirs)) * 0.5;
    let normal = (outwards(tooth, side) - outwards(other, theirs)).normalize();
    let buccal = {
        let across = Vec3::new(-normal.y, normal.x, 0.0);
        across * across.dot(&tooth.frame.buccal).signum()
    };
    let count = ((TOP - JAW_TOP) / Face::STEP) as usize + 4;
    let low = JAW_TOP - 1.0;
    let faces = [1.0, -1.0].map(|way| {
        let along = buccal * way;
        let distance = (0..count)
            .map(|row| {
                let z = low + row as f64 * Face::STEP;
                let of = |tooth: &Standing| {
                    let around = std::f64::consts::FRAC_PI_2 * way;
                    let height = z - tooth.frame.origin.z * 1e3;
                    let r = outer_face(&tooth.sections, wall, around, height);
                    let middle = tooth.frame.origin * 1e3 + tooth.frame.buccal * (r * way);
                    (middle - at).dot(&along)
                };
                0.5 * (of(tooth) + of(other)) - DIP
            })
            .collect();
        Face {
            low: low - tooth.frame.origin.z * 1e3,
            distance,
        }
    });
    // To the tooth's frame.
    let own = |v: &Vec3| [v.dot(&tooth.frame.mesial), v.dot(&tooth.frame.buccal)];
    Neighbour {
        contact: own(&(at - tooth.frame.origin * 1e3)),
        normal: own(&normal),
        faces,
        end: (other.fdi, theirs),
        floors: [f64::INFINITY; 2],
    }
}
