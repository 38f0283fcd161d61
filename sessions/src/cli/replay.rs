//! `replay`: recorded sessions run again.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use sulcus_core::optimise::SolverKind;

use super::print::{Outcome, at, object};
use crate::key::PublicKey;
use crate::read::Recording;
use crate::replay::{ReplayOptions, ReplayReport, replay};

#[derive(Args)]
pub(super) struct ReplayArgs {
    /// Recordings
    #[arg(required = true, value_name = "FILE")]
    pub(super) files: Vec<PathBuf>,
    /// Let an independent solver judge the answer of every tick
    #[arg(long)]
    pub(super) audit: bool,
    /// Replay with this solver instead of the scene's
    #[arg(long, value_enum)]
    pub(super) solver: Option<Solver>,
    /// Accept only recordings signed by this key: a file with the public key, or its 64 hexadecimal digits
    #[arg(long, value_name = "PUBKEYFILE|HEX")]
    pub(super) signer: Option<String>,
    /// Print one JSON object on the last line of standard output
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Solver {
    /// The solver of the tick
    ActiveSet,
    /// The judge
    Clarabel,
}

impl From<Solver> for SolverKind {
    fn from(solver: Solver) -> Self {
        match solver {
            Solver::ActiveSet => Self::ActiveSet,
            Solver::Clarabel => Self::Clarabel,
        }
    }
}

pub(super) fn options(args: &ReplayArgs) -> anyhow::Result<ReplayOptions> {
    let trust = args
        .signer
        .as_deref()
        .map(PublicKey::from_file_or_hex)
        .transpose()?;
    Ok(ReplayOptions {
        solver: args.solver.map(Into::into),
        audit: args.audit,
        trust,
    })
}

pub(super) fn replay_of(path: &Path, options: &ReplayOptions) -> anyhow::Result<Outcome> {
    let recording = Recording::open(path).map_err(|error| at(path, &error))?;
    // Draws nothing when standard error is no terminal.
    let bar =
        ProgressBar::with_draw_target(Some(recording.facts().rows), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} ticks, {eta} left") {
        bar.set_style(style);
    }
    let report = replay(&recording, options, &mut |ticks| bar.set_position(ticks));
    bar.finish_and_clear();
    let report = report.map_err(|error| at(path, &error))?;
    let mut json = object(serde_json::to_value(&report)?);
    json.insert("file".to_owned(), json!(path.display().to_string()));
    let ours = PublicKey::of_this_station().map(|key| key == recording.signer());
    json.insert("signed_by_this_station".to_owned(), json!(ours));
    Ok(Outcome {
        json,
        text: format!("{}\n{}", path.display(), text(&report, options, ours)),
        finding: report.is_finding(),
    })
}

pub(super) fn text(report: &ReplayReport, options: &ReplayOptions, ours: Option<bool>) -> String {
    let mut lines = vec![match (&report.divergence, report.first_divergent_tick) {
        (Some(d), Some(tick)) => format!(
            "  DIFFERS    first at tick {tick} ({:?}: recorded {}, replayed {}), {} of {} ticks; force by up to {:.3e} N{}",
            d.what,
            d.hash_recorded,
            d.hash_replayed,
            d.ticks,
            report.ticks,
            report.max_force_deviation_n,
            if options.solver.is_some() {
                " (another solver never gives the same bits)"
            } else {
                ""
            }
        ),
        _ => format!(
            "  identical  {} ticks, {:.1} times real time",
            report.ticks, report.realtime_factor
        ),
    }];
    // Whoever makes a whole file anew can sign it with a key of their own: say whose key it is.
    let whose = match ours {
        _ if report.signer_trusted => "",
        Some(true) => " (this station's key)",
        Some(false) => " (NOT this station's key: name the right one with --signer)",
        None => " (the key is the recording's own: name the right one with --signer)",
    };
    lines.push(format!("  signature  {}{whose}", report.signature));
    lines.push(format!("  ending     {}", report.ending));
    lines.push(match &report.reason {
        None => "  gradable   yes".to_owned(),
        Some(reason) => format!("  gradable   no: {reason}"),
    });
    if let Some(audit) = &report.audit {
        lines.push(format!(
            "  audit      {} ticks with contact ({} unjudged), pose within {:.3e} mm of the judge's, KKT residual up to {:.3e}",
            audit.ticks, audit.unjudged, audit.max_pose_error_mm, audit.max_kkt_residual
        ));
    }
    lines.join("\n")
}
