//! The tree as a file for the Rerun viewer.

use std::io::{BufWriter, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::Context as _;
use sulcus_core::Vec3;
use sulcus_program::PathText;
use sulcus_scene::error::surface_error;
use sulcus_scene::mesh::TriMesh;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::mesh::repair::repair;
use sulcus_view::{LevelPicture, TreePicture};

use crate::page::{LevelErrors, Subject};
use crate::picture::{diverging, ivory};

/// Colours are per vertex, so triangles are cut in four until there are at least so many.
const TRIANGLES: usize = 40_000;

/// Writes `tree.rrd` through the child process `program`, which reads the picture as JSON from its standard input.
///
/// # Errors
/// When the child process cannot be started or fails; its own message stands on standard error.
pub(super) fn write(
    program: &Path,
    path: &Path,
    subject: &Subject,
    levels: &[LevelErrors],
) -> anyhow::Result<()> {
    let picture = picture(subject, levels);
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

fn picture(subject: &Subject, levels: &[LevelErrors]) -> TreePicture {
    let mut mesh = subject.distance.mesh().clone();
    while mesh.triangles.len() < TRIANGLES {
        mesh = cut_in_four(&mesh);
    }
    let fine = MeshDistance::new(mesh);
    let mesh = fine.mesh();
    let millimetres = |v: &Vec3| [v.x, v.y, v.z].map(|x| (1e3 * x) as f32);
    TreePicture {
        name: subject.name.clone(),
        vertices: mesh.vertices.iter().map(millimetres).collect(),
        normals: (0..mesh.vertices.len() as u32)
            .map(|v| {
                let n = fine.vertex_normal(v);
                [n.x, n.y, n.z].map(|x| x as f32)
            })
            .collect(),
        triangles: mesh.triangles.clone(),
        levels: levels
            .iter()
            .zip(&subject.report.levels)
            .map(|(level, error)| LevelPicture {
                level: level.level,
                vertex_colours: surface_error(&level.spheres, &mesh.vertices)
                    .into_iter()
                    .map(|error| diverging(level.scale.part(1e3 * error)))
                    .collect(),
                centres: level.spheres.iter().map(|s| millimetres(&s.centre)).collect(),
                radii: level.spheres.iter().map(|s| (1e3 * s.radius) as f32).collect(),
                sphere_colours: (0..level.spheres.len() as u32).map(ivory).collect(),
                caption: format!(
                    "**Level {}: {} spheres.** Blue: the mesh sticks out of the spheres (gap, at most {:.3} mm). Orange: a sphere sticks out of the mesh (bulge, at most {:.3} mm). Full colour: {} mm.\n\nMesh to spheres: mean {:.4}, max {:.4} mm. Spheres to mesh: mean {:.4}, max {:.4} mm.",
                    level.level,
                    error.spheres,
                    error.max_gap_mm,
                    error.max_bulge_mm,
                    level.scale.full_mm,
                    error.mesh_to_spheres_mm.mean,
                    error.mesh_to_spheres_mm.max,
                    error.spheres_to_mesh_mm.mean,
                    error.spheres_to_mesh_mm.max,
                ),
            })
            .collect(),
    }
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
