//! The lower dental arch: place and direction of each tooth. Neighbours touch at their contact points.
//!
//! World frame: x anterior, y to the patient's left, z up.
//!
//! Teeth are placed one after the other from the midline backwards. Each is turned until both its contact points lie
//! on the arch.
//!
//! The arch is the curve `x = front - a |y|^3`. Its width at the first molars is an adult's, about 44 mm between the
//! middles of the crowns.

use sulcus_core::Vec3;
use sulcus_core::tissue::gingiva::ToothFrame;

/// Place of the arch on the midline, mm: the labial side of the central incisors.
const FRONT: f64 = 31.0;
/// `a` of the curve, 1/mm^2.
const CURVE: f64 = 0.00262;
/// Height of the occlusal plane, mm.
pub const OCCLUSAL: f64 = 8.0;
/// Gap between the contact points of neighbours, mm: small enough to touch, large enough not to wedge.
const CONTACT_GAP: f64 = 0.04;

/// Measures of a tooth that the arch needs, mm, in the tooth's frame.
#[derive(Clone, Copy, Debug)]
pub struct Footprint {
    /// FDI number.
    pub fdi: u8,
    /// Mesial and distal contact point.
    pub contacts: [Vec3; 2],
    /// Height of the crown over the tooth's origin.
    pub crown_height: f64,
}

/// Maps a point of a tooth's frame (any unit) into the world; `frame.origin` in the same unit.
pub fn to_world(frame: &ToothFrame, p: &Vec3) -> Vec3 {
    frame.origin + turned(frame, p)
}

/// Maps a direction of a tooth's frame into the world.
pub fn turned(frame: &ToothFrame, v: &Vec3) -> Vec3 {
    frame.mesial * v.x + frame.buccal * v.y + frame.axis * v.z
}

/// Places the teeth of one side, from the midline backwards (31, 32, ... or 41, 42, ...). Returns frames with origins
/// in mm.
pub fn quadrant(teeth: &[Footprint]) -> Vec<ToothFrame> {
    let on_curve = |y: f64| [FRONT - CURVE * y * y * y, y];
    let mut frames = Vec::with_capacity(teeth.len());
    let mut from_y = 0.5 * CONTACT_GAP;
    for tooth in teeth {
        let right = tooth.fdi / 10 == 4;
        let [mesial, distal] = tooth.contacts;
        let chord = mesial - distal;
        let length = (chord.x * chord.x + chord.y * chord.y).sqrt();
        // The distal contact lies on the curve, at the tooth's own distance from the mesial one.
        let from = on_curve(from_y);
        let far = |y: f64| {
            let to = on_curve(y);
            ((to[0] - from[0]).powi(2) + (to[1] - from[1]).powi(2)).sqrt()
        };
        let (mut near, mut beyond) = (from_y, from_y + 2.0 * length + 1.0);
        for _ in 0..60 {
            let y = 0.5 * (near + beyond);
            if far(y) < length {
                near = y;
            } else {
                beyond = y;
            }
        }
        let to_y = 0.5 * (near + beyond);
        let to = on_curve(to_y);
        // The chord in the tooth is turned onto the chord in the mouth. The right side mirrors the left side.
        let (sx, sy) = ((from[0] - to[0]) / length, (from[1] - to[1]) / length);
        let (cx, cy) = (chord.x / length, chord.y / length);
        let (cosine, sine) = (sx * cx + sy * cy, sy * cx - sx * cy);
        let mirror = if right { -1.0 } else { 1.0 };
        let axes = [[cosine, sine], [-sine, cosine]].map(|[x, y]| Vec3::new(x, mirror * y, 0.0));
        let at = Vec3::new(from[0], mirror * from[1], OCCLUSAL - tooth.crown_height);
        let offset = axes[0] * mesial.x + axes[1] * mesial.y;
        frames.push(ToothFrame {
            origin: at - offset,
            axis: Vec3::z(),
            mesial: axes[0],
            buccal: axes[1],
        });
        // The next tooth begins at the gap, along the curve.
        let slope = 3.0 * CURVE * to_y * to_y;
        from_y = to_y + CONTACT_GAP / (1.0 + slope * slope).sqrt();
    }
    frames
}

#[cfg(test)]
mod tests {
    use super::*;

    fn teeth(side: u8) -> Vec<Footprint> {
        let widths = [5.0, 5.5, 7.0, 7.0, 7.0, 11.0, 10.5];
        (1..=7)
            .zip(widths)
            .map(|(k, width)| Footprint {
                fdi: 10 * side + k,
                contacts: [
                    Vec3::new(0.5 * width, 0.2, 4.0),
                    Vec3::new(-0.48 * width, -0.1, 4.0),
                ],
                crown_height: 8.0,
            })
            .collect()
    }

    #[test]
    fn neighbours_touch_and_the_right_side_is_the_mirror_image() {
        let (left, right) = (teeth(3), teeth(4));
        let (at_left, at_right) = (quadrant(&left), quadrant(&right));
        for k in 0..7 {
            let (l, r) = (&at_left[k], &at_right[k]);
            for (a, b) in [
                (l.origin, r.origin),
                (l.mesial, r.mesial),
                (l.buccal, r.buccal),
            ] {
                assert!((a - Vec3::new(b.x, -b.y, b.z)).norm() < 1e-12);
            }
            assert!(l.buccal.y > -1e-9 || k == 0, "buccal is outwards: {l:?}");
            if k > 0 {
                let mine = to_world(l, &left[k].contacts[0]);
                let before = to_world(&at_left[k - 1], &left[k - 1].contacts[1]);
                let gap = ((mine.x - before.x).powi(2) + (mine.y - before.y).powi(2)).sqrt();
                assert!((gap - CONTACT_GAP).abs() < 2e-3, "{gap}");
            }
        }
        let between = at_left[5].origin.y - at_right[5].origin.y;
        assert!((40.0..48.0).contains(&between), "{between}");
    }
}
