//! Moving mesh in patches. A probe dents a corner of a gingiva, and only the moved patches are written again.

use std::collections::BTreeMap;

use rerun::RecordingStream;

use super::normals::normals;
use super::picture::{MeshPicture, Moment};
use super::waiting::Times;
use crate::error::Refusal;

/// Number of patches along the longest side of the mesh.
const ALONG: f32 = 4.0;
/// Motion of a vertex from which its patch is written again, as a share of the mesh's longest side. The share is a
/// fraction of a pixel when the whole mesh is in view. At 1e-3 seams between patches are visible as hairlines.
const SEEN: f32 = 4e-4;
/// Steps per millimetre to which vertices are rounded. Unmoved vertices keep the same bytes, which compress well.
const STEPS: f32 = 256.0;

/// Moving mesh in patches.
#[derive(Debug)]
pub(super) struct Patches {
    triangles: Vec<[u32; 3]>,
    seen: f32,
    patches: Vec<Patch>,
}

#[derive(Debug)]
struct Patch {
    path: String,
    /// Vertices of the mesh in the patch.
    vertices: Vec<u32>,
    /// Triangles by the patch's own vertices.
    triangles: Vec<[u32; 3]>,
    /// Vertices as last written.
    last: Vec<[f32; 3]>,
    times: Times,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
}

impl Patches {
    /// Cuts a mesh at rest. The patches are entities below `path`.
    pub fn new(path: &str, mesh: &MeshPicture) -> Self {
        let mut low = [f32::INFINITY; 3];
        let mut high = [f32::NEG_INFINITY; 3];
        for vertex in &mesh.vertices {
            for k in 0..3 {
                low[k] = low[k].min(vertex[k]);
                high[k] = high[k].max(vertex[k]);
            }
        }
        let longest = (0..3).fold(0.0f32, |most, k| most.max(high[k] - low[k]));
        let cell = (longest / ALONG).max(1e-6);
        let mut cells: BTreeMap<[u8; 3], Vec<[u32; 3]>> = BTreeMap::new();
        for triangle in &mesh.triangles {
            let middle = |k: usize| {
                let sum: f32 = triangle.iter().map(|&v| mesh.vertices[v as usize][k]).sum();
                ((sum / 3.0 - low[k]) / cell) as u8
            };
            cells
                .entry([middle(0), middle(1), middle(2)])
                .or_default()
                .push(*triangle);
        }
        let patches = cells.into_values().enumerate();
        let patches = patches.map(|(k, triangles)| Patch::new(format!("{path}/{k}"), &triangles));
        Self {
            triangles: mesh.triangles.clone(),
            seen: longest * SEEN,
            patches: patches.collect(),
        }
    }

    /// Writes the constant part of each patch.
    pub fn begin(&self, stream: &RecordingStream, mesh: &MeshPicture) -> Result<(), Refusal> {
        for patch in &self.patches {
            let of = MeshPicture {
                vertices: Vec::new(),
                triangles: patch.triangles.clone(),
                colour: mesh.colour,
                vertex_colours: colours(mesh, &patch.vertices),
            };
            let shown = rerun::Mesh3D::update_fields()
                .with_triangle_indices(of.triangles)
                .with_vertex_colors(super::begin::colours(&of.vertex_colours));
            stream.log_static(patch.path.as_str(), &shown)?;
        }
        // Columns do not wait for earlier logged data. Without the flush a viewer would have vertices and no triangles.
        stream.flush_blocking()?;
        Ok(())
    }

    /// Takes the places of the vertices, and adds rows for the moved patches.
    pub fn push(&mut self, at: Moment, vertices: &[[f32; 3]]) {
        let moved = |patch: &Patch| {
            let last = patch.last.iter();
            patch.last.is_empty()
                || last.zip(&patch.vertices).any(|(before, &v)| {
                    let now = vertices[v as usize];
                    (0..3).any(|k| (now[k] - before[k]).abs() > self.seen)
                })
        };
        let moved: Vec<bool> = self.patches.iter().map(moved).collect();
        if !moved.contains(&true) {
            return;
        }
        // The normals are those of the whole mesh, so that no seam is visible.
        let normals = normals(vertices, &self.triangles);
        let moved = self.patches.iter_mut().zip(moved);
        for patch in moved.filter_map(|(patch, moved)| moved.then_some(patch)) {
            patch.last.clear();
            let of = patch.vertices.iter().map(|&v| vertices[v as usize]);
            patch.last.extend(of);
            let rounded = patch
                .last
                .iter()
                .map(|v| v.map(|x| (x * STEPS).round() / STEPS));
            patch.positions.extend(rounded);
            let of = patch.vertices.iter().map(|&v| normals[v as usize]);
            patch.normals.extend(of);
            patch.times.push(at);
        }
    }

    /// Sends the waiting rows.
    pub fn send(&mut self, stream: &RecordingStream) -> Result<(), Refusal> {
        for patch in &mut self.patches {
            let rows = patch.times.len();
            if rows == 0 {
                continue;
            }
            let columns = rerun::Mesh3D::update_fields()
                .with_vertex_positions(patch.positions.drain(..))
                .with_vertex_normals(patch.normals.drain(..))
                .columns(std::iter::repeat_n(patch.vertices.len(), rows))?;
            patch.times.send(stream, &patch.path, columns)?;
        }
        Ok(())
    }

    /// Path and times of each patch.
    pub fn times(&self) -> impl Iterator<Item = (&str, &Times)> {
        let patches = self.patches.iter();
        patches.map(|patch| (patch.path.as_str(), &patch.times))
    }
}

impl Patch {
    fn new(path: String, triangles: &[[u32; 3]]) -> Self {
        let mut local = BTreeMap::new();
        let mut vertices = Vec::new();
        let triangles = triangles.iter().map(|triangle| {
            triangle.map(|v| {
                *local.entry(v).or_insert_with(|| {
                    vertices.push(v);
                    vertices.len() as u32 - 1
                })
            })
        });
        let triangles = triangles.collect();
        Self {
            path,
            vertices,
            triangles,
            last: Vec::new(),
            times: Times::default(),
            positions: Vec::new(),
            normals: Vec::new(),
        }
    }
}

fn colours(mesh: &MeshPicture, vertices: &[u32]) -> Vec<[u8; 3]> {
    let of = |&v: &u32| mesh.vertex_colours.get(v as usize).copied();
    vertices
        .iter()
        .map(|v| of(v).unwrap_or(mesh.colour))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of `n` squares along x.
    fn strip(n: u32) -> MeshPicture {
        let point = |k: u32| [(k / 2) as f32, (k % 2) as f32, 0.0];
        let square = |k: u32| {
            let v = 2 * k;
            [[v, v + 2, v + 1], [v + 1, v + 2, v + 3]]
        };
        MeshPicture {
            vertices: (0..2 * n + 2).map(point).collect(),
            triangles: (0..n).flat_map(square).collect(),
            colour: [1, 2, 3],
            vertex_colours: Vec::new(),
        }
    }

    #[test]
    fn every_triangle_is_in_one_patch_with_its_own_corners() {
        let mesh = strip(40);
        let patches = Patches::new("/a", &mesh);
        assert!((4..=5).contains(&patches.patches.len()));
        let of = |patch: &Patch| -> Vec<[u32; 3]> {
            let global = |triangle: &[u32; 3]| triangle.map(|v| patch.vertices[v as usize]);
            patch.triangles.iter().map(global).collect()
        };
        let mut found: Vec<[u32; 3]> = patches.patches.iter().flat_map(of).collect();
        let mut all = mesh.triangles.clone();
        found.sort_unstable();
        all.sort_unstable();
        assert_eq!(found, all);
    }

    #[test]
    fn only_what_has_moved_far_enough_is_written() {
        let mesh = strip(40);
        let mut patches = Patches::new("/a", &mesh);
        let at = |tick| Moment {
            tick,
            session_ns: tick,
        };
        let rows = |patches: &Patches| -> Vec<usize> {
            patches.times().map(|(_, times)| times.len()).collect()
        };
        let mut now = mesh.vertices.clone();
        patches.push(at(0), &now);
        assert!(rows(&patches).iter().all(|rows| *rows == 1), "all at first");
        // The motion is less than 4e-4 of 40 mm.
        now[0][2] = 0.01;
        patches.push(at(1), &now);
        assert!(rows(&patches).iter().all(|rows| *rows == 1));
        // The motion counts from the last written place, not from the last place.
        now[0][2] = 0.02;
        patches.push(at(2), &now);
        let many: Vec<usize> = rows(&patches);
        assert_eq!(
            many.iter().filter(|rows| **rows == 2).count(),
            1,
            "{many:?}"
        );
    }
}
