//! Speed against error for level x tissue x solver x method: every combination under one recorded hand a scene.
//!
//! The hand felt the scene as it is shipped. What is compared is the force that each combination gives that same hand:
//! against the finest level by the coupled method with the judge.

use std::collections::BTreeMap;

use serde::Serialize;
use sulcus_cases::comparison::as_printed;
use sulcus_cases::{Measures, Observer, record};
use sulcus_core::optimise::SolverKind;
use sulcus_core::{MAX_TOOLS, NoProbe, Scene, State, TickInput, Vec3, Workspace, tick};
use sulcus_operator::HandParams;

use super::mouth::off_drawn;
use super::rates::LOOKS_S;
use super::rows::{solver_name, tissues};
use super::shipped::{SEED, SHIPPED, Shipped};
use super::times::Times;
use super::together::on_all_cores;

/// One thing that yields in each, or nothing: the whole mouth has parts of its own in the report.
const SCENES: [&str; 4] = ["crown", "pocket", "tongue", "organ"];
/// How long is measured from when the hand is at work, seconds, in a full report and in a quick one.
const SECONDS: [f64; 2] = [1.2, 0.6];
/// How long of that where the judge solves, which takes milliseconds (as printed up to a quarter of a second): all but the reference.
const JUDGED_S: f64 = 0.15;
/// Coarsest level that is touched: the levels above only serve culling.
const COARSEST: u8 = 2;

/// One combination.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Cell {
    pub(crate) scene: &'static str,
    /// What yields, as shipped.
    pub(crate) tissue: String,
    pub(crate) method: &'static str,
    pub(crate) solver: &'static str,
    /// Level of what is touched.
    pub(crate) level: u8,
    /// Whether it is the combination that is shipped.
    pub(crate) shipped: bool,
    pub(crate) spheres: usize,
    #[serde(flatten)]
    pub(crate) times: Times,
    /// Distance of the first object as it is touched from it as it is drawn, at rest, micrometres, mean.
    pub(crate) shape_error_um: f64,
    /// Difference of the raw force to the reference's, rms over ticks in which either bears load, percent of its rms.
    pub(crate) force_off_percent: f64,
    /// The same over the ticks that the judge solves, the same for every cell of a scene; none where no judge was asked.
    pub(crate) force_off_at_first_percent: Option<f64>,
    /// What it is compared with.
    pub(crate) reference: bool,
    pub(crate) residual_um: f64,
    pub(crate) graphic_jump_um: f64,
    pub(crate) buzz_n: f64,
    pub(crate) slow_force_step_n: f64,
    pub(crate) exhausted_ticks: u64,
}

/// What is run.
struct Wanted {
    scene: Scene,
    level: u8,
    method: &'static str,
    solver: SolverKind,
}

impl Wanted {
    fn is_own(&self) -> bool {
        self.solver == SolverKind::ActiveSet
    }
}

/// Raw forces of the tools in a tick.
type Forces = [Vec3; MAX_TOOLS];

/// Measures them all.
pub(super) fn measure(quick: bool, progress: &dyn Fn(&str, f64)) -> Vec<Cell> {
    let mut cells = Vec::new();
    for (k, shipped) in SHIPPED
        .iter()
        .filter(|shipped| SCENES.contains(&shipped.name))
        .enumerate()
    {
        let share = |of: f64| progress(shipped.name, (k as f64 + of) / SCENES.len() as f64);
        cells.extend(of_scene(shipped, quick, &share));
    }
    cells
}

fn of_scene(shipped: &Shipped, quick: bool, share: &dyn Fn(f64)) -> Vec<Cell> {
    share(0.0);
    let scene = (shipped.scene)();
    let begins = scene.params.ticks_in(shipped.begins) as usize;
    let ends = shipped.begins + SECONDS[usize::from(quick)];
    let hand = (HandParams::default(), SEED);
    let ticks = scene.params.ticks_in(ends);
    let inputs = record(&scene, shipped.hands(&scene, ends), hand, ticks, |_, _| {});
    let wanted = wanted(&scene, quick);
    let looks = LOOKS_S[usize::from(quick)];
    let judged = begins + scene.params.ticks_in(JUDGED_S) as usize;
    let numbered: Vec<(usize, &Wanted)> = wanted.iter().enumerate().collect();
    let progress = |of| share(0.1 + 0.6 * of);
    let runs = on_all_cores(&numbered, &progress, |(k, wanted)| {
        let all = wanted.is_own() || *k == 0;
        let inputs = &inputs[..if all { inputs.len() } else { judged }];
        run(&wanted.scene, inputs, looks)
    });
    let reference = &runs[0].1;
    // The same whatever the method and the solver.
    let mut errors: BTreeMap<u8, f64> = BTreeMap::new();
    let count = wanted.len() as f64;
    let cell = |(k, (wanted, (measures, forces))): (usize, (&Wanted, &(Measures, Vec<Forces>)))| {
        share(0.7 + 0.3 * k as f64 / count);
        let touches = |k: usize| k >= begins && forces[k].iter().any(|f| f.norm_squared() > 0.0);
        let until = if wanted.is_own() {
            inputs.len()
        } else {
            judged
        };
        let repeats = if quick || !wanted.is_own() { 1 } else { 3 };
        let times = Times::of(&wanted.scene, &inputs[..until], repeats, touches);
        let touched = &wanted.scene.objects[0];
        let error = errors.entry(touched.level);
        let error = error.or_insert_with(|| off_drawn(touched).mean);
        Cell {
            scene: shipped.name,
            tissue: tissues(&scene),
            method: wanted.method,
            solver: solver_name(wanted.solver),
            level: wanted.level,
            shipped: wanted.level == level_of(&scene)
                && wanted.is_own()
                && wanted.method == "coupled",
            spheres: touched.tree.shape_at(touched.level).count(),
            times,
            shape_error_um: *error * 1e3,
            force_off_percent: off(&forces[begins..], &reference[begins..]),
            force_off_at_first_percent: (!quick)
                .then(|| off(&forces[begins..judged], &reference[begins..judged])),
            reference: k == 0,
            residual_um: measures.residual * 1e6,
            graphic_jump_um: measures.jump * 1e6,
            buzz_n: measures.buzz,
            slow_force_step_n: measures.slow_force_step,
            exhausted_ticks: measures.exhausted,
        }
    };
    let mut cells: Vec<Cell> = wanted.iter().zip(&runs).enumerate().map(cell).collect();
    cells.sort_by_key(|cell| (cell.method, cell.solver, cell.level));
    cells
}

/// Level at which the first object is touched.
fn level_of(scene: &Scene) -> u8 {
    let touched = &scene.objects[0];
    touched.level.min(touched.tree.depth())
}

/// What is run in `scene`; the reference first. A quick report does without the judge, and without what is coarser than shipped.
fn wanted(scene: &Scene, quick: bool) -> Vec<Wanted> {
    let mut all = Vec::new();
    let finest = scene.objects[0].tree.depth();
    let solvers: &[SolverKind] = match quick {
        true => &[SolverKind::ActiveSet],
        false => &[SolverKind::Clarabel, SolverKind::ActiveSet],
    };
    let mut printed = scene.clone();
    as_printed(&mut printed);
    let methods = [("coupled", scene), ("printed", &printed)];
    // Where nothing is as printed there is nothing to compare.
    let methods = &methods[..1 + usize::from(tissues(&printed) != tissues(scene))];
    let coarsest = if quick { level_of(scene) } else { COARSEST };
    for level in (coarsest..=finest).rev() {
        for (method, scene) in methods {
            for &solver in solvers {
                let mut scene = (*scene).clone();
                scene.params.solver = solver;
                for object in &mut scene.objects {
                    object.level = level.min(object.tree.depth());
                }
                for tool in &mut scene.tools {
                    tool.level = level.min(tool.tree.depth());
                }
                all.push(Wanted {
                    scene,
                    level,
                    method,
                    solver,
                });
            }
        }
    }
    all
}

fn run(scene: &Scene, inputs: &[TickInput], looks_s: f64) -> (Measures, Vec<Forces>) {
    let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
    let mut observer = Observer::new(scene);
    observer.residual_every = scene.params.ticks_in(looks_s);
    let forces = inputs.iter().map(|input| {
        let output = tick(scene, &mut state, &mut ws, input, &mut NoProbe);
        observer.observe(scene, input, &output, &ws);
        output.tools.each_ref().map(|tool| tool.raw_wrench.force)
    });
    let forces = forces.collect();
    (observer.measures(), forces)
}

/// Rms difference of forces over the rms of the reference, over ticks in which either is not zero, percent.
fn off(forces: &[Forces], reference: &[Forces]) -> f64 {
    let (mut apart, mut whole) = (0.0, 0.0);
    for (found, expected) in forces.iter().flatten().zip(reference.iter().flatten()) {
        apart += (found - expected).norm_squared();
        whole += expected.norm_squared();
    }
    100.0 * (apart / whole).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_that_is_a_tenth_too_large_is_off_by_ten_percent() {
        let reference = vec![[Vec3::new(1.0, 0.0, 2.0), Vec3::zeros()]; 5];
        let forces: Vec<Forces> = reference.iter().map(|f| f.map(|f| f * 1.1)).collect();
        assert!((off(&forces, &reference) - 10.0).abs() < 1e-9);
        assert_eq!(off(&reference, &reference), 0.0);
    }
}
