//! Pictures of meshes in pages, drawn by the processor, and the colours of errors.

mod camera;
mod colour;
mod field;
mod image;
mod raster;
mod scale;
mod scene;
pub(crate) mod text;
mod whole;

pub(crate) use camera::{Camera, MOUTH, SIDES};
pub(crate) use colour::{GREY, diverging, hex, ivory};
pub(crate) use image::{Image, data_uri};
pub(crate) use raster::{Fragments, draw_mesh};
pub(crate) use scale::Scale;
pub(crate) use scene::Still;
pub use whole::{mouth_picture, mouth_sides};
