//! `replay`: replay of recorded sessions.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use serde_json::json;
use sulcus_core::optimise::SolverKind;
use sulcus_program::PathText;

use super::compared::comparison_of;
use super::inputs::{open, recordings};
use super::parallel::{Progress, for_each_at_once};
use super::print::{Outcome, at, object};
use crate::record::key::PublicKey;
use crate::record::viewers::Viewers;
use crate::replay::whatif::{TissueChoice, WhatIf};
use crate::replay::{ReplayOptions, ReplayReport, Span, replay};

pub(super) const ABOUT: &str = "\
Runs recorded sessions again and compares every state, wrench, snapshot and signature.

A recording has its compiled scene and the input of every tick, so the same program gives the same bits. The first tick that \
differs is named. If another version recorded, the deviation from the record is printed, too. A recording of a former version of \
the format is migrated: the present tick runs its inputs, and the session can be graded as long as the replay stays close. \
Signatures show that the recording is the station's own. Without --signer the key is taken from the recording itself; compare its \
fingerprint.

--from and --to replay a part. The replay starts from the last snapshot before the part, of which there is one every ten \
seconds, and compares everything that it runs.

--solver, --tissue, --level, --detail and --blend change the scene. The result is then a comparison and no replay \
(`comparison: true`, never identical). The recorded and the changed scene run the recorded motion, which does not answer to \
changed forces. Only changes within the compiled scene are possible: rigid or printed tissue, and levels of its trees. Finer \
trees, other organs or another elasticity need the meshes: compile another scene.";

pub(super) const EXAMPLES: &str = "\
Examples:
  sulcus-sessions replay session.mcap
  sulcus-sessions replay session.mcap --signer station.pub --json
  sulcus-sessions replay session.mcap --from 30 --to 42.5
  sulcus-sessions replay recordings/*.mcap --audit --jobs 4
  sulcus-sessions replay session.mcap --solver clarabel     difference of the independent solver in newtons
  sulcus-sessions replay session.mcap --tissue rigid        forces without soft tissue
  sulcus-sessions replay session.mcap --level 2 --to 10     coarser teeth";

#[derive(Args)]
pub(super) struct ReplayArgs {
    /// Recordings, or folders of recordings
    #[arg(required = true, value_name = "FILE")]
    pub(super) files: Vec<PathBuf>,
    /// Start at this session time, seconds, from the snapshot before
    #[arg(long, value_name = "S")]
    from: Option<f64>,
    /// End at this session time, seconds
    #[arg(long, value_name = "S")]
    to: Option<f64>,
    /// Check the solution of every tick by an independent solver
    #[arg(long)]
    audit: bool,
    #[command(flatten)]
    what_if: WhatIfArgs,
    /// Accept only recordings signed by this key: a file with the public key, or its 64 hexadecimal digits. The public
    /// key of a station is `station.pub` in $SULCUS_STATE_DIR, else in ~/.local/state/sulcus
    #[arg(long, value_name = "PUBKEYFILE|HEX")]
    signer: Option<PathBuf>,
    /// Number of files replayed at once. Default: the number of cores
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// Changes of a what-if comparison.
#[derive(Args)]
#[group(id = "what_if", multiple = true, conflicts_with = "audit")]
struct WhatIfArgs {
    /// Comparison with another solver of the tick, not a replay
    #[arg(long, value_enum)]
    solver: Option<Solver>,
    /// Comparison with another model of all tissues
    #[arg(long, value_enum)]
    tissue: Option<Tissue>,
    /// Comparison with rigid objects at this level of their sphere trees, or at the finest level that a tree has
    #[arg(long, value_name = "N")]
    level: Option<u8>,
    /// Comparison with tissues at this level of detail, 0 or 1, where they have two
    #[arg(long, value_name = "N")]
    detail: Option<u8>,
    /// Comparison with blended surfaces of the calibrated trees on or off
    #[arg(long, value_enum)]
    blend: Option<Switch>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Solver {
    /// Solver of the tick: dual active set
    ActiveSet,
    /// Independent solver: interior point
    Clarabel,
}

#[derive(Clone, Copy, ValueEnum)]
enum Tissue {
    /// All tissues rigid
    Rigid,
    /// Skeletons and gingivae by the equations as printed in the paper
    Printed,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Switch {
    On,
    Off,
}

impl WhatIfArgs {
    fn what_if(&self) -> WhatIf {
        WhatIf {
            solver: self.solver.map(|solver| match solver {
                Solver::ActiveSet => SolverKind::ActiveSet,
                Solver::Clarabel => SolverKind::Clarabel,
            }),
            tissue: self.tissue.map(|tissue| match tissue {
                Tissue::Rigid => TissueChoice::Rigid,
                Tissue::Printed => TissueChoice::Printed,
            }),
            level: self.level,
            detail: self.detail,
            blend: self.blend.map(|blend| blend == Switch::On),
        }
    }
}

pub(super) fn run(args: &ReplayArgs) -> anyhow::Result<ExitCode> {
    let signer = args.signer.as_deref();
    let options = ReplayOptions {
        audit: args.audit,
        trust: signer.map(PublicKey::from_file_or_hex).transpose()?,
        span: Span {
            from_s: args.from,
            to_s: args.to,
        },
    };
    let what_if = args.what_if.what_if();
    Ok(for_each_at_once(
        &recordings(&args.files),
        args.json,
        "ticks",
        args.jobs,
        |path, progress| {
            if what_if.is_asked() {
                comparison_of(path, &what_if, &options, progress)
            } else {
                replay_of(path, &options, progress)
            }
        },
    ))
}

fn replay_of(path: &Path, options: &ReplayOptions, progress: &Progress) -> anyhow::Result<Outcome> {
    let recording = open(path)?;
    let mut tell = progress.file(recording.facts().rows);
    let report = replay(&recording, options, &mut tell).map_err(|error| at(path, &error))?;
    // For a part, the rest counts as finished.
    tell(recording.facts().rows);
    let mut json = object(serde_json::to_value(&report)?);
    json.insert("file".to_owned(), json!(path.shown().to_string()));
    let ours = PublicKey::of_this_station().map(|key| key == recording.signer());
    json.insert("signed_by_this_station".to_owned(), json!(ours));
    Ok(Outcome {
        json,
        text: format!("{}\n{}", path.shown(), text(&report, ours)),
        finding: report.is_finding(),
    })
}

fn text(report: &ReplayReport, ours: Option<bool>) -> String {
    let mut lines = vec![match (&report.divergence, report.first_divergent_tick) {
        (Some(d), Some(tick)) => format!(
            "  {}    first at tick {tick} ({:?}: recorded {}, replayed {}), {} of {} ticks",
            if report.is_close() {
                "differs"
            } else {
                "DIFFERS"
            },
            d.what,
            d.hash_recorded,
            d.hash_replayed,
            d.ticks,
            report.ticks,
        ),
        _ => format!(
            "  identical  {} ticks, {:.1} times real time",
            report.ticks, report.realtime_factor
        ),
    }];
    if !report.identical {
        let d = &report.deviation;
        let at = d
            .max_force_tick
            .map_or(String::new(), |tick| format!(" at tick {tick}"));
        let pose = d.max_pose_mm.map_or(String::new(), |mm| {
            format!(", graphic tools at snapshots by up to {mm:.3e} mm")
        });
        lines.push(format!(
            "  deviation  force by up to {:.3e} N{at} (rms {:.3e} N), torque by up to {:.3e} N m{pose}; status in {} ticks",
            d.max_force_n, d.rms_force_n, d.max_torque_nm, d.status_ticks
        ));
    }
    if let Some(migration) = &report.migration {
        lines.push(format!("  migrated   {migration}"));
    }
    if report.recorded_by != report.replayed_by {
        lines.push(format!(
            "  programs   recorded by {}, replayed by {}",
            report.recorded_by, report.replayed_by
        ));
    }
    if let Some(part) = &report.part {
        lines.push(format!(
            "  part       ticks {} to {}, from the snapshot of tick {}",
            part.from_tick, part.to_tick, part.snapshot_tick
        ));
    }
    for stretch in &report.stretches {
        lines.push(format!("  stretch    {stretch}"));
    }
    // A person who makes a whole file anew can sign it with another key. So the text names the owner of the key.
    let whose = match ours {
        _ if report.signer_trusted => "",
        Some(true) => " (this station's key)",
        Some(false) => " (NOT this station's key; --signer gives the right key)",
        None => " (key from the recording itself; --signer gives the right key)",
    };
    lines.push(format!("  signature  {}{whose}", report.signature));
    if report.viewers == Viewers::Changed {
        lines.push(format!("  viewers    {}", report.viewers));
    }
    lines.push(format!("  ending     {}", report.ending));
    lines.push(match &report.reason {
        None => "  gradable   yes".to_owned(),
        Some(reason) => format!("  gradable   no: {reason}"),
    });
    if let Some(audit) = &report.audit {
        lines.push(format!(
            "  audit      {} ticks with contact ({} unjudged), pose within {:.3e} mm of the judge's pose, KKT residual up to {:.3e}",
            audit.ticks, audit.unjudged, audit.max_pose_error_mm, audit.max_kkt_residual
        ));
    }
    lines.join("\n")
}
