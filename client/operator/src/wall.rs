//! Surface of a tooth for a probe's tip, sounded with rays from the tooth's axis.

use sulcus_core::tissue::gingiva::ToothFrame;
use sulcus_core::{Object, Sphere, Vec3};

use crate::sounding::first_touch;

/// Number of angles of the table.
const ANGLES: usize = 120;
/// Angle between two rays, radians.
const STEP: f64 = std::f64::consts::TAU / ANGLES as f64;
/// Height between two rows, metres.
const HEIGHT_STEP: f64 = 0.25e-3;

/// Table of the distance from the tooth's axis at which the centre of the tip's ball touches the tooth.
///
/// Grooves and furcations are bridged: a probe along the tooth passes over them.
#[derive(Clone, Debug)]
pub(crate) struct Wall {
    frame: ToothFrame,
    /// Lowest height of the table, along the axis over the frame's origin, metres.
    bottom: f64,
    /// Distance, metres, by height above `bottom` and by angle from mesial over buccal.
    radius: Vec<Vec<f64>>,
}

impl Wall {
    /// Table of `tooth` for a ball of radius `tip`, metres.
    pub fn of(tooth: &Object, frame: &ToothFrame, tip: f64) -> Self {
        let spheres: Vec<_> = tooth
            .tree
            .shape_at(tooth.level)
            .map(|(_, node)| node.sphere())
            .collect();
        let height = |centre: &Vec3| (centre - frame.origin).dot(&frame.axis);
        let (low, high) =
            spheres
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| {
                    let z = height(&s.centre);
                    (low.min(z - s.radius), high.max(z + s.radius))
                });
        let rows = ((high - low) / HEIGHT_STEP).ceil() as usize + 1;
        let mut wall = Self {
            frame: *frame,
            bottom: low,
            radius: Vec::new(),
        };
        wall.radius = (0..rows)
            .map(|row| {
                let centre = frame.origin + frame.axis * (low + row as f64 * HEIGHT_STEP);
                let sounded: Vec<f64> = (0..ANGLES)
                    .map(|k| {
                        let out = wall.outward(k as f64 * STEP);
                        let touches =
                            |s: &Sphere| first_touch(&centre, &out, &s.centre, s.radius + tip);
                        spheres.iter().filter_map(touches).fold(0.0, f64::max)
                    })
                    .collect();
                bridged(&sounded)
            })
            .collect();
        wall
    }

    /// Unit vector away from the axis at an angle, radians from mesial over buccal.
    pub fn outward(&self, around: f64) -> Vec3 {
        self.frame.mesial * libm::cos(around) + self.frame.buccal * libm::sin(around)
    }

    /// Height of the highest row over the frame's origin, metres: at the highest cusp or less than a row's step above
    /// it.
    pub fn top(&self) -> f64 {
        self.bottom + (self.radius.len() - 1) as f64 * HEIGHT_STEP
    }

    /// Distance from the axis, metres, at an angle and a height over the frame's origin; beyond the rows, that of the
    /// last row.
    pub fn radius_at(&self, around: f64, height: f64) -> f64 {
        let at = (around / std::f64::consts::TAU).rem_euclid(1.0) * ANGLES as f64;
        let (k, f) = (at.floor() as usize % ANGLES, at - at.floor());
        let rows = self.radius.len();
        let row = ((height - self.bottom) / HEIGHT_STEP).clamp(0.0, (rows - 1) as f64);
        let (r, g) = (row.floor() as usize, row - row.floor());
        let round = |row: &[f64]| row[k] * (1.0 - f) + row[(k + 1) % ANGLES] * f;
        round(&self.radius[r]) * (1.0 - g) + round(&self.radius[(r + 1).min(rows - 1)]) * g
    }
}

/// Convex outline of a section: at each angle the nearest tangent line with the whole section on one side.
fn bridged(radius: &[f64]) -> Vec<f64> {
    let apart = |a: usize, b: usize| libm::cos((a as f64 - b as f64) * STEP);
    let reach: Vec<f64> = (0..ANGLES)
        .map(|k| {
            let along = radius.iter().enumerate().map(|(j, r)| r * apart(k, j));
            along.fold(0.0, f64::max)
        })
        .collect();
    (0..ANGLES)
        .map(|k| {
            let lines = reach
                .iter()
                .enumerate()
                .map(|(j, reach)| (reach, apart(k, j)));
            let facing = lines.filter(|(_, cosine)| *cosine > 0.2);
            facing.fold(f64::INFINITY, |least, (reach, cosine)| {
                least.min(reach / cosine)
            })
        })
        .collect()
}
