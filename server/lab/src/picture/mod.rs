//! Small pictures of meshes and spheres, drawn by the processor: what a report shows.

mod camera;
mod colour;
mod field;
mod image;
mod raster;
mod scene;
pub(crate) mod text;

pub(crate) use camera::{Camera, MOUTH, SIDES};
pub(crate) use colour::{GREY, diverging, hex, ivory};
pub(crate) use image::{Image, data_uri};
pub(crate) use raster::{Fragments, draw_mesh, draw_spheres};
pub(crate) use scene::Still;
