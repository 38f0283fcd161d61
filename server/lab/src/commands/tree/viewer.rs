//! The tree as a file for the Rerun viewer.

use std::io::{BufWriter, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::Context as _;
use sulcus_core::{Sphere, SphereTree, Vec3};
use sulcus_program::PathText;
use sulcus_scene::error::{TreeReport, surface_error, surface_points};
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::mesh::repair::repair;
use sulcus_view::{LevelPicture, TreePicture};

use crate::picture::{Scale, diverging, ivory};

/// Colours are per vertex, so triangles are cut in four until there are at least so many.
const TRIANGLES: usize = 40_000;
/// Points of the surface whose errors set the scale of a level.
const POINTS: usize = 50_000;

/// Content of the file.
pub(super) struct Subject<'a> {
    /// Name of the mesh.
    pub(super) name: String,
    /// The mesh.
    pub(super) distance: &'a MeshDistance,
    /// The tree.
    pub(super) tree: &'a SphereTree,
    /// The measured errors.
    pub(super) report: &'a TreeReport,
}

/// Writes `tree.rrd` through the child process `program`, which reads the picture as JSON from its standard input.
///
/// # Errors
/// When the child process cannot be started or fails; its own message stands on standard error.
pub(super) fn write(program: &Path, path: &Path, subject: &Subject) -> anyhow::Result<()> {
    let picture = picture(subject);
    let named = || format!("{}: cannot write {}", program.shown(), path.shown());
    let mut child = Command::new(program)
        .args(["tree", "--out"])
        .arg(path)
        .stdin(Stdio::piped())
        .spawn()
        .with_context(named)?;
    let to = child.stdin.take().with_context(named)?;
    let mut to = BufWriter::new(to);
    // A child that failed closes the pipe; its exit code says more than the broken pipe.
    let written = serde_json::to_writer(&mut to, &picture).map_err(anyhow::Error::from);
    let flushed = to.flush();
    drop(to);
    let ended = child.wait().with_context(named)?;
    anyhow::ensure!(ended.success(), "{}: ended by {ended}", named());
    written.with_context(named)?;
    flushed.with_context(named)
}

fn picture(subject: &Subject) -> TreePicture {
    let mut mesh = subject.distance.mesh().clone();
    while mesh.triangles.len() < TRIANGLES {
        mesh = cut_in_four(&mesh);
    }
    let fine = MeshDistance::new(mesh);
    let mesh = fine.mesh();
    let normal = |v| {
        let n = fine.vertex_normal(v);
        [n.x, n.y, n.z].map(|x| x as f32)
    };
    TreePicture {
        name: subject.name.clone(),
        vertices: mesh.vertices.iter().map(millimetres).collect(),
        normals: (0..mesh.vertices.len() as u32).map(normal).collect(),
        triangles: mesh.triangles.clone(),
        levels: levels(subject, mesh),
    }
}

fn millimetres(v: &Vec3) -> [f32; 3] {
    [v.x, v.y, v.z].map(|x| (1e3 * x) as f32)
}

/// The levels of the tree, coarse to fine, with the colours of the vertices of `fine`, the mesh cut finer.
fn levels(subject: &Subject, fine: &TriMesh) -> Vec<LevelPicture> {
    let points = surface_points(subject.distance.mesh(), POINTS);
    let places: Vec<_> = points.iter().map(|p| p.point).collect();
    let level = |level: u8| {
        let shape = subject.tree.shape_at(level);
        let spheres: Vec<Sphere> = shape.map(|(_, node)| node.sphere()).collect();
        let errors = surface_error(&spheres, &places).into_iter().zip(&points);
        let weighted_mm: Vec<_> = errors.map(|(error, p)| (1e3 * error, p.area)).collect();
        let scale = Scale::fit(&weighted_mm);
        let vertex_colours = surface_error(&spheres, &fine.vertices)
            .into_iter()
            .map(|error| diverging(scale.part(1e3 * error)));
        let error = &subject.report.levels[usize::from(level)];
        LevelPicture {
            level,
            vertex_colours: vertex_colours.collect(),
            centres: spheres.iter().map(|s| millimetres(&s.centre)).collect(),
            radii: spheres.iter().map(|s| (1e3 * s.radius) as f32).collect(),
            sphere_colours: (0..spheres.len() as u32).map(ivory).collect(),
            caption: format!(
                "**Level {level}: {} spheres.** Blue: the mesh sticks out of the spheres (gap, at most {:.3} mm). Orange: a sphere sticks out of the mesh (bulge, at most {:.3} mm). Full colour: {} mm.\n\nMesh to spheres: mean {:.4}, max {:.4} mm. Spheres to mesh: mean {:.4}, max {:.4} mm.",
                error.spheres,
                error.max_gap_mm,
                error.max_bulge_mm,
                scale.full_mm,
                error.mesh_to_spheres_mm.mean,
                error.mesh_to_spheres_mm.max,
                error.spheres_to_mesh_mm.mean,
                error.spheres_to_mesh_mm.max,
            ),
        }
    };
    (0..=subject.tree.depth()).map(level).collect()
}

/// Every triangle as four, on the same surface.
fn cut_in_four(mesh: &TriMesh) -> TriMesh {
    let mut cut = TriMesh::default();
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t);
        let first = cut.vertices.len() as u32;
        // Both triangles of an edge get the same middle, to the bit: joining equal vertices closes the cuts.
        let (ab, bc, ca) = ((a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5);
        cut.vertices.extend([a, b, c, ab, bc, ca]);
        for corners in [[0, 3, 5], [3, 1, 4], [5, 4, 2], [4, 5, 3]] {
            cut.triangles.push(corners.map(|k| first + k));
        }
    }
    repair(cut).0
}

#[cfg(test)]
mod tests {
    use sulcus_scene::mesh::shapes::cuboid;

    use super::*;

    #[test]
    fn cutting_keeps_the_solid() {
        let mesh = cuboid(Vec3::new(0.001, 0.002, 0.003));
        let cut = cut_in_four(&mesh);
        // Vertices and edges of the box: 8 + 18.
        assert_eq!((cut.triangles.len(), cut.vertices.len()), (48, 26));
        assert!((cut.signed_volume() / mesh.signed_volume() - 1.0).abs() < 1e-12);
    }
}
