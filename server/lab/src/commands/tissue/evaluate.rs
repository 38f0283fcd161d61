//! `sulcus-server tissue evaluate`.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args;
use serde::Serialize;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::skeleton::Skeleton;
use sulcus_core::tissue::surface::SurfaceParams;
use sulcus_fem::CondenseOptions;
use sulcus_program::{PathText, say};
use sulcus_scene::default_cache_dir;
use sulcus_scene::mesh::distance::MeshDistance;
use sulcus_scene::organ::skeleton::SkeletonOptions;
use sulcus_scene::organ::springs::FittedSprings;
use sulcus_scene::organ::{condensed, skin};

use super::Model;
use crate::commands::tree::writable;
use crate::page::tissue;
use crate::tissue::cases::cases;
use crate::tissue::judge::{CaseError, Outcome, TickTime, judge};
use crate::tissue::loaded::Loaded;
use crate::tissue::organ::Organ;
use crate::tissue::printed::{as_printed, one_carrier};
use sulcus_program::ProgressLines;

/// Judge a tissue model.
#[derive(Clone, Debug, Args)]
#[command(
    about = "Judge a tissue model on the load cases of a folder",
    long_about = "Judge a tissue model on the load cases of a folder.\n\nThe folder holds a mesh of finite elements (nodes.csv, tets10.csv, fixed_all_nodes.csv), unit forces of each load (LOAD_forces_unit.csv, columns f?_vert) and displacements (LOAD_lin_<N>N.csv, LOAD_nl_<N>N.csv). The model is the product's own: sphere tree of the mesh's surface, skeleton, skin. The forces act through the skin on its spheres, it is run tick by tick until it rests, and only then the displacements are read. Errors are over the free vertices of the surface.",
    after_long_help = "Examples:\n  sulcus-server tissue evaluate --fem data/fem --model skeleton\n  sulcus-server tissue evaluate --fem data/fem --model skeleton --params tongue-springs.toml --out tongue --json | tail -1 | jq '.cases[].rel_l2_percent'"
)]
pub struct EvaluateArgs {
    /// Folder with finite elements and load cases
    #[arg(long, value_name = "DIR")]
    fem: PathBuf,
    /// Model to evaluate
    #[arg(long)]
    model: Model,
    /// File of springs from `tissue fit`. Default: the springs of the built-in scenes
    #[arg(long, value_name = "PARAMS")]
    params: Option<PathBuf>,
    /// Young's modulus of the cases, kPa. Fitted springs are scaled to it
    #[arg(long, value_name = "KPA", default_value_t = 100.0)]
    young_kpa: f64,
    /// Folder for a page with pictures. A missing folder is created
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report<'a> {
    model: Model,
    #[serde(serialize_with = "sulcus_program::path::text_or_null")]
    params: Option<&'a Path>,
    fitted: &'a str,
    cases: Vec<&'a CaseError>,
    tick_us: TickTime,
    ticks: usize,
    vertices: usize,
    parts: &'a str,
    #[serde(serialize_with = "sulcus_program::path::text_or_null")]
    page: Option<PathBuf>,
}

pub(super) fn run(args: &EvaluateArgs) -> anyhow::Result<u8> {
    let progress = ProgressLines::default();
    if let Some(out) = &args.out {
        writable(out)?;
    }
    let given = args
        .params
        .as_deref()
        .map(FittedSprings::read)
        .transpose()?;
    let organ = Organ::read(&args.fem, &|stage, share| {
        progress.report(stage, 0.3 * share)
    })?;
    let cases = cases(&args.fem, &organ)?;
    let Judgement {
        mut models,
        parts,
        what: fitted,
    } = judgement(args, given.as_ref(), &organ, &progress)?;
    let mut outcomes: Vec<Outcome> = Vec::with_capacity(cases.len());
    for case in &cases {
        progress.report(
            &case.name,
            0.3 + 0.7 * outcomes.len() as f64 / cases.len() as f64,
        );
        let last = models.len() - 1;
        let model = &mut models[if case.linear { 0 } else { last }];
        outcomes.push(judge(model, &organ, case)?);
    }
    let ns: Vec<u64> = models.iter().flat_map(|m| m.tick_ns()).copied().collect();
    let tick_us = TickTime::of(&ns);

    say!(
        "{}: {} free vertices; {parts}: {fitted}\n",
        args.fem.shown(),
        organ.free.len()
    );
    say!("case                              rms %   rel_l2 %    max %   FEM, mm   model, mm");
    for CaseError {
        name,
        rms_percent,
        rel_l2_percent,
        max_percent,
        max_displacement_mm,
        model_max_displacement_mm,
    } in outcomes.iter().map(|outcome| &outcome.error)
    {
        say!(
            "{name:30} {rms_percent:8.2}   {rel_l2_percent:8.1} {max_percent:8.1}  {max_displacement_mm:8.3}  {model_max_displacement_mm:10.3}"
        );
    }
    say!(
        "\ntissue per tick: {:.1} us at p50, {:.1} us at p99.9 ({} ticks)",
        tick_us.p50,
        tick_us.p999,
        ns.len()
    );
    let page = match &args.out {
        Some(out) => {
            let subject = tissue::Subject {
                folder: &args.fem,
                organ: &organ,
                outcomes: &outcomes,
                fitted: &fitted,
                tick_us,
            };
            let page = tissue::write(out, &subject, &|what| progress.report(what, 1.0))?;
            say!("written to {}", page.shown());
            Some(page)
        }
        None => None,
    };
    if args.json {
        let report = Report {
            model: args.model,
            params: args.params.as_deref(),
            fitted: &fitted,
            cases: outcomes.iter().map(|outcome| &outcome.error).collect(),
            tick_us,
            ticks: ns.len(),
            vertices: organ.free.len(),
            parts: &parts,
            page,
        };
        say!("{}", serde_json::to_string(&report)?);
    }
    Ok(0)
}

/// What is judged.
struct Judgement<'a> {
    /// The model for linear cases, and that for others if it is another.
    models: Vec<Loaded<'a>>,
    /// What it is made of.
    parts: String,
    /// How to call it.
    what: String,
}

fn judgement<'a>(
    args: &EvaluateArgs,
    given: Option<&FittedSprings>,
    organ: &'a Organ,
    progress: &ProgressLines,
) -> anyhow::Result<Judgement<'a>> {
    if args.model == Model::SurfaceCompliance {
        if let Some(params) = &args.params {
            bail!(
                "--params is {}, expected none: a surface compliance comes from the finite elements, there is nothing to fit",
                params.shown()
            );
        }
        return surface(args, organ, progress);
    }
    let (skeleton, what) = skeleton(args, given, organ)?;
    let level = &skeleton.coarse;
    let (nodes, springs) = (level.nodes.len(), level.springs.len());
    let parts = format!(
        "{nodes} nodes, {} fixed, {springs} springs",
        nodes - level.free()
    );
    let model = TissueModel::Skeleton(Box::new(skeleton));
    Ok(Judgement {
        models: vec![Loaded::new(organ, model)?],
        parts,
        what,
    })
}

/// The folder's elements, condensed: linear, and with the term for large displacements.
fn surface<'a>(
    args: &EvaluateArgs,
    organ: &'a Organ,
    progress: &ProgressLines,
) -> anyhow::Result<Judgement<'a>> {
    let fine = CondenseOptions::default();
    let poisson = SurfaceParams::default().poisson;
    let say = |stage: &str, _: f64| progress.report(stage, 0.3);
    let kept = default_cache_dir();
    let made = condensed(&organ.elements, poisson, &fine, kept.as_deref(), &say)?;
    let skin = skin(
        &organ.tree,
        &MeshDistance::new(organ.surface.clone()),
        &made,
    );
    let model = |large: f64| {
        let params = SurfaceParams {
            young: args.young_kpa * 1e3,
            large,
            ..SurfaceParams::default()
        };
        let model = made.model(skin.clone(), params);
        Loaded::new(organ, TissueModel::Surface(Box::new(model)))
    };
    Ok(Judgement {
        models: vec![model(0.0)?, model(1.0)?],
        parts: format!("{} masters, {} cells", made.masters().moving(), fine.cells),
        what: "condensed; linear cases without the term for large displacements".into(),
    })
}

/// What is judged of springs, and how to call it.
fn skeleton(
    args: &EvaluateArgs,
    given: Option<&FittedSprings>,
    organ: &Organ,
) -> anyhow::Result<(Skeleton, String)> {
    let mut skeleton = organ.skeleton(&SkeletonOptions::default())?;
    let printed = args.model == Model::PrintedSkeleton;
    let Some(given) = given else {
        let name = if printed {
            "as printed, all springs as stiff as those shipped are on average"
        } else {
            "as shipped"
        };
        return Ok((
            if printed {
                as_printed(&skeleton, organ)
            } else {
                skeleton
            },
            name.to_owned(),
        ));
    };
    given.put_into(&mut skeleton, &organ.tree, args.young_kpa)?;
    if printed {
        one_carrier(&mut skeleton.coarse);
    }
    Ok((skeleton, given.fitted.clone()))
}
