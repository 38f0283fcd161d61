//! View of a picture, its kind, and its work.

use crate::camera::Camera;
use crate::lamp::Lamp;

/// Kind of picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Lit picture.
    Beauty,
    /// Flat colour for each part, without light: [`super::Renderer::identity`] has the colours.
    Identity,
}

/// View of one picture.
#[derive(Clone, Copy, Debug)]
pub struct Drawing {
    /// Camera.
    pub camera: Camera,
    /// Lamp.
    pub lamp: Lamp,
    /// Fog on the glass of a mirror, 0 to 1.
    pub fog: f32,
    /// Scratches of the glass, 0 to 1.
    pub scratches: f32,
}

impl Drawing {
    /// View through a camera with the lamp beside its eye and a clean glass.
    pub fn through(camera: Camera) -> Self {
        Self {
            lamp: Lamp::beside(&camera),
            camera,
            fog: 0.0,
            scratches: 0.0,
        }
    }
}

/// Work of one picture, panel left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Calls.
    pub draws: usize,
    /// Triangles in these calls.
    pub triangles: usize,
}
