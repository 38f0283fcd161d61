//! `replay` with changes of the scene: a comparison.

use std::path::Path;

use serde_json::json;
use sulcus_program::PathText;

use super::inputs::open;
use super::parallel::Progress;
use super::print::{Outcome, at, object};
use crate::replay::ReplayOptions;
use crate::replay::compare::{ComparisonReport, Side, compare};
use crate::replay::whatif::WhatIf;

pub(super) fn comparison_of(
    path: &Path,
    what_if: &WhatIf,
    options: &ReplayOptions,
    progress: &Progress,
) -> anyhow::Result<Outcome> {
    let recording = open(path)?;
    let mut tell = progress.file(recording.facts().rows);
    let report = compare(&recording, what_if, options, &mut tell);
    let report = report.map_err(|error| at(path, &error))?;
    tell(recording.facts().rows);
    let mut json = object(serde_json::to_value(&report)?);
    json.insert("file".to_owned(), json!(path.shown().to_string()));
    Ok(Outcome {
        json,
        text: format!("{}\n{}", path.shown(), text(&report)),
        finding: report.is_finding(),
    })
}

fn text(report: &ComparisonReport) -> String {
    let apart = &report.apart;
    let at = apart
        .max_force_tick
        .map_or(String::new(), |tick| format!(" at tick {tick}"));
    let first = report
        .first_divergent_tick
        .map_or("nowhere".to_owned(), |tick| format!("from tick {tick}"));
    let mut lines = vec![
        format!(
            "  COMPARISON, not a replay: with {}; {} ticks, {:.1} times real time",
            report.changed.join(", "),
            report.ticks,
            report.realtime_factor
        ),
        format!(
            "  apart      {first}; force by up to {:.3e} N{at} (rms in contact {:.3e} N), torque by up to {:.3e} N m, tips by up to {:.3e} mm (rms {:.3e} mm)",
            apart.max_force_n,
            apart.rms_force_n,
            apart.max_torque_nm,
            apart.max_tip_mm,
            apart.rms_tip_mm
        ),
        side("recorded", &report.recorded),
        side("changed", &report.what_if),
    ];
    if let Some(migration) = &report.migration {
        lines.push(format!("  migrated   {migration}"));
    } else if !report.recorded_side_identical {
        lines.push(
            "  WARNING    the recorded scene does not give the recorded states either, so the change is not the only difference"
                .to_owned(),
        );
    }
    if let Some(part) = &report.part {
        lines.push(format!(
            "  part       ticks {} to {}, from the snapshot of tick {}",
            part.from_tick, part.to_tick, part.snapshot_tick
        ));
        if report.what_if_snapshot_tick != part.snapshot_tick {
            lines.push(format!(
                "             changed scene from the snapshot of tick {}: the recorded state is not valid in it",
                report.what_if_snapshot_tick
            ));
        }
    }
    lines.push(format!("  signature  {}", report.signature));
    lines.push(format!("  ending     {}", report.ending));
    lines.join("\n")
}

fn side(name: &str, side: &Side) -> String {
    let deepest = side
        .deepest_mm
        .map_or(String::new(), |mm| format!(", deepest reading {mm:.2} mm"));
    format!(
        "  {name:<10} {:.1} us a tick, {} ticks in contact, at most {:.3} N, residual {:.3} um, {} exhausted, {} failed{deepest}",
        side.tick_us,
        side.contact_ticks,
        side.max_force_n,
        side.max_residual_um,
        side.exhausted,
        side.failed
    )
}
