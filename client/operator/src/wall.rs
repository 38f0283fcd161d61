//! The surface of a tooth as a probe's tip feels it, sounded with rays from the tooth's axis.

use sulcus_core::tissue::gingiva::ToothFrame;
use sulcus_core::{Object, Vec3};

use crate::sounding::first_touch;

/// Angles and heights at which the tooth is sounded.
const ANGLES: usize = 120;
const HEIGHT_STEP: f64 = 0.25e-3;
/// Steepest that the way goes inwards on the way down, metres per metre: a probe held along the root passes over the
/// entrance of a furcation.
const INWARDS: f64 = 0.6;

/// Distance from the axis at which the middle of the tip's ball touches the tooth.
#[derive(Clone, Debug)]
pub(crate) struct Wall {
    frame: ToothFrame,
    /// Lowest height sounded, along the axis over the frame's origin, metres.
    bottom: f64,
    /// By angle from mesial over buccal, and height above `bottom`.
    radius: Vec<Vec<f64>>,
}

impl Wall {
    /// Sounds `tooth` with a ball of radius `tip`, metres.
    pub fn of(tooth: &Object, frame: &ToothFrame, tip: f64) -> Self {
        let spheres: Vec<_> = tooth
            .tree
            .shape_at(tooth.level)
            .map(|(_, node)| node.sphere())
            .collect();
        let height = |centre: &Vec3| (centre - frame.origin).dot(&frame.axis);
        let (low, high) = spheres.iter().fold(
            (f64::INFINITY, f64::NEG_INFINITY),
            |(low, high), s| {
                let z = height(&s.centre);
                (low.min(z - s.radius), high.max(z + s.radius))
            },
        );
        let rows = ((high - low) / HEIGHT_STEP).ceil() as usize + 1;
        let mut wall = Self {
            frame: *frame,
            bottom: low,
            radius: Vec::with_capacity(ANGLES),
        };
        for k in 0..ANGLES {
            let out = wall.outward(k as f64 * std::f64::consts::TAU / ANGLES as f64);
            let mut column: Vec<f64> = (0..rows)
                .map(|row| {
                    let centre = frame.origin + frame.axis * (low + row as f64 * HEIGHT_STEP);
                    let touches = |s: &sulcus_core::Sphere| {
                        first_touch(&centre, &out, &s.centre, s.radius + tip)
                    };
                    spheres.iter().filter_map(touches).fold(0.0, f64::max)
                })
                .collect();
            for row in (0..rows - 1).rev() {
                column[row] = column[row].max(column[row + 1] - INWARDS * HEIGHT_STEP);
            }
            wall.radius.push(column);
        }
        wall
    }

    /// Unit vector away from the axis at an angle.
    pub fn outward(&self, around: f64) -> Vec3 {
        self.frame.mesial * libm::cos(around) + self.frame.buccal * libm::sin(around)
    }

    /// Height of the highest cusp over the frame's origin, metres.
    pub fn top(&self) -> f64 {
        self.bottom + (self.radius[0].len() - 1) as f64 * HEIGHT_STEP
    }

    /// Distance from the axis at an angle and a height over the frame's origin.
    pub fn radius_at(&self, around: f64, height: f64) -> f64 {
        let at = (around / std::f64::consts::TAU).rem_euclid(1.0) * ANGLES as f64;
        let (k, f) = (at.floor() as usize % ANGLES, at - at.floor());
        let rows = self.radius[0].len();
        let row = ((height - self.bottom) / HEIGHT_STEP).clamp(0.0, (rows - 1) as f64);
        let (r, g) = (row.floor() as usize, row - row.floor());
        let up = |column: &[f64]| column[r] * (1.0 - g) + column[(r + 1).min(rows - 1)] * g;
        up(&self.radius[k]) * (1.0 - f) + up(&self.radius[(k + 1) % ANGLES]) * f
    }
}
