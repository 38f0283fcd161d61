//! Solver of the tick against a reference: the same problems with `active_set` and Clarabel. Each answer must also
//! satisfy the optimality conditions.

// A test, not the core: its own arithmetic need not be bit-identical.
#![allow(clippy::disallowed_methods, clippy::disallowed_macros)]

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use sulcus_core::optimise::{
    ContactSolver, Problem, ProblemRow, Solution, SolveStatus,
    active_set::ActiveSet,
    clarabel::{AllRows, Clarabel},
};
use sulcus_core::{Params, Vec3};

const KT: f64 = 500.0;
const KR: f64 = 0.5;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Family {
    Random,
    Clustered,
    Duplicate,
    NearlyParallel,
    Opposing,
    Infeasible,
}

const FAMILIES: [Family; 6] = [
    Family::Random,
    Family::Clustered,
    Family::Duplicate,
    Family::NearlyParallel,
    Family::Opposing,
    Family::Infeasible,
];

struct Dice(ChaCha8Rng);

impl Dice {
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }
    fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
    fn direction(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(
                self.range(-1.0, 1.0),
                self.range(-1.0, 1.0),
                self.range(-1.0, 1.0),
            );
            if v.norm() > 0.1 && v.norm() < 1.0 {
                return v.normalize();
            }
        }
    }
}

/// Returns the row of a tool sphere at `arm` from the working point with the contact normal `normal`. `bias` is the gap
/// at the unconstrained optimum.
fn row(normal: Vec3, arm: Vec3, bias: f64, tool: u8) -> ProblemRow {
    let (n, m) = (normal / KT.sqrt(), arm.cross(&normal) / KR.sqrt());
    ProblemRow {
        a: [n.x, n.y, n.z, m.x, m.y, m.z],
        tool,
        bias,
    }
}

fn rows(family: Family, m: usize, dice: &mut Dice) -> Vec<ProblemRow> {
    let axis = dice.direction();
    let centre = dice.direction() * dice.range(0.0, 0.02);
    let arm = |dice: &mut Dice| dice.direction() * dice.range(0.0, 0.02);
    let press = dice.range(0.0, 3e-3);
    let mut rows: Vec<ProblemRow> = Vec::with_capacity(m);
    for k in 0..m {
        let tool = u8::from(dice.unit() < 0.2);
        rows.push(match family {
            Family::Random => {
                let (normal, at) = (dice.direction(), arm(dice));
                row(normal, at, dice.range(-2e-3, 1e-3), tool)
            }
            Family::Clustered => {
                let normal = (axis + dice.direction() * 0.3).normalize();
                let at = centre + dice.direction() * 5e-4;
                row(normal, at, dice.range(-1e-4, 1e-4) - press, 0)
            }
            Family::Duplicate if k % 3 != 0 => rows[k - k % 3],
            Family::Duplicate => {
                let (normal, at) = ((axis + dice.direction()).normalize(), arm(dice));
                row(normal, at, dice.range(-2e-3, 5e-4), 0)
            }
            Family::NearlyParallel => {
                let normal = (axis + dice.direction() * 1e-7).normalize();
                let at = centre + dice.direction() * 1e-6;
                row(normal, at, dice.range(-1e-7, 1e-7) - press, 0)
            }
            Family::Opposing => {
                let side = if k % 2 == 0 { 1.0 } else { -1.0 };
                let normal = (axis * side + dice.direction() * 0.05).normalize();
                row(normal, arm(dice), dice.range(-1e-4, 3e-4), 0)
            }
            Family::Infeasible => {
                let side = if k % 2 == 0 { 1.0 } else { -1.0 };
                row(axis * side, centre, dice.range(-3e-4, -1e-5), 0)
            }
        });
    }
    rows
}

/// Returns the compliance of soft tissue under the rows: an exponential kernel, positive definite.
fn tissue(m: usize, dice: &mut Dice) -> Vec<f64> {
    let at: Vec<f64> = (0..m).map(|_| dice.range(0.0, 4.0)).collect();
    let compliance = dice.range(1e-5, 5e-3);
    let entry = |k: usize| compliance * (-(at[k / m] - at[k % m]).abs()).exp();
    (0..m * m).map(entry).collect()
}

/// Returns the largest difference of the two answers' poses, millimetres: translation, and rotation at 20 mm from the
/// working point.
fn pose_difference_mm(a: &Solution, b: &Solution) -> f64 {
    let part =
        |s: &Solution, at: usize, root: f64| Vec3::new(s.y[at], s.y[at + 1], s.y[at + 2]) / root;
    (0..2)
        .map(|tool| {
            let v = part(a, 6 * tool, KT.sqrt()) - part(b, 6 * tool, KT.sqrt());
            let w = part(a, 6 * tool + 3, KR.sqrt()) - part(b, 6 * tool + 3, KR.sqrt());
            (v.norm() + 0.02 * w.norm()) * 1e3
        })
        .fold(0.0, f64::max)
}

/// Largest number of rows in a problem.
const CAPACITY: usize = 512;

#[test]
fn both_solvers_agree_on_ten_thousand_row_sets() {
    const SETS: usize = 10_000;
    let mut dice = Dice(ChaCha8Rng::seed_from_u64(2014));
    let (mut own, mut judge) = (ActiveSet::with_capacity(CAPACITY), Clarabel);
    let (mut ours, mut theirs) = (
        Solution::with_capacity(CAPACITY),
        Solution::with_capacity(CAPACITY),
    );
    let mut differences = Vec::new();
    let mut unusable = 0;
    let mut worst_kkt = (0.0, Family::Random, 0);
    for set in 0..SETS {
        let family = FAMILIES[set % FAMILIES.len()];
        let m = match set % 50 {
            // Occasional full capacity: a flat tool on a flat face.
            0 if set % 500 == 0 => CAPACITY,
            0 => 120,
            k if k < 10 => 30,
            _ => 1 + (dice.unit() * 15.0) as usize,
        };
        let rows = rows(family, m, &mut dice);
        let compliance = (set / FAMILIES.len() % 4 == 3).then(|| tissue(m, &mut dice));
        // Contact compliances of the prototype (1e-7) and of the tick's default (1e-8), m/N.
        let contact_compliance = if set % 2 == 0 { 1e-7 } else { 1e-8 };
        let problem = Problem {
            rows: &rows,
            tissue: compliance.as_deref(),
            contact_compliance,
            warm_start: &[],
            max_iterations: usize::from(Params::default().max_iterations),
        };
        own.solve(&problem, &mut ours);
        assert_eq!(
            ours.status,
            SolveStatus::Solved,
            "set {set} {family:?} m {m}"
        );
        let kkt = problem.kkt_residual(&ours.lambda);
        if kkt > worst_kkt.0 {
            worst_kkt = (kkt, family, m);
        }
        judge.solve(&problem, &mut theirs);
        if theirs.status == SolveStatus::Solved {
            differences.push(pose_difference_mm(&ours, &theirs));
        } else {
            unusable += 1;
        }
    }
    differences.sort_by(f64::total_cmp);
    let (p999, most) = (
        differences[differences.len() * 999 / 1000],
        differences[differences.len() - 1],
    );
    println!(
        "KKT {worst_kkt:?}; poses p99.9 {p999:e} mm, max {most:e} mm; Clarabel unusable {unusable} of {SETS}"
    );
    assert!(worst_kkt.0 <= 1e-9, "KKT residual {worst_kkt:?}");
    assert!(p999 <= 2e-4, "{p999:e} mm");
    assert!(most <= 1e-3, "{most:e} mm");
    assert!(
        unusable <= SETS / 100,
        "the judge must answer nearly always, it did not {unusable} times"
    );
}

/// Clarabel in the tick starts with the most violated rows. The result must equal that with all rows.
#[test]
fn rows_that_are_added_as_they_are_violated_end_where_all_of_them_do() {
    const SETS: usize = 600;
    let mut dice = Dice(ChaCha8Rng::seed_from_u64(2026));
    let (mut added, mut all) = (
        Solution::with_capacity(CAPACITY),
        Solution::with_capacity(CAPACITY),
    );
    let (mut worst, mut compared) = (0.0_f64, 0);
    let mut kkt = [0.0_f64; 2];
    for set in 0..SETS {
        let m = match set % 100 {
            // Full capacity of a problem on tissue.
            0..=5 => 256,
            _ => 20 + (dice.unit() * 60.0) as usize,
        };
        let rows = rows(FAMILIES[set % FAMILIES.len()], m, &mut dice);
        let compliance = (set / FAMILIES.len() % 4 == 3).then(|| tissue(m, &mut dice));
        let problem = Problem {
            rows: &rows,
            tissue: compliance.as_deref(),
            contact_compliance: 1e-7,
            warm_start: &[],
            max_iterations: 0,
        };
        AllRows.solve(&problem, &mut all);
        if all.status != SolveStatus::Solved {
            continue;
        }
        Clarabel.solve(&problem, &mut added);
        assert_eq!(added.status, SolveStatus::Solved, "set {set}");
        compared += 1;
        worst = worst.max(pose_difference_mm(&added, &all));
        for (kkt, solution) in kkt.iter_mut().zip([&added, &all]) {
            *kkt = kkt.max(problem.kkt_residual(&solution.lambda));
        }
    }
    println!("{compared} of {SETS} compared, {worst:e} mm apart; KKT {kkt:?}");
    assert!(compared >= SETS * 99 / 100, "{compared}");
    assert!(worst <= 1e-4, "{worst:e} mm");
    assert!(kkt[0] <= 2.0 * kkt[1], "{kkt:?}");
}

#[test]
fn an_iteration_limit_is_said_and_not_an_answer() {
    let mut dice = Dice(ChaCha8Rng::seed_from_u64(7));
    let rows = rows(Family::Random, 40, &mut dice);
    let problem = Problem {
        rows: &rows,
        tissue: None,
        contact_compliance: 1e-7,
        warm_start: &[],
        max_iterations: 1,
    };
    let (mut solver, mut solution) = (ActiveSet::with_capacity(64), Solution::with_capacity(64));
    solver.solve(&problem, &mut solution);
    assert_eq!(solution.status, SolveStatus::IterationLimit);
}

#[test]
fn numbers_that_are_not_finite_give_no_answer() {
    let mut dice = Dice(ChaCha8Rng::seed_from_u64(8));
    let mut solution = Solution::with_capacity(40);
    for m in [5, 40] {
        let good = rows(Family::Random, m, &mut dice);
        let soft = tissue(m, &mut dice);
        for bad in [f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for place in 0..3 {
                let (mut rows, mut soft) = (good.clone(), soft.clone());
                match place {
                    0 => rows[2].bias = bad,
                    1 => rows[2].a[4] = bad,
                    // The matrix is symmetric.
                    _ => (soft[2], soft[2 * m]) = (bad, bad),
                }
                let problem = Problem {
                    rows: &rows,
                    tissue: (place == 2).then_some(&soft),
                    contact_compliance: 1e-7,
                    warm_start: &[],
                    max_iterations: 100,
                };
                let mut own = ActiveSet::with_capacity(m);
                let solvers: [&mut dyn ContactSolver; 3] = [&mut Clarabel, &mut AllRows, &mut own];
                // The tick's own solver checks the biases only. In a tick biases are computed from the rows, and are
                // not finite where rows are not.
                for solver in solvers.into_iter().take(if place == 0 { 3 } else { 2 }) {
                    solver.solve(&problem, &mut solution);
                    let status = solution.status;
                    assert_ne!(status, SolveStatus::Solved, "{bad} in {place} of {m}");
                }
            }
        }
    }
}

#[test]
fn one_row_has_the_answer_on_paper() {
    // Pressed 1 mm into a plane at the working point: F = k_t depth / (1 + k_t eps).
    let rows = [row(Vec3::z(), Vec3::zeros(), -1e-3, 0)];
    let problem = Problem {
        rows: &rows,
        tissue: None,
        contact_compliance: 1e-7,
        warm_start: &[],
        max_iterations: 100,
    };
    let mut solution = Solution::with_capacity(1);
    for solver in [
        &mut ActiveSet::with_capacity(1) as &mut dyn ContactSolver,
        &mut Clarabel,
    ] {
        solver.solve(&problem, &mut solution);
        assert!((solution.lambda[0] - 0.5 / (1.0 + KT * 1e-7)).abs() < 1e-6);
    }
}
