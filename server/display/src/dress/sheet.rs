//! Surface that is reshaped for a display.

use sulcus_core::Vec3;
use sulcus_scene::mesh::TriMesh;

/// Largest distance of a moved vertex's old place from the surface, mm.
const MOVED: f64 = 0.006;

/// Triangles of a surface, mm.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    /// Vertices.
    pub at: Vec<Vec3>,
    /// Triangles, counter-clockwise as seen from outside.
    pub triangles: Vec<[usize; 3]>,
    /// Whether a vertex lies on a line that has been drawn into the surface, and must stay.
    pub fixed: Vec<bool>,
}

impl Sheet {
    /// The surface of a mesh.
    pub fn of(mesh: &TriMesh) -> Self {
        Self {
            at: mesh.vertices.clone(),
            triangles: mesh
                .triangles
                .iter()
                .map(|t| t.map(|v| v as usize))
                .collect(),
            fixed: vec![false; mesh.vertices.len()],
        }
    }

    /// The surface as a mesh.
    pub fn to_mesh(&self) -> TriMesh {
        TriMesh {
            vertices: self.at.clone(),
            triangles: self.triangles.iter().map(|t| t.map(|v| v as u32)).collect(),
        }
    }

    /// Normal of a triangle times twice its area.
    pub fn area_vector(&self, [a, b, c]: [usize; 3]) -> Vec3 {
        (self.at[b] - self.at[a]).cross(&(self.at[c] - self.at[a]))
    }

    /// Unit normals of the vertices, weighted by the areas of their triangles.
    pub fn normals(&self) -> Vec<Vec3> {
        let mut normals = vec![Vec3::zeros(); self.at.len()];
        for triangle in &self.triangles {
            let area = self.area_vector(*triangle);
            for v in triangle {
                normals[*v] += area;
            }
        }
        for normal in &mut normals {
            *normal /= normal.norm().max(f64::MIN_POSITIVE);
        }
        normals
    }

    /// Edges in ascending order, each with its triangles.
    pub fn edges(&self) -> Vec<Edge> {
        let mut sides: Vec<([usize; 2], usize)> = Vec::with_capacity(3 * self.triangles.len());
        for (t, [a, b, c]) in self.triangles.iter().copied().enumerate() {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                sides.push(([from.min(to), from.max(to)], t));
            }
        }
        sides.sort_unstable();
        let of = |group: &[([usize; 2], usize)]| Edge {
            ends: group[0].0,
            triangles: group.iter().map(|side| side.1).collect(),
        };
        sides.chunk_by(|a, b| a.0 == b.0).map(of).collect()
    }

    /// Whether a free vertex may move to a place nearby: its old place stays within [`MOVED`] of the new planes.
    pub fn may_move(&self, v: usize, to: &Vec3) -> bool {
        let round = self.triangles.iter().filter(|t| t.contains(&v));
        let is_near = |t: &[usize; 3]| {
            let corners = t.map(|w| if w == v { *to } else { self.at[w] });
            let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
            let old = self.area_vector(*t);
            let off = normal.dot(&(self.at[v] - to)).abs();
            normal.dot(&old) > 0.5 * normal.norm() * old.norm() && off < MOVED * normal.norm()
        };
        !self.fixed[v] && round.clone().all(is_near)
    }

    /// Adds a vertex that must stay. Returns its index.
    pub fn push_fixed(&mut self, at: Vec3) -> usize {
        self.at.push(at);
        self.fixed.push(true);
        self.at.len() - 1
    }

    /// Drops vertices that no triangle has.
    pub fn drop_unused(&mut self) {
        let mut number = vec![usize::MAX; self.at.len()];
        let (mut at, mut fixed) = (Vec::new(), Vec::new());
        for v in self.triangles.iter_mut().flatten() {
            if number[*v] == usize::MAX {
                number[*v] = at.len();
                at.push(self.at[*v]);
                fixed.push(self.fixed[*v]);
            }
            *v = number[*v];
        }
        (self.at, self.fixed) = (at, fixed);
    }
}

/// Edge of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// Its vertices in ascending order.
    pub ends: [usize; 2],
    /// Its triangles: two in a closed surface.
    pub triangles: Vec<usize>,
}

/// Least height of a triangle relative to its longest edge: 0 for a line, 0.87 for equal edges.
pub fn fullness([a, b, c]: [Vec3; 3]) -> f64 {
    let longest = [b - a, c - b, a - c]
        .iter()
        .fold(0.0, |most: f64, edge| most.max(edge.norm_squared()));
    (b - a).cross(&(c - a)).norm() / longest.max(f64::MIN_POSITIVE)
}
