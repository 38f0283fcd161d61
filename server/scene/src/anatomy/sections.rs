//! Distance of a tooth's surface from its axis, by angle and height. Gingiva is laid round these sections.
//!
//! Each horizontal section of the tooth is replaced by its convex hull. Tissue bridges furcations and grooves, so
//! they leave no notch.

use sulcus_core::Vec3;

use crate::mesh::TriMesh;
use crate::parallel;

/// Number of angles of a section.
const ANGLES: usize = 128;
/// Distance between sections, mm.
const STEP: f64 = 0.25;
/// Radius of a section that does not contain the axis, mm.
const THIN: f64 = 0.3;

/// Radii of a tooth's sections, mm, in the tooth's frame (x mesial, y buccal, z occlusal).
#[derive(Clone, Debug)]
pub struct Sections {
    low: f64,
    radii: Vec<Vec<f64>>,
}

impl Sections {
    /// Returns the sections of a closed mesh (metres, the tooth's frame) from the height `low` to `high`, mm.
    pub fn of(mesh: &TriMesh, low: f64, high: f64) -> Self {
        let count = ((high - low) / STEP).ceil() as usize + 1;
        // The offset avoids sections through a row of vertices.
        let low = low + 1.7e-4;
        let mut points = vec![Vec::new(); count];
        for triangle in &mesh.triangles {
            let corners = triangle.map(|v| mesh.vertices[v as usize] * 1e3);
            let heights = corners.map(|p| p.z);
            let bottom = heights.iter().fold(f64::INFINITY, |a, b| a.min(*b));
            let top = heights.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
            let first = ((bottom - low) / STEP).ceil().max(0.0) as usize;
            for (k, points) in points.iter_mut().enumerate().skip(first) {
                let z = low + k as f64 * STEP;
                if z > top {
                    break;
                }
                for e in 0..3 {
                    let (a, b) = (&corners[e], &corners[(e + 1) % 3]);
                    if (a.z < z) != (b.z < z) {
                        let share = (z - a.z) / (b.z - a.z);
                        let p = a + (b - a) * share;
                        points.push([p.x, p.y]);
                    }
                }
            }
        }
        let radii = parallel::map(count, |k| radii_of(&hull(&points[k])));
        Self { low, radii }
    }

    /// Returns the distance from the axis to the surface at an angle (radians from mesial over buccal) and a height
    /// (mm), mm. The distance is 0 above the tooth.
    pub fn radius(&self, around: f64, z: f64) -> f64 {
        let row = ((z - self.low) / STEP).clamp(0.0, (self.radii.len() - 1) as f64);
        let (k, f) = (row as usize, row - row.floor());
        let turn = around / std::f64::consts::TAU;
        let at = (turn - turn.floor()) * ANGLES as f64;
        let (a, g) = (at as usize % ANGLES, at - at.floor());
        let on = |k: usize| {
            let radii = &self.radii[k.min(self.radii.len() - 1)];
            radii[a] * (1.0 - g) + radii[(a + 1) % ANGLES] * g
        };
        on(k) * (1.0 - f) + on(k + 1) * f
    }

    /// Returns the unit vector out of the surface at an angle, across the axis.
    pub fn outward(&self, around: f64, z: f64) -> Vec3 {
        let step = std::f64::consts::PI / ANGLES as f64;
        let radius = self.radius(around, z).max(THIN);
        let slope = (self.radius(around + step, z) - self.radius(around - step, z)) / (2.0 * step);
        let (sine, cosine) = (libm::sin(around), libm::cos(around));
        // The outline's normal is the radial direction less the growth of its radius along the angle.
        let lean = slope / radius;
        Vec3::new(cosine + lean * sine, sine - lean * cosine, 0.0).normalize()
    }
}

/// Convex hull, counter-clockwise (Andrew's monotone chain).
fn hull(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    sorted.dedup();
    if sorted.len() < 3 {
        return Vec::new();
    }
    let turn = |o: &[f64; 2], a: &[f64; 2], b: &[f64; 2]| {
        (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
    };
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while chain.len() >= 2
                && turn(&chain[chain.len() - 2], &chain[chain.len() - 1], &p) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut lower = chain(&mut sorted.iter().copied());
    lower.extend(chain(&mut sorted.iter().rev().copied()));
    lower
}

/// Distances from the origin to the hull's border.
fn radii_of(hull: &[[f64; 2]]) -> Vec<f64> {
    if hull.len() < 3 {
        return vec![0.0; ANGLES];
    }
    (0..ANGLES)
        .map(|k| {
            let angle = std::f64::consts::TAU * k as f64 / ANGLES as f64;
            let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
            let mut farthest: f64 = THIN;
            for (i, a) in hull.iter().enumerate() {
                let b = hull[(i + 1) % hull.len()];
                let side = |p: &[f64; 2]| p[1] * cosine - p[0] * sine;
                let along = |p: &[f64; 2]| p[0] * cosine + p[1] * sine;
                let (sa, sb) = (side(a), side(&b));
                if (sa < 0.0) != (sb < 0.0) {
                    let share = sa / (sa - sb);
                    farthest = farthest.max(along(a) + share * (along(&b) - along(a)));
                }
            }
            farthest
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::polygonise::polygonise;

    #[test]
    fn an_ellipsoid_has_its_radii_and_two_legs_have_no_notch() {
        let ball = |p: &Vec3| {
            ((p.x / 4.0).powi(2) + (p.y / 3.0).powi(2) + (p.z / 6.0).powi(2)).sqrt() - 1.0
        };
        let (low, high) = (Vec3::repeat(-7.0), Vec3::repeat(7.0));
        let mesh = polygonise(&ball, low, high, 0.25).placed(1e-3, Vec3::zeros());
        let sections = Sections::of(&mesh, -5.0, 5.0);
        for (around, z) in [(0.0, 0.0), (1.2, 2.1), (-2.5, -3.3), (3.1, 4.0)] {
            let (s, c) = (libm::sin(around), libm::cos(around));
            let wanted = ((1.0 - z * z / 36.0_f64) / (c * c / 16.0 + s * s / 9.0)).sqrt();
            assert!((sections.radius(around, z) - wanted).abs() < 0.02);
            let normal = Vec3::new(c / 16.0, s / 9.0, 0.0).normalize();
            assert!(sections.outward(around, z).dot(&normal) > 0.999);
        }
        let legs = |p: &Vec3| {
            let leg = |x: f64| ((p.x - x).powi(2) + p.y * p.y).sqrt() - 1.5;
            leg(2.5).min(leg(-2.5)).max(p.z.abs() - 4.0)
        };
        let mesh = polygonise(&legs, low, high, 0.25).placed(1e-3, Vec3::zeros());
        let sections = Sections::of(&mesh, -3.0, 3.0);
        let buccal = sections.radius(std::f64::consts::FRAC_PI_2, 0.0);
        assert!((buccal - 1.5).abs() < 0.03, "{buccal}");
        assert_eq!(sections.radius(0.3, 10.0), sections.radius(0.3, 3.0));
    }
}
