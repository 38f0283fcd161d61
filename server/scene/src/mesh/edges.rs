//! Edges shared by triangles. Sorted lists replace hash maps, so every order is a function of the mesh alone.

use std::collections::BTreeMap;

use sulcus_core::Vec3;

use crate::mesh::TriMesh;

/// One triangle's side of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Side {
    /// The edge's vertex with the lower index.
    pub low: u32,
    /// The other.
    pub high: u32,
    /// The triangle.
    pub triangle: u32,
    /// Whether the triangle traverses the edge from `low` to `high`.
    pub forward: bool,
}

impl Side {
    /// Returns start and end in the triangle's direction.
    pub(crate) fn walked(&self) -> [u32; 2] {
        if self.forward {
            [self.low, self.high]
        } else {
            [self.high, self.low]
        }
    }
}

/// All sides of all triangles, sides of one edge together.
pub(crate) fn sides(mesh: &TriMesh) -> Vec<Side> {
    let mut sides = Vec::with_capacity(mesh.triangles.len() * 3);
    for (triangle, &[a, b, c]) in (0_u32..).zip(&mesh.triangles) {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            sides.push(Side {
                low: from.min(to),
                high: from.max(to),
                triangle,
                forward: from < to,
            });
        }
    }
    sides.sort_unstable();
    sides
}

/// The sides grouped by edge.
pub(crate) fn by_edge(sides: &[Side]) -> impl Iterator<Item = &[Side]> {
    sides.chunk_by(|a, b| (a.low, a.high) == (b.low, b.high))
}

/// Sides of edges that have one triangle only.
pub(crate) fn open_sides(sides: &[Side]) -> Vec<Side> {
    by_edge(sides)
        .filter(|edge| edge.len() == 1)
        .map(|edge| edge[0])
        .collect()
}

/// Disjoint sets of vertices. The lowest vertex is the name of its set.
pub(crate) struct Sets(Vec<u32>);

impl Sets {
    /// Returns sets of one vertex each.
    pub(crate) fn new(vertices: usize) -> Self {
        Self((0..vertices as u32).collect())
    }

    /// The set of a vertex.
    pub(crate) fn find(&mut self, mut v: u32) -> u32 {
        while self.0[v as usize] != v {
            self.0[v as usize] = self.0[self.0[v as usize] as usize];
            v = self.0[v as usize];
        }
        v
    }

    /// Joins two sets.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

/// An opening in a surface: a connected set of open edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Opening {
    /// Open edges around it.
    pub edges: usize,
    /// Largest distance between two of its vertices, mm. With more than a few hundred vertices it is the diagonal of
    /// its box.
    pub diameter_mm: f64,
    /// Mean of its vertices, mm, in the mesh's frame.
    pub at_mm: [f64; 3],
}

impl std::fmt::Display for Opening {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} edges, {} mm across, at {} mm",
            self.edges,
            Length(self.diameter_mm),
            Place(self.at_mm)
        )
    }
}

impl Opening {
    pub(crate) fn around(mesh: &TriMesh, rim: &[u32], edges: usize) -> Self {
        let points: Vec<Vec3> = rim.iter().map(|&v| mesh.vertices[v as usize]).collect();
        let sum: Vec3 = points.iter().sum();
        Self {
            edges,
            diameter_mm: diameter(&points) * 1e3,
            at_mm: (sum / points.len().max(1) as f64 * 1e3).into(),
        }
    }
}

/// Largest distance between two points, metres.
pub(crate) fn diameter(points: &[Vec3]) -> f64 {
    let mut largest = 0.0;
    if points.len() > 512 {
        let mut low = points[0];
        let mut high = points[0];
        for point in points {
            low = low.zip_map(point, sulcus_core::math::fmin);
            high = high.zip_map(point, sulcus_core::math::fmax);
        }
        return (high - low).norm();
    }
    for (k, a) in points.iter().enumerate() {
        for b in &points[..k] {
            let distance = (a - b).norm();
            if distance > largest {
                largest = distance;
            }
        }
    }
    largest
}

/// Returns the openings of a mesh, widest first. Triangles may disagree about their orientation.
pub(crate) fn openings(mesh: &TriMesh, open: &[Side]) -> Vec<Opening> {
    let mut sets = Sets::new(mesh.vertices.len());
    for side in open {
        sets.join(side.low, side.high);
    }
    let mut rims: BTreeMap<u32, (Vec<u32>, usize)> = BTreeMap::new();
    for side in open {
        let rim = rims.entry(sets.find(side.low)).or_default();
        rim.0.extend([side.low, side.high]);
        rim.1 += 1;
    }
    let mut openings: Vec<Opening> = rims
        .into_values()
        .map(|(mut rim, edges)| {
            rim.sort_unstable();
            rim.dedup();
            Opening::around(mesh, &rim, edges)
        })
        .collect();
    openings.sort_by(|a, b| b.diameter_mm.total_cmp(&a.diameter_mm));
    openings
}

/// Returns a number with three decimals for messages. Small numbers keep their digits.
pub(crate) fn rounded(x: f64) -> f64 {
    if x.abs() < 1e-3 {
        x
    } else {
        (x * 1e3).round() / 1e3
    }
}

/// A length for messages: mm with three decimals, or two digits where those would be zeros.
pub(crate) struct Length(pub f64);

impl std::fmt::Display for Length {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0.abs() < 1e-3 && self.0 != 0.0 {
            write!(f, "{:.1e}", self.0)
        } else {
            write!(f, "{}", rounded(self.0))
        }
    }
}

/// A place for messages, mm with three decimals.
pub(crate) struct Place(pub [f64; 3]);

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // The added zero turns -0 into 0.
        let [x, y, z] = self.0.map(|x| (x * 1e3).round() / 1e3 + 0.0);
        write!(f, "({x}, {y}, {z})")
    }
}

/// Returns the first few items of a list and the number of the others, for a sentence.
pub(crate) fn first_few(items: &[impl ToString]) -> String {
    const FEW: usize = 5;
    let mut said: Vec<String> = items.iter().take(FEW).map(ToString::to_string).collect();
    if items.len() > FEW {
        said.push(format!("and {} more", items.len() - FEW));
    }
    said.join("; ")
}
