//! Blocks of constants that the shaders read. The order of the fields is that of the structures in the shaders.

use bytemuck::{Pod, Zeroable};
use nalgebra::Matrix4;

use crate::camera::{Matrix, PassCamera, Vector};
use crate::lamp::Lamp;
use crate::material::Material;
use crate::mirror::Window;
use crate::quality::Looks;

/// Distance between two blocks of one buffer, bytes: the alignment that every adapter accepts.
pub(super) const STRIDE: u64 = 256;
/// Light of the lamp over the reference, so that lit gingiva has its reference colour.
const EXPOSURE: f32 = 1.0;
/// Brightness of the key light.
const KEY: f32 = 1.25;

/// Constants of a pass.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct PassBlock {
    camera: [[f32; 4]; 4],
    lamp: [[f32; 4]; 4],
    eye: [f32; 4],
    light: [f32; 4],
    beam: [f32; 4],
    patch_axis: [f32; 4],
    looks: [f32; 4],
}

impl PassBlock {
    pub fn new(camera: &PassCamera, lamp: &Lamp, looks: &Looks, is_coded: bool) -> Self {
        let [beam, across] = lamp.axes();
        let [wide, high] = lamp.tangents();
        let texel = if looks.shadow > 0 {
            1.0 / looks.shadow as f32
        } else {
            0.0
        };
        let relief = if looks.relief { 1.0 } else { 0.0 };
        Self {
            camera: columns(&camera.matrix()),
            lamp: columns(&lamp.shadows()),
            eye: with(&camera.eye, texel),
            light: with(&lamp.at, KEY * lamp.brightness as f32),
            beam: with(&beam, wide as f32),
            patch_axis: with(&across, high as f32),
            looks: [
                relief,
                EXPOSURE,
                f32::from(u8::from(is_coded)),
                looks.roughness,
            ],
        }
    }
}

/// Constants of a part.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct PartBlock {
    world: [[f32; 4]; 4],
    material: [f32; 4],
    identity: [f32; 4],
    materials: [[f32; 4]; Material::ALL.len()],
}

impl PartBlock {
    pub fn new(world: &Matrix4<f32>, material: Material, identity: [f32; 4]) -> Self {
        let values = |material: Material| {
            let [r, g, b] = material.wrap();
            [r, g, b, material.reflectance()]
        };
        Self {
            world: (*world).into(),
            material: values(material),
            identity,
            materials: Material::ALL.map(values),
        }
    }
}

/// Constants of a glass.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(super) struct GlassBlock {
    pub camera: [[f32; 4]; 4],
    pub world: [[f32; 4]; 4],
    pub window: [f32; 4],
    pub centre: [f32; 4],
    pub normal: [f32; 4],
    pub looks: [f32; 4],
    pub used: [f32; 4],
    pub clean: [f32; 4],
}

/// Window as one vector: middle, then half size.
pub(super) fn window(window: &Window) -> [f32; 4] {
    let [x, y] = window.middle;
    let [w, h] = window.half;
    [x, y, w, h].map(|v| v as f32)
}

/// Columns of a matrix in the precision of the shaders.
pub(super) fn columns(matrix: &Matrix) -> [[f32; 4]; 4] {
    matrix.map(|x| x as f32).into()
}

fn with(v: &Vector, last: f32) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, last]
}
