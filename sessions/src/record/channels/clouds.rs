//! Spheres as point clouds: at rest once, then at their places while their tissue is awake.

use foxglove::messages::PointCloud;
use sulcus_core::{SphereTree, Vec3};

use super::foxglove_types::cloud;
use super::moved::MovedTissue;
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
#[derive(Default)]
pub(super) struct Cloud {
    /// Points of the last message.
    last: Vec<u8>,
    awake: bool,
}

impl Cloud {
    /// Message for the tissue after a copy of its shape. No message if the points are those of the last one.
    pub fn after(&mut self, unix_ns: u64, tissue: &MovedTissue) -> Option<PointCloud> {
        let awake = tissue.is_awake();
        if !awake && !self.awake {
            return None;
        }
        self.awake = awake;
        let mut data = Vec::with_capacity(12 * tissue.shown().len());
        for centre in tissue.shown() {
            put(&mut data, centre);
        }
        if data == self.last {
            return None;
        }
        self.last.clone_from(&data);
        Some(cloud(unix_ns, WORLD, &["x", "y", "z"], data))
    }
}
