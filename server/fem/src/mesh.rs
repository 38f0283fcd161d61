//! A mesh of quadratic tetrahedra with its held nodes.

use std::collections::BTreeMap;

use sulcus_core::Vec3;

use crate::element::{EDGES, gradients, is_upright};
use crate::error::FemError;

/// A mesh of quadratic tetrahedra.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TetMesh {
    /// Nodes, metres.
    pub nodes: Vec<Vec3>,
    /// Four corners, then the middles of the edges 01, 12, 02, 03, 13, 23.
    pub tets: Vec<[u32; 10]>,
    /// Whether each node is held along x, y, z.
    pub held: Vec<[bool; 3]>,
}

impl TetMesh {
    /// Returns the mesh of linear tetrahedra, with a node added in the middle of each edge. Nothing is held.
    pub fn from_corners(corners: Vec<Vec3>, tets: &[[u32; 4]]) -> Self {
        let mut nodes = corners;
        let mut middles = BTreeMap::new();
        let tets = tets.iter().map(|corners| {
            std::array::from_fn(|a| {
                let Some(edge) = a.checked_sub(4) else {
                    return corners[a];
                };
                let [i, j] = EDGES[edge].map(|k| corners[k]);
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    nodes.push((nodes[i as usize] + nodes[j as usize]) * 0.5);
                    nodes.len() as u32 - 1
                })
            })
        });
        let tets = tets.collect();
        let held = vec![[false; 3]; nodes.len()];
        Self { nodes, tets, held }
    }

    /// Checks all fields of the mesh.
    ///
    /// # Errors
    /// [`FemError::Field`] with the field, the value found and the values allowed.
    pub fn validate(&self) -> Result<(), FemError> {
        let n = self.nodes.len();
        if self.tets.is_empty() {
            return Err(FemError::field("number of tetrahedra", "0", "at least 1"));
        }
        if self.held.len() != n {
            let found = self.held.len().to_string();
            return Err(FemError::field("length of `held`", found, n.to_string()));
        }
        let place = self
            .nodes
            .iter()
            .position(|x| !x.iter().all(|x| x.abs() <= 10.0));
        if let Some(k) = place {
            let found = format!("{:?} at {k}", self.nodes[k]);
            return Err(FemError::field("node", found, "within 10 m"));
        }
        for (k, tet) in self.tets.iter().enumerate() {
            if let Some(unknown) = tet.iter().find(|&&node| node as usize >= n) {
                let found = format!("{unknown} in tetrahedron {k}");
                return Err(FemError::field("node", found, format!("below {n}")));
            }
            if !is_upright(&self.corners(tet)) {
                let found = format!("flat or inside out ({k})");
                let expected = "corners 1, 2, 3 anticlockwise seen from corner 0's far side, edges not bent over";
                return Err(FemError::field("tetrahedron", found, expected));
            }
        }
        Ok(())
    }

    /// Returns the places of the nodes of a tetrahedron, metres.
    pub(crate) fn corners(&self, tet: &[u32; 10]) -> [Vec3; 10] {
        tet.map(|node| self.nodes[node as usize])
    }

    /// Returns the volume, m3.
    pub fn volume(&self) -> f64 {
        let of = |tet: &[u32; 10]| {
            let all = gradients(&self.corners(tet));
            all.map_or(0.0, |all| all.iter().map(|(_, volume)| volume).sum())
        };
        self.tets.iter().map(of).sum()
    }
}
