//! Ways of the probe into the pocket of tooth 36: along the tooth's wall, clear of the teeth by their meshes, with as little
//! tissue in the way as may be.

use sulcus_cases::pocket::Way;
use sulcus_core::math::exp_rotation;
use sulcus_core::tissue::gingiva::ToothFrame;
use sulcus_core::{Scene, Vec3};
use sulcus_scene::mesh::distance::MeshDistance;

use super::scene::gingiva;

/// Radius of the tip, how much the working end widens, and how far it stays from teeth, metres.
const TIP: f64 = 2.5e-4;
const TAPER: f64 = 0.015;
const SPARE: f64 = 2e-5;
/// Points along the working end, and their distance.
const ALONG: usize = 32;
const APART: f64 = 5e-4;
/// Heights over the floor for which the way is laid, and their distance.
const HEIGHTS: usize = 17;
const RISE: f64 = 5e-4;
/// What a degree away from the direction below counts, metres of tissue.
const STEADY: f64 = 4e-6;

/// The tip's place and the direction up the working end at each height over the floor, at one angle.
#[derive(Clone)]
pub struct Descent {
    outward: Vec3,
    tangent: Vec3,
    steps: Vec<(Vec3, Vec3)>,
}

/// A mouth to go into.
pub struct Site<'a> {
    pub frame: ToothFrame,
    /// The tooth that is probed comes first.
    pub teeth: Vec<&'a MeshDistance>,
    pub tissue: &'a MeshDistance,
    /// Height of the floor over the frame's origin.
    pub floor: f64,
}

impl<'a> Site<'a> {
    pub fn new(
        scene: &Scene,
        teeth: Vec<&'a MeshDistance>,
        tissue: &'a MeshDistance,
        floor: f64,
    ) -> Self {
        Self {
            frame: gingiva(scene).tooth,
            teeth,
            tissue,
            floor,
        }
    }

    /// The way down at an angle.
    pub fn descent(&self, degrees: f64) -> Descent {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let frame = &self.frame;
        let outward = frame.mesial * cosine + frame.buccal * sine;
        let tangent = frame.buccal * cosine - frame.mesial * sine;
        let mut last: Option<Vec3> = None;
        let mut steps: Vec<(Vec3, Vec3)> = Vec::new();
        for k in 0..HEIGHTS {
            let height = frame.axis * (self.floor + TIP + SPARE + RISE * k as f64);
            // The tip's centre, from outside inwards.
            let mut along = 0.02;
            let centre = |along: f64| frame.origin + outward * along + height;
            for _ in 0..300 {
                along -= self.teeth[0].signed(&centre(along)) - TIP - SPARE;
            }
            let centre = centre(along.max(0.0));
            let step = match (self.up(&centre, &outward, last), steps.last()) {
                (Some(up), _) => (centre - up * TIP, up),
                // Between two crowns there is no place higher up the wall: straight on.
                (None, Some((tip, up))) => (tip + up * RISE, *up),
                (None, None) => panic!("no way at {degrees} degrees is clear of the teeth"),
            };
            last = Some(step.1);
            steps.push(step);
        }
        Descent {
            outward,
            tangent,
            steps,
        }
    }

    /// The direction up the working end from a tip's centre: clear of the teeth, with the least tissue in its way; none where no
    /// direction is clear.
    fn up(&self, centre: &Vec3, outward: &Vec3, last: Option<Vec3>) -> Option<Vec3> {
        let axis = self.frame.axis;
        let mut best = (f64::INFINITY, axis);
        for out in -12..=12 {
            for side in -8..=8 {
                let lean =
                    outward.cross(&-axis) * f64::from(3 * out) + outward * f64::from(3 * side);
                let up = exp_rotation(&(lean * 1_f64.to_radians())) * axis;
                let places = (0..ALONG).map(|k| {
                    let s = APART * k as f64;
                    (centre + up * s, TIP + TAPER * s)
                });
                let (mut tooth, mut tissue) = (f64::INFINITY, 0.0_f64);
                for (point, radius) in places {
                    let clear = self.teeth.iter().map(|tooth| tooth.signed(&point));
                    tooth = tooth.min(clear.fold(f64::INFINITY, f64::min) - radius);
                    tissue = tissue.max(radius - self.tissue.signed(&point));
                }
                if tooth < 0.5 * SPARE {
                    continue;
                }
                let turned = last.map_or(0.0, |last| up.angle(&last).to_degrees());
                let upright = up.angle(&axis).to_degrees();
                let cost = tissue + STEADY * (turned + 0.2 * upright);
                if cost < best.0 {
                    best = (cost, up);
                }
            }
        }
        best.0.is_finite().then_some(best.1)
    }
}

impl Descent {
    /// The way whose floor is where the tip is `above` metres over the floor, pressed into it where that is negative.
    pub fn at(&self, above: f64) -> Way {
        let at = above.max(0.0) / RISE;
        let k = (at as usize).min(HEIGHTS - 2);
        let share = (at - k as f64).min(1.0);
        let ((a, up_a), (b, up_b)) = (self.steps[k], self.steps[k + 1]);
        let up = (up_a + (up_b - up_a) * share).normalize();
        // Beyond the ends it goes straight on.
        let beyond = above.min(0.0) + (above - RISE * (HEIGHTS - 1) as f64).max(0.0);
        Way {
            floor: a + (b - a) * share + up * beyond,
            up,
            outward: self.outward,
            tangent: self.tangent,
        }
    }
}

/// Between two ways.
pub fn between(a: &Way, b: &Way, share: f64) -> Way {
    let mix = |a: &Vec3, b: &Vec3| a + (b - a) * share;
    Way {
        floor: mix(&a.floor, &b.floor),
        up: mix(&a.up, &b.up).normalize(),
        outward: mix(&a.outward, &b.outward).normalize(),
        tangent: mix(&a.tangent, &b.tangent).normalize(),
    }
}
