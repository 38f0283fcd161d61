//! Neighbours of skeleton nodes.

use sulcus_core::Vec3;

use crate::mesh::distance::MeshDistance;

/// Number of neighbours of a node.
const NEIGHBOURS: usize = 6;
/// Number of places along a spring that must lie in the solid.
const PLACES: usize = 7;

/// Returns the pairs `(a, b)`, `a < b`, of nodes of which either is among the nearest six of the other.
///
/// A spring that would leave the solid is left out, from tip to tip of a fork or across a fold. If a node would then
/// be connected to no fixed node, the springs that leave the solid least are added one by one.
pub(super) fn edges(
    places: &[Vec3],
    fixed: &[bool],
    distance: &MeshDistance,
) -> Vec<(usize, usize)> {
    let n = places.len();
    let mut pairs: Vec<(usize, usize)> = Vec::new();
    for a in 0..n {
        let mut near: Vec<(f64, usize)> = (0..n)
            .filter(|&b| b != a)
            .map(|b| ((places[a] - places[b]).norm_squared(), b))
            .collect();
        near.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        pairs.extend(
            near.iter()
                .take(NEIGHBOURS)
                .map(|&(_, b)| (a.min(b), a.max(b))),
        );
    }
    pairs.sort_unstable();
    pairs.dedup();
    let (mut kept, mut refused) = (Vec::new(), Vec::new());
    for (a, b) in pairs {
        let outside = excursion(&places[a], &places[b], distance);
        if outside > 0.0 {
            refused.push((outside, a, b));
        } else {
            kept.push((a, b));
        }
    }
    refused.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
    let mut held = Held::new(fixed);
    kept.iter().for_each(|&(a, b)| {
        held.join(a, b);
    });
    // A spring between two parts, one of which is connected to no fixed node, brings that part nearer to one.
    for (_, a, b) in refused {
        if !(held.is_held(a) && held.is_held(b)) && held.join(a, b) {
            kept.push((a, b));
        }
    }
    kept.sort_unstable();
    kept
}

/// Returns the largest distance of the straight line from `a` to `b` outside of the solid, metres; 0 if it stays
/// inside.
fn excursion(a: &Vec3, b: &Vec3, distance: &MeshDistance) -> f64 {
    let place = |k: usize| a + (b - a) * (k as f64 / (PLACES + 1) as f64);
    (1..=PLACES)
        .map(|k| distance.signed(&place(k)))
        .fold(0.0, f64::max)
}

/// Parts of the graph, and whether each is connected to a fixed node.
struct Held {
    parent: Vec<usize>,
    fixed: Vec<bool>,
}

impl Held {
    fn new(fixed: &[bool]) -> Self {
        Self {
            parent: (0..fixed.len()).collect(),
            fixed: fixed.to_vec(),
        }
    }

    fn root(&self, mut k: usize) -> usize {
        while self.parent[k] != k {
            k = self.parent[k];
        }
        k
    }

    fn is_held(&self, k: usize) -> bool {
        self.fixed[self.root(k)]
    }

    /// Joins two parts; returns false if they are already one.
    fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[b] = a;
        self.fixed[a] |= self.fixed[b];
        a != b
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes::icosphere;

    #[test]
    fn springs_join_near_nodes_both_ways_and_stay_inside() {
        let distance = MeshDistance::new(icosphere(0.02, 4));
        let places: Vec<Vec3> = (0..60)
            .map(|k| {
                let t = f64::from(k);
                Vec3::new(libm::sin(t), libm::sin(1.7 * t + 1.0), libm::cos(0.6 * t)) * 0.01
            })
            .collect();
        let fixed: Vec<bool> = places.iter().map(|p| p.z < -0.005).collect();
        let edges = edges(&places, &fixed, &distance);
        for (k, place) in places.iter().enumerate() {
            let degree = edges.iter().filter(|(a, b)| *a == k || *b == k).count();
            assert!(degree >= NEIGHBOURS, "node {k} at {place:?} has {degree}");
        }
        assert!(edges.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn a_spring_through_the_air_is_kept_only_where_a_node_needs_it() {
        // Two nodes in a ball, and one far outside of it. Every spring to that one leaves the solid.
        let distance = MeshDistance::new(icosphere(0.01, 3));
        let places = [
            Vec3::new(0.0, 0.0, 0.0),
            Vec3::new(0.0, 0.0, 0.005),
            Vec3::new(0.03, 0.0, 0.0),
        ];
        let one_held = edges(&places, &[true, false, false], &distance);
        assert_eq!(one_held, [(0, 1), (0, 2)], "the nearest way, and only that");
        let both_held = edges(&places, &[true, false, true], &distance);
        assert_eq!(both_held, [(0, 1)]);
    }
}
