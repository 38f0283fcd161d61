//! Stiffness of a skeleton at rest.

use sulcus_core::tissue::skeleton::SkeletonLevel;
use sulcus_core::{SphereTree, Vec3};

/// Radius of the reference tool, metres: a number 4 mirror.
const RADIUS: f64 = 0.011;
/// Depth of the press, metres.
const DEPTH: f64 = 0.006;
/// Places of the press along the organ, as shares of its length.
const PLACES: [f64; 3] = [0.45, 0.6, 0.75];
/// Largest number of sweeps over the spheres under the disc.
const SWEEPS: usize = 20_000;

/// Returns the force of a rigid flat disc pressed 6 mm from above into the middle of the back, newtons. It is the
/// mean over three places.
///
/// The disc is as wide as a mouth mirror. Springs have their stiffness at rest. Contact is without friction; each
/// sphere is pushed or free.
pub fn pressed(level: &SkeletonLevel, tree: &SphereTree) -> f64 {
    let spheres: Vec<(usize, Vec3, f64)> = tree
        .shape_at(3)
        .map(|(k, node)| (k as usize, node.centre, node.contact_radius))
        .collect();
    let huge = Vec3::repeat(f64::INFINITY);
    let (mut low, mut high) = (huge, -huge);
    for (_, c, r) in &spheres {
        low = low.inf(&(c - Vec3::repeat(*r)));
        high = high.sup(&(c + Vec3::repeat(*r)));
    }
    let sum: f64 = PLACES
        .iter()
        .map(|share| {
            let (x, y) = (low.x + share * (high.x - low.x), 0.5 * (low.y + high.y));
            let under: Vec<(usize, f64)> = spheres
                .iter()
                .filter(|(_, c, _)| (c.x - x).hypot(c.y - y) < RADIUS)
                .map(|(k, c, r)| (*k, c.z + r))
                .collect();
            let top = under.iter().fold(f64::NEG_INFINITY, |top, s| top.max(s.1));
            let pressed: Vec<(usize, f64)> = under
                .into_iter()
                .map(|(k, height)| (k, DEPTH - (top - height)))
                .filter(|(_, overlap)| *overlap > 0.0)
                .collect();
            punch(level, &pressed)
        })
        .sum();
    sum / PLACES.len() as f64
}

/// Returns the force that moves each of `spheres` down by at least its overlap without pulling any, newtons, by
/// projected Gauss-Seidel.
fn punch(level: &SkeletonLevel, spheres: &[(usize, f64)]) -> f64 {
    let n = spheres.len();
    let loads: Vec<Vec<f64>> = spheres.iter().map(|(k, _)| load_of(level, *k)).collect();
    let compliance: Vec<Vec<f64>> = loads
        .iter()
        .map(|load| {
            let moved = solve(level, 2, load);
            let along = |other: &Vec<f64>| moved.iter().zip(other).map(|(u, w)| u * w).sum();
            loads.iter().map(along).collect()
        })
        .collect();
    let mut force = vec![0.0; n];
    for _ in 0..SWEEPS {
        let mut change = 0.0_f64;
        for i in 0..n {
            // A sphere on fixed nodes only cannot move.
            if compliance[i][i] < 1e-9 {
                continue;
            }
            let moved: f64 = compliance[i].iter().zip(&force).map(|(c, f)| c * f).sum();
            let new = (force[i] + (spheres[i].1 - moved) / compliance[i][i]).max(0.0);
            change = change.max((new - force[i]).abs());
            force[i] = new;
        }
        if change < 1e-9 {
            break;
        }
    }
    force.iter().sum()
}

/// Returns the share of a unit load on a sphere that each free node bears.
fn load_of(level: &SkeletonLevel, sphere: usize) -> Vec<f64> {
    let mut load = vec![0.0; level.nodes.len()];
    let skin = &level.skin[sphere];
    for (node, w) in skin.nodes.iter().zip(skin.weights) {
        if !level.fixed[usize::from(*node)] {
            load[usize::from(*node)] += w;
        }
    }
    load
}

/// Solves `K u = f` along one axis by conjugate gradients. Fixed nodes do not move.
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
