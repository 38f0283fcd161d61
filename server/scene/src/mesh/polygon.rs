//! Faces with more than three corners as triangles that fill exactly the face.
//!
//! A fan from the first corner fills a face only if every corner is visible from the first. For a horseshoe it also
//! covers the open side.
//!
//! - Quadrilaterals are cut along a diagonal that lies inside.
//! - Other faces are triangulated in the coordinate plane that faces them most, by constrained Delaunay with exact
//!   predicates. Every corner becomes a corner of triangles, also on a straight edge. Edges that cross or touch are
//!   detected.

use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};
use sulcus_core::Vec3;
use sulcus_core::math::fmax;

/// Largest distance of a corner from the best plane of a face of five corners or more, as a share of the diagonal of
/// the face's box.
pub const FLAT_SHARE: f64 = 0.05;
/// The same for quadrilaterals. Their two triangles follow a bent surface, as usual in meshes of quadrilaterals.
pub const FLAT_SHARE_OF_FOUR: f64 = 0.1;
/// Largest number of corners of a face.
pub const MOST_CORNERS: usize = 100_000;
/// Areas below this share of the square of the face's size are rounding.
const NO_AREA: f64 = 1e-12;

/// The kind of face expected, for messages.
pub(crate) const FACE: &str =
    "a flat face of different corners whose edges meet nowhere but at the corners";

/// Appends the triangles of a face in the direction of its corners.
///
/// A face of three corners is the triangle of any shape. A convex quadrilateral is cut from its first corner to its
/// third.
///
/// # Errors
/// The fault of the face, in a few words.
pub(crate) fn triangulate(
    corners: &[u32],
    vertices: &[Vec3],
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(), String> {
    let most = match corners.len() {
        4 => FLAT_SHARE_OF_FOUR,
        _ => FLAT_SHARE,
    };
    triangulate_within(corners, vertices, most, triangles)
}

/// Appends the triangles of a face whose corners may be off its best plane by a share `most` of its size.
///
/// # Errors
/// Errors of [`triangulate`].
pub(crate) fn triangulate_within(
    corners: &[u32],
    vertices: &[Vec3],
    most: f64,
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(), String> {
    match corners {
        [] | [_] | [_, _] => return Err(format!("a face of {} corners", corners.len())),
        &[a, b, c] => {
            triangles.push([a, b, c]);
            return Ok(());
        }
        _ if corners.len() > MOST_CORNERS => {
            let count = corners.len();
            return Err(format!(
                "a face of {count} corners, more than {MOST_CORNERS}"
            ));
        }
        _ => {}
    }
    if let Some((first, second)) = repeated(corners) {
        return Err(format!(
            "a face whose corners {first} and {second} are the same vertex"
        ));
    }
    let points: Vec<Vec3> = corners.iter().map(|&v| vertices[v as usize]).collect();
    let plane = Plane::of(&points, most)?;
    let local = match points.len() {
        4 => quadrilateral(&points, &plane)?.to_vec(),
        _ => delaunay(&points, &plane)?,
    };
    triangles.extend(local.into_iter().map(|t| t.map(|k| corners[k])));
    Ok(())
}

/// Returns the numbers, from 1, of the first two corners that are one vertex.
fn repeated(corners: &[u32]) -> Option<(usize, usize)> {
    let mut order: Vec<(u32, usize)> = corners.iter().copied().zip(1..).collect();
    order.sort_unstable();
    let pairs = order.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    pairs.map(|pair| (pair[0].1, pair[1].1)).min()
}

/// The best plane of a face.
pub(crate) struct Plane {
    /// Unit normal, by the right hand; zero for a face without area.
    normal: Vec3,
    /// Diagonal of the face's box.
    size: f64,
    /// Largest distance of a corner from the plane.
    pub(crate) off: f64,
}

impl Plane {
    /// Returns the plane through the mean of the corners with Newell's normal.
    pub(crate) fn through(points: &[Vec3]) -> Self {
        let mean = points.iter().sum::<Vec3>() / points.len() as f64;
        let mut area = Vec3::zeros();
        let (mut low, mut high) = (points[0], points[0]);
        for (k, p) in points.iter().enumerate() {
            let next = points[(k + 1) % points.len()];
            area += (p - mean).cross(&(next - mean));
            low = low.zip_map(p, sulcus_core::math::fmin);
            high = high.zip_map(p, fmax);
        }
        let (size, length) = ((high - low).norm(), area.norm());
        let normal = if length > NO_AREA * size * size {
            area / length
        } else {
            Vec3::zeros()
        };
        let off = points
            .iter()
            .fold(0.0, |most, p| fmax(most, normal.dot(&(p - mean)).abs()));
        Self { normal, size, off }
    }

    /// Returns the plane of a face that must be flat.
    fn of(points: &[Vec3], most: f64) -> Result<Self, String> {
        if !points.iter().flatten().all(|x| x.is_finite()) {
            return Err("a face with a corner whose place is not a number".to_owned());
        }
        let plane = Self::through(points);
        if plane.normal != Vec3::zeros() && plane.off > most * plane.size {
            return Err(format!(
                "a face of {} corners that is not flat: a corner is {:.1} % of the face's size off the best plane, more than {} %",
                points.len(),
                100.0 * plane.off / plane.size,
                100.0 * most
            ));
        }
        Ok(plane)
    }
}

/// The two triangles of a quadrilateral.
fn quadrilateral(points: &[Vec3], plane: &Plane) -> Result<[[usize; 3]; 2], String> {
    let least = NO_AREA * plane.size * plane.size;
    let cross = |[a, b, c]: [usize; 3]| (points[b] - points[a]).cross(&(points[c] - points[a]));
    let halves = [[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]];
    for pair in halves {
        if pair.iter().all(|&t| cross(t).dot(&plane.normal) > least) {
            return Ok(pair);
        }
    }
    // Points on one line have no area to fill.
    let line = halves.iter().flatten().all(|&t| cross(t).norm() <= least);
    if line && plane.size > 0.0 {
        return Ok(halves[0]);
    }
    Err("a face of 4 corners that crosses or touches itself".to_owned())
}

/// Returns the triangles of a face, each from its first corner, in order.
fn delaunay(points: &[Vec3], plane: &Plane) -> Result<Vec<[usize; 3]>, String> {
    let count = points.len();
    if plane.normal == Vec3::zeros() {
        return Err(format!("a face of {count} corners without area"));
    }
    let mut net = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut handles: Vec<FixedVertexHandle> = Vec::with_capacity(count);
    for (k, p) in points.iter().enumerate() {
        let handle = net
            .insert(flat(p, &plane.normal))
            .map_err(|error| format!("a face whose corner {} is out of range ({error})", k + 1))?;
        // Vertices are numbered in their order. An occupied place returns the earlier number.
        if handle.index() != k {
            return Err(format!(
                "a face whose corners {} and {} are in one place",
                handle.index() + 1,
                k + 1
            ));
        }
        handles.push(handle);
    }
    let mut inside = Vec::new();
    for k in 0..count {
        let next = (k + 1) % count;
        let parts = net.try_add_constraint(handles[k], handles[next]);
        let [edge] = parts[..] else {
            let how = if parts.is_empty() {
                "crosses"
            } else {
                "touches"
            };
            return Err(format!(
                "a face of {count} corners that {how} itself at the edge from corner {} to {}",
                k + 1,
                next + 1
            ));
        };
        inside.push(edge);
    }
    let mut seen = vec![false; net.num_all_faces()];
    let mut faces = Vec::new();
    for edge in inside {
        faces.extend(net.directed_edge(edge).face().as_inner());
    }
    let mut filled = Vec::with_capacity(count - 2);
    while let Some(face) = faces.pop() {
        if std::mem::replace(&mut seen[face.fix().index()], true) {
            continue;
        }
        filled.push(from_first(face.vertices().map(|v| v.fix().index())));
        for edge in face.adjacent_edges() {
            if !edge.is_constraint_edge() {
                faces.extend(edge.rev().face().as_inner());
            }
        }
    }
    // The angles of a simple polygon add up to those of this number of triangles.
    if filled.len() != count - 2 {
        return Err(format!(
            "a face of {count} corners that has no triangulation ({} triangles)",
            filled.len()
        ));
    }
    filled.sort_unstable();
    Ok(filled)
}

/// Returns the place in the coordinate plane that faces `normal` most, as seen from the tip of the normal.
fn flat(p: &Vec3, normal: &Vec3) -> Point2<f64> {
    let w = normal.iamax();
    let (u, v) = ((w + 1) % 3, (w + 2) % 3);
    let (u, v) = if normal[w] < 0.0 { (v, u) } else { (u, v) };
    // Numbers too small for the predicates are zeros.
    let part = |x: f64| if x.abs() < 1e-40 { 0.0 } else { x };
    Point2::new(part(p[u]), part(p[v]))
}

fn from_first([a, b, c]: [usize; 3]) -> [usize; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}
