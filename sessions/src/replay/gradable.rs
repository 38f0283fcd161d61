//! Conditions of a grade on a replayed session.

use super::close::CLOSE;
use super::report::ReplayReport;
use crate::record::read::{Ending, Recording};
use crate::record::signature::Signature;

/// Reason against a grade, as text; `None` if the session may be graded.
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
    if let Some(why) = &recording.facts().diverged {
        return Some(why.clone());
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

/// Reason against a grade on a recording that another one continues, as text; `None` if the session may be graded. The
/// signature of the other recording covers this one, which needs no end.
pub fn why_not_continued(recording: &Recording, report: &ReplayReport) -> Option<String> {
    match recording.ending() {
        Ending::CutOff { .. } => {}
        _ => return report.reason.clone(),
    }
    if let Some(tick) = report.first_divergent_tick
        && !report.is_close()
    {
        return Some(differs(report, tick));
    }
    if let Some(why) = &recording.facts().diverged {
        return Some(why.clone());
    }
    match &report.signature {
        Signature::Invalid { reason, .. } => Some(reason.clone()),
        _ if !report.chain_ok => Some("the chain of hashes is broken".to_owned()),
        _ => None,
    }
}

/// Text for a missing end or a missing part of the session.
fn no_end(recording: &Recording, ending: &Ending) -> String {
    match ending {
        Ending::Recovered { .. } if !recording.gaps().is_empty() => {
            let gaps: Vec<String> = recording.gaps().iter().map(ToString::to_string).collect();
            format!(
                "the recording was recovered from a damaged file and lacks {}",
                gaps.join("; ")
            )
        }
        Ending::Recovered { .. } => {
            "the recording was recovered from a file that was cut off: the session's end is missing"
                .to_owned()
        }
        ending => format!("the recording is {ending}"),
    }
}

/// Text for a replay that differs, with the amount, and with both programs if they differ.
fn differs(report: &ReplayReport, tick: u64) -> String {
    let mut said = format!("the replay differs from tick {tick}");
    if let Some(migration) = &report.migration {
        said.push_str(&format!(
            ", beyond the tolerance of the migration {migration}: force by {:.2e} N rms (tolerance {:.2e} N), a tool's place by {:.2e} mm (tolerance {:.2e} mm), {} rows and snapshots out of step",
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
