//! Planes between the gingivae of neighbours: a plane through their contact point and the mean of their axes, and on it
//! a common outer face.

use sulcus_core::Vec3;

use super::standing::{JAW_TOP, Standing};
use crate::anatomy::arch::{from_world, to_world, turned, turned_back};
use crate::anatomy::collar::{Face, Neighbour, outer_face};

/// Depth of the face between two teeth, relative to the face beside them, mm. Roots stand out under the gingiva.
const DIP: f64 = 0.7;
/// Highest place of the faces, mm in the world: above every margin.
const TOP: f64 = 10.0;
/// Largest distance between the contact points of neighbours across the vertical, mm.
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
    to_world(&tooth.frame_mm(), &tooth.contacts[side])
}

/// Returns the unit vector out of a side, in the world.
fn outwards(tooth: &Standing, side: usize) -> Vec3 {
    let [mesial, distal] = tooth.contacts;
    let along = turned(&tooth.frame, &(mesial - distal));
    along.normalize() * if side == 0 { 1.0 } else { -1.0 }
}

/// Plane between two teeth, world, mm.
struct Plane {
    /// Contact point.
    at: Vec3,
    /// Unit vector up in the plane: the mean of both axes.
    up: Vec3,
    /// Unit normal, towards the neighbour.
    normal: Vec3,
    /// Unit vector across the axis in the plane, buccally.
    buccal: Vec3,
}

impl Plane {
    fn between((own, side): (&Standing, usize), (other, theirs): (&Standing, usize)) -> Self {
        let up = (own.frame.axis + other.frame.axis).normalize();
        let normal = outwards(own, side) - outwards(other, theirs);
        let normal = (normal - up * normal.dot(&up)).normalize();
        let across = up.cross(&normal);
        Self {
            at: (contact(own, side) + contact(other, theirs)) * 0.5,
            buccal: across * across.dot(&own.frame.buccal).signum(),
            up,
            normal,
        }
    }

    /// Height over the contact and distance from it of a tooth's outer face on a side (1 buccal, -1 lingual), at a
    /// height in the tooth's frame.
    fn face(&self, tooth: &Standing, wall: f64, way: f64, height: f64) -> [f64; 2] {
        let around = std::f64::consts::FRAC_PI_2 * way;
        let r = outer_face(&tooth.sections, wall, around, height);
        let off = to_world(&tooth.frame_mm(), &Vec3::new(0.0, r * way, height)) - self.at;
        [off.dot(&self.up), off.dot(&self.buccal) * way]
    }
}

fn neighbour(
    tooth: &Standing,
    side: usize,
    (other, theirs): (&Standing, usize),
    wall: f64,
) -> Neighbour {
    let plane = Plane::between((tooth, side), (other, theirs));
    let frame = tooth.frame_mm();
    let normal = turned_back(&frame, &plane.normal);
    let up = turned_back(&frame, &plane.up);
    let across = (normal.x * normal.x + normal.y * normal.y).sqrt();
    let mut found = Neighbour {
        contact: from_world(&frame, &plane.at),
        slope: [up.x / up.z, up.y / up.z],
        normal: [normal.x / across, normal.y / across],
        faces: [1.0, -1.0].map(|_| Face {
            low: 0.0,
            distance: Vec::new(),
        }),
        end: (other.fdi, theirs),
        floors: [f64::INFINITY; 2],
    };
    let count = ((TOP - JAW_TOP + 2.0 * REACH) / Face::STEP) as usize + 1;
    let low = JAW_TOP - REACH - tooth.frame.origin.z * 1e3;
    found.faces = [1.0, -1.0].map(|way| {
        let rows = |tooth: &Standing| -> Vec<[f64; 2]> {
            let low = JAW_TOP - 2.0 * REACH - tooth.frame.origin.z * 1e3;
            let heights = (0..count + 16).map(|row| low + row as f64 * Face::STEP);
            heights
                .map(|height| plane.face(tooth, wall, way, height))
                .collect()
        };
        let (own, their) = (rows(tooth), rows(other));
        // The common face, in the frame of the tooth: heights and distances from the contact.
        let common: Vec<[f64; 2]> = own
            .iter()
            .map(|[s, t]| {
                let t = 0.5 * (t + at(&their, *s)) - DIP;
                let p = plane.at + plane.up * *s + plane.buccal * (way * t);
                let p = from_world(&frame, &p);
                let [x, y] = found.contact_at(p.z);
                [p.z, ((p.x - x).powi(2) + (p.y - y).powi(2)).sqrt()]
            })
            .collect();
        let distance = (0..count).map(|row| at(&common, low + row as f64 * Face::STEP));
        Face {
            low,
            distance: distance.collect(),
        }
    });
    found
}

/// Room below the jaw's top and above [`TOP`] that leaning teeth need, mm.
const REACH: f64 = 6.0;

/// Value of a chain of places and values, ascending, at a place. Beyond the ends the end's value holds.
fn at(rows: &[[f64; 2]], place: f64) -> f64 {
    let k = rows.partition_point(|[s, _]| *s < place);
    let (Some(before), Some(after)) = (rows.get(k.wrapping_sub(1)), rows.get(k)) else {
        return rows[k.min(rows.len() - 1)][1];
    };
    let share = (place - before[0]) / (after[0] - before[0]);
    before[1] + (after[1] - before[1]) * share
}
