//! Tests of a skeleton in time: vibration, decay, energy.

use super::super::entry::Axes;
use super::super::lattice::Lattice;
use super::*;
use crate::TICK_S;

/// Returns a skeleton of one mass on one spring with its other end fixed.
fn one_spring(stiffness: f64, mass: f64, damping: f64) -> (SphereTree, Skeleton) {
    let places = [Vec3::zeros(), Vec3::new(0.0, 0.0, 0.01)];
    let tree = tree_of(places.iter().copied());
    let params = SkeletonParams {
        mass,
        damping,
        law: StretchLaw::LINEAR,
    };
    let mut coarse = level(&tree, &places, 0.02, params);
    coarse.springs[0].stiffness = [stiffness, 2.0 * stiffness, 4.0 * stiffness];
    // The free node alone carries every sphere.
    for skin in &mut coarse.skin {
        *skin = Skin {
            nodes: [1; CARRIERS],
            weights: [1.0, 0.0, 0.0, 0.0],
        };
    }
    (tree, Skeleton { coarse, fine: None })
}

/// Returns the displacement of an undamped mass along `axis` one period after release from 1 mm, in units of 1 mm. The
/// second value is the exact result of implicit Euler.
fn after_a_period(stiffness: f64, axis: usize) -> (f64, f64) {
    let mass = 0.5;
    let (tree, model) = one_spring(stiffness, mass, 0.0);
    let mut bench = Bench::new(&tree, &model);
    bench.state[axis] = 1e-3;
    let omega = (stiffness * [1.0, 2.0, 4.0][axis] / mass).sqrt();
    let ticks = (2.0 * std::f64::consts::PI / (omega * TICK_S)).round() as usize;
    for _ in 0..ticks {
        bench.tick(&[], &[]);
    }
    // Exact result of implicit Euler: `u + i v / omega` is divided by `1 + i omega dt` in each step.
    let angle = libm::atan(omega * TICK_S) * ticks as f64;
    let shrunk = libm::pow(1.0 + omega * omega * TICK_S * TICK_S, -0.5 * ticks as f64);
    (bench.state[axis] / 1e-3, shrunk * libm::cos(angle))
}

#[test]
fn a_mass_on_a_spring_swings_as_analysis_says() {
    for axis in 0..3 {
        let (found, discrete) = after_a_period(20.0, axis);
        assert!((found - discrete).abs() < 1e-9, "{found} {discrete}");
        // The continuous result is 1, and the error of the step is of first order. Four times the period gives a
        // quarter of it.
        let (slower, _) = after_a_period(20.0 / 16.0, axis);
        let order = (1.0 - found) / (1.0 - slower);
        assert!(
            (3.8..4.2).contains(&order),
            "axis {axis}: {found} {slower} {order}"
        );
    }
}

#[test]
fn damping_decays_as_analysis_says() {
    // Overdamped: the slow root of `m s2 + b s + k` governs the decay.
    let (k, m, b) = (10.0, 1e-3, 1.0);
    let (tree, model) = one_spring(k, m, b);
    let mut bench = Bench::new(&tree, &model);
    bench.state[0] = 1e-3;
    for _ in 0..100 {
        bench.tick(&[], &[]);
    }
    let before = bench.state[0];
    for _ in 0..100 {
        bench.tick(&[], &[]);
    }
    let slow = (b - (b * b - 4.0 * k * m).sqrt()) / (2.0 * m);
    let wanted = libm::exp(-slow * 0.1);
    let found = bench.state[0] / before;
    assert!((found / wanted - 1.0).abs() < 0.01, "{found} {wanted}");
}

fn energy(lattice: &Lattice<Axes>, mass: f64, u: &[Axes], v: &[Axes]) -> f64 {
    let squares: f64 = v.iter().flatten().map(|x| x * x).sum();
    lattice.elastic_energy(u) + 0.5 * mass * squares
}

#[test]
fn energy_never_grows_in_a_free_step_however_stretched_and_fast() {
    for (scale, limit, damping) in [
        (1e-4, 3.0, 0.0),
        (5e-3, 3.0, 0.0),
        (0.1, 50.0, 0.0),
        (0.1, 50.0, 0.3),
        (10.0, 100.0, 0.0),
    ] {
        let params = SkeletonParams {
            damping,
            law: StretchLaw { limit, half: 0.4 },
            ..SOFT
        };
        let (tree, model) = soft_block(params);
        let mut lattice = Lattice::<Axes>::new(&model.coarse, &tree, TICK_S);
        let n = lattice.free();
        let wave = |k: usize, t: f64| -> Axes {
            let x = t * (k + 1) as f64;
            [libm::sin(x), libm::cos(1.3 * x), libm::sin(2.1 * x), 0.0].map(|a| a * scale)
        };
        let mut u: Vec<Axes> = (0..n).map(|k| wave(k, 1.0)).collect();
        let mut v: Vec<Axes> = (0..n).map(|k| wave(k, 0.7).map(|a| 30.0 * a)).collect();
        let mut next = u.clone();
        let mut last = energy(&lattice, params.mass, &u, &v);
        let begin = last;
        for _ in 0..500 {
            lattice.free_step(&u, &v, &mut next);
            for k in 0..n {
                for axis in 0..4 {
                    v[k][axis] = (next[k][axis] - u[k][axis]) / TICK_S;
                }
            }
            u.copy_from_slice(&next);
            let now = energy(&lattice, params.mass, &u, &v);
            assert!(now <= last * (1.0 + 1e-12), "{now} after {last}");
            last = now;
        }
        assert!(last < 0.9 * begin, "{last} of {begin}");
    }
}

#[test]
fn the_springs_force_is_the_slope_of_their_energy() {
    let (tree, model) = soft_block(SOFT);
    let lattice = Lattice::<Axes>::new(&model.coarse, &tree, TICK_S);
    let at = |k: usize| -> Axes {
        let x = (k + 1) as f64;
        [libm::sin(x), libm::cos(x), libm::sin(2.0 * x), 0.0].map(|a| a * 3e-3)
    };
    let u: Vec<Axes> = (0..lattice.free()).map(at).collect();
    let force = lattice.elastic_force(&u);
    let step = 1e-7;
    let mut most = 0.0;
    for k in 0..u.len() {
        for axis in 0..3 {
            let moved = |by: f64| {
                let mut u = u.clone();
                u[k][axis] += by;
                lattice.elastic_energy(&u)
            };
            let slope = (moved(step) - moved(-step)) / (2.0 * step);
            most = crate::math::fmax(most, slope.abs());
            assert!(
                (slope + force[k][axis]).abs() < 1e-6,
                "{slope} {}",
                force[k][axis]
            );
        }
    }
    assert!(most > 0.05, "forces of weight: {most}");
}

#[test]
fn the_sparse_inverse_is_the_dense_one() {
    let (tree, model) = soft_block(SOFT);
    let lattice = Lattice::<Axes>::new(&model.coarse, &tree, TICK_S);
    let n = lattice.free();
    let mut matrix = lattice.stiffness_at_rest();
    for axis in 0..3 {
        let own = SOFT.mass / (TICK_S * TICK_S) + SOFT.damping / TICK_S;
        let a: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| {
                        let k = SOFT.law.steepest() * matrix.at(i, j)[axis];
                        if i == j { k + own } else { k }
                    })
                    .collect()
            })
            .collect();
        for j in [0, n / 2, n - 1] {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            for (i, wanted) in dense_solve(a.clone(), unit).into_iter().enumerate() {
                let found = lattice.inverse()[j * n + i][axis];
                assert!(
                    (found - wanted).abs() < 1e-14 / own * 1e3,
                    "{found} {wanted}"
                );
            }
        }
    }
    assert!(
        lattice.fill() < n * (n - 1) / 2,
        "{} entries",
        lattice.fill()
    );
}

#[test]
fn let_go_it_comes_back_to_rest_exactly_and_is_then_still() {
    let (tree, model) = soft_block(SOFT);
    let (mut bench, sites) = (Bench::new(&tree, &model), sites(&tree));
    bench.free_step();
    assert!(bench.still);
    let lambda = vec![0.2; sites.len()];
    for _ in 0..500 {
        bench.tick(&sites, &lambda);
    }
    bench.free_step();
    assert!(!bench.still && bench.state.iter().any(|x| *x != 0.0));
    let mut ticks = 0;
    while !bench.still {
        bench.tick(&[], &[]);
        bench.free_step();
        ticks += 1;
        assert!(ticks < 5000, "never still");
    }
    assert!(bench.state.iter().all(|x| *x == 0.0));
    let rest: Vec<Vec3> = tree.nodes().iter().map(|node| node.centre).collect();
    assert_eq!(bench.centres_in(&bench.shape), rest);
}

#[test]
fn a_thousand_times_as_stiff_and_thrown_far_it_stays_finite_and_settles() {
    let (tree, mut model) = soft_block(SOFT);
    for spring in &mut model.coarse.springs {
        spring.stiffness = spring.stiffness.map(|k| 1e3 * k);
    }
    let (mut bench, sites) = (Bench::new(&tree, &model), sites(&tree));
    let n = bench.state.len() / 2;
    for (k, x) in bench.state.iter_mut().enumerate() {
        *x = 0.05 * libm::sin(k as f64) * if k < n { 1.0 } else { 1e3 };
    }
    for k in 0..20_000 {
        let lambda = vec![if k < 100 { 1e3 } else { 0.0 }; sites.len()];
        bench.tick(if k < 100 { &sites } else { &[] }, &lambda);
        assert!(bench.target.iter().all(|x| x.is_finite()));
        bench.free_step();
        if bench.still {
            return;
        }
    }
    panic!("never still");
}
