//! Tests of the compliance, and of the equilibrium under a load.

use super::*;
use crate::tissue::Gram;

/// Load that moves a skeleton in one tick far more than the rounding of centres, newtons.
const MUCH: f64 = 1e3;

fn matrix(ready: &mut dyn Tissue, sites: &[Site]) -> Vec<f64> {
    let m = sites.len();
    let mut entries = vec![0.0; m * m];
    ready.add_gram(sites, &mut Gram::new(&mut entries, m, 0));
    entries
}

/// Computes the displacement of every skeleton node under loads, by Picard's iteration on dense matrices of the data.
fn at_rest(model: &SkeletonLevel, tree: &SphereTree, sites: &[Site], lambda: &[f64]) -> Vec<Vec3> {
    let n = model.nodes.len();
    let mut load = vec![Vec3::zeros(); n];
    for (site, lambda) in sites.iter().zip(lambda) {
        let skin = &model.skin[site.sphere as usize];
        for (node, w) in skin.nodes.iter().zip(skin.weights) {
            load[usize::from(*node)] -= site.normal * (*lambda * w);
        }
    }
    let mut u = vec![Vec3::zeros(); n];
    for _ in 0..200 {
        let mut k = vec![vec![vec![0.0; n]; n]; 3];
        for spring in &model.springs {
            let (a, b) = (usize::from(spring.a), usize::from(spring.b));
            let centre = |c: usize| tree.nodes()[model.nodes[c] as usize].centre;
            let (change, length) = (u[a] - u[b], norm(&(centre(a) - centre(b))));
            let s = Vec3::from(spring.stiffness);
            let energy = s.dot(&change.component_mul(&change));
            let stretch = (energy * 3.0 / s.sum()).sqrt() / length;
            let x = (stretch / model.params.law.half) * (stretch / model.params.law.half);
            let factor = 1.0 + (model.params.law.limit - 1.0) * x / (1.0 + x);
            for axis in 0..3 {
                for (i, j) in [(a, b), (b, a)] {
                    k[axis][i][i] += factor * s[axis];
                    k[axis][i][j] -= factor * s[axis];
                }
            }
        }
        let mut change = 0.0;
        for axis in 0..3 {
            let mut matrix = k[axis].clone();
            let mut right: Vec<f64> = load.iter().map(|f| f[axis]).collect();
            for c in (0..n).filter(|&c| model.fixed[c]) {
                matrix[c] = vec![0.0; n];
                matrix[c][c] = 1.0;
                right[c] = 0.0;
            }
            for (u, new) in u.iter_mut().zip(dense_solve(matrix, right)) {
                let step = 0.7 * (new - u[axis]);
                u[axis] += step;
                change = crate::math::fmax(change, step.abs());
            }
        }
        if change < 1e-13 {
            return u;
        }
    }
    panic!("the reference did not settle");
}

#[test]
fn comes_to_rest_where_a_dense_solution_of_the_statics_says() {
    for law in [StretchLaw::LINEAR, SOFT.law] {
        let (tree, model) = soft_block(SkeletonParams { law, ..SOFT });
        let (mut bench, sites) = (Bench::new(&tree, &model), sites(&tree));
        let lambda: Vec<f64> = (0..sites.len()).map(|k| 0.3 + 0.05 * k as f64).collect();
        for _ in 0..4000 {
            bench.tick(&sites, &lambda);
        }
        let u = at_rest(&model.coarse, &tree, &sites, &lambda);
        let (mut off, mut most) = (0.0, 0.0);
        for (node, centre) in bench.centres().iter().enumerate() {
            let skin = &model.coarse.skin[node];
            let carried = skin.nodes.iter().zip(skin.weights);
            let wanted: Vec3 = carried.map(|(k, w)| u[usize::from(*k)] * w).sum();
            let rest = tree.nodes()[node].centre;
            off = crate::math::fmax(off, norm(&(centre - rest - wanted)));
            most = crate::math::fmax(most, norm(&wanted));
        }
        assert!(most > 4e-3, "it must be pressed well: {most}");
        assert!(off < 1e-9 * most, "{off} of {most}");
    }
}

#[test]
fn the_matrix_of_contacts_is_what_a_unit_load_moves_and_symmetric() {
    let (tree, model) = two_levels(SOFT);
    for (detail, ticks) in [(0, 1), (1, 1), (1, 300), (0, 20)] {
        let (mut bench, sites) = (Bench::new(&tree, &model), sites(&tree));
        // The state is displaced. The second and third case are in a change of level.
        let lambda = vec![0.1; sites.len()];
        bench.tick(&sites, &lambda);
        for k in 0..ticks {
            bench.detail = if k + 70 < ticks { 1 - detail } else { detail };
            bench.tick(&sites, &lambda);
        }
        bench.free_step();
        let gram = matrix(&mut *bench.ready, &sites);
        let m = sites.len();
        let most = (0..m).fold(0.0, |most, i| crate::math::fmax(most, gram[i * m + i]));
        for j in 0..m {
            let mut load = vec![0.0; m];
            load[j] = MUCH;
            bench
                .ready
                .apply(&sites, &load, &bench.free, &mut bench.target);
            let (loaded, free) = (bench.centres(), bench.centres_in(&bench.free));
            for (i, site) in sites.iter().enumerate() {
                let at = site.sphere as usize;
                let moved = -site.normal.dot(&(loaded[at] - free[at])) / MUCH;
                let entry = gram[i * m + j];
                assert!(
                    (moved - entry).abs() < 1e-13 * most,
                    "{i} {j}: {moved} {entry}"
                );
                assert!((entry - gram[j * m + i]).abs() <= 1e-16 * most);
            }
        }
    }
}

#[test]
fn what_loads_move_is_the_matrix_times_the_loads() {
    let (tree, model) = two_levels(SOFT);
    let (mut bench, sites) = (Bench::new(&tree, &model), sites(&tree));
    bench.free_step();
    let gram = matrix(&mut *bench.ready, &sites);
    let m = sites.len();
    let lambda: Vec<f64> = (0..m)
        .map(|k| MUCH * libm::fabs(libm::sin(k as f64)))
        .collect();
    let most = (0..m).fold(0.0, |most, i| crate::math::fmax(most, gram[i * m + i]));
    bench
        .ready
        .apply(&sites, &lambda, &bench.free, &mut bench.target);
    let (loaded, free) = (bench.centres(), bench.centres_in(&bench.free));
    for (i, site) in sites.iter().enumerate() {
        let at = site.sphere as usize;
        let moved = -site.normal.dot(&(loaded[at] - free[at]));
        let wanted: f64 = (0..m).map(|j| gram[i * m + j] * lambda[j]).sum();
        assert!(
            (moved - wanted).abs() < 1e-13 * MUCH * most,
            "{moved} {wanted}"
        );
    }
}

#[test]
fn the_matrix_of_contacts_is_never_indefinite() {
    let (tree, model) = two_levels(SOFT);
    for detail in [0, 1] {
        let mut bench = Bench::new(&tree, &model);
        bench.detail = detail;
        bench.free_step();
        let leaves: Vec<u32> = tree.shape_at(7).map(|(k, _)| k).collect();
        let mut seed = 1u64;
        let mut random = || {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / f64::from(1u32 << 31)
        };
        for _ in 0..50 {
            let sites: Vec<Site> = (0..40)
                .map(|_| Site {
                    sphere: leaves[(random() * leaves.len() as f64) as usize % leaves.len()],
                    normal: Vec3::new(random() - 0.5, random() - 0.5, random() - 0.5).normalize(),
                })
                .collect();
            let gram = matrix(&mut *bench.ready, &sites);
            let (m, mut scale) = (sites.len(), 0.0);
            for i in 0..m {
                scale = crate::math::fmax(scale, gram[i * m + i]);
            }
            // There are 40 rows and 24 free nodes at the coarse level, so the matrix may be singular. A shift by a
            // rounding error keeps the pivots positive.
            let mut l = gram.clone();
            for j in 0..m {
                let mut pivot = l[j * m + j] + 1e-13 * scale;
                for k in 0..j {
                    pivot -= l[j * m + k] * l[j * m + k];
                }
                assert!(pivot > 0.0, "pivot {j} is {pivot:e}");
                let root = pivot.sqrt();
                l[j * m + j] = root;
                for i in j + 1..m {
                    let mut entry = l[i * m + j];
                    for k in 0..j {
                        entry -= l[i * m + k] * l[j * m + k];
                    }
                    l[i * m + j] = entry / root;
                }
            }
        }
    }
}

#[test]
fn springs_and_loads_turned_together_give_what_they_gave_turned() {
    use crate::math::{Mat3, exp_rotation};
    let (tree, model) = soft_block(SOFT);
    let turn = exp_rotation(&Vec3::new(0.5, -0.8, 0.3));
    let r: Mat3 = *turn.to_rotation_matrix().matrix();
    let mut turned = model.clone();
    for spring in &mut turned.coarse.springs {
        let t = r * Mat3::from_diagonal(&Vec3::from(spring.stiffness)) * r.transpose();
        spring.stiffness = [t[(0, 0)], t[(1, 1)], t[(2, 2)]];
        spring.coupling = [t[(1, 2)], t[(0, 2)], t[(0, 1)]];
    }
    assert!(turned.couples() && !model.couples());
    turned.validate(&tree).expect("still positive definite");
    let sites = sites(&tree);
    let around: Vec<Site> = sites
        .iter()
        .map(|site| Site {
            normal: turn * site.normal,
            ..*site
        })
        .collect();
    let (mut one, mut other) = (Bench::new(&tree, &model), Bench::new(&tree, &turned));
    let lambda: Vec<f64> = (0..sites.len()).map(|k| 0.3 + 0.05 * k as f64).collect();
    for _ in 0..300 {
        one.tick(&sites, &lambda);
        other.tick(&around, &lambda);
    }
    let mut most = 0.0;
    for (node, (a, b)) in tree
        .nodes()
        .iter()
        .zip(one.centres().iter().zip(other.centres()))
    {
        let (a, b) = (a - node.centre, b - node.centre);
        assert!(norm(&(turn * a - b)) < 1e-12, "{a:?} {b:?}");
        most = crate::math::fmax(most, norm(&a));
    }
    assert!(most > 1e-3, "{most}");
    let (a, b) = (
        matrix(&mut *one.ready, &sites),
        matrix(&mut *other.ready, &around),
    );
    for (a, b) in a.iter().zip(&b) {
        assert!(
            (a - b).abs() < 1e-12 * crate::math::fmax(a.abs(), 1e-6),
            "{a} {b}"
        );
    }
    // A stiffness matrix that is not positive definite is refused.
    turned.coarse.springs[3].coupling = [1e3, 0.0, 0.0];
    let refused = turned.validate(&tree).expect_err("not positive definite");
    assert_eq!(refused.field, "coupling of a spring");
}
