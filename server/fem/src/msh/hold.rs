//! Held nodes: those of the physical groups named `fixed`.

use std::collections::BTreeMap;

use super::{Reader, TET4, TET10};
use crate::element::EDGES;
use crate::error::FemError;
use crate::mesh::TetMesh;

/// Name of the groups.
const FIXED: &str = "fixed";

impl Reader<'_> {
    /// Holds the nodes of the groups named `fixed`. `new` has the mesh's number of each node of the file.
    pub(super) fn hold(
        &self,
        mesh: &mut TetMesh,
        index: &BTreeMap<u64, usize>,
        new: &[u32],
    ) -> Result<(), FemError> {
        let groups = self.groups(FIXED, 0);
        if groups.is_empty() {
            return Ok(());
        }
        let mut middles = BTreeMap::new();
        for tet in &mesh.tets {
            for ([i, j], middle) in EDGES.iter().zip(&tet[4..]) {
                let (a, b) = (tet[*i], tet[*j]);
                middles.insert((a.min(b), a.max(b)), *middle);
            }
        }
        for element in &self.file.elements {
            if !self.is_in(element, &groups) {
                continue;
            }
            let corners = match element.kind {
                15 => 1,
                1 | 8 => 2,
                2 | 9 => 3,
                TET4 | TET10 => 4,
                other => {
                    let found = format!("element of kind {other} in group \"{FIXED}\"");
                    let expected = "points, lines, triangles or tetrahedra";
                    return Err(self.wrong(element.line, &found, expected));
                }
            };
            let ids = self.ids(element, index)?;
            let mut hold = |node: u32| {
                // A node of another volume is not in the mesh.
                if let Some(held) = mesh.held.get_mut(node as usize) {
                    *held = [true; 3];
                }
            };
            ids.iter().for_each(|&id| hold(new[id]));
            let corners = &ids[..corners];
            for a in corners {
                for b in corners {
                    let (a, b) = (new[*a], new[*b]);
                    middles
                        .get(&(a, b))
                        .into_iter()
                        .for_each(|middle| hold(*middle));
                }
            }
        }
        if mesh.held.iter().any(|held| held[0]) {
            return Ok(());
        }
        let found = format!("no node of the volume in group \"{FIXED}\"");
        Err(self.whole(&found, "at least 1, or no such group"))
    }
}
