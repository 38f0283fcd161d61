//! Sounding of surfaces with rays: the places where a tool's tip touches.

use sulcus_core::{Tool, Vec3};

/// Horizontal unit vector at a bearing in degrees: 0 along x, 90 along y.
pub(crate) fn bearing_vector(degrees: f64) -> Vec3 {
    let angle = degrees.to_radians();
    Vec3::new(libm::cos(angle), libm::sin(angle), 0.0)
}

/// Distance from `centre` along the unit vector `out` at which a ray from outside first meets a sphere of `radius` at
/// `sphere`; `None` without a hit. Metres.
pub(crate) fn first_touch(centre: &Vec3, out: &Vec3, sphere: &Vec3, radius: f64) -> Option<f64> {
    let to = sphere - centre;
    let along = to.dot(out);
    let off = to.norm_squared() - along * along;
    let reach = radius * radius - off;
    (reach > 0.0).then(|| along + reach.sqrt())
}

/// Contact radius of the tool's sphere nearest to the tip, metres.
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
