//! Centres of maximal inscribed balls: the shrinking-ball method (Ma, Bae and Choi 2012).

use sulcus_core::Vec3;

use crate::mesh::distance::MeshDistance;
use crate::mesh::sample::Sample;

/// Cosine of the smallest valid angle at the centre between the two touching points. A smaller angle comes from the
/// mesh's facets, not from the shape.
const NOISE_COS: f64 = 0.94;

/// Returns the centre of the largest ball inside the surface that touches it at `sample`.
pub fn inscribed_centre(distance: &MeshDistance, sample: &Sample, largest: f64) -> Vec3 {
    let (p, n) = (sample.point, sample.normal);
    let mut radius = largest;
    for _ in 0..16 {
        let centre = p - n * radius;
        let hit = distance.nearest(&centre);
        let to_hit = hit.point - centre;
        let reach = to_hit.norm();
        if reach >= radius * (1.0 - 1e-3) {
            break;
        }
        if hit.signed < 0.0
            && reach > 0.9 * radius
            && to_hit.dot(&(p - centre)) > NOISE_COS * reach * radius
        {
            break;
        }
        // The ball tangent at p that also passes through the point that was too near.
        let chord = p - hit.point;
        let along = 2.0 * n.dot(&chord);
        if along <= 1e-12 {
            break;
        }
        let smaller = chord.norm_squared() / along;
        if smaller >= radius {
            break;
        }
        radius = smaller;
    }
    p - n * radius
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::sample::surface;
    use crate::mesh::shapes::{cuboid, icosphere};

    #[test]
    fn the_inscribed_ball_of_a_ball_is_itself() {
        let distance = MeshDistance::new(icosphere(0.005, 4));
        for sample in surface(&distance, 50, 0.0) {
            let centre = inscribed_centre(&distance, &sample, 0.02);
            assert!(centre.norm() < 0.1e-3, "{centre:?}");
        }
    }

    #[test]
    fn the_inscribed_balls_of_a_thin_slab_lie_in_its_middle() {
        let distance = MeshDistance::new(cuboid(Vec3::new(0.01, 0.01, 0.0005)));
        for sample in surface(&distance, 200, 0.0) {
            let centre = inscribed_centre(&distance, &sample, 0.02);
            let from_border = 0.01 - sample.point.xy().abs().max();
            if from_border > 0.001 {
                assert!(centre.z.abs() < 0.02e-3, "{sample:?} {centre:?}");
            }
            assert!(distance.signed(&centre) < 1e-6, "{sample:?} {centre:?}");
        }
    }
}
