//! True signed distance to a closed mesh.
//!
//! A tree of boxes finds the nearest triangle. The sign is that of the angle-weighted pseudonormal of the nearest
//! feature (Baerentzen and Aanaes 2005).

use sulcus_core::Vec3;

use crate::mesh::TriMesh;

/// Triangles in a leaf box.
const LEAF: usize = 4;

/// The point of the surface nearest to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Distance, metres; negative inside.
    pub signed: f64,
    /// The surface point, metres.
    pub point: Vec3,
    /// Index of its triangle.
    pub triangle: u32,
}

/// Distance queries about one mesh. The mesh is part of it.
#[derive(Clone, Debug)]
pub struct MeshDistance {
    mesh: TriMesh,
    corners: Vec<[Vec3; 3]>,
    boxes: Vec<Box3>,
    /// Triangles in the order of the leaves.
    order: Vec<u32>,
    face_normals: Vec<Vec3>,
    edge_normals: Vec<[Vec3; 3]>,
    vertex_normals: Vec<Vec3>,
}

#[derive(Clone, Copy, Debug)]
struct Box3 {
    low: Vec3,
    high: Vec3,
    /// Right child, or first triangle of a leaf; the left child follows its parent.
    next: u32,
    /// Triangles of a leaf, 0 for an inner box.
    count: u32,
}

impl MeshDistance {
    /// Prepares the queries. The mesh must have passed [`crate::mesh::check::check`].
    pub fn new(mesh: TriMesh) -> Self {
        let corners: Vec<_> = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect();
        let mut order: Vec<u32> = (0..corners.len() as u32).collect();
        let mut boxes = Vec::new();
        if !order.is_empty() {
            build(&corners, &mut order, 0, &mut boxes);
        }
        let face_normals: Vec<Vec3> = (0..corners.len())
            .map(|t| unit(mesh.area_vector(t)))
            .collect();
        let vertex_normals = vertex_normals(&mesh, &face_normals);
        let edge_normals = edge_normals(&mesh, &face_normals);
        Self {
            mesh,
            corners,
            boxes,
            order,
            face_normals,
            edge_normals,
            vertex_normals,
        }
    }

    /// The mesh.
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// Unit normal of a triangle.
    pub fn face_normal(&self, triangle: u32) -> Vec3 {
        self.face_normals[triangle as usize]
    }

    /// Angle-weighted unit normal of a vertex.
    pub fn vertex_normal(&self, vertex: u32) -> Vec3 {
        self.vertex_normals[vertex as usize]
    }

    /// Signed distance from `point` to the surface, metres; negative inside.
    pub fn signed(&self, point: &Vec3) -> f64 {
        self.nearest(point).signed
    }

    /// The nearest point of the surface.
    pub fn nearest(&self, point: &Vec3) -> Nearest {
        let mut best = (f64::INFINITY, Vec3::zeros(), 0_u32, Feature::Face);
        let mut stack = [(0_u32, 0.0_f64); 64];
        let mut top = usize::from(!self.boxes.is_empty());
        while top > 0 {
            top -= 1;
            let (index, squared) = stack[top];
            if squared >= best.0 {
                continue;
            }
            let node = &self.boxes[index as usize];
            if node.count > 0 {
                for &triangle in &self.order[node.next as usize..(node.next + node.count) as usize]
                {
                    let (on, feature) =
                        closest_on_triangle(&self.corners[triangle as usize], point);
                    let squared = (on - point).norm_squared();
                    if squared < best.0 {
                        best = (squared, on, triangle, feature);
                    }
                }
                continue;
            }
            let (left, right) = (index + 1, node.next);
            let (dl, dr) = (
                self.boxes[left as usize].squared(point),
                self.boxes[right as usize].squared(point),
            );
            // The nearer child is examined first.
            let (near, far) = if dl <= dr {
                ((left, dl), (right, dr))
            } else {
                ((right, dr), (left, dl))
            };
            stack[top] = far;
            stack[top + 1] = near;
            top += 2;
        }
        let (squared, on, triangle, feature) = best;
        let t = triangle as usize;
        let outward = match feature {
            Feature::Face => self.face_normals[t],
            Feature::Edge(e) => self.edge_normals[t][e],
            Feature::Vertex(v) => self.vertex_normals[self.mesh.triangles[t][v] as usize],
        };
        let distance = squared.sqrt();
        let signed = if (point - on).dot(&outward) < 0.0 {
            -distance
        } else {
            distance
        };
        Nearest {
            signed,
            point: on,
            triangle,
        }
    }
}

impl Box3 {
    fn squared(&self, p: &Vec3) -> f64 {
        let mut sum = 0.0;
        for axis in 0..3 {
            let out = (self.low[axis] - p[axis])
                .max(p[axis] - self.high[axis])
                .max(0.0);
            sum += out * out;
        }
        sum
    }
}

/// Returns the boxes of `order`, the box itself first. The first element of `order` has the leaf position `first`.
fn build(corners: &[[Vec3; 3]], order: &mut [u32], first: usize, boxes: &mut Vec<Box3>) {
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for corner in order.iter().flat_map(|&t| &corners[t as usize]) {
        low = low.zip_map(corner, f64::min);
        high = high.zip_map(corner, f64::max);
    }
    let here = boxes.len();
    boxes.push(Box3 {
        low,
        high,
        next: first as u32,
        count: order.len() as u32,
    });
    if order.len() <= LEAF {
        return;
    }
    let axis = (high - low).imax();
    let key = |t: u32| corners[t as usize].iter().map(|c| c[axis]).sum::<f64>();
    let middle = order.len() / 2;
    // Ties are broken by index, so the tree is a function of the mesh alone.
    order.select_nth_unstable_by(middle, |&a, &b| key(a).total_cmp(&key(b)).then(a.cmp(&b)));
    let (left, right) = order.split_at_mut(middle);
    build(corners, left, first, boxes);
    boxes[here].next = boxes.len() as u32;
    boxes[here].count = 0;
    build(corners, right, first + middle, boxes);
}

fn unit(v: Vec3) -> Vec3 {
    let length = v.norm();
    if length > 0.0 { v / length } else { v }
}

fn vertex_normals(mesh: &TriMesh, faces: &[Vec3]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::zeros(); mesh.vertices.len()];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let c = mesh.corners(t);
        for k in 0..3 {
            let (to, fro) = (c[(k + 1) % 3] - c[k], c[(k + 2) % 3] - c[k]);
            let angle = libm::atan2(to.cross(&fro).norm(), to.dot(&fro));
            normals[triangle[k] as usize] += faces[t] * angle;
        }
    }
    normals.into_iter().map(unit).collect()
}

/// Per triangle the normals of its edges 01, 12, 20: the sum of the two faces' normals.
fn edge_normals(mesh: &TriMesh, faces: &[Vec3]) -> Vec<[Vec3; 3]> {
    let mut all: Vec<(u32, u32, u32, usize)> = Vec::with_capacity(faces.len() * 3);
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for e in 0..3 {
            let (a, b) = (triangle[e], triangle[(e + 1) % 3]);
            all.push((a.min(b), a.max(b), t as u32, e));
        }
    }
    all.sort_unstable();
    let mut normals = vec![[Vec3::zeros(); 3]; faces.len()];
    for shared in all.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let sum: Vec3 = shared.iter().map(|edge| faces[edge.2 as usize]).sum();
        for edge in shared {
            normals[edge.2 as usize][edge.3] = sum;
        }
    }
    normals
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Feature {
    Vertex(usize),
    Edge(usize),
    Face,
}

/// Closest point of a triangle, by its Voronoi regions (Ericson, Real-Time Collision Detection, 5.1.5).
fn closest_on_triangle(corners: &[Vec3; 3], p: &Vec3) -> (Vec3, Feature) {
    let [a, b, c] = corners;
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (*a, Feature::Vertex(0));
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return (*b, Feature::Vertex(1));
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + ab * (d1 / (d1 - d3)), Feature::Edge(0));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return (*c, Feature::Vertex(2));
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + ac * (d2 / (d2 - d6)), Feature::Edge(2));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return (
            b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))),
            Feature::Edge(1),
        );
    }
    let scale = 1.0 / (va + vb + vc);
    (a + ab * (vb * scale) + ac * (vc * scale), Feature::Face)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes::{cuboid, ellipsoid};
    use crate::random::Random;

    fn brute(mesh: &TriMesh, p: &Vec3) -> f64 {
        (0..mesh.triangles.len())
            .map(|t| (closest_on_triangle(&mesh.corners(t), p).0 - p).norm())
            .fold(f64::INFINITY, f64::min)
    }

    /// Inside or outside by the solid angle of all triangles, a method unlike the tested one.
    fn winding(mesh: &TriMesh, p: &Vec3) -> f64 {
        (0..mesh.triangles.len())
            .map(|t| {
                let [a, b, c] = mesh.corners(t).map(|v| v - p);
                let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
                let below = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
                libm::atan2(a.dot(&b.cross(&c)), below) / (2.0 * std::f64::consts::PI)
            })
            .sum()
    }

    #[test]
    fn agrees_with_brute_force_in_size_and_sign() {
        for mesh in [
            ellipsoid(Vec3::new(0.006, 0.004, 0.002), 3),
            cuboid(Vec3::new(0.005, 0.003, 0.001)),
        ] {
            let tree = MeshDistance::new(mesh.clone());
            let mut random = Random::new(7);
            for _ in 0..2000 {
                let p = Vec3::from_fn(|_, _| random.between(-0.008, 0.008));
                let found = tree.nearest(&p);
                assert!(
                    (found.signed.abs() - brute(&mesh, &p)).abs() < 1e-15,
                    "{p:?}"
                );
                assert_eq!(found.signed < 0.0, winding(&mesh, &p) > 0.5, "{p:?}");
            }
        }
    }

    #[test]
    fn the_sign_is_right_beyond_sharp_edges_and_corners() {
        let tree = MeshDistance::new(cuboid(Vec3::repeat(0.001)));
        assert!((tree.signed(&Vec3::repeat(0.002)) - 0.001 * 3.0_f64.sqrt()).abs() < 1e-15);
        assert!(
            (tree.signed(&Vec3::new(0.002, 0.002, 0.0)) - 0.001 * 2.0_f64.sqrt()).abs() < 1e-15
        );
        assert_eq!(tree.signed(&Vec3::zeros()), -0.001);
    }
}
