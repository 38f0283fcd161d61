//! `sulcus-server tissue fit`.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use serde::Serialize;
use sulcus_fem::{Elastic, Factored};
use sulcus_program::{PathText, say};
use sulcus_scene::mesh::load::to_obj;
use sulcus_scene::organ::skeleton::SkeletonOptions;
use sulcus_scene::organ::springs::FittedSprings;

use crate::tissue::fit::{Example, Fit, Freedom};
use crate::tissue::loads::training;
use crate::tissue::organ::Organ;
use crate::tissue::printed::as_printed;
use sulcus_program::ProgressLines;

/// Places of patches, each loaded along three directions, and loads that are spread over the surface.
const PATCHES: usize = 60;
const SPREAD: usize = 12;
/// Loads that go through the elements at once.
const AT_ONCE: usize = 16;
/// Share of the work that the elements are, about.
const ELEMENTS: f64 = 0.6;

/// Fit the springs of a skeleton.
#[derive(Clone, Debug, Args)]
#[command(
    about = "Fit the springs of a skeleton to load cases made by the built-in finite elements",
    long_about = "Fit the springs of a skeleton to load cases made by the built-in finite elements.\n\nOf the folder only the geometry is read: nodes.csv, tets10.csv, fixed_all_nodes.csv. The training loads are round patches at places of a fixed low-discrepancy sequence over the free surface, each pressed in and dragged two ways, and loads spread over what faces some direction; the folder's own cases are not looked at.\n\nA scene uses what was fitted by mesh = \"PARAMS.obj\", unit = \"m\", tissue = \"skeleton\" and, in [object.skeleton], springs_file = \"PARAMS.toml\". There they are scaled to springs_young_kpa, 10 kPa (a living tongue) unless the scene says otherwise: name the modulus of the fit to feel them as fitted.",
    after_long_help = "Examples:\n  sulcus-server tissue fit --fem data/fem --model skeleton --out tongue-springs.toml\n  sulcus-server tissue evaluate --fem data/fem --model skeleton --params tongue-springs.toml"
)]
pub struct FitArgs {
    /// Folder with a mesh of finite elements
    #[arg(long, value_name = "DIR")]
    fem: PathBuf,
    /// Model to fit
    #[arg(long)]
    model: Springs,
    /// File for the springs (TOML). The surface is written beside it (OBJ)
    #[arg(long, value_name = "PARAMS")]
    out: PathBuf,
    /// Freedom of each spring: one common factor, the stiffness along each axis, or the whole 3x3 stiffness
    #[arg(long, value_enum, default_value = "tensor")]
    freedom: Freedom,
    /// Largest number of steps of the fit
    #[arg(long, default_value_t = 600, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: u32,
    /// Young's modulus of the training cases, kPa. The fitted stiffness is proportional to it
    #[arg(long, value_name = "KPA", default_value_t = 100.0)]
    young_kpa: f64,
    /// Poisson's ratio of the training cases
    #[arg(long, default_value_t = 0.49)]
    poisson: f64,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    json: bool,
}

/// The models that have springs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[value(rename_all = "snake_case")]
#[serde(rename_all = "snake_case")]
pub enum Springs {
    /// Springs between 64 nodes under a skin of spheres
    Skeleton,
    /// The same exactly by the paper: one stiffness for all springs, each sphere after one node (with `--freedom one`)
    PrintedSkeleton,
}

#[derive(Serialize)]
struct Report<'a> {
    model: Springs,
    #[serde(serialize_with = "sulcus_program::path::text")]
    out: &'a Path,
    fitted: &'a str,
    training_cases: usize,
    springs: usize,
    nodes: usize,
    fixed: usize,
    steps: usize,
    training_rel_l2_percent: f64,
}

pub(super) fn run(args: &FitArgs) -> anyhow::Result<u8> {
    let progress = ProgressLines::default();
    if args.model == Springs::PrintedSkeleton && args.freedom != Freedom::One {
        bail!(
            "--freedom is not `one`, expected that for the printed skeleton: its springs are all as stiff"
        );
    }
    let surface = args.out.with_extension("obj");
    if surface == args.out {
        bail!(
            "--out is {}, expected another ending: the surface is written to that one",
            args.out.shown()
        );
    }
    writable(&args.out)?;
    let organ = Organ::read(&args.fem, &|stage, share| {
        progress.report(stage, 0.1 * share)
    })?;
    let text = to_obj(&organ.surface);
    // A mesh of the same name may be somebody's own.
    if std::fs::read(&surface).is_ok_and(|there| there != text.as_bytes()) {
        bail!(
            "{}: found another file, expected none: the surface of the springs is written there",
            surface.shown()
        );
    }
    writable(&surface)?;
    let mut skeleton = organ.skeleton(&SkeletonOptions::default())?;
    if args.model == Springs::PrintedSkeleton {
        skeleton = as_printed(&skeleton, &organ);
    }
    let loads = training(&organ, PATCHES, SPREAD);
    if loads.is_empty() {
        bail!(
            "{}: found no free surface to load, expected some",
            args.fem.shown()
        );
    }
    progress.report("factoring the finite elements", 0.1);
    let material = Elastic {
        young: args.young_kpa * 1e3,
        poisson: args.poisson,
    };
    let elements = Factored::new(&organ.elements, &material)?;
    let mut examples = Vec::with_capacity(loads.len());
    for part in loads.chunks(AT_ONCE) {
        let done = examples.len();
        progress.report(
            &format!("training case {done} of {}: {}", loads.len(), part[0].name),
            0.2 + (ELEMENTS - 0.2) * done as f64 / loads.len() as f64,
        );
        let on_nodes: Vec<_> = part.iter().map(|load| load.on_nodes.clone()).collect();
        for (load, moved) in part.iter().zip(elements.solve(&on_nodes)?) {
            let moved = organ
                .nodes
                .iter()
                .map(|&node| moved[node as usize])
                .collect();
            examples.push(Example {
                forces: load.on_vertices.clone(),
                moved,
            });
        }
    }
    let fit = Fit::new(&organ, &skeleton.coarse, &examples, args.freedom);
    let most = args.steps as usize;
    let told = |step: usize, error: f64| {
        if step.is_multiple_of(20) {
            progress.report(
                &format!(
                    "step {step}: training error {:.2} % of the displacement",
                    100.0 * error
                ),
                ELEMENTS + (1.0 - ELEMENTS) * step as f64 / most as f64,
            );
        }
    };
    let Some((level, error, steps)) = fit.run(most, &told) else {
        bail!(
            "{}: the skeleton of this organ cannot be solved, expected springs that hold every node",
            args.fem.shown()
        );
    };
    level.validate(&organ.tree)?;
    let what = match args.freedom {
        Freedom::One => "one factor on all springs",
        Freedom::Axes => "the stiffness of each spring along each axis",
        Freedom::Tensor => "the 3x3 stiffness of each spring",
    };
    let fitted = format!(
        "{what}, to {} training cases, which it misses by {:.2} % of the displacement",
        examples.len(),
        100.0 * error
    );
    let springs = FittedSprings::of(
        &level,
        &organ.tree,
        fitted.clone(),
        (args.young_kpa, args.poisson),
    );
    springs.write(&args.out)?;
    std::fs::write(&surface, text)
        .with_context(|| format!("{}: cannot write the surface", surface.shown()))?;
    say!(
        "fitted: {fitted}\nsprings written to {}, their surface (in metres) to {}",
        args.out.shown(),
        surface.shown()
    );
    if args.json {
        let report = Report {
            model: args.model,
            out: &args.out,
            fitted: &fitted,
            training_cases: examples.len(),
            springs: level.springs.len(),
            nodes: level.nodes.len(),
            fixed: level.nodes.len() - level.free(),
            steps,
            training_rel_l2_percent: 100.0 * error,
        };
        say!("{}", serde_json::to_string(&report)?);
    }
    Ok(0)
}

/// Minutes of fitting should not end at a file that cannot be written.
fn writable(file: &Path) -> anyhow::Result<()> {
    let opened = std::fs::OpenOptions::new()
        .append(true)
        .create(true)
        .open(file);
    let empty = opened
        .and_then(|opened| opened.metadata())
        .map(|is| is.len() == 0);
    match empty {
        // What was there stays until there is something better.
        Ok(true) => std::fs::remove_file(file),
        other => other.map(drop),
    }
    .with_context(|| format!("{}: cannot write the file of --out", file.shown()))
}
