//! Spheres as point clouds: at rest once, then at their places while their tissue is awake.

use foxglove::messages::PointCloud;
use sulcus_core::tissue::Tissue;
use sulcus_core::{Object, SphereTree, Vec3};

use super::foxglove_types::cloud;
use super::topics::WORLD;

/// Largest number of points of one object. A finer tree is shown at a coarser level.
const MAX_POINTS: usize = 1024;
/// Steps per metre to which places are rounded: 8 um, less than a pixel when a tooth fills a screen. A power of two
/// leaves zeros in place of the dropped digits. Measured on two hands in a mouth: 4.6 MB a minute; at a micrometre 10.9
/// MB.
const STEPS_PER_M: f64 = 131_072.0;

/// Finest level up to the touched level that has few enough points.
pub(super) fn shown_level(tree: &SphereTree, touched: u8) -> u8 {
    let fits = |level: &u8| tree.shape_at(*level).count() <= MAX_POINTS;
    (0..=touched).rev().find(fits).unwrap_or(0)
}

/// Point cloud of a level's spheres at rest, with radii.
pub(super) fn at_rest(unix_ns: u64, frame: &str, tree: &SphereTree, level: u8) -> PointCloud {
    let mut data = Vec::new();
    for (_, node) in tree.shape_at(level) {
        put(&mut data, &node.centre);
        data.extend((node.contact_radius as f32).to_le_bytes());
    }
    cloud(unix_ns, frame, &["x", "y", "z", "radius"], data)
}

fn put(data: &mut Vec<u8>, centre: &Vec3) {
    for x in centre.iter() {
        let rounded = (x * STEPS_PER_M).round() / STEPS_PER_M;
        data.extend((rounded as f32).to_le_bytes());
    }
}

/// Point cloud of one tissue.
pub(super) struct Cloud {
    model: Box<dyn Tissue>,
    /// Configuration at rest: zeros.
    rest: Vec<f64>,
    ids: Vec<u32>,
    centres: Vec<Vec3>,
    /// Points of the last message.
    last: Vec<u8>,
    awake: bool,
}

impl Cloud {
    /// Cloud of an object with ticks of `tick_s` seconds; `None` for a rigid object.
    pub fn new(object: &Object, tick_s: f64) -> Option<Self> {
        let model = object.tissue.ready(&object.tree, object.level, tick_s)?;
        let level = shown_level(&object.tree, object.level);
        let ids: Vec<u32> = object.tree.shape_at(level).map(|(id, _)| id).collect();
        Some(Self {
            rest: vec![0.0; model.shape_len()],
            model,
            centres: vec![Vec3::zeros(); ids.len()],
            ids,
            last: Vec::new(),
            awake: false,
        })
    }

    /// Message for the configuration after a tick, or for sleeping tissue (`None`). No message if the points are those
    /// of the last one.
    pub fn after(&mut self, unix_ns: u64, shape: Option<&[f64]>) -> Option<PointCloud> {
        let awake = shape.is_some();
        if !awake && !self.awake {
            return None;
        }
        self.awake = awake;
        let data = self.points(shape);
        if data == self.last {
            return None;
        }
        self.last.clone_from(&data);
        Some(cloud(unix_ns, WORLD, &["x", "y", "z"], data))
    }

    fn points(&mut self, shape: Option<&[f64]>) -> Vec<u8> {
        let shape = shape.unwrap_or(&self.rest);
        self.model.centres(shape, &self.ids, &mut self.centres);
        let mut data = Vec::with_capacity(12 * self.centres.len());
        for centre in &self.centres {
            put(&mut data, centre);
        }
        data
    }
}
