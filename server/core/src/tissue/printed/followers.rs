//! Who moves with whom: section 6 of the paper. The nodes of one level move, those below shift as their ancestor does,
//! those above keep their centre and change their radius (Eq. 17, which the tick does for every tissue).

use crate::math::Vec3;
use crate::tree::{Node, SphereTree, refit_bounds};

/// Nodes of a tree by the moving node that they follow.
#[derive(Clone, Debug)]
pub(super) struct Followers {
    rest: Vec<Node>,
    /// Tree nodes that move, ascending.
    pub movers: Vec<u32>,
    /// Per tree node the place in `movers` of the one it follows; none above them.
    pub place: Vec<Option<u32>>,
    nodes: Vec<Node>,
}

impl Followers {
    /// Of the tree's shape at `level`.
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

    /// The same, each node below the movers going with the mover (a tree node) that `carriers` names for it instead of
    /// with its ancestor.
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

    /// Displacement of a tree node when the movers are displaced by `u` (x, y, z of each), metres.
    #[inline]
    fn displacement(&self, u: &[f64], node: u32) -> Vec3 {
        self.place[node as usize].map_or_else(Vec3::zeros, |at| {
            let at = 3 * at as usize;
            Vec3::new(u[at], u[at + 1], u[at + 2])
        })
    }

    /// Centres of the nodes `ids` when the movers are displaced by `u`, world axes, metres.
    pub fn centres(&self, u: &[f64], ids: &[u32], out: &mut [Vec3]) {
        for (&id, centre) in ids.iter().zip(out) {
            *centre = self.rest[id as usize].centre + self.displacement(u, id);
        }
    }

    /// All nodes when the movers are displaced by `u`, bounds refit, with the place of each.
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
