//! Distances of points from planes and triangles.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmax, fmin};

/// Sum of squared distances to planes, weighted by areas: `p A p + 2 b p + c`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quadric {
    square: [f64; 6],
    linear: Vec3,
    constant: f64,
    area: f64,
}

impl Quadric {
    /// The plane of a triangle, from its area vector and a corner.
    pub fn of(area_vector: &Vec3, point: &Vec3) -> Self {
        let area = area_vector.norm();
        let n = area_vector / area.max(f64::MIN_POSITIVE);
        let d = -n.dot(point);
        Self {
            square: [
                n.x * n.x,
                n.x * n.y,
                n.x * n.z,
                n.y * n.y,
                n.y * n.z,
                n.z * n.z,
            ]
            .map(|x| x * area),
            linear: n * (d * area),
            constant: d * d * area,
            area,
        }
    }

    /// Adds the planes of another sum.
    pub fn add(&mut self, other: &Self) {
        for (to, from) in self.square.iter_mut().zip(other.square) {
            *to += from;
        }
        self.linear += other.linear;
        self.constant += other.constant;
        self.area += other.area;
    }

    /// Root of the mean squared distance of a point from the planes.
    pub fn distance(&self, p: &Vec3) -> f64 {
        let [xx, xy, xz, yy, yz, zz] = self.square;
        let square = xx * p.x * p.x
            + yy * p.y * p.y
            + zz * p.z * p.z
            + 2.0 * (xy * p.x * p.y + xz * p.x * p.z + yz * p.y * p.z)
            + 2.0 * self.linear.dot(p)
            + self.constant;
        fmax(square / self.area.max(f64::MIN_POSITIVE), 0.0).sqrt()
    }
}

/// Returns the squared distance of a point from a triangle.
pub fn squared(p: &Vec3, [a, b, c]: [Vec3; 3]) -> f64 {
    let normal = (b - a).cross(&(c - a));
    let is_left = |from: &Vec3, to: &Vec3| normal.dot(&(to - from).cross(&(p - from))) >= 0.0;
    if is_left(&a, &b) && is_left(&b, &c) && is_left(&c, &a) {
        let height = normal.dot(&(p - a));
        return height * height / normal.norm_squared().max(f64::MIN_POSITIVE);
    }
    let edge = |from: &Vec3, to: &Vec3| {
        let along = to - from;
        let share = along.dot(&(p - from)) / along.norm_squared().max(f64::MIN_POSITIVE);
        (p - from - along * fclamp(share, 0.0, 1.0)).norm_squared()
    };
    fmin(edge(&a, &b), fmin(edge(&b, &c), edge(&c, &a)))
}
