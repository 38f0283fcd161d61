//! Tests of the transition between the levels of detail.

use super::*;

#[test]
fn at_rest_a_change_of_level_is_at_once_and_moves_nothing() {
    let (tree, model) = two_levels(SOFT);
    let mut bench = Bench::new(&tree, &model);
    bench.detail = 1;
    bench.free_step();
    assert!(!bench.still, "the share must get into the state");
    bench.tick(&[], &[]);
    assert_eq!(bench.state.last(), Some(&1.0));
    bench.free_step();
    assert!(bench.still);
    let rest: Vec<Vec3> = tree.nodes().iter().map(|node| node.centre).collect();
    assert_eq!(bench.centres_in(&bench.shape), rest);
}

#[test]
fn under_load_the_skin_goes_over_smoothly_and_ends_where_the_other_level_says() {
    let (tree, model) = two_levels(SOFT);
    let sites = sites(&tree);
    let lambda = vec![0.1; sites.len()];
    let alone = |detail: u8| {
        let mut bench = Bench::new(&tree, &model);
        bench.detail = detail;
        for _ in 0..4000 {
            bench.tick(&sites, &lambda);
        }
        bench.centres()
    };
    let (coarse, fine) = (alone(0), alone(1));
    let farthest = |a: &[Vec3], b: &[Vec3]| {
        a.iter()
            .zip(b)
            .fold(0.0, |most, (a, b)| crate::math::fmax(most, norm(&(a - b))))
    };
    let apart = farthest(&coarse, &fine);
    assert!(apart > 1e-4, "the levels differ: {apart}");
    let mut bench = Bench::new(&tree, &model);
    for _ in 0..4000 {
        bench.tick(&sites, &lambda);
    }
    for (detail, wanted) in [(1, &fine), (0, &coarse)] {
        bench.detail = detail;
        let mut before = bench.centres();
        let mut most = 0.0;
        for _ in 0..4000 {
            bench.tick(&sites, &lambda);
            let now = bench.centres();
            most = crate::math::fmax(most, farthest(&before, &now));
            before = now;
        }
        assert!(
            most < 0.05 * apart,
            "a step of {most}, levels {apart} apart"
        );
        assert!(
            farthest(&before, wanted) < 1e-9,
            "{}",
            farthest(&before, wanted)
        );
    }
    // The inactive fine level leaves nothing in the state.
    let coarse_len = 6 * model.coarse.free();
    assert!(bench.state[coarse_len..].iter().all(|x| *x == 0.0));
}

#[test]
fn motion_bounds_every_sphere_at_every_share() {
    let (tree, model) = two_levels(SOFT);
    let (mut bench, sites) = (Bench::new(&tree, &model), sites(&tree));
    let (mut shares, mut kept) = (0, bench.shape.clone());
    for k in 0..600 {
        bench.detail = u8::from(k % 300 > 100);
        let lambda: Vec<f64> = (0..sites.len())
            .map(|j| libm::fabs(libm::sin((k + j) as f64)))
            .collect();
        bench.tick(&sites, &lambda);
        // Two starting configurations: the start of the tick, and an older one at another share.
        if k % 40 == 0 {
            kept.clone_from(&bench.shape);
        }
        for from in [&bench.shape, &kept] {
            let bound = bench.ready.motion(from, &bench.target);
            let (from, to) = (bench.centres_in(from), bench.centres());
            for (a, b) in from.iter().zip(&to) {
                assert!(norm(&(b - a)) <= bound * (1.0 + 1e-12) + 1e-17);
            }
        }
        shares += u32::from(bench.state.last().is_some_and(|s| *s > 0.0 && *s < 1.0));
    }
    assert!(shares > 100, "{shares} ticks between the levels");
}

#[test]
fn the_state_is_all_that_outlives_a_tick() {
    let (tree, model) = two_levels(SOFT);
    let (mut bench, sites) = (Bench::new(&tree, &model), sites(&tree));
    let mut other = Bench::new(&tree, &model);
    for k in 0..700 {
        let detail = u8::from(k % 400 > 150);
        let lambda: Vec<f64> = (0..sites.len())
            .map(|j| libm::fabs(libm::sin(0.1 * (k + j) as f64)))
            .collect();
        let (some, loads): (&[Site], &[f64]) = if k % 90 < 60 {
            (&sites, &lambda)
        } else {
            (&[], &[])
        };
        if k % 37 == 0 {
            // A fresh model takes over from the state alone.
            other = Bench::new(&tree, &model);
            other.state.clone_from(&bench.state);
        }
        for bench in [&mut bench, &mut other] {
            bench.detail = detail;
            bench.tick(some, loads);
        }
        let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&bench.state), bits(&other.state), "tick {k}");
    }
}
