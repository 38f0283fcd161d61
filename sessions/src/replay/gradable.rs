//! Whether a grade may rest on a session, and if not, why.

use super::ReplayReport;
use crate::record::format::CLOSE;
use crate::record::read::{Ending, Recording};
use crate::record::verify::Signature;

/// Why not, in a sentence; `None` when it may.
pub(super) fn why_not(recording: &Recording, report: &ReplayReport) -> Option<String> {
    if let Some(tick) = report.first_divergent_tick
        && !report.is_close()
    {
        return Some(differs(report, tick));
    }
    let end = match (&report.signature, recording.facts().end) {
        (Signature::Valid { .. }, Some(end)) => end,
        (Signature::Invalid { reason, .. }, _) => return Some(reason.clone()),
        _ => return Some(no_end(recording, &report.ending)),
    };
    if end.dropped_rows > 0 {
        return Some(format!(
            "{} rows were dropped while recording",
            end.dropped_rows
        ));
    }
    let rows = recording.facts().rows;
    if end.ticks != rows {
        return Some(format!(
            "the session ran {} ticks, the recording has {rows}",
            end.ticks
        ));
    }
    report.part.map(|part| {
        format!(
            "only ticks {} to {} were replayed",
            part.from_tick, part.to_tick
        )
    })
}

/// That the session's end, or a part of the session, is not there.
fn no_end(recording: &Recording, ending: &Ending) -> String {
    match ending {
        Ending::Recovered { .. } if !recording.gaps().is_empty() => {
            let gaps: Vec<String> = recording.gaps().iter().map(ToString::to_string).collect();
            format!(
                "the recording is recovered from a damaged one: missing are {}",
                gaps.join("; ")
            )
        }
        Ending::Recovered { .. } => {
            "the recording is recovered from a torn one: the session's end is missing".to_owned()
        }
        ending => format!("the recording is {ending}"),
    }
}

/// That the replay differs, and by how much; where another program recorded, that it was another.
fn differs(report: &ReplayReport, tick: u64) -> String {
    let mut said = format!("the replay differs from tick {tick}");
    if let Some(migration) = &report.migration {
        said.push_str(&format!(
            ", by more than the migration {migration} may: force by {:.2e} N rms ({:.2e} N may be), a tool's place by {:.2e} mm ({:.2e} mm), {} rows and snapshots out of step",
            report.deviation.rms_force_n,
            CLOSE.rms_force_n,
            report.deviation.max_pose_mm.unwrap_or_default(),
            CLOSE.pose_mm,
            report.deviation.out_of_step
        ));
    } else if report.recorded_by != report.replayed_by {
        said.push_str(&format!(
            ", recorded by {}, replayed by {}: force by up to {:.2e} N (rms {:.2e} N)",
            report.recorded_by,
            report.replayed_by,
            report.deviation.max_force_n,
            report.deviation.rms_force_n
        ));
    }
    said
}
