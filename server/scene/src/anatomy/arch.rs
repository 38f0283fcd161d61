//! The lower dental arch: place and direction of each tooth. Neighbours touch at their contact points.
//!
//! World frame: x anterior, y to the patient's left, z up.
//!
//! Teeth are placed one after the other from the midline backwards. Each leans by its own angles, and is turned until
//! both its contact points lie over the arch. Its height follows the curve of Spee.
//!
//! The arch is the curve `x = front - a |y|^3`. Its width at the first molars is an adult's, about 44 mm between the
//! middles of the crowns.

use sulcus_core::Vec3;
use sulcus_core::math::Mat3;
use sulcus_core::tissue::gingiva::ToothFrame;

/// Place of the arch on the midline, mm: the labial side of the central incisors.
const FRONT: f64 = 31.0;
/// `a` of the curve, 1/mm^2.
const CURVE: f64 = 0.00262;
/// Height of the occlusal plane, mm. The curve of Spee lies on both sides of this plane.
pub const OCCLUSAL: f64 = 8.0;
/// Gap between the contact points of neighbours, mm: small enough to touch, large enough not to wedge.
const CONTACT_GAP: f64 = 0.04;

/// Inclination of a tooth in the mouth, and its place on the curve of Spee.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stance {
    /// Mesial tip of the whole tooth: the crown stands mesially of the root, degrees.
    pub tip_deg: f64,
    /// Faciolingual lean of the whole tooth: the crown stands outwards of the root, degrees.
    pub lean_deg: f64,
    /// Rotation about the vertical: the distal end turns towards the tongue, degrees. Slight disorder.
    pub turn_deg: f64,
    /// Height of the highest cusp or of the incisal edge over the occlusal plane, mm.
    pub height_mm: f64,
}

/// Stances of the teeth from the midline backwards, 31 to 37. Those of 41 to 47 are mirror images, in front with slight
/// disorder.
///
/// Sources of tip and lean: Tong 2012 (near-normal occlusion, computed tomography) for 31, 35 and 37, Ashfaq 2023
/// (doi:10.25301/JPDA.324) for 36, Li 2022 (doi:10.3390/jcm11226629) for 37, values between them for the others. The
/// planes of reference of these papers differ by up to 5 degrees; the stances lie within 5 degrees of the means.
///
/// The heights give a curve of Spee of 2 mm, deepest at the mesiobuccal cusp of 36 (Marshall 2008,
/// doi:10.1016/j.ajodo.2006.10.037), with the marginal ridges of neighbours level. Turns and steps of height are
/// chosen.
pub const STANCES: [Stance; 7] = [
    stance(0.0, 25.5, 1.5, 2.05),
    stance(0.5, 23.0, -2.5, 1.8),
    stance(4.0, 11.0, 2.0, 1.65),
    stance(5.0, 4.0, -1.5, 0.1),
    stance(7.0, -3.8, 1.5, -0.05),
    stance(9.0, -11.0, 0.0, 0.18),
    stance(12.7, -12.0, 0.0, 1.6),
];

/// Differences of 41, 42 and 43 from the left side: turn, degrees, and height, mm. No mouth is symmetric. Chosen within
/// the 3 degrees and 0.3 mm of slight disorder.
const DISORDER: [[f64; 2]; 3] = [[-3.5, -0.25], [3.5, 0.15], [-1.0, -0.1]];

const fn stance(tip_deg: f64, lean_deg: f64, turn_deg: f64, height_mm: f64) -> Stance {
    Stance {
        tip_deg,
        lean_deg,
        turn_deg,
        height_mm,
    }
}

impl Stance {
    /// Stance of a lower tooth by its FDI number, 31 to 37 or 41 to 47. An unknown number stands upright.
    pub fn of(fdi: u8) -> Self {
        let kind = usize::from(fdi % 10).wrapping_sub(1);
        let Some(stance) = STANCES.get(kind) else {
            return stance(0.0, 0.0, 0.0, 0.0);
        };
        let [turn_deg, height_mm] = DISORDER
            .get(kind)
            .filter(|_| fdi / 10 == 4)
            .copied()
            .unwrap_or([0.0; 2]);
        Self {
            turn_deg: stance.turn_deg + turn_deg,
            height_mm: stance.height_mm + height_mm,
            ..*stance
        }
    }

    /// Rotation from the tooth's frame to its inclination: x mesial, y buccal and z up in the mouth.
    pub fn leaned(&self) -> Mat3 {
        let (s, c) = sine_cosine(self.tip_deg);
        let tipped = Mat3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c);
        let (s, c) = sine_cosine(self.lean_deg);
        let outwards = Mat3::new(1.0, 0.0, 0.0, 0.0, c, s, 0.0, -s, c);
        outwards * tipped
    }
}

fn sine_cosine(degrees: f64) -> (f64, f64) {
    let angle = degrees.to_radians();
    (libm::sin(angle), libm::cos(angle))
}

/// Measures of a tooth that the arch needs, mm.
#[derive(Clone, Copy, Debug)]
pub struct Footprint {
    /// FDI number.
    pub fdi: u8,
    /// Inclination and height.
    pub stance: Stance,
    /// Mesial and distal contact point of the leaned tooth, in the tooth's frame.
    pub contacts: [Vec3; 2],
    /// Height of the leaned tooth's highest point over its origin.
    pub top: f64,
}

/// Maps a point of a tooth's frame (any unit) into the world; `frame.origin` in the same unit.
pub fn to_world(frame: &ToothFrame, p: &Vec3) -> Vec3 {
    frame.origin + turned(frame, p)
}

/// Maps a direction of a tooth's frame into the world.
pub fn turned(frame: &ToothFrame, v: &Vec3) -> Vec3 {
    frame.mesial * v.x + frame.buccal * v.y + frame.axis * v.z
}

/// Maps a point of the world (any unit) into a tooth's frame; `frame.origin` in the same unit.
pub fn from_world(frame: &ToothFrame, p: &Vec3) -> Vec3 {
    turned_back(frame, &(p - frame.origin))
}

/// Maps a direction of the world into a tooth's frame.
pub fn turned_back(frame: &ToothFrame, v: &Vec3) -> Vec3 {
    Vec3::new(
        v.dot(&frame.mesial),
        v.dot(&frame.buccal),
        v.dot(&frame.axis),
    )
}

/// Places the teeth of one side, from the midline backwards (31, 32, ... or 41, 42, ...). Returns frames with origins
/// in mm.
pub fn quadrant(teeth: &[Footprint]) -> Vec<ToothFrame> {
    let on_curve = |y: f64| [FRONT - CURVE * y * y * y, y];
    let mut frames = Vec::with_capacity(teeth.len());
    let mut from_y = 0.5 * CONTACT_GAP;
    for tooth in teeth {
        let right = tooth.fdi / 10 == 4;
        let leaned = tooth.stance.leaned();
        let [mesial, distal] = tooth.contacts.map(|contact| leaned * contact);
        let chord = mesial - distal;
        let length = (chord.x * chord.x + chord.y * chord.y).sqrt();
        // The distal contact lies over the curve, at the tooth's own distance from the mesial one.
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
        let onto = Mat3::new(cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0);
        // The disorder turns about the middle between both contacts.
        let (s, c) = sine_cosine(tooth.stance.turn_deg);
        let disorder = Mat3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
        let middle = Vec3::new(0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1]), 0.0);
        let turn = disorder * onto;
        let mut offset = turn * ((mesial + distal) * 0.5);
        offset.z = tooth.top;
        let mirrored = |v: Vec3| if right { Vec3::new(v.x, -v.y, v.z) } else { v };
        let up = Vec3::z() * (OCCLUSAL + tooth.stance.height_mm);
        let axes = (turn * leaned)
            .column_iter()
            .map(|axis| mirrored(axis.into()))
            .collect::<Vec<Vec3>>();
        frames.push(ToothFrame {
            origin: mirrored(middle + up - offset),
            axis: axes[2],
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
                stance: Stance {
                    turn_deg: 0.0,
                    ..STANCES[usize::from(k) - 1]
                },
                contacts: [
                    Vec3::new(0.5 * width, 0.2, 4.0),
                    Vec3::new(-0.48 * width, -0.1, 4.0),
                ],
                top: 8.0,
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
                (l.axis, r.axis),
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

    #[test]
    fn an_axis_leans_by_its_tip_mesially_and_by_its_lean_outwards() {
        for (k, frame) in quadrant(&teeth(3)).iter().enumerate() {
            let stance = STANCES[k];
            let along = Vec3::new(frame.mesial.x, frame.mesial.y, 0.0).normalize();
            let out = Vec3::new(-along.y, along.x, 0.0) * along.cross(&frame.buccal).z.signum();
            let tip = libm::atan2(frame.axis.dot(&along), frame.axis.z).to_degrees();
            let lean = libm::atan2(frame.axis.dot(&out), frame.axis.z).to_degrees();
            assert!((tip - stance.tip_deg).abs() < 1.5, "{tip} {stance:?}");
            assert!((lean - stance.lean_deg).abs() < 1.5, "{lean} {stance:?}");
            let p = Vec3::new(1.0, 2.0, 3.0);
            assert!((from_world(frame, &to_world(frame, &p)) - p).norm() < 1e-12);
        }
    }
}
