//! Blocks with loads, and the place of the reference solutions.

// Each test file uses a part of this module.
#![allow(dead_code)]

use std::path::{Path, PathBuf};

use sulcus_core::Vec3;
use sulcus_fem::files::{ForceColumns, read_displacements, read_forces};
use sulcus_fem::msh::{Unit, read_msh};
use sulcus_fem::{Elastic, TetMesh};

/// Folder of reference solutions; `None` if the data is absent.
pub fn reference() -> Option<PathBuf> {
    sulcus_support::data("fem")
}

/// Forces of a case of the reference on all nodes, newtons.
pub fn load(folder: &Path, name: &str, newtons: &str, nodes: usize) -> Vec<Vec3> {
    let file = folder.join(format!("{name}_forces_unit.csv"));
    let unit = read_forces(&file, nodes, ForceColumns::Quadratic).expect("forces");
    let by: f64 = newtons.parse().expect("a number");
    unit.iter().map(|f| f * by).collect()
}

/// Largest difference from the reference at any of its vertices, as a share of its largest displacement.
pub fn off(folder: &Path, case: &str, moved: &[Vec3]) -> f64 {
    let known = read_displacements(&folder.join(case), moved.len()).expect("displacements");
    assert!(known.len() > 2000);
    let most = known.iter().map(|(_, u)| u.norm()).fold(0.0, f64::max);
    let off = known
        .iter()
        .map(|(k, u)| (moved[*k] - u).norm())
        .fold(0.0, f64::max);
    println!(
        "{case}: {} vertices, largest {:.3} mm, off by at most {:.5} mm, {:.4} %",
        known.len(),
        most * 1e3,
        off * 1e3,
        100.0 * off / most
    );
    off / most
}

/// Material of the reference solutions.
pub const TONGUE: Elastic = Elastic {
    young: 1e5,
    poisson: 0.49,
};

/// A block of `cells` boxes, each of six tetrahedra, of `size` metres. One corner is at the origin.
pub fn block(cells: [usize; 3], size: Vec3) -> TetMesh {
    let [nx, ny, nz] = cells;
    let id = |i: usize, j: usize, k: usize| (i + (nx + 1) * (j + (ny + 1) * k)) as u32;
    let mut corners = Vec::new();
    for k in 0..=nz {
        for j in 0..=ny {
            for i in 0..=nx {
                let part = [(i, nx), (j, ny), (k, nz)].map(|(i, n)| i as f64 / n as f64);
                corners.push(size.component_mul(&Vec3::from(part)));
            }
        }
    }
    let mut tets = Vec::new();
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                let c = |bits: usize| id(i + (bits & 1), j + (bits >> 1 & 1), k + (bits >> 2));
                // Ring around the diagonal from 0 to 7.
                let ring = [1, 3, 2, 6, 4, 5];
                for s in 0..6 {
                    tets.push([c(0), c(ring[s]), c(ring[(s + 1) % 6]), c(7)]);
                }
            }
        }
    }
    TetMesh::from_corners(corners, &tets)
}

/// Nodes for which `on` holds.
pub fn nodes(mesh: &TetMesh, on: impl Fn(&Vec3) -> bool) -> Vec<usize> {
    (0..mesh.nodes.len())
        .filter(|&k| on(&mesh.nodes[k]))
        .collect()
}

/// Forces of a uniform traction (Pa) on the face of the block at `x = end`.
///
/// Consistent forces are a third of a triangle's share on the middle of each edge, and zero on its corners.
pub fn pull(mesh: &TetMesh, end: f64, traction: Vec3) -> Vec<Vec3> {
    let mut forces = vec![Vec3::zeros(); mesh.nodes.len()];
    let on = |node: u32| (mesh.nodes[node as usize].x - end).abs() < 1e-12;
    for tet in &mesh.tets {
        let face: Vec<u32> = tet[..4].iter().copied().filter(|&n| on(n)).collect();
        let [a, b, c] = face[..] else { continue };
        let [a, b, c] = [a, b, c].map(|n| mesh.nodes[n as usize]);
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        for &node in tet[4..].iter().filter(|&&n| on(n)) {
            forces[node as usize] += traction * (area / 3.0);
        }
    }
    forces
}

pub const SOFT: Elastic = Elastic {
    young: 1e5,
    poisson: 0.49,
};

/// A file that Gmsh wrote.
pub fn data(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(name)
}

/// Writes a text as a file of Gmsh and reads it as a mesh, in metres.
pub fn try_text(
    name: &str,
    text: impl AsRef<[u8]>,
    volume: Option<&str>,
) -> Result<TetMesh, String> {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, text).expect("a file");
    read_msh(&path, Unit::Metre, volume).map_err(|error| error.to_string())
}

/// Tetrahedron of four nodes with tags far apart, an unused node, a held triangle, line ends of another system,
/// and an unknown section.
pub const ONE: &str =
    "$MeshFormat\r\n2.2 0 8\r\n$EndMeshFormat\r\n$Comments\nanything $Nodes\n$EndComments
$PhysicalNames\n2\n2 5 \"fixed\"\n3 6 \"one\"\n$EndPhysicalNames
$Nodes\n5\n7 0 0 0\n4000000000000 1 0 0\n3 9 9 9\n12 0 1e0 0\n5 0.0 0 1\n$EndNodes
$Elements\n2\n1 2 2 5 1 7 12 4000000000000\n9 4 2 6 1 7 4000000000000 12 5\n$EndElements\n";
