//! Comparison of large displacements with answers that are known without finite elements.

use crate::common::{SOFT, block, pull};
use sulcus_core::Vec3;
use sulcus_core::math::Mat3;
use sulcus_fem::{
    Elastic, Factored, FemError, NewtonOptions, NewtonProgress, TetMesh, internal_forces,
    neo_hookean_forces, solve_neo_hookean,
};

fn solve(
    mesh: &TetMesh,
    load: &[Vec3],
    options: &NewtonOptions,
) -> (Result<Vec<Vec3>, FemError>, Vec<NewtonProgress>) {
    let mut told = Vec::new();
    let answer = solve_neo_hookean(mesh, &SOFT, load, options, &mut |p| told.push(*p));
    (answer, told)
}

/// Root of an increasing function between `low` and `high`.
fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    assert!(f(low) < 0.0 && f(high) > 0.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        *(if f(middle) < 0.0 { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}

/// Force per area at rest (Pa) along x and across, of a block stretched by `along` and `across`.
///
/// The energy `mu/2 (J^(-2/3) I1 - 3) + K/2 (J - 1)^2` was differentiated by hand.
fn nominal(along: f64, across: f64) -> (f64, f64) {
    let mu = SOFT.young / (2.0 * (1.0 + SOFT.poisson));
    let bulk = SOFT.young / (3.0 * (1.0 - 2.0 * SOFT.poisson));
    let j = along * across * across;
    let first = along * along + 2.0 * across * across;
    let shear = mu * j.powf(-2.0 / 3.0);
    let pressure = bulk * (j - 1.0) * j;
    let of = |stretch: f64| shear * (stretch - first / (3.0 * stretch)) + pressure / stretch;
    (of(along), of(across))
}

#[test]
fn a_block_is_stretched_and_pressed_uniformly_as_the_energy_says() {
    let size = Vec3::new(0.04, 0.02, 0.01);
    let mut mesh = block([3, 2, 1], size);
    for (held, x) in mesh.held.iter_mut().zip(&mesh.nodes) {
        *held = [x.x == 0.0, x.y == 0.0, x.z == 0.0];
    }
    // Below 0.7 the uniform state is no longer stable: the loaded end wrinkles.
    for along in [0.85, 1.05, 1.6] {
        let across = root(0.3, 2.0, |across| nominal(along, across).1);
        let traction = nominal(along, across).0;
        let load = pull(&mesh, size.x, Vec3::x() * traction);
        let moved = solve(&mesh, &load, &NewtonOptions::default()).0;
        for (x, u) in mesh.nodes.iter().zip(moved.expect("equilibrium")) {
            let exact = Vec3::new(along - 1.0, across - 1.0, across - 1.0).component_mul(x);
            assert!(
                (u - exact).norm() < 1e-10,
                "{along} {x}: {u}, exactly {exact}"
            );
        }
    }
}

#[test]
fn a_turn_costs_nothing_however_far() {
    let mesh = block([2, 1, 1], Vec3::new(0.02, 0.01, 0.01));
    let turn = Mat3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
        * Mat3::new(1.0, 0.0, 0.0, 0.0, -0.6, -0.8, 0.0, 0.8, -0.6);
    let turned = |x: &Vec3| turn * x - x + Vec3::new(0.1, 0.2, -0.3);
    let moved: Vec<Vec3> = mesh.nodes.iter().map(turned).collect();
    let idle = neo_hookean_forces(&mesh, &SOFT, &moved).expect("upright");
    assert!(idle.iter().all(|f| f.norm() < 1e-10), "{:?}", idle[0]);
    // The linear solid fails this test, which is the reason for the neo-Hookean one.
    let linear = internal_forces(&mesh, &SOFT, &moved);
    assert!(linear.iter().any(|f| f.norm() > 0.1));
}

/// A cantilever, held at one end, with a force (N) down at the other.
fn cantilever(newtons: f64) -> (TetMesh, Vec<Vec3>) {
    let size = Vec3::new(0.05, 0.01, 0.01);
    let mut mesh = block([8, 2, 2], size);
    for (held, x) in mesh.held.iter_mut().zip(&mesh.nodes) {
        *held = [x.x == 0.0; 3];
    }
    let load = pull(&mesh, size.x, Vec3::z() * (-newtons / 1e-4));
    (mesh, load)
}

fn lowest(moved: &[Vec3]) -> f64 {
    moved.iter().map(|u| u.z).fold(0.0, f64::min)
}

#[test]
fn a_small_load_moves_it_as_the_linear_solid_and_nearer_so_the_smaller() {
    let off = [2e-3, 1e-3].map(|newtons| {
        let (mesh, load) = cantilever(newtons);
        let linear = Factored::new(&mesh, &SOFT)
            .expect("held")
            .solve(std::slice::from_ref(&load));
        let linear = &linear.expect("finite")[0];
        let moved = solve(&mesh, &load, &NewtonOptions::default()).0;
        let moved = moved.expect("equilibrium");
        let apart = moved.iter().zip(linear).map(|(u, v)| (u - v).norm());
        apart.fold(0.0, f64::max) / -lowest(linear)
    });
    assert!(off[0] < 0.02 && off[0] > 1e-4, "{off:?}");
    assert!((1.7..2.3).contains(&(off[0] / off[1])), "{off:?}");
}

#[test]
fn forces_are_in_balance_and_steps_do_not_change_the_answer() {
    let (mesh, load) = cantilever(0.08);
    let one = NewtonOptions {
        steps: 1,
        ..NewtonOptions::default()
    };
    let (answer, told) = solve(&mesh, &load, &one);
    let moved = answer.expect("equilibrium");
    assert!(lowest(&moved) < -0.02, "far: {}", lowest(&moved));
    assert!(told.iter().any(|p| p.load < 1.0), "the one step was halved");
    let inner = neo_hookean_forces(&mesh, &SOFT, &moved).expect("upright");
    let total: Vec3 = load.iter().sum();
    let mut support = Vec3::zeros();
    let mut turning = Vec3::zeros();
    for (k, (f, x)) in inner.iter().zip(&mesh.nodes).enumerate() {
        if mesh.held[k] == [true; 3] {
            support += f;
            continue;
        }
        assert!((f - load[k]).norm() < 1e-8 * total.norm(), "{k}");
        turning += (x + moved[k]).cross(&load[k]);
    }
    assert!((support + total).norm() < 1e-8 * total.norm());
    // Moments are balanced about the origin at the displaced places of the ends, not at their rest places.
    let held = (0..mesh.nodes.len()).filter(|&k| mesh.held[k][0]);
    let back: Vec3 = held.map(|k| mesh.nodes[k].cross(&inner[k])).sum();
    assert!(
        (back + turning).norm() < 1e-9 * turning.norm(),
        "{back} {turning}"
    );
    let many = NewtonOptions {
        steps: 10,
        ..NewtonOptions::default()
    };
    let (answer, told) = solve(&mesh, &load, &many);
    let apart = answer.expect("equilibrium").into_iter().zip(&moved);
    let apart = apart.map(|(u, v)| (u - v).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-9, "{apart:e}");
    // Near the end each correction squares the residual.
    let last = &told[told.len() - 3..];
    assert!(
        last[0].left > last[1].left && last[1].left * 1e-2 > last[2].left,
        "{last:?}"
    );
}

#[test]
fn without_load_nothing_moves() {
    let (mesh, load) = cantilever(0.0);
    let (answer, told) = solve(&mesh, &load, &NewtonOptions::default());
    assert!(answer.expect("at rest").iter().all(|u| *u == Vec3::zeros()));
    assert!(told.is_empty());
}

#[test]
fn what_cannot_be_solved_is_said() {
    // A pressure of fifty times Young's modulus: the energy of this solid is finite at zero volume.
    let size = Vec3::new(0.01, 0.01, 0.01);
    let mut mesh = block([1, 1, 1], size);
    for (held, x) in mesh.held.iter_mut().zip(&mesh.nodes) {
        *held = [x.x == 0.0; 3];
    }
    let crush = pull(&mesh, size.x, Vec3::x() * (-50.0 * SOFT.young));
    let (answer, told) = solve(&mesh, &crush, &NewtonOptions::default());
    match answer.expect_err("crushed") {
        FemError::Newton { reached, aim, .. } => {
            assert!(
                reached > 0.0 && reached < 1.0 && aim > reached,
                "{reached} {aim}"
            );
            assert!(
                aim - reached < 1.0 / 1000.0,
                "halved eight times: {aim} {reached}"
            );
        }
        other => panic!("{other}"),
    }
    assert!(
        told.iter()
            .all(|p| p.tangents <= NewtonOptions::default().tangents)
    );
    let few = NewtonOptions {
        tangents: 3,
        ..NewtonOptions::default()
    };
    let (mesh, load) = cantilever(0.08);
    let said = solve(&mesh, &load, &few)
        .0
        .expect_err("too few")
        .to_string();
    assert!(said.contains("no more tangents"), "{said}");
    let said = |options: NewtonOptions| {
        let answer = solve(&mesh, &load, &options).0;
        answer.expect_err("wrong options").to_string()
    };
    let good = NewtonOptions::default();
    assert!(said(NewtonOptions { steps: 0, ..good }).contains("steps is 0"));
    assert!(
        said(NewtonOptions {
            halvings: 21,
            ..good
        })
        .contains("halvings is 21")
    );
    assert!(
        said(NewtonOptions {
            corrections: 0,
            ..good
        })
        .contains("corrections is 0")
    );
    assert!(
        said(NewtonOptions {
            tangents: 0,
            ..good
        })
        .contains("tangents is 0")
    );
    let tolerance = f64::NAN;
    assert!(said(NewtonOptions { tolerance, ..good }).contains("tolerance is NaN"));
    let mut loose = mesh.clone();
    loose.held.fill([false; 3]);
    let said = solve(&loose, &load, &good)
        .0
        .expect_err("loose")
        .to_string();
    assert!(said.contains("0 of 6 rigid motions"), "{said}");
    let said = solve(&mesh, &load[1..], &good)
        .0
        .expect_err("short")
        .to_string();
    assert!(said.contains("forces of a load"), "{said}");
    let wrong = Elastic {
        poisson: 0.5,
        ..SOFT
    };
    let said = solve_neo_hookean(&mesh, &wrong, &load, &good, &mut |_| ());
    assert!(
        said.expect_err("wrong")
            .to_string()
            .contains("poisson is 0.5")
    );
}
