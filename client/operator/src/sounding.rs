//! Feeling for surfaces with rays: where a tool's tip would touch.

use sulcus_core::{Tool, Vec3};

/// Horizontal unit vector at a bearing: 0 along x, 90 along y, degrees.
pub(crate) fn bearing_vector(degrees: f64) -> Vec3 {
    let angle = degrees.to_radians();
    Vec3::new(libm::cos(angle), libm::sin(angle), 0.0)
}

/// Where a ray from outside along `-out` first meets a sphere: distance from `centre` along `out`.
pub(crate) fn first_touch(centre: &Vec3, out: &Vec3, sphere: &Vec3, radius: f64) -> Option<f64> {
    let to = sphere - centre;
    let along = to.dot(out);
    let off = to.norm_squared() - along * along;
    let reach = radius * radius - off;
    (reach > 0.0).then(|| along + reach.sqrt())
}

/// Radius of the sphere nearest to the tip.
pub(crate) fn tip_radius(tool: &Tool) -> f64 {
    let nearest = tool.tree.shape_at(tool.level).min_by(|a, b| {
        let d = |node: &sulcus_core::Node| (node.centre - tool.tip).norm();
        d(a.1).total_cmp(&d(b.1))
    });
    nearest.map_or(0.0, |(_, node)| node.contact_radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_meets_a_ball_at_its_near_side() {
        let hit = first_touch(&Vec3::zeros(), &Vec3::x(), &Vec3::new(2.0, 0.0, 0.0), 1.0);
        assert_eq!(hit, Some(3.0));
        assert_eq!(
            first_touch(&Vec3::zeros(), &Vec3::x(), &Vec3::new(2.0, 1.5, 0.0), 1.0),
            None
        );
    }
}
