//! Section 3.2: how long a problem of 500 constraints takes, by both solvers.

use sulcus_cases::statistics::{Interval, median};
use sulcus_cases::timing::cpu_ns;
use sulcus_core::Vec3;
use sulcus_core::optimise::active_set::ActiveSet;
use sulcus_core::optimise::clarabel::AllRows;
use sulcus_core::optimise::{ContactSolver, Problem, ProblemRow, Solution, SolveStatus};

use super::answers::Answers;
use super::contact::SEED;

/// The paper's bounds: 50 regions of 10 pairs.
const REGIONS: usize = 50;
const PAIRS: usize = 10;
/// Coupling stiffness, N/m and N m/rad, of a probe.
const STIFFNESS: (f64, f64) = (500.0, 0.5);
/// Repeats of the whole, and problems in each.
const REPEATS: usize = 5;
const PROBLEMS: usize = 20;

/// Numbers from a seed, 0 to 1 (SplitMix64).
struct Chance(u64);

impl Chance {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn side(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    fn within(&mut self, radius: f64) -> Vec3 {
        Vec3::new(self.side(), self.side(), self.side()) * radius
    }
}

/// Contacts all over a tool of 2 cm from one half of space, as under a tool that is pressed into something bumpy: the pairs of a
/// region are neighbours, with about one normal.
fn rows(chance: &mut Chance) -> Vec<ProblemRow> {
    let (kt, kr) = STIFFNESS;
    let mut rows = Vec::with_capacity(REGIONS * PAIRS);
    for _ in 0..REGIONS {
        let (arm, lean) = (chance.within(1e-2), chance.within(0.7));
        for _ in 0..PAIRS {
            let normal = (Vec3::z() + lean + chance.within(0.2)).normalize();
            let turn = (arm + chance.within(1e-3)).cross(&normal);
            let (along, about) = (normal / kt.sqrt(), turn / kr.sqrt());
            rows.push(ProblemRow {
                a: [along.x, along.y, along.z, about.x, about.y, about.z],
                tool: 0,
                // Up to half a millimetre inside, some not yet touching.
                bias: -5e-4 * chance.unit() + 1e-4,
            });
        }
    }
    rows
}

/// The compliance of a soft tissue between the rows: `exp(-|i - j| / 10)` of 2 mm/N, as along a line.
fn tissue(n: usize) -> Vec<f64> {
    let entry = |k: usize| {
        let apart = (k / n).abs_diff(k % n) as f64;
        2e-3 * (-apart / 10.0).exp()
    };
    (0..n * n).map(entry).collect()
}

/// Median time of a solve in milliseconds by repeat, and how many were solved of how many.
fn timed(solver: &mut dyn ContactSolver, soft: Option<&[f64]>, problems: usize) -> (Interval, f64) {
    let mut solution = Solution::with_capacity(REGIONS * PAIRS);
    let mut solved = 0;
    let medians = (0..REPEATS).map(|_| {
        let mut chance = Chance(SEED);
        let times = (0..problems).map(|_| {
            let rows = rows(&mut chance);
            let problem = Problem {
                rows: &rows,
                tissue: soft,
                contact_compliance: 1e-8,
                warm_start: &[],
                max_iterations: 4000,
            };
            let begin = cpu_ns();
            solver.solve(&problem, &mut solution);
            let time = cpu_ns() - begin;
            solved += usize::from(solution.status == SolveStatus::Solved);
            time as f64 * 1e-6
        });
        median(times.collect())
    });
    let medians: Vec<f64> = medians.collect();
    (
        Interval::of(&medians),
        solved as f64 / (REPEATS * problems) as f64,
    )
}

/// Answers for the 500 rows.
pub(super) fn answer(quick: bool, answers: &mut Answers) {
    let n = REGIONS * PAIRS;
    let soft = tissue(n);
    let problems = if quick { PROBLEMS / 4 } else { PROBLEMS };
    let mut own = ActiveSet::with_capacity(n);
    let (rigid, rigid_solved) = timed(&mut own, None, problems);
    let (yielding, yielding_solved) = timed(&mut own, Some(&soft), problems);
    let (judge, judge_solved) = timed(&mut AllRows, None, problems);
    answers.measured(
        "solve-500-ms",
        format!("own solver {rigid:.3} ms where nothing yields, {yielding:.2} ms on soft tissue; Clarabel, all rows at once, {judge:.2} ms where nothing yields"),
        &[
            ("own_rigid_ms", rigid.mean),
            ("own_rigid_ms_half", rigid.half),
            ("own_soft_ms", yielding.mean),
            ("own_soft_ms_half", yielding.half),
            ("clarabel_rigid_ms", judge.mean),
            ("clarabel_rigid_ms_half", judge.half),
            ("solved_share_least", rigid_solved.min(yielding_solved).min(judge_solved)),
        ],
        format!("{n} rows drawn from seed {SEED}: {REGIONS} regions of {PAIRS} pairs, six unknowns; thread CPU time, median of {problems} problems, mean and 95 % interval of {REPEATS} repeats; solved {:.0}, {:.0}, {:.0} %; a tick's own problems on tissue hold 256 rows at most", rigid_solved * 100.0, yielding_solved * 100.0, judge_solved * 100.0),
    );
}
