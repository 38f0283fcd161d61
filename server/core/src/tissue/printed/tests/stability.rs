//! Tests of the stability limits of explicit Euler and of the refusal of unstable skeletons.

use super::*;

/// Whether a free vibration grows in 8000 steps.
///
/// The largest magnitude in steps 7000 to 7999 is compared with the largest in steps 3000 to 3999.
fn grows(graph: &Graph, numbers: (f64, f64, f64, f64)) -> bool {
    let n = 3 * graph.fixed.len();
    let mut now: Vec<f64> = (0..2 * n)
        .map(|k| {
            if k < n {
                1e-3 * libm::sin(1.0 + 7.0 * k as f64)
            } else {
                0.0
            }
        })
        .collect();
    let (mut next, force) = (vec![0.0; 2 * n], vec![0.0; n]);
    let (mut early, mut late) = (0.0, 0.0);
    for step in 0..8_000 {
        graph.euler(numbers, &force, &now, &mut next);
        std::mem::swap(&mut now, &mut next);
        let size = now.iter().fold(0.0, |most, x| math::fmax(most, x.abs()));
        if size > 1e6 {
            return true;
        }
        match step {
            3_000..4_000 => early = math::fmax(early, size),
            7_000.. => late = math::fmax(late, size),
            _ => {}
        }
    }
    late > early
}

/// Returns the onset of instability between `low` (stable) and `high` (unstable), to a relative tolerance of 0.001.
fn onset(mut low: f64, mut high: f64, unstable: impl Fn(f64) -> bool) -> f64 {
    assert!(!unstable(low) && unstable(high), "{low} to {high}");
    while high > low * 1.001 {
        let middle = 0.5 * (low + high);
        if unstable(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

#[test]
fn one_spring_becomes_unstable_where_eq_9_says() {
    // The graph has a single free sphere on a single spring; k is k_s + k_p.
    let graph = Graph {
        springs: vec![[0, 1]],
        fixed: vec![true, false],
    };
    // The cases are below, at and above critical damping.
    for (k, b, m) in [
        (205.0, 2.0, 0.02),
        (505.0, 0.5, 0.02),
        (205.0, 2.0 * (205.0_f64 * 0.02).sqrt(), 0.02),
        (205.0, 30.0, 0.02),
        (505.0, 600.0, 0.3),
    ] {
        let limit = largest_time_step(k, b, m);
        let measured = onset(0.5 * limit, 2.0 * limit, |dt| grows(&graph, (k, b, m, dt)));
        assert!(
            (measured / limit - 1.0).abs() < 0.01,
            "k {k}, b {b}, m {m}: measured {measured}, predicted {limit}"
        );
    }
}

#[test]
fn a_skeleton_becomes_unstable_where_its_eigenvalues_say() {
    let tree = block();
    let model = skeleton(&tree);
    let graph = model.graph(&tree).expect("its own nodes");
    let unit = Spectrum::of_unit_springs(graph.fixed.len(), &graph.springs, &graph.fixed);
    assert!(unit.least > 0.0 && unit.most > 3.0 * unit.least, "{unit:?}");
    let (b, m, dt) = (12.0, 0.02, TICK_S);
    // Limit of the stiffness, from the largest eigenvalue.
    let limit = b / dt / unit.most;
    let measured = onset(0.5 * limit, 2.0 * limit, |k| grows(&graph, (k, b, m, dt)));
    assert!(
        (measured / limit - 1.0).abs() < 0.01,
        "stiffness {measured}, {limit}"
    );
    // Limits of damping and mass, from the smallest eigenvalue.
    let k = 0.5 * limit;
    let limit = 2.0 * m / dt + 0.5 * dt * k * unit.least;
    let measured = onset(0.5 * limit, 2.0 * limit, |b| grows(&graph, (k, b, m, dt)));
    assert!(
        (measured / limit - 1.0).abs() < 0.01,
        "damping {measured}, {limit}"
    );
    let limit = unit.scaled(k, 0.0).smallest_mass(b, dt);
    let measured = onset(0.5 / limit, 2.0 / limit, |inverse| {
        grows(&graph, (k, b, 1.0 / inverse, dt))
    });
    assert!(
        (measured * limit - 1.0).abs() < 0.01,
        "mass {}, {limit}",
        1.0 / measured
    );
    // Limit of the time step.
    for (k, b) in [(k, 6.0), (k, 30.0)] {
        let limit = unit.scaled(k, 0.0).largest_time_step(b, m);
        let measured = onset(0.5 * limit, 2.0 * limit, |dt| grows(&graph, (k, b, m, dt)));
        assert!(
            (measured / limit - 1.0).abs() < 0.01,
            "step {measured}, {limit}"
        );
    }
}

/// Returns the number that follows `words` in `text`.
fn number_after(text: &str, words: &str) -> f64 {
    let rest = text.split(words).nth(1).expect("the words");
    let number: String = rest.chars().take_while(|c| !c.is_whitespace()).collect();
    number.parse().expect("a number")
}

#[test]
fn a_skeleton_over_the_limit_is_refused_with_what_would_do() {
    let tree = block();
    let mut model = skeleton(&tree);
    model
        .validate(&tree, TICK_S)
        .expect("the defaults are stable");
    let spectrum = model.spectrum(&tree).expect("its own nodes");
    let unit = (spectrum.most - model.penalty_n_per_m) / model.spring_n_per_m;
    let stiffest = (model.damping_n_s_per_m / TICK_S - model.penalty_n_per_m) / unit;
    for (share, stands) in [(0.9, true), (0.99, true), (1.01, false), (1000.0, false)] {
        model.spring_n_per_m = stiffest * share;
        let found = model.validate(&tree, TICK_S);
        assert_eq!(found.is_ok(), stands, "{share}: {found:?}");
    }
    // Values of the paper: 0.5 N/mm, 0.6 N s/mm, 20 g.
    (model.spring_n_per_m, model.damping_n_s_per_m) = (500.0, 600.0);
    let refused = model
        .validate(&tree, TICK_S)
        .expect_err("section 8.1 at 20 g")
        .to_string();
    assert!(
        refused.contains("spring at most") && refused.contains("time step of at most"),
        "{refused}"
    );
    // No stiffness is stable at that damping, so the message states a stiffness and another damping. Slightly smaller
    // values of both must be accepted, and slightly larger values refused.
    let (stiffest, damping) = (
        number_after(&refused, "spring at most "),
        number_after(&refused, "(with a damping of "),
    );
    for (share, stands) in [(0.999, true), (1.01, false)] {
        let mut other = model.clone();
        other.spring_n_per_m = stiffest * share;
        other.damping_n_s_per_m = damping * 0.5 * (1.0 + share);
        assert_eq!(
            other.validate(&tree, TICK_S).is_ok(),
            stands,
            "{share}: {refused}"
        );
    }
    let step = number_after(&refused, "time step of at most ");
    let spectrum = model.spectrum(&tree).expect("its own nodes");
    assert!((step / spectrum.largest_time_step(600.0, 0.02) - 1.0).abs() < 1e-3);
    // Masses just below and just above the stated limit: 0.3 kg minus the contribution of the slowest mode.
    let least = model.spectrum(&tree).expect("its own nodes").least;
    let mass = 0.5 * TICK_S * 600.0 - 0.25 * TICK_S * TICK_S * least;
    assert!(
        mass > 0.29 && refused.contains(&format!("mass at least {mass:.4e} kg")),
        "{refused}"
    );
    for (share, stands) in [(0.999, false), (1.001, true)] {
        model.mass_kg = mass * share;
        assert_eq!(model.validate(&tree, TICK_S).is_ok(), stands, "{share}");
    }
}
