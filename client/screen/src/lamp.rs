//! Dental lamp: a patch of light with soft borders.
//!
//! A lamp stands some 650 mm from the mouth, beside the operator's line of sight, and lights a patch of 160 by 80 mm
//! (ISO 9680; distances chosen). Few shadows show, and the surroundings are dark.

use crate::camera::{Camera, Matrix, PassCamera, Vector};

/// Distance of the lamp from the middle of its patch, mm.
const AWAY_MM: f64 = 650.0;
/// Height of the lamp over the eye, as a share of the distance of the eye.
const OVER_EYE: f64 = 0.33;
/// Half width and half height of the patch, mm.
const PATCH_MM: [f64; 2] = [80.0, 42.0];
/// Half edge of the square that has shadows, mm.
const SHADOWS_MM: f64 = 60.0;

/// Lamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// Place of the lamp, mm.
    pub at: Vector,
    /// Middle of the patch, mm.
    pub towards: Vector,
    /// Brightness; 1 lights attached gingiva as in the reference colours.
    pub brightness: f64,
}

impl Lamp {
    /// Lamp over the eye of a camera, aimed at the middle of its glass.
    pub fn beside(camera: &Camera) -> Self {
        let (eye, towards) = (camera.eye(), camera.middle());
        let away = (eye - towards).norm();
        let from = eye + Vector::z() * (OVER_EYE * away) - towards;
        Self {
            at: towards + from.normalize() * AWAY_MM,
            towards,
            brightness: 1.0,
        }
    }

    /// The same lamp with its patch moved by a vector, mm.
    pub fn aimed(mut self, by: &Vector) -> Self {
        self.towards += by;
        self
    }

    /// Unit axis of the beam, and the horizontal unit vector across it.
    pub fn axes(&self) -> [Vector; 2] {
        let beam = (self.towards - self.at).normalize();
        let aside = if beam.z.abs() > 0.999 {
            Vector::x()
        } else {
            Vector::z()
        };
        [beam, beam.cross(&aside).normalize()]
    }

    /// Half width and half height of the patch as tangents of the beam's angles.
    pub fn tangents(&self) -> [f64; 2] {
        let away = (self.towards - self.at).norm();
        PATCH_MM.map(|half| half / away)
    }

    /// Clip space of the shadow map from world.
    pub fn shadows(&self) -> Matrix {
        let up = if self.axes()[0].z.abs() > 0.999 {
            Vector::x()
        } else {
            Vector::z()
        };
        let away = (self.towards - self.at).norm();
        let height = 2.0 * (SHADOWS_MM / away).atan().to_degrees();
        let pass: PassCamera = Camera::looking(self.at, self.towards, up, height, 1.0).pass();
        pass.matrix()
    }
}
