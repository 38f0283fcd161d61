//! Rays between two points, and spheres that block them.

use sulcus_core::{Sphere, Vec3};

/// Ray from one point to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    from: Vec3,
    /// Unit vector along the ray.
    way: Vec3,
    length: f64,
}

impl Ray {
    /// Ray from one point to another, metres.
    pub fn new(from: Vec3, to: Vec3) -> Self {
        let way = to - from;
        let length = way.dot(&way).sqrt();
        Self {
            from,
            way: if length > 0.0 { way / length } else { way },
            length,
        }
    }

    /// Unit vector along the ray; zero for two equal points.
    pub fn way(&self) -> &Vec3 {
        &self.way
    }

    /// Whether the sphere blocks the ray: some point of the segment is nearer to the centre than the radius.
    #[inline]
    pub fn meets(&self, sphere: &Sphere) -> bool {
        let to = sphere.centre - self.from;
        let along = to.dot(&self.way);
        let along = sulcus_core::math::fclamp(along, 0.0, self.length);
        let apart = to - self.way * along;
        apart.dot(&apart) < sphere.radius * sphere.radius
    }

    /// Whether no sphere blocks the ray.
    pub fn is_free<'a>(&self, spheres: impl IntoIterator<Item = &'a Sphere>) -> bool {
        !spheres.into_iter().any(|sphere| self.meets(sphere))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere(x: f64, y: f64, z: f64, radius: f64) -> Sphere {
        Sphere {
            centre: Vec3::new(x, y, z),
            radius,
        }
    }

    /// Free share of a square of edge 2 at z = 0, seen from `eye` past the spheres, by n x n rays.
    fn share(eye: Vec3, spheres: &[Sphere], n: usize) -> f64 {
        let at = |k: usize| -1.0 + (k as f64 + 0.5) * 2.0 / n as f64;
        let all = (0..n * n).map(|k| Vec3::new(at(k % n), at(k / n), 0.0));
        let free = all.filter(|point| Ray::new(*point, eye).is_free(spheres));
        free.count() as f64 / (n * n) as f64
    }

    #[test]
    fn a_sphere_leaves_free_what_its_shadow_does_not_cover() {
        // For an eye straight above, the edge of the shadow is the cone that touches the sphere.
        let (height, z, radius) = (10.0, 3.0, 0.4);
        let away: f64 = height - z;
        let reach = height * radius / (away * away - radius * radius).sqrt();
        let exact = 1.0 - std::f64::consts::PI * reach * reach / 4.0;
        let error = |n| {
            (share(
                Vec3::new(0.0, 0.0, height),
                &[sphere(0.0, 0.0, z, radius)],
                n,
            ) - exact)
                .abs()
        };
        assert!(error(400) < 1e-3, "{}", error(400));
        assert!(error(400) < error(10).max(1e-4));
    }

    #[test]
    fn a_row_of_spheres_is_a_capsule() {
        // For a distant eye, the shadow of a capsule along x is its outline.
        let (half, radius) = (0.5, 0.3);
        let row: Vec<Sphere> = (0..=400)
            .map(|k| sphere(-half + f64::from(k) / 400.0 * 2.0 * half, 0.1, 2.0, radius))
            .collect();
        let exact = 1.0 - (4.0 * half * radius + std::f64::consts::PI * radius * radius) / 4.0;
        let found = share(Vec3::new(0.0, 0.1, 1e5), &row, 400);
        assert!((found - exact).abs() < 2e-3, "{found} {exact}");
    }

    #[test]
    fn only_what_lies_between_hides() {
        let ray = Ray::new(Vec3::zeros(), Vec3::new(0.0, 0.0, 1.0));
        for (z, hides) in [
            (0.5, true),
            (1.05, true),
            (1.2, false),
            (-0.05, true),
            (-0.2, false),
        ] {
            assert_eq!(ray.meets(&sphere(0.0, 0.0, z, 0.1)), hides, "{z}");
        }
        assert!(
            !ray.meets(&sphere(0.1, 0.0, 0.5, 0.1)),
            "touched is not hidden"
        );
        assert!(!ray.meets(&sphere(f64::NAN, 0.0, 0.5, 0.1)));
        let point = Ray::new(Vec3::zeros(), Vec3::zeros());
        assert!(
            point.meets(&sphere(0.0, 0.0, 0.05, 0.1)) && !point.meets(&sphere(1.0, 0.0, 0.0, 0.1))
        );
    }
}
