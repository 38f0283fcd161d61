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

    /// Largest difference of two displacements, metres.
    pub fn motion(&self, from: &[f64], to: &[f64]) -> f64 {
        let squared = from
            .chunks_exact(3)
            .zip(to.chunks_exact(3))
            .fold(0.0, |most, (a, b)| {
                let way = Vec3::new(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
                crate::math::fmax(most, way.dot(&way))
            });
        squared.sqrt()
    }
}
