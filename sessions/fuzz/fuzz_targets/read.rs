//! Any bytes as a recording: a clear error or an answer, no panic, whatever is asked of them. Start from real ones:
//!
//! ```text
//! cargo fuzz run read -- -max_len=300000 tests/corpus   (in `sessions`; copy the folder first, libFuzzer adds to it)
//! ```
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use sulcus_sessions::{Ending, Recording, ReplayOptions, Span, info, recover_to, replay, verify};

fuzz_target!(|bytes: &[u8]| {
    let recording = match Recording::from_bytes(bytes.to_vec()) {
        Ok(recording) => recording,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    verify(&recording, None).expect("in memory it does not change");
    let said = info(Path::new("x"), &recording).expect("in memory it does not change");
    assert!(!said.to_string().is_empty());
    // A twentieth of a second is enough to run into what a state or a scene may hold.
    let span = Span {
        from_s: None,
        to_s: recording.scene().ok().map(|scene| {
            let (first, _) = recording.facts().ticks.unwrap_or_default();
            (first + 50) as f64 * scene.tick_s()
        }),
    };
    let options = ReplayOptions {
        span,
        ..ReplayOptions::default()
    };
    if let Ok(report) = replay(&recording, &options, &mut |_| {}) {
        assert!(!(report.gradable && *recording.ending() != Ending::Finished));
    }
    if let Ok((whole, _)) = recover_to(&recording, Vec::new(), &mut |_| {}) {
        let again = Recording::from_bytes(whole).expect("what was recovered opens");
        assert_eq!(again.facts(), recording.facts());
    }
});
