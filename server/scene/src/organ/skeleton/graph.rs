//! Which skeleton nodes are neighbours.

use sulcus_core::Vec3;

use crate::mesh::distance::MeshDistance;

/// Neighbours that each node asks for.
const NEIGHBOURS: usize = 6;
/// Places along a spring that must lie in the solid.
const PLACES: usize = 7;

/// Pairs `(a, b)`, `a < b`, of nodes of which either is among the nearest six of the other. A spring that
/// would leave the solid (from tip to tip of a fork, across a fold) is left out, unless a node would then hang
/// on nothing that is fixed: then the ones that leave it least come back, one by one.
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
    // A spring between two parts of which either hangs on nothing brings that part nearer to something.
    for (_, a, b) in refused {
        if !(held.is_held(a) && held.is_held(b)) && held.join(a, b) {
            kept.push((a, b));
        }
    }
    kept.sort_unstable();
    kept
}

/// How far the straight way from `a` to `b` leaves the solid, metres; 0 where it does not.
fn excursion(a: &Vec3, b: &Vec3, distance: &MeshDistance) -> f64 {
    let place = |k: usize| a + (b - a) * (k as f64 / (PLACES + 1) as f64);
    (1..=PLACES)
        .map(|k| distance.signed(&place(k)))
        .fold(0.0, f64::max)
}

/// Parts of the graph, and which of them hold on to something fixed.
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

    /// Joins two parts; false if they are one already.
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
        // Two nodes in a ball, one far outside of it: everything to that one leaves the solid.
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
