//! Section 4.4, Eq. 9, Fig. 7 and Table 1: the benchmark with one degree of freedom.

use sulcus_cases::one_dof::{DEPTH, Method, OneDof, SPEEDS, SPRINGS, Table};
use sulcus_core::Params;

use super::answers::Answers;

/// Shares of the limit at which explicit Euler is run.
const SHARES: [f64; 3] = [0.9, 0.99, 1.01];
/// Springs that stand for Eq. 9, N/m: from soft to near the limit at a millisecond.
const JUDGED: [f64; 3] = [5.0, 500.0, 19_000.0];

/// A benchmark with that damping ratio.
fn with_ratio(spring: f64, damping_ratio: f64) -> OneDof {
    OneDof {
        damping_ratio,
        ..OneDof::with_spring(spring)
    }
}

/// Answers for everything with one degree of freedom.
pub(super) fn answer(answers: &mut Answers) {
    let numbers = OneDof::with_spring(SPRINGS[0]);
    let run = "the number that the benchmark is run with: the paper's";
    let grams = numbers.mass * 1e3;
    answers.measured("table1-mass-g", format!("{grams} g"), &[("g", grams)], run);
    let ratio = numbers.damping_ratio;
    answers.measured(
        "table1-damping-ratio",
        format!("{ratio}"),
        &[("ratio", ratio)],
        run,
    );
    let coupling = numbers.coupling;
    answers.measured(
        "table1-coupling-n-per-m",
        format!("{coupling} N/m"),
        &[("n_per_m", coupling)],
        run,
    );
    let penalty = numbers.penalty;
    answers.measured(
        "table1-penalty-n-per-m",
        format!("{penalty} N/m"),
        &[("n_per_m", penalty)],
        run,
    );
    answers.measured(
        "fig7-spheres",
        "one moving sphere on a spring to a fixed place, explicit Euler, a tool on the same line",
        &[("moving", 1.0)],
        "the benchmark as section 4.4 has it",
    );
    table(&Table::run(), answers);
    limits(answers);
}

/// What Table 1's contacts come to.
fn table(table: &Table, answers: &mut Answers) {
    let rows = &table.0;
    let springs = SPRINGS.map(|spring| format!("{spring}")).join(", ");
    answers.measured(
        "table1-spring-n-per-m",
        format!("{springs} N/m"),
        &[("least", SPRINGS[0]), ("most", SPRINGS[SPRINGS.len() - 1])],
        "chosen here, from a fifth of the penalty stiffness to near the limit at a millisecond: the paper's are lost",
    );
    let cases = SPRINGS.len() * Method::ALL.len() * SPEEDS.len();
    answers.measured(
        "table1-case-count",
        format!("{cases}"),
        &[("cases", cases as f64)],
        "springs by methods (as printed, implicit, coupled) by speeds, all chosen here",
    );
    let speeds = SPEEDS.map(|speed| speed * 1e3);
    answers.measured(
        "table1-contact-velocity",
        format!("{} and {} mm/s", speeds[0], speeds[1]),
        &[("slow_mm_per_s", speeds[0]), ("fast_mm_per_s", speeds[1])],
        "chosen here: slow, and the paper's own speed of a tool",
    );
    let press = |row: &sulcus_cases::one_dof::Row, method: Method| {
        let found = row.presses.iter().find(|(of, _)| *of == method);
        found.map_or_else(Default::default, |(_, presses)| *presses)
    };
    let (mut settled, mut step, mut lost) = (0, 0.0_f64, 0.0_f64);
    for row in rows {
        let n = &row.numbers;
        let [slow, fast] = press(row, Method::Printed);
        // Where spring and penalty hold each other.
        let rest = n.penalty * DEPTH / n.stiffness();
        settled += usize::from((slow.depth - rest).abs().max((fast.depth - rest).abs()) < 1e-6);
        step = step.max(slow.force_step).max(fast.force_step);
        lost = lost.max(slow.device_force / slow.tissue_force);
    }
    let coupled: f64 = rows
        .iter()
        .map(|row| {
            let [slow, _] = press(row, Method::Coupled);
            (slow.device_force / slow.tissue_force - 1.0).abs()
        })
        .fold(0.0, f64::max);
    answers.measured(
        "table1-outcome",
        format!(
            "as printed: {settled} of {} springs come to rest where they should at both speeds; the device then feels {lost:.0} times what the tissue bears; coupled: both the same to {:.0e}",
            rows.len(),
            coupled.max(1e-16),
        ),
        &[
            ("settled", settled as f64),
            ("force_step_n", step),
            ("device_over_tissue_printed", lost),
            ("device_over_tissue_coupled_error", coupled),
        ],
        format!("hand from 5 mm off to {} mm inside, then three seconds at rest, steps of 1 ms; largest force step as printed {step:.4} N", DEPTH * 1e3),
    );
    let depth = |row, method| press(row, method)[0].depth * 1e3;
    let (soft, hard) = (&rows[0], &rows[rows.len() - 1]);
    answers.measured(
        "stiffness-ratio",
        format!(
            "as printed {:.2} mm at kS/kp = {}, {:.4} mm at {}; coupled {:.2} and {:.3} mm",
            depth(soft, Method::Printed),
            soft.numbers.spring / soft.numbers.penalty,
            depth(hard, Method::Printed),
            hard.numbers.spring / hard.numbers.penalty,
            depth(soft, Method::Coupled),
            depth(hard, Method::Coupled),
        ),
        &[
            ("soft_mm", depth(soft, Method::Printed)),
            ("hard_mm", depth(hard, Method::Printed)),
        ],
        "depth of the sphere with the hand 10 mm inside, 1 degree of freedom; coupled it depends on kS/kc instead",
    );
    let bounds = rows.iter().map(|row| row.limits);
    let worst = bounds
        .clone()
        .map(|(p, m)| (m / p - 1.0).abs())
        .fold(0.0, f64::max);
    let list: Vec<String> = bounds
        .zip(SPRINGS)
        .map(|((predicted, measured), spring)| {
            format!(
                "{:.3} ({:.3}) ms at {spring} N/m",
                measured * 1e3,
                predicted * 1e3
            )
        })
        .collect();
    answers.measured(
        "eq9-table1-limit-ms",
        list.join("; "),
        &[("worst_share_off", worst)],
        "found by running explicit Euler in lasting contact; in brackets what Eq. 9 predicts",
    );
}

/// Eq. 9, each of its three cases.
fn limits(answers: &mut Answers) {
    let cases = [
        ("eq9-underdamped", 0.5),
        ("eq9-critical", 1.0),
        ("eq9-overdamped", 2.0),
    ];
    for (id, ratio) in cases {
        let mut worst = 0.0_f64;
        let mut grown = [0; SHARES.len()];
        for spring in JUDGED {
            let numbers = with_ratio(spring, ratio);
            let limit = numbers.predicted_limit();
            worst = worst.max((numbers.measured_limit() / limit - 1.0).abs());
            for (grown, share) in grown.iter_mut().zip(SHARES) {
                *grown += usize::from(numbers.grows(share * limit));
            }
        }
        let n = JUDGED.len();
        answers.measured(
            id,
            format!(
                "limit found within {:.2} %; grows at 0.9, 0.99, 1.01 of it in {}, {}, {} of {n} springs",
                worst * 100.0,
                grown[0],
                grown[1],
                grown[2]
            ),
            &[
                ("worst_share_off", worst),
                ("grow_at_0.9", grown[0] as f64),
                ("grow_at_0.99", grown[1] as f64),
                ("grow_at_1.01", grown[2] as f64),
            ],
            format!("damping ratio {ratio}, springs of {JUDGED:?} N/m with the penalty's 5, mass 20 g, run in lasting contact"),
        );
    }
    let limit = |mass: f64| {
        let numbers = OneDof {
            mass: mass * 1e-3,
            ..OneDof::with_spring(500.0)
        };
        numbers.measured_limit() * 1e3
    };
    let masses = [10.0, 20.0, 40.0];
    let found = masses.map(limit);
    answers.measured(
        "mass-raises-limit",
        format!(
            "{:.2}, {:.2}, {:.2} ms at 10, 20, 40 g",
            found[0], found[1], found[2]
        ),
        &[
            ("at_10_g", found[0]),
            ("at_20_g", found[1]),
            ("at_40_g", found[2]),
        ],
        "largest stable step, found by running it; kS 500 N/m, damping ratio 0.5",
    );
    answers.measured(
        "time-step-ms",
        format!("{} ms", Params::default().tick_s() * 1e3),
        &[("ms", Params::default().tick_s() * 1e3)],
        "one tick; fixed",
    );
}
