//! Everything that is asked of bytes which may be anything: by `mutated.rs` of real recordings torn and mutated, and by the fuzz
//! target `read` of whatever it comes upon. (That one is no part of the workspace: so this file needs nothing but the crate.)

use std::path::Path;

use sulcus_sessions::{
    Ending, Facts, Recording, ReplayOptions, ReplayReport, Span, info, recover_to, replay, verify,
};

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

/// What was recovered of it says the same, but for chunks of viewers' that were damaged and left behind.
fn recovered(recording: &Recording) {
    let Ok((whole, lost)) = recover_to(recording, Vec::new(), &mut |_| {}) else {
        return;
    };
    assert!(!lost.to_string().is_empty());
    let again = Recording::from_bytes(whole).expect("what was recovered opens");
    assert_eq!(*again.facts(), without_damage(recording));
    assert!(matches!(
        again.ending(),
        Ending::Recovered { .. } | Ending::Finished
    ));
}

/// What a recovery of `recording` must have.
pub fn without_damage(recording: &Recording) -> Facts {
    let mut facts = recording.facts().clone();
    facts.damaged_views = 0;
    facts
}
