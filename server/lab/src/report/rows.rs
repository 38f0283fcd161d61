//! The hard cases, row by row: what each costs, how wrong it is, what holds and what does not.

use serde::Serialize;
use sulcus_cases::comparison::as_printed;
use sulcus_cases::statistics::percentile;
use sulcus_cases::{Case, CaseReport, TABLE, run_on};
use sulcus_core::optimise::SolverKind;
use sulcus_core::tissue::TissueModel;
use sulcus_core::{Scene, TickInput, ToolOutput};

use super::times::Times;
use super::together::on_all_cores;

/// One case by one method with one solver.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Row {
    pub(crate) case: &'static str,
    pub(crate) about: &'static str,
    /// `coupled`, or `printed`: as the paper has it.
    pub(crate) method: &'static str,
    /// What yields in the scene.
    pub(crate) tissue: String,
    /// `active_set`, the tick's own, or `clarabel`, the judge.
    pub(crate) solver: &'static str,
    /// Finest level in contact.
    pub(crate) level: u8,
    #[serde(flatten)]
    pub(crate) times: Times,
    pub(crate) work: Work,
    pub(crate) residual_um: f64,
    pub(crate) exhausted_residual_um: f64,
    pub(crate) graphic_jump_um: f64,
    pub(crate) buzz_n: f64,
    pub(crate) force_step_n: f64,
    /// Of hands at up to 0.2 m/s.
    pub(crate) slow_force_step_n: f64,
    pub(crate) energy_mj: f64,
    /// How far from going through it was; none where there is nothing to go through.
    pub(crate) margin_mm: Option<f64>,
    pub(crate) exhausted_ticks: u64,
    pub(crate) settling_ticks: u64,
    pub(crate) contact_ticks: u64,
    /// Passes of the solver in a tick in contact, mean over the ticks and both tools: the cost of continuous collision.
    /// The motion of a pass ends at the border of the region that the pass searched for contacts.
    pub(crate) passes_mean: f64,
    /// Largest number of passes in a tick.
    pub(crate) passes_max: u32,
    /// `holds`, `broken`, or `shown` for what is not asked to hold.
    pub(crate) status: &'static str,
    /// What does not hold, in words.
    pub(crate) broken: Vec<String>,
    /// Which bound is nearest, and how much of it is used, percent.
    pub(crate) nearest: (String, f64),
}

/// Percentiles of the counted work of a tick in contact, operations. The same on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Work {
    pub(crate) p50: u32,
    pub(crate) p999: u32,
    pub(crate) max: u32,
}

impl Work {
    /// Percentiles of `ticks`, in any order; all zero without ticks.
    fn of(mut ticks: Vec<u32>) -> Self {
        ticks.sort_unstable();
        let at = |share| percentile(&ticks, share).unwrap_or(0);
        Self {
            p50: at(0.5),
            p999: at(0.999),
            max: at(1.0),
        }
    }
}

/// The same in thousands of operations.
pub(crate) struct Thousands {
    pub(crate) p50: f64,
    pub(crate) p999: f64,
    pub(crate) max: f64,
}

impl Work {
    /// The same in thousands of operations.
    pub(crate) fn thousands(&self) -> Thousands {
        let thousands = |count| f64::from(count) * 1e-3;
        Thousands {
            p50: thousands(self.p50),
            p999: thousands(self.p999),
            max: thousands(self.max),
        }
    }
}

/// Cases of a quick report.
const QUICK: [&str; 13] = [
    "thin-plate-0.3mm-2",
    "teleport",
    "wedge",
    "sharp-edge",
    "peg-in-hole",
    "opposed-0",
    "immersed",
    "long-lever",
    "tissue-comes-back",
    "pocket-0.4",
    "tongue-10-k2",
    "organ-10-k2",
    "soft-next-to-hard",
];
/// Cases that run as printed, too: those with tissue as the paper has it (but a minute of rest), and three of contact
/// among rigid things alone, where the tool's own step is what is printed. Where nothing of it is printed there is
/// nothing to compare.
const PAPERS: [&str; 26] = [
    "sharp-edge",
    "peg-in-hole",
    "flat-on-flat",
    "pocket-0.4",
    "pocket-0.5",
    "pocket-0.65",
    "pocket-0.8",
    "pocket-stiff",
    "two-probes",
    "pocket-teleport",
    "pit-teleport",
    "pocket-flicker",
    "tongue-10-k0.5",
    "tongue-10-k2",
    "tongue-10-k5",
    "tongue-15-k0.5",
    "tongue-15-k2",
    "tongue-15-k5",
    "two-mirrors",
    "soft-next-to-hard",
    "tongue-stiff",
    "tongue-teleport",
    "tongue-edge-0.1",
    "tongue-edge-0.5",
    "tongue-edge-2",
    "tissue-comes-back",
];
/// Cases that the judge solves, one of each kind; the first few in a quick report. (It takes minutes for them all.)
const JUDGED: [&str; 16] = [
    "wedge",
    "opposed-0",
    "sharp-edge",
    "thin-plate-0.3mm-2",
    "teleport",
    "peg-in-hole",
    "groove-steep",
    "flat-on-flat",
    "immersed",
    "long-lever",
    "tongue-edge-0.5",
    "pocket-0.4",
    "tongue-10-k0.5",
    "organ-10-k0.5",
    "soft-next-to-hard",
    "pocket-teleport",
];
const JUDGED_QUICK: usize = 3;
/// Ticks over which what is not the tick's own method and solver is timed.
const FEWER: usize = 3_000;
/// Ticks from which one run says enough of times: nothing of a case that takes longer is left out, nor repeated.
const LONG: usize = 8_000;

/// Measures them all.
pub(super) fn measure(quick: bool, progress: &dyn Fn(&str, f64)) -> Vec<Row> {
    let cases = || {
        TABLE
            .iter()
            .filter(|case| !quick || QUICK.contains(&case.name))
    };
    let mut wanted: Vec<(&Case, bool, SolverKind)> = Vec::new();
    for case in cases() {
        wanted.push((case, false, SolverKind::ActiveSet));
        let judged = if quick {
            &JUDGED[..JUDGED_QUICK]
        } else {
            &JUDGED
        };
        if judged.contains(&case.name) {
            wanted.push((case, false, SolverKind::Clarabel));
        }
        if PAPERS.contains(&case.name) && (!quick || case.name == "tongue-10-k2") {
            wanted.push((case, true, SolverKind::ActiveSet));
        }
    }
    // What is measured does not mind a neighbour; what is timed does.
    let ran = on_all_cores(
        &wanted,
        &|share| progress("", 0.6 * share),
        |(case, printed, solver)| ran(case, *printed, *solver),
    );
    let all = wanted.len() as f64;
    let row = |(k, ran): (usize, Ran)| {
        let (case, printed, solver) = wanted[k];
        progress(case.name, 0.6 + 0.4 * k as f64 / all);
        timed(case, printed, solver, ran, quick)
    };
    ran.into_iter().enumerate().map(row).collect()
}

/// Measures one.
#[cfg(test)]
pub(crate) fn row(case: &Case, printed: bool, solver: SolverKind, quick: bool) -> Row {
    timed(case, printed, solver, ran(case, printed, solver), quick)
}

/// A case as it was run, by what it may be timed.
struct Ran {
    scene: Scene,
    inputs: Vec<TickInput>,
    /// Ticks in which a tool bore load.
    touching: Vec<bool>,
    /// Passes of both tools over those ticks, and the most of one.
    passes: (u64, u32),
    /// Counted work of each of those ticks, operations.
    work: Vec<u32>,
    report: CaseReport,
}

fn ran(case: &Case, printed: bool, solver: SolverKind) -> Ran {
    let (mut inputs, mut scene, mut touching) = (Vec::new(), None, Vec::new());
    let (mut passes, mut work) = ((0, 0), Vec::new());
    let report = run_on(
        case,
        |scene| {
            if printed {
                as_printed(scene);
            }
            scene.params.solver = solver;
        },
        |seen| {
            scene.get_or_insert_with(|| seen.scene.clone());
            inputs.push(*seen.input);
            let bears = seen.output.tools.iter().any(|tool| tool.active > 0);
            touching.push(bears);
            if bears {
                let of = |tool: &ToolOutput| u32::from(tool.substeps);
                let now: u32 = seen.output.tools.iter().map(of).sum();
                passes = (passes.0 + u64::from(now), passes.1.max(now));
                work.push(seen.output.work);
            }
        },
    );
    Ran {
        scene: scene.expect("a case has ticks"),
        inputs,
        touching,
        passes,
        work,
        report,
    }
}

fn timed(case: &Case, printed: bool, solver: SolverKind, ran: Ran, quick: bool) -> Row {
    let Ran {
        scene,
        inputs,
        touching,
        passes,
        work,
        report,
    } = ran;
    let bearing = touching.iter().filter(|bears| **bears).count();
    // What is there for comparison is slow, and not who must be fast.
    let ours = !printed && solver == SolverKind::ActiveSet;
    let runs = match (ours, quick) {
        (false, _) | (_, true) => 1,
        _ if inputs.len() > LONG => 1,
        _ => 3,
    };
    let timed = if ours {
        inputs.len()
    } else {
        FEWER.min(inputs.len())
    };
    let counts = |k: usize| touching[k];
    let times = Times::of(&scene, &inputs[..timed], runs, counts).with_stages(
        &scene,
        &inputs[..timed],
        counts,
    );
    let m = &report.measures;
    let checks = case.bounds.checks(m, report.margin);
    let nearest = checks
        .iter()
        .filter(|check| !check.floor)
        .max_by(|a, b| a.used().total_cmp(&b.used()))
        .map_or((String::new(), 0.0), |check| {
            (check.what.to_owned(), 100.0 * check.used())
        });
    Row {
        case: case.name,
        about: case.about,
        method: if printed { "printed" } else { "coupled" },
        tissue: tissues(&scene),
        solver: solver_name(solver),
        level: scene
            .objects
            .iter()
            .map(|o| o.level.min(o.tree.depth()))
            .max()
            .unwrap_or(0),
        times,
        work: Work::of(work),
        residual_um: m.residual * 1e6,
        exhausted_residual_um: m.exhausted_residual * 1e6,
        graphic_jump_um: m.jump * 1e6,
        buzz_n: m.buzz,
        force_step_n: m.force_step,
        slow_force_step_n: m.slow_force_step,
        energy_mj: m.energy * 1e3,
        margin_mm: report.margin.is_finite().then_some(report.margin * 1e3),
        exhausted_ticks: m.exhausted,
        settling_ticks: m.settling,
        contact_ticks: m.contact_ticks,
        passes_mean: passes.0 as f64 / bearing.max(1) as f64,
        passes_max: passes.1,
        status: match (printed, report.broken.is_empty()) {
            (_, true) => "holds",
            (true, false) => "shown",
            (false, false) => "broken",
        },
        broken: report.broken,
        nearest,
    }
}

/// Name of a solver in the JSON.
pub(super) fn solver_name(solver: SolverKind) -> &'static str {
    match solver {
        SolverKind::ActiveSet => "active_set",
        SolverKind::Clarabel => "clarabel",
    }
}

/// Names of what yields in a scene.
pub(super) fn tissues(scene: &Scene) -> String {
    let mut names: Vec<&str> = scene
        .objects
        .iter()
        .map(|object| match &object.tissue {
            TissueModel::Rigid => "rigid",
            TissueModel::Skeleton(_) => "skeleton",
            TissueModel::Surface(_) => "surface_compliance",
            TissueModel::Gingiva(_) => "gingiva",
            TissueModel::PrintedSkeleton(_) => "printed skeleton",
            TissueModel::PrintedGingiva(_) => "printed gingiva",
        })
        .collect();
    names.sort_unstable();
    names.dedup();
    names.join(" + ")
}
