//! The three answers of the first screen.

use super::failures::failures;
use super::rates;
use crate::report::{FELT_MJ, Level, Loop, Report, Row};

/// A question, a short answer, and its grounds.
pub(crate) struct Answer {
    pub(crate) question: &'static str,
    pub(crate) short: String,
    /// `yes`, `so` or `no`.
    pub(crate) mood: &'static str,
    pub(super) long: Vec<Line>,
}

/// A paragraph of an answer.
pub(super) enum Line {
    Text(String),
    /// A bound that does not hold.
    Broken(String),
    /// Largest errors of the models of the tongue, percent of the displacement.
    Tongue {
        /// Surface compliance.
        elements: f64,
        /// Springs with one factor fitted.
        fitted: f64,
        /// Springs as shipped.
        shipped: f64,
    },
}

/// The answers, in their order.
pub(crate) fn answers(report: &Report) -> [Answer; 3] {
    [speed(report), error(report), breaks(report)]
}

/// The case without any way out: its overlap is what was asked for.
const IMPOSSIBLE: &str = "infeasible";

/// Error of a tissue's displacement that is said to be good, percent of it.
const GOOD_SHAPE: f64 = 10.0;

/// The level that is shipped.
const SHIPPED: u8 = 3;

fn shipped(report: &Report) -> Option<&Level> {
    let levels = &report.mouth.levels;
    levels
        .iter()
        .find(|level| level.level == SHIPPED)
        .or(levels.first())
}

fn coupled(report: &Report) -> impl Iterator<Item = &Row> {
    report
        .rows
        .iter()
        .filter(|row| row.method == "coupled" && row.solver == "active_set")
}

fn speed(report: &Report) -> Answer {
    let question = "Does it hold 1 kHz here?";
    let Some(level) = shipped(report) else {
        return Answer {
            question,
            short: "not measured".into(),
            mood: "so",
            long: Vec::new(),
        };
    };
    let t = &level.times;
    let (mood, short) = match (t.tick_us.p999 <= 1000.0, t.tick_us.max <= 1000.0) {
        (true, true) => ("yes", "Yes".to_owned()),
        (true, false) => ("so", "Yes, but for single ticks".to_owned()),
        (false, _) => ("no", "No".to_owned()),
    };
    let spread = |of: fn(&crate::report::TickUs) -> f64| {
        let half = t.tick_us_ci95.as_ref().map(of);
        half.map_or(String::new(), |half| format!(" ± {half:.0}"))
    };
    let mut long = vec![Line::Text(format!(
        "The whole mouth, two hands at work: {:.0}{} µs in the median, {:.0}{} µs at p99.9, {:.0} µs at most, of 1,000 (CPU time, {} ticks, {}). On the wall {:.2} % of ticks took longer than a millisecond.",
        t.tick_us.p50,
        spread(|t| t.p50),
        t.tick_us.p999,
        spread(|t| t.p999),
        t.tick_us.max,
        t.ticks,
        match t.runs {
            1 => "one run".to_owned(),
            runs => format!("{runs} runs; ± is 95 %"),
        },
        t.over_1_ms_percent,
    ))];
    let mut slow: Vec<&Row> = coupled(report).collect();
    slow.sort_by(|a, b| b.times.tick_us.p999.total_cmp(&a.times.tick_us.p999));
    let over = slow
        .iter()
        .filter(|row| row.times.tick_us.p999 > 1000.0)
        .count();
    if let Some(row) = slow.first() {
        long.push(Line::Text(format!(
            "Rates held of {} kHz: {}. Of {} hard cases {over} take longer than a millisecond at p99.9; the slowest, {}: {:.0} µs.",
            rates::tried(&report.rates),
            rates::held(&report.rates),
            slow.len(),
            row.case,
            row.times.tick_us.p999,
        )));
    }
    let mood = if over > 0 && mood == "yes" {
        "so"
    } else {
        mood
    };
    Answer {
        question,
        short: format!("{short}: {:.0} µs of 1,000 at p99.9", t.tick_us.p999),
        mood,
        long,
    }
}

fn error(report: &Report) -> Answer {
    let deepest = coupled(report)
        .map(|row| row.residual_um)
        .fold(0.0, f64::max);
    let jump = coupled(report)
        .map(|row| row.slow_force_step_n)
        .fold(0.0, f64::max);
    let mut long = vec![Line::Text(format!(
        "Deepest that a tool is in what it touches, over {} hard cases: {deepest:.2} µm (at most 1). Largest click of the force under a slow hand: {:.0} mN (at most 20).",
        coupled(report).count(),
        jump * 1e3,
    ))];
    let mut short = format!("{deepest:.2} µm deep");
    if let Some(level) = shipped(report) {
        long.push(Line::Text(format!(
            "What is touched stands off the drawn molar by {:.0} µm in the mean, {:.0} µm at most.",
            level.tooth_error_mean_um, level.tooth_error_max_um
        )));
        short += &format!(", shape {:.0} µm", level.tooth_error_mean_um);
    }
    let outrun = outrun_um(report);
    let (share, scene) = outrun_most(report);
    if outrun > 1.0 {
        long.push(Line::Text(format!(
            "In ticks that a leaping hand outran (under random poses {share:.0} % of a tool's at most: {scene}) a tool and what it strikes, soft tissue most, overlap by up to {outrun:.0} µm until a later one is done.",
        )));
    }
    let worst = |model: &str| {
        let all = report.finite_elements.iter().filter(|e| e.model == model);
        all.map(|e| e.rel_l2_percent).fold(0.0, f64::max)
    };
    let (elements, fitted) = (worst("surface_compliance"), worst("skeleton_one_factor"));
    if elements > 0.0 {
        long.push(Line::Tongue {
            elements,
            fitted,
            shipped: worst("skeleton"),
        });
        short += &format!(", tongue {fitted:.0} % ({elements:.0} % by elements)");
    }
    Answer {
        question: "How wrong is it?",
        short,
        mood: match (deepest <= 1.0 && jump <= 0.020001, fitted <= GOOD_SHAPE) {
            (true, true) => "yes",
            (true, false) => "so",
            (false, _) => "no",
        },
        long,
    }
}

/// Deepest overlap in ticks that ran out of passes, random poses included, micrometres.
fn outrun_um(report: &Report) -> f64 {
    let rows = coupled(report).filter(|row| row.case != IMPOSSIBLE);
    let rows = rows.map(|row| row.exhausted_residual_um);
    let rough = report.random_poses.iter().map(|r| r.exhausted_residual_um);
    rows.chain(rough).fold(0.0, f64::max)
}

/// Largest share of tool-ticks that a random walk outran, percent, and where.
fn outrun_most(report: &Report) -> (f64, &'static str) {
    let all = report.random_poses.iter();
    let shares = all.map(|r| (r.exhausted_percent, r.scene));
    shares.fold(
        (0.0, "none"),
        |most, this| if this.0 > most.0 { this } else { most },
    )
}

/// What the loops over links put out at most, without and with the controller, in words.
fn over_links(report: &Report) -> Option<String> {
    let loops = &report.passivity.loops;
    let most = |of: fn(&Loop) -> f64| loops.iter().max_by(|a, b| of(a).total_cmp(&of(b)));
    let without = most(|l| l.energy_mj)?;
    let with = most(|l| l.energy_controlled_mj)?;
    let quiet = loops.iter().filter(|l| l.energy_controlled_mj <= FELT_MJ);
    Some(format!(
        "Over {} links with loss and up to 5 ms the loop puts out up to {:.0} mJ ({}); with the controller under {FELT_MJ} mJ over {}, {:.1} mJ at most ({}).",
        loops.len(),
        without.energy_mj,
        without.case,
        quiet.count(),
        with.energy_controlled_mj,
        with.case,
    ))
}

fn breaks(report: &Report) -> Answer {
    let of = |method: &'static str| report.rows.iter().filter(move |row| row.method == method);
    let broken = failures(report);
    let (printed, failing) = (
        of("printed").count(),
        of("printed").filter(|row| row.status != "holds").count(),
    );
    let mut long: Vec<Line> = broken.iter().take(3).cloned().map(Line::Broken).collect();
    let mut near: Vec<&Row> = of("coupled").filter(|row| row.status == "holds").collect();
    near.sort_by(|a, b| b.nearest.1.total_cmp(&a.nearest.1));
    // Limits that the tick itself keeps to are reached whenever they are needed.
    let kept = ["slow force step", "step sent"];
    let mut named: Vec<String> = Vec::new();
    for row in near
        .iter()
        .filter(|row| !kept.contains(&row.nearest.0.as_str()))
    {
        let again = named.iter().any(|said| said.starts_with(row.case));
        if named.len() < 3 && row.nearest.1 < 100.0 && !again {
            named.push(format!(
                "{} ({} at {:.0} % of its bound)",
                row.case, row.nearest.0, row.nearest.1
            ));
        }
    }
    if !named.is_empty() {
        let near = named.join(", ");
        long.push(Line::Text(format!("Nearest to breaking: {near}.")));
    }
    let exhausted: u64 = coupled(report).map(|row| row.exhausted_ticks).sum();
    long.push(Line::Text(format!(
        "Ticks in which the hand outran the tool: {exhausted}. The method as printed, for comparison: {failing} of {printed} cases do not hold."
    )));
    long.extend(over_links(report).map(Line::Text));
    let passivity = &report.passivity;
    let all = of("coupled").count()
        + report.random_poses.len()
        + passivity.loops.len()
        + passivity.hours.len()
        + report.devices.len();
    let felt = |l: &&Loop| l.energy_controlled_mj > FELT_MJ;
    let felt = passivity.loops.iter().filter(felt).count();
    let (short, mood) = match broken.len() {
        0 if felt > 0 => (
            format!("Nowhere in {all} runs; {felt} links give back more than {FELT_MJ} mJ"),
            "so",
        ),
        0 => (format!("Nowhere in {all} runs"), "yes"),
        n => (format!("In {n} of {all} runs"), "no"),
    };
    Answer {
        question: "Where does it break?",
        short,
        mood,
        long,
    }
}
