//! Carriers of a sphere among the skeleton nodes.

use sulcus_core::Vec3;
use sulcus_core::tissue::skeleton::{CARRIERS, Skin};

/// Returns the four nearest nodes with weights `(1 - d/r)^2`; `r` is the distance of the fifth. The weights add up to
/// 1.
///
/// The weight of a node and its slope are zero where another node takes its place, so the skin is smooth.
pub(super) fn skin(point: &Vec3, places: &[Vec3]) -> Skin {
    let mut near: Vec<(f64, usize)> = places
        .iter()
        .enumerate()
        .map(|(k, p)| ((p - point).norm(), k))
        .collect();
    near.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    // With fewer nodes the kernel reaches twice as far as the last.
    let reach = match (near.get(CARRIERS), near.last()) {
        (Some((fifth, _)), _) => *fifth,
        (None, Some((last, _))) => 2.0 * last,
        _ => 0.0,
    };
    let mut skin = Skin {
        nodes: [near.first().map_or(0, |(_, k)| *k as u16); CARRIERS],
        weights: [0.0; CARRIERS],
    };
    for (slot, &(d, k)) in near.iter().take(CARRIERS).enumerate() {
        let rest = (1.0 - d / reach.max(f64::MIN_POSITIVE)).max(0.0);
        skin.nodes[slot] = k as u16;
        skin.weights[slot] = rest * rest;
    }
    let sum: f64 = skin.weights.iter().sum();
    if sum > 0.0 {
        skin.weights = skin.weights.map(|w| w / sum);
    } else {
        // All five have one distance: the first is chosen.
        skin.weights = [1.0, 0.0, 0.0, 0.0];
    }
    skin
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places() -> Vec<Vec3> {
        (0..50)
            .map(|k| {
                let t = f64::from(k);
                Vec3::new(libm::sin(2.1 * t), libm::cos(1.3 * t), libm::sin(0.7 * t)) * 0.02
            })
            .collect()
    }

    #[test]
    fn weights_are_a_partition_of_unity_and_change_smoothly_across_space() {
        let places = places();
        let value = |p: &Vec3| {
            let skin = skin(p, &places);
            let sum: f64 = skin.weights.iter().sum();
            assert!((sum - 1.0).abs() < 1e-12 && skin.weights.iter().all(|w| *w >= 0.0));
            // Any field on the nodes, carried to the point.
            let of = |k: u16| libm::sin(f64::from(k));
            skin.nodes
                .iter()
                .zip(skin.weights)
                .map(|(k, w)| of(*k) * w)
                .sum::<f64>()
        };
        // Along a line the skin is continuous, whatever the four nearest nodes are.
        let at = |k: i32| Vec3::new(-0.02 + 1e-6 * f64::from(k), 0.003, 0.001);
        let mut last = value(&at(0));
        for k in 1..40_000 {
            let now = value(&at(k));
            assert!((now - last).abs() < 5e-3, "at step {k}: {last} to {now}");
            last = now;
        }
    }

    #[test]
    fn a_node_is_carried_mostly_by_itself() {
        let places = places();
        for (k, p) in places.iter().enumerate() {
            let skin = skin(p, &places);
            assert_eq!(usize::from(skin.nodes[0]), k);
            assert!(skin.weights.iter().all(|w| *w <= skin.weights[0]));
        }
    }
}
