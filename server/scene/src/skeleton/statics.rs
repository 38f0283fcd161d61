//! How far a skeleton gives way at rest.

use sulcus_core::tissue::skeleton::SkeletonLevel;
use sulcus_core::{SphereTree, Vec3};

/// Radius of the reference load, metres: a number 4 mirror.
const LOAD_RADIUS: f64 = 0.011;
/// Spheres whose top is within this of the highest under the load bear it, metres.
const LOAD_DEPTH: f64 = 0.004;
/// Where along the organ it presses, as shares of its length.
const PLACES: [f64; 3] = [0.45, 0.6, 0.75];

/// Mean way down under the load of a flat mirror from above, per newton, over three places along the middle of the
/// back, m/N. Springs at rest stiffness; the load is shared evenly by the spheres under it.
pub fn pressed(level: &SkeletonLevel, tree: &SphereTree) -> f64 {
    let root = &tree.nodes()[0];
    let (mut low, mut high) = (root.centre, root.centre);
    let spheres: Vec<(usize, Vec3, f64)> = tree
        .shape_at(3)
        .map(|(k, node)| (k as usize, node.centre, node.contact_radius))
        .collect();
    for (_, c, r) in &spheres {
        low = low.inf(&(c - Vec3::repeat(*r)));
        high = high.sup(&(c + Vec3::repeat(*r)));
    }
    let sum: f64 = PLACES
        .iter()
        .map(|share| {
            let (x, y) = (low.x + share * (high.x - low.x), 0.5 * (low.y + high.y));
            let under: Vec<&(usize, Vec3, f64)> = spheres
                .iter()
                .filter(|(_, c, _)| (c.x - x).hypot(c.y - y) < LOAD_RADIUS)
                .collect();
            let top = under
                .iter()
                .fold(f64::NEG_INFINITY, |top, (_, c, r)| top.max(c.z + r));
            let bearing: Vec<usize> = under
                .iter()
                .filter(|(_, c, r)| c.z + r > top - LOAD_DEPTH)
                .map(|(k, ..)| *k)
                .collect();
            compliance(level, &bearing)
        })
        .sum();
    sum / PLACES.len() as f64
}

/// Mean way along z of `spheres` under a unit load shared evenly by them, m/N.
fn compliance(level: &SkeletonLevel, spheres: &[usize]) -> f64 {
    let mut load = vec![0.0; level.nodes.len()];
    for &k in spheres {
        let skin = &level.skin[k];
        for (node, w) in skin.nodes.iter().zip(skin.weights) {
            load[usize::from(*node)] += w / spheres.len() as f64;
        }
    }
    for (load, fixed) in load.iter_mut().zip(&level.fixed) {
        if *fixed {
            *load = 0.0;
        }
    }
    let moved = solve(level, 2, &load);
    moved.iter().zip(&load).map(|(u, f)| u * f).sum()
}

/// `K u = f` along one axis by conjugate gradients; fixed nodes stay.
fn solve(level: &SkeletonLevel, axis: usize, load: &[f64]) -> Vec<f64> {
    let n = load.len();
    let times = |u: &[f64]| {
        let mut f = vec![0.0; n];
        for spring in &level.springs {
            let (a, b) = (usize::from(spring.a), usize::from(spring.b));
            let force = spring.stiffness[axis] * (u[a] - u[b]);
            f[a] += force;
            f[b] -= force;
        }
        for (f, fixed) in f.iter_mut().zip(&level.fixed) {
            if *fixed {
                *f = 0.0;
            }
        }
        f
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (mut u, mut rest) = (vec![0.0; n], load.to_vec());
    let mut way = rest.clone();
    let (begin, mut now) = (dot(&rest, &rest), dot(&rest, &rest));
    for _ in 0..20 * n {
        if now <= 1e-24 * begin {
            break;
        }
        let force = times(&way);
        let step = now / dot(&way, &force);
        for k in 0..n {
            u[k] += step * way[k];
            rest[k] -= step * force[k];
        }
        let next = dot(&rest, &rest);
        for k in 0..n {
            way[k] = rest[k] + next / now * way[k];
        }
        now = next;
    }
    u
}
