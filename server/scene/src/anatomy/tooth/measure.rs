//! Measures of a tooth, from its implicit function: contact points and furcations.

use sulcus_core::Vec3;
use sulcus_core::math::{Mat3, fmax, fmin};

use super::Tooth;

/// An entrance between two roots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Furcation {
    /// Place of its opening on the tooth: angle from mesial over buccal, radians, -pi to pi.
    pub around: f64,
    /// Height of its roof at the entrance, mm. It is negative, below the CEJ.
    pub height_mm: f64,
}

impl Tooth {
    /// Returns the mesial and the distal contact point of an upright tooth, mm: the farthest points of the crown.
    pub fn contacts(&self) -> [Vec3; 2] {
        self.contacts_leaned(&Mat3::identity())
    }

    /// Returns the mesial and the distal contact point of a tooth that leans, mm, in the tooth's frame. `leaned` turns
    /// the tooth's frame to its inclination in the mouth, where the contacts are the farthest points of the crown.
    pub fn contacts_leaned(&self, leaned: &Mat3) -> [Vec3; 2] {
        [1.0, -1.0].map(|way| contact(self, leaned, way))
    }

    /// Returns the entrances between the roots; none if there is one root.
    pub fn furcations(&self) -> Vec<Furcation> {
        if self.form().roots.is_none() {
            return Vec::new();
        }
        [1.0, -1.0]
            .into_iter()
            .map(|side| furcation(self, side))
            .collect()
    }
}

/// Returns the distance of the surface from the axis plane in the direction of `way` on a line along x of the leaned
/// tooth, mm; `None` if the line misses the tooth.
fn reach(tooth: &Tooth, leaned: &Mat3, way: f64, y: f64, z: f64) -> Option<f64> {
    let outside = 0.6 * tooth.mesiodistal_mm() + 3.0;
    let at = |x: f64| tooth.distance(&(leaned.transpose() * Vec3::new(way * x, y, z)));
    let mut out = outside;
    // The first sample inside is found from outside, then bisection follows.
    let steps = 60;
    let mut inside = None;
    for k in 1..=steps {
        let x = outside * (1.0 - f64::from(k) / f64::from(steps));
        if at(x) < 0.0 {
            inside = Some(x);
            break;
        }
        out = x;
    }
    let mut inside = inside?;
    for _ in 0..40 {
        let middle = 0.5 * (inside + out);
        if at(middle) < 0.0 {
            inside = middle;
        } else {
            out = middle;
        }
    }
    Some(0.5 * (inside + out))
}

/// Returns the farthest point of the crown of the leaned tooth towards mesial (`way` 1) or distal (-1), mm, in the
/// tooth's frame.
fn contact(tooth: &Tooth, leaned: &Mat3, way: f64) -> Vec3 {
    let crown = tooth.crown_height_mm();
    let middle = leaned * Vec3::new(0.0, 0.0, 0.55 * crown);
    let mut centre = [middle.y, middle.z];
    let mut half = [0.3 * tooth.buccolingual_mm(), 0.45 * crown];
    let mut best = (f64::NEG_INFINITY, centre);
    // A grid over the crown, then finer ones around the best place.
    for _ in 0..12 {
        for j in -6..=6_i32 {
            for k in -6..=6_i32 {
                let y = centre[0] + half[0] * f64::from(j) / 6.0;
                let z = centre[1] + half[1] * f64::from(k) / 6.0;
                if let Some(x) = reach(tooth, leaned, way, y, z)
                    && x > best.0
                {
                    best = (x, [y, z]);
                }
            }
        }
        centre = best.1;
        half = half.map(|h| 0.4 * h);
    }
    leaned.transpose() * Vec3::new(way * best.0, best.1[0], best.1[1])
}

/// Depth of an entered furcation, as a share of the way from the trunk's surface to the axis.
const ENTERED: f64 = 0.35;

/// Returns the entrance on the buccal (`side` 1) or lingual (-1) face.
fn furcation(tooth: &Tooth, side: f64) -> Furcation {
    let half = 0.5 * tooth.buccolingual_mm();
    let lowest = -0.7 * tooth.root_length_mm();
    let mut found = (f64::NEG_INFINITY, 0.0, half);
    // Vertical lines between the roots, at the depth of an entrance, up to the roof.
    let y = side * half * 0.86 * (1.0 - ENTERED);
    for k in -20..=20_i32 {
        let x = 0.1 * tooth.mesiodistal_mm() * f64::from(k) / 20.0;
        let at = |z: f64| tooth.distance(&Vec3::new(x, y, z));
        if at(lowest) < 0.0 {
            continue;
        }
        let (mut free, mut z) = (lowest, lowest);
        while z < 0.0 && at(z) >= 0.0 {
            free = z;
            z += 0.05;
        }
        let (mut low, mut high) = (free, fmin(free + 0.05, 0.0));
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if at(middle) >= 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        if low > found.0 {
            found = (low, x, fmax(y.abs(), 1e-9));
        }
    }
    Furcation {
        around: libm::atan2(side * found.2, found.1),
        height_mm: found.0,
    }
}
