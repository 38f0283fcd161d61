//! Folder of a mesh and its load cases: comma-separated tables, in millimetres and newtons.
//!
//! - `nodes.csv`: id, x, y, z, kind. Ids count from 0 in the order of the rows.
//! - `tets10.csv`: id and ten nodes.
//! - `fixed_all_nodes.csv`: id.
//! - `fixed_surface_vertices.csv`: id, region.
//! - forces: id, x, y, z, then two sets of three numbers for the same load ([`ForceColumns`]).
//! - displacements: id, x, y, z, ux, uy, uz.

use std::path::Path;

use serde::Deserialize;
use serde::de::DeserializeOwned;
use sulcus_core::Vec3;

use crate::error::FemError;
use crate::mesh::TetMesh;

const MM: f64 = 1e-3;

#[derive(Deserialize)]
struct NodeRow {
    id: u32,
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Deserialize)]
struct TetRow {
    id: u32,
    n0: u32,
    n1: u32,
    n2: u32,
    n3: u32,
    m01: u32,
    m12: u32,
    m02: u32,
    m03: u32,
    m13: u32,
    m23: u32,
}

#[derive(Deserialize)]
struct IdRow {
    id: u32,
}

#[derive(Deserialize)]
struct QuadraticRow {
    id: u32,
    fx_quad: f64,
    fy_quad: f64,
    fz_quad: f64,
}

#[derive(Deserialize)]
struct VertexRow {
    id: u32,
    fx_vert: f64,
    fy_vert: f64,
    fz_vert: f64,
}

/// Set of columns of a table of forces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceColumns {
    /// `fx_quad`, `fy_quad`, `fz_quad`: consistent with the quadratic elements, on corners and midside nodes. The
    /// finite elements use them.
    Quadratic,
    /// `fx_vert`, `fy_vert`, `fz_vert`: the same load on the corners alone. Models of vertices or spheres use them.
    Vertices,
}

#[derive(Deserialize)]
struct MovedRow {
    id: u32,
    ux: f64,
    uy: f64,
    uz: f64,
}

/// Returns all rows of a table, each with its line.
fn rows<T: DeserializeOwned>(path: &Path) -> Result<Vec<(u64, T)>, FemError> {
    let wrong = |line: u64, found: String| FemError::Row {
        path: path.to_owned(),
        line,
        found,
        expected: "the columns that the head of the table names".into(),
    };
    let file = std::fs::File::open(path).map_err(|source| FemError::Open {
        path: path.to_owned(),
        source,
    })?;
    let mut reader = csv::Reader::from_reader(file);
    let mut all = Vec::new();
    for row in reader.deserialize() {
        let line = all.len() as u64 + 2;
        let row = row.map_err(|error| {
            let at = error.position().map_or(line, csv::Position::line);
            wrong(at, error.to_string())
        })?;
        all.push((line, row));
    }
    Ok(all)
}

/// Returns an id as an index; the id must be less than `bound`.
fn known(path: &Path, line: u64, id: u32, bound: usize) -> Result<usize, FemError> {
    if (id as usize) < bound {
        return Ok(id as usize);
    }
    Err(FemError::Row {
        path: path.to_owned(),
        line,
        found: format!("node {id}"),
        expected: format!("below {bound}"),
    })
}

/// Checks that an id is the number of its row.
fn in_order(path: &Path, line: u64, id: u32) -> Result<(), FemError> {
    let expected = line - 2;
    if u64::from(id) == expected {
        return Ok(());
    }
    Err(FemError::Row {
        path: path.to_owned(),
        line,
        found: format!("id {id}"),
        expected: format!("id {expected}, in order"),
    })
}

/// Reads the mesh of a folder. Its listed nodes are held along all axes.
///
/// # Errors
/// [`FemError`] with file and line, or with the fault of the mesh.
pub fn read_mesh(folder: &Path) -> Result<TetMesh, FemError> {
    let path = folder.join("nodes.csv");
    let mut mesh = TetMesh::default();
    for (line, row) in rows::<NodeRow>(&path)? {
        in_order(&path, line, row.id)?;
        mesh.nodes.push(Vec3::new(row.x, row.y, row.z) * MM);
    }
    let n = mesh.nodes.len();
    let path = folder.join("tets10.csv");
    for (line, r) in rows::<TetRow>(&path)? {
        in_order(&path, line, r.id)?;
        let tet = [
            r.n0, r.n1, r.n2, r.n3, r.m01, r.m12, r.m02, r.m03, r.m13, r.m23,
        ];
        for node in tet {
            known(&path, line, node, n)?;
        }
        mesh.tets.push(tet);
    }
    mesh.held = vec![[false; 3]; n];
    let path = folder.join("fixed_all_nodes.csv");
    for (line, row) in rows::<IdRow>(&path)? {
        mesh.held[known(&path, line, row.id, n)?] = [true; 3];
    }
    mesh.validate()?;
    Ok(mesh)
}

/// Reads nodal forces (N) for a mesh with this number of `nodes`. Nodes that the table omits have no load.
///
/// # Errors
/// [`FemError`] with file and line.
pub fn read_forces(
    path: &Path,
    nodes: usize,
    columns: ForceColumns,
) -> Result<Vec<Vec3>, FemError> {
    let named: Vec<(u64, u32, [f64; 3])> = match columns {
        ForceColumns::Quadratic => rows::<QuadraticRow>(path)?
            .into_iter()
            .map(|(line, r)| (line, r.id, [r.fx_quad, r.fy_quad, r.fz_quad]))
            .collect(),
        ForceColumns::Vertices => rows::<VertexRow>(path)?
            .into_iter()
            .map(|(line, r)| (line, r.id, [r.fx_vert, r.fy_vert, r.fz_vert]))
            .collect(),
    };
    let mut forces = vec![Vec3::zeros(); nodes];
    for (line, id, force) in named {
        forces[known(path, line, id, nodes)?] = Vec3::from(force);
    }
    Ok(forces)
}

/// Reads the held vertices of a list, all less than `nodes`, in the order of the list.
///
/// # Errors
/// [`FemError`] with file and line.
pub fn read_fixed_vertices(path: &Path, nodes: usize) -> Result<Vec<usize>, FemError> {
    let rows = rows::<IdRow>(path)?.into_iter();
    rows.map(|(line, row)| known(path, line, row.id, nodes))
        .collect()
}

/// Reads displacements: node and metres, row by row.
///
/// # Errors
/// [`FemError`] with file and line.
pub fn read_displacements(path: &Path, nodes: usize) -> Result<Vec<(usize, Vec3)>, FemError> {
    let rows = rows::<MovedRow>(path)?.into_iter();
    let read = rows.map(|(line, row)| {
        let node = known(path, line, row.id, nodes)?;
        Ok((node, Vec3::new(row.ux, row.uy, row.uz) * MM))
    });
    read.collect()
}
