//! The load cases of a folder: tables of unit forces, and of displacements under so many times them.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use sulcus_core::Vec3;
use sulcus_fem::files::{ForceColumns, read_displacements, read_forces};
use sulcus_program::PathText;

use super::organ::Organ;

/// One case: a table of displacements, and the forces that made them.
pub(crate) struct Case {
    /// Stem of the table's name.
    pub(crate) name: String,
    /// Whether the finite elements were linear.
    pub(crate) linear: bool,
    /// Forces on the vertices of the surface, newtons.
    pub(crate) forces: Vec<Vec3>,
    table: PathBuf,
}

/// The cases of a folder, by name and rising load: each table `LOAD_lin_<N>N.csv` or `LOAD_nl_<N>N.csv` beside a table
/// `LOAD_forces_unit.csv`. Displacements are not read yet.
///
/// # Errors
/// If there is none, or a table of forces cannot be read.
pub(crate) fn cases(folder: &Path, organ: &Organ) -> anyhow::Result<Vec<Case>> {
    let listed = std::fs::read_dir(folder)
        .with_context(|| format!("{}: cannot read the folder", folder.shown()))?;
    let mut tables: Vec<(String, String, f64, PathBuf)> = listed
        .filter_map(|entry| {
            let path = entry.ok()?.path();
            let stem = path.file_name()?.to_str()?.strip_suffix("N.csv")?;
            let (rest, newtons) = stem.rsplit_once('_')?;
            let (load, law) = rest.rsplit_once('_')?;
            let newtons: f64 = newtons.parse().ok()?;
            matches!(law, "lin" | "nl")
                .then(|| (load.to_owned(), law.to_owned(), newtons, path.clone()))
        })
        .collect();
    tables.sort_by(|a, b| (&a.0, &a.1).cmp(&(&b.0, &b.1)).then(a.2.total_cmp(&b.2)));
    if tables.is_empty() {
        bail!(
            "{}: found no table of displacements, expected some named LOAD_lin_<N>N.csv or LOAD_nl_<N>N.csv",
            folder.shown()
        );
    }
    let mut unit: Option<(String, Vec<Vec3>)> = None;
    tables
        .into_iter()
        .map(|(load, law, newtons, table)| {
            if unit.as_ref().is_none_or(|(of, _)| *of != load) {
                let path = folder.join(format!("{load}_forces_unit.csv"));
                unit = Some((load.clone(), vertex_forces(&path, organ)?));
            }
            let forces = unit
                .iter()
                .flat_map(|(_, forces)| forces.iter().map(|f| f * newtons))
                .collect();
            Ok(Case {
                name: format!("{load}_{law}_{newtons}N"),
                linear: law == "lin",
                forces,
                table,
            })
        })
        .collect()
}

/// Forces on the vertices of the surface, newtons.
fn vertex_forces(path: &Path, organ: &Organ) -> anyhow::Result<Vec<Vec3>> {
    let all = read_forces(path, organ.elements.nodes.len(), ForceColumns::Vertices)?;
    let inside = |(k, f): (usize, &Vec3)| {
        (*f != Vec3::zeros() && !organ.vertex_of.contains_key(&(k as u32))).then_some(k)
    };
    if let Some(node) = all.iter().enumerate().find_map(inside) {
        bail!(
            "{}: a force on node {node}, expected forces on the surface's vertices only",
            path.shown()
        );
    }
    Ok(organ.nodes.iter().map(|&node| all[node as usize]).collect())
}

impl Case {
    /// What the finite elements say: displacements of the vertices of the surface, metres.
    ///
    /// # Errors
    /// If the table cannot be read or lacks a vertex.
    pub(crate) fn displacements(&self, organ: &Organ) -> anyhow::Result<Vec<Vec3>> {
        let mut moved = vec![None; organ.nodes.len()];
        for (node, by) in read_displacements(&self.table, organ.elements.nodes.len())? {
            if let Some(vertex) = organ.vertex_of.get(&(node as u32)) {
                moved[*vertex] = Some(by);
            }
        }
        if let Some(&vertex) = organ.free.iter().find(|&&v| moved[v].is_none()) {
            bail!(
                "{}: there is no node {}, expected all vertices of the surface",
                self.table.shown(),
                organ.nodes[vertex]
            );
        }
        Ok(moved.into_iter().map(Option::unwrap_or_default).collect())
    }
}
