//! A part of space with a higher weight: the builder puts more samples there, and a report measures it separately.
//!
//! Examples are the pocket walls of a gingiva, which lie near its tooth, and a tip, which is a ball.

use std::sync::Arc;

use sulcus_core::Vec3;
use sulcus_core::math::{fmax, fmin};

use crate::mesh::distance::MeshDistance;

/// A simple region, in the frame of the mesh. Its border belongs to it.
#[derive(Clone, Debug)]
pub enum Region {
    /// A ball.
    Ball {
        /// Centre, metres.
        centre: Vec3,
        /// Radius, metres.
        radius: f64,
    },
    /// All points at most this far from the *surface* of another mesh, inside or outside.
    Near {
        /// The other mesh, in the same frame.
        mesh: Arc<MeshDistance>,
        /// Largest distance, metres.
        within: f64,
    },
    /// A box along the axes.
    Box {
        /// Lowest corner, metres.
        low: Vec3,
        /// Highest corner, metres.
        high: Vec3,
    },
}

/// An intersection of regions: a point is in the zone if it is in every region.
#[derive(Clone, Debug)]
pub struct Zone {
    /// Name of the zone in reports.
    pub name: String,
    /// The regions; an empty list is all of space.
    pub regions: Vec<Region>,
}

impl Region {
    /// Returns a number, metres, that is at most 0 exactly inside the region.
    ///
    /// The number changes by no more than the distance moved. A ball about `p` with a smaller radius therefore contains
    /// no point of the region.
    pub fn beyond(&self, p: &Vec3) -> f64 {
        match self {
            Region::Ball { centre, radius } => (p - centre).norm() - radius,
            Region::Near { mesh, within } => mesh.signed(p).abs() - within,
            Region::Box { low, high } => (0..3).fold(f64::NEG_INFINITY, |most, axis| {
                fmax(most, fmax(low[axis] - p[axis], p[axis] - high[axis]))
            }),
        }
    }
}

impl Zone {
    /// Returns whether a point (metres) is in the zone.
    pub fn contains(&self, p: &Vec3) -> bool {
        self.regions.iter().all(|region| region.beyond(p) <= 0.0)
    }

    /// Returns [`Region::beyond`] of all regions together.
    pub fn beyond(&self, p: &Vec3) -> f64 {
        self.regions.iter().fold(f64::NEG_INFINITY, |most, region| {
            fmax(most, region.beyond(p))
        })
    }
}

/// Distance outside of a zone over which its weight fades to 1, metres. A sharp border through a sphere's patch of
/// surface would leave half of that sphere poorly fitted.
const FADE: f64 = 1e-3;

/// Returns the weight of a surface point (metres) in the building of a tree: `weight` inside a zone, fading to 1
/// around it.
pub fn importance(zones: &[Zone], weight: f64, p: &Vec3) -> f64 {
    let nearest = zones
        .iter()
        .fold(f64::INFINITY, |near, zone| fmin(near, zone.beyond(p)));
    libm::pow(weight, (1.0 - nearest / FADE).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes::cuboid;
    use crate::random::Random;

    fn regions() -> [Region; 3] {
        [
            Region::Ball {
                centre: Vec3::new(0.001, 0.0, 0.0),
                radius: 0.002,
            },
            Region::Near {
                mesh: Arc::new(MeshDistance::new(cuboid(Vec3::repeat(0.002)))),
                within: 0.0005,
            },
            Region::Box {
                low: Vec3::new(-0.001, -0.002, -0.003),
                high: Vec3::new(0.003, 0.002, 0.001),
            },
        ]
    }

    #[test]
    fn each_region_holds_what_it_says() {
        let [ball, near, cube] = regions();
        let inside = |region: &Region, x, y, z| region.beyond(&Vec3::new(x, y, z)) <= 0.0;
        assert!(inside(&ball, 0.003, 0.0, 0.0) && !inside(&ball, 0.0, 0.002, 0.0));
        assert!(inside(&near, 0.0024, 0.0, 0.0) && inside(&near, 0.0016, 0.0, 0.0));
        assert!(!inside(&near, 0.0, 0.0, 0.0) && !inside(&near, 0.0026, 0.0, 0.0));
        assert!(inside(&cube, 0.003, 0.002, 0.001) && !inside(&cube, 0.0, 0.0, 0.0011));
    }

    #[test]
    fn a_zone_is_what_all_its_regions_share_and_beyond_grows_no_faster_than_the_way() {
        let zone = Zone {
            name: "all three".into(),
            regions: regions().into(),
        };
        let mut random = Random::new(3);
        let mut point = || Vec3::from_fn(|_, _| random.between(-0.004, 0.004));
        let mut inside = 0;
        for _ in 0..2000 {
            let (a, b) = (point(), point());
            let all = regions().iter().all(|region| region.beyond(&a) <= 0.0);
            assert_eq!(zone.contains(&a), all);
            assert_eq!(zone.beyond(&a) <= 0.0, all);
            assert!((zone.beyond(&a) - zone.beyond(&b)).abs() <= (a - b).norm() + 1e-15);
            inside += usize::from(all);
        }
        assert!((10..1900).contains(&inside), "{inside}");
        let everywhere = Zone {
            name: String::new(),
            regions: Vec::new(),
        };
        assert!(everywhere.contains(&point()));
    }
}
