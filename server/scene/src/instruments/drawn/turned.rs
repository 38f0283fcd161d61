//! Builder of a turned surface: rings round a line, joined one to the next.

use sulcus_core::Vec3;

use super::Steel;
use crate::instruments::tube::Station;
use crate::mesh::TriMesh;

/// Overlap of the two sides of a crease along the line, mm. A screen joins vertices that are less than half as far
/// apart.
pub(super) const OVERLAP_MM: f64 = 0.014;
/// Largest difference of equal angles, radians.
const SAME: f64 = 1e-9;

/// Turned surface in the making, mm.
pub(super) struct Turned<'a> {
    pub mesh: TriMesh,
    pub steel: Vec<Steel>,
    line: &'a dyn Fn(f64) -> Station,
    /// Newest ring: vertices with their angles in the plane of the ring, radians, ascending.
    last: Vec<(f64, u32)>,
}

impl<'a> Turned<'a> {
    /// Begins with a point at the start of the line.
    pub fn from_point(line: &'a dyn Fn(f64) -> Station, s: f64, steel: Steel) -> Self {
        Self {
            mesh: TriMesh {
                vertices: vec![line(s).point],
                triangles: Vec::new(),
            },
            steel: vec![steel],
            line,
            last: Vec::new(),
        }
    }

    /// Begins with a surface that is open at the ring `rim`, at `s` along the line. The rim runs as a ring does.
    pub fn from_rim(
        line: &'a dyn Fn(f64) -> Station,
        s: f64,
        (mesh, steel): (TriMesh, Vec<Steel>),
        rim: &[u32],
    ) -> Self {
        let mut turned = Self {
            mesh,
            steel,
            line,
            last: Vec::new(),
        };
        turned.last = turned.by_angle(s, rim.iter().copied());
        turned
    }

    /// Adds a circle at `s` along the line and joins it to the newest ring.
    pub fn ring(&mut self, s: f64, radius: f64, corners: usize, steel: Steel) {
        let station = (self.line)(s);
        let side = station.side();
        let corner = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / corners as f64;
            let (x, y) = (radius * libm::cos(angle), radius * libm::sin(angle));
            station.point + side * x + Vec3::y() * y
        };
        let points: Vec<Vec3> = (0..corners).map(corner).collect();
        self.outline(s, points, steel);
    }

    /// Adds a ring of these corners at `s` along the line and joins it to the newest ring.
    pub fn outline(&mut self, s: f64, corners: Vec<Vec3>, steel: Steel) {
        let first = self.mesh.vertices.len() as u32;
        self.steel.extend(corners.iter().map(|_| steel));
        self.mesh.vertices.extend(corners);
        let ring = self.by_angle(s, first..self.mesh.vertices.len() as u32);
        if self.last.is_empty() {
            for k in 0..ring.len() {
                let next = ring[(k + 1) % ring.len()].1;
                self.mesh.triangles.push([0, next, ring[k].1]);
            }
        } else {
            self.join(&ring);
        }
        self.last = ring;
    }

    /// Doubles the newest ring, which lies at `s`, so that normals and finishes on both its sides are apart.
    ///
    /// The two sides overlap by [`OVERLAP_MM`]: a screen gives vertices in one place a common normal.
    pub fn crease(&mut self, s: f64, steel: Steel) {
        let along = (self.line)(s).along * (0.5 * OVERLAP_MM);
        for (_, v) in &mut self.last {
            let old = self.mesh.vertices[*v as usize];
            self.mesh.vertices[*v as usize] = old + along;
            *v = self.mesh.vertices.len() as u32;
            self.mesh.vertices.push(old - along);
            self.steel.push(steel);
        }
    }

    /// Closes the newest ring by a flat lid at `s` along the line.
    pub fn close(&mut self, s: f64, steel: Steel) {
        let middle = self.mesh.vertices.len() as u32;
        self.mesh.vertices.push((self.line)(s).point);
        self.steel.push(steel);
        for k in 0..self.last.len() {
            let next = self.last[(k + 1) % self.last.len()].1;
            self.mesh.triangles.push([self.last[k].1, next, middle]);
        }
    }

    fn by_angle(&self, s: f64, ring: impl Iterator<Item = u32>) -> Vec<(f64, u32)> {
        let station = (self.line)(s);
        let angle = |v: u32| {
            let off = self.mesh.vertices[v as usize] - station.point;
            let angle = libm::atan2(off.y, off.dot(&station.side()));
            // Half a turn has one sign, whatever the rounding.
            if angle < SAME - std::f64::consts::PI {
                angle + std::f64::consts::TAU
            } else {
                angle
            }
        };
        let mut ring: Vec<(f64, u32)> = ring.map(|v| (angle(v), v)).collect();
        ring.sort_by(|a, b| a.0.total_cmp(&b.0));
        ring
    }

    /// Joins the newest ring to the next, which may have another number of corners.
    fn join(&mut self, upper: &[(f64, u32)]) {
        let lower = &self.last;
        let (m, n) = (lower.len(), upper.len());
        let (mut i, mut j) = (0, 0);
        while i < m || j < n {
            let angle = |ring: &[(f64, u32)], k: usize| {
                ring[k % ring.len()].0 + std::f64::consts::TAU * (k / ring.len()) as f64
            };
            let (here, above) = (lower[i % m].1, upper[j % n].1);
            // The triangle with the nearer next corner comes first; the newest ring's corner at equal angles.
            if j == n || (i < m && angle(lower, i + 1) <= angle(upper, j + 1) + SAME) {
                let next = lower[(i + 1) % m].1;
                self.mesh.triangles.push([here, next, above]);
                i += 1;
            } else {
                let next = upper[(j + 1) % n].1;
                self.mesh.triangles.push([here, next, above]);
                j += 1;
            }
        }
    }
}
