//! Everything that is asked of bytes which may be anything: by `mutated.rs` of real recordings torn and mutated, and by the fuzz
//! target `read` of whatever it comes upon. (That one is no part of the workspace: so this file needs nothing but the crate.)

use std::path::Path;

use sulcus_sessions::{Ending, Recording, ReplayOptions, ReplayReport, Span, recover_to, replay};
use sulcus_sessions::{info, verify};

/// Ticks that are replayed: what is wrong with a scene or a state shows in the first.
const TICKS: u64 = 20;

/// What the replay of its first ticks says of the recording that `bytes` are, or why they are none.
///
/// # Panics
/// When what is said of it contradicts itself.
pub fn ask(bytes: &[u8]) -> Result<ReplayReport, String> {
    let recording = match Recording::from_bytes(bytes.to_vec()) {
        Ok(recording) => recording,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return Err(error.to_string());
        }
    };
    let verdict = verify(&recording, None).expect("in memory it does not change");
    let said = info(Path::new("x"), &recording).expect("in memory it does not change");
    assert!(!said.to_string().is_empty());
    assert_eq!(verdict.signature, said.signature);
    recovered(&recording);
    let tick_s = recording
        .scene()
        .map_err(|error| error.to_string())?
        .tick_s();
    let (first, _) = recording.facts().ticks.unwrap_or_default();
    let span = Span {
        from_s: None,
        to_s: Some((first + TICKS) as f64 * tick_s),
    };
    let options = ReplayOptions {
        span,
        ..ReplayOptions::default()
    };
    let report = replay(&recording, &options, &mut |_| {}).map_err(|error| error.to_string())?;
    assert!(!(report.gradable && *recording.ending() != Ending::Finished));
    assert_eq!(report.ending, *recording.ending());
    Ok(report)
}

/// Checks that its recovery is whole, and has all that was read of it.
fn recovered(recording: &Recording) {
    let Ok((whole, lost)) = recover_to(recording, Vec::new(), &mut |_| {}) else {
        return;
    };
    assert!(!lost.to_string().is_empty());
    let again = Recording::from_bytes(whole).expect("what was recovered opens");
    has_all_of(&again, recording);
    assert!(matches!(
        again.ending(),
        Ending::Recovered { .. } | Ending::Finished
    ));
    // Whatever the gaps are, a replay of the stretches between them says something.
    if again.scene().is_ok() && !again.gaps().is_empty() {
        let span = Span {
            from_s: None,
            to_s: Some(0.05),
        };
        let options = ReplayOptions {
            span,
            ..ReplayOptions::default()
        };
        if let Ok(report) = replay(&again, &options, &mut |_| {}) {
            assert!(!report.gradable);
        }
    }
}

/// That `again`, recovered from `recording`, has what the latter was read to have, and what was whole behind its damage.
pub fn has_all_of(again: &Recording, recording: &Recording) {
    let (found, before) = (again.facts(), recording.facts());
    assert!(found.rows >= before.rows && found.snapshots >= before.snapshots);
    assert!(found.events >= before.events && found.signatures >= before.signatures);
    assert_eq!(found.damaged_views, 0);
}
