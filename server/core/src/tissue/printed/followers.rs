//! Motion of the tree's nodes with the nodes of a single level: section 6 of the paper.
//!
//! The nodes of that level are the movers. Nodes below the movers shift with their ancestor. Nodes above the movers
//! keep their centre and change their radius by Eq. 17, which the tick applies to every tissue.

use crate::math::Vec3;
use crate::tree::{Node, SphereTree, refit_bounds};

/// Assignment of the nodes of a tree to the movers that they follow.
#[derive(Clone, Debug)]
pub(super) struct Followers {
    rest: Vec<Node>,
    /// Movers: tree nodes of the moving level, ascending.
    pub movers: Vec<u32>,
    /// For each tree node, the index in `movers` of its mover; `None` for nodes above the movers.
    pub place: Vec<Option<u32>>,
    nodes: Vec<Node>,
}

impl Followers {
    /// Creates the assignment with the tree's shape at `level` as movers.
    pub fn new(rest: &SphereTree, level: u8) -> Self {
        let nodes = rest.nodes();
        let movers: Vec<u32> = rest.shape_at(level).map(|(id, _)| id).collect();
        let mut place = vec![None; nodes.len()];
        for (at, &id) in movers.iter().enumerate() {
            place[id as usize] = Some(at as u32);
        }
        for (id, node) in nodes.iter().enumerate() {
            if node.level >= level {
                let first = node.first_child as usize;
                for child in first..first + usize::from(node.children) {
                    place[child] = place[id];
                }
            }
        }
        Self {
            movers,
            place,
            nodes: nodes.to_vec(),
            rest: nodes.to_vec(),
        }
    }

    /// Reassigns each node below the movers from its ancestor to the mover that `carriers` names.
    ///
    /// `carriers` holds a tree node for each node of the tree. Entries that are no movers are ignored.
    pub fn carried_by(mut self, carriers: &[u32]) -> Self {
        let below = |followers: &Self, id: usize| {
            followers.place[id].is_some() && followers.movers.binary_search(&(id as u32)).is_err()
        };
        for (id, carrier) in carriers.iter().enumerate().take(self.place.len()) {
            if below(&self, id)
                && let Ok(at) = self.movers.binary_search(carrier)
            {
                self.place[id] = Some(at as u32);
            }
        }
        self
    }

    /// Displacement of a tree node under the movers' displacements `u`, world axes, metres; `u` holds x, y, z of each
    /// mover.
    #[inline]
    fn displacement(&self, u: &[f64], node: u32) -> Vec3 {
        self.place[node as usize].map_or_else(Vec3::zeros, |at| {
            let at = 3 * at as usize;
            Vec3::new(u[at], u[at + 1], u[at + 2])
        })
    }

    /// Writes the centres of the nodes `ids` under the movers' displacements `u` to `out`, world axes, metres.
    pub fn centres(&self, u: &[f64], ids: &[u32], out: &mut [Vec3]) {
        for (&id, centre) in ids.iter().zip(out) {
            *centre = self.rest[id as usize].centre + self.displacement(u, id);
        }
    }

    /// Returns all nodes under the movers' displacements `u` (x, y, z of each mover, metres), with refitted bounds, and
    /// the field `place`.
    pub fn posed(&mut self, u: &[f64]) -> (&[Node], &[Option<u32>]) {
        if u.iter().all(|x| *x == 0.0) {
            return (&self.rest, &self.place);
        }
        for (node, (rest, place)) in self.nodes.iter_mut().zip(self.rest.iter().zip(&self.place)) {
            node.centre = rest.centre;
            if let Some(at) = place {
                let at = 3 * *at as usize;
                node.centre += Vec3::new(u[at], u[at + 1], u[at + 2]);
            }
        }
        refit_bounds(&mut self.nodes);
        (&self.nodes, &self.place)
    }
}
