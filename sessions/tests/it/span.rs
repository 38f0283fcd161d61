//! A part of a session, replayed from the snapshot before it, is what it was in the whole.
#![allow(clippy::unwrap_used)]

use crate::common::*;
use sulcus_sessions::*;

fn session(ticks: u64, snapshot_every: u64) -> Recording {
    Recording::from_bytes(recorded_every(ticks, snapshot_every)).unwrap()
}

fn span(from_s: Option<f64>, to_s: Option<f64>) -> ReplayOptions {
    let span = Span { from_s, to_s };
    ReplayOptions {
        span,
        ..ReplayOptions::default()
    }
}

/// Tick and hash of every tick that is run.
fn hashes(recording: &Recording, options: &ReplayOptions) -> (Vec<(u64, u64)>, ReplayReport) {
    let mut found = Vec::new();
    let report = replay_observed(recording, options, &mut |_| {}, &mut |_, _, output, _| {
        found.push((output.tick, output.hash));
    });
    (found, report.unwrap())
}

#[test]
fn a_part_has_the_hashes_of_the_linear_run() {
    let recording = session(5000, 700);
    let (linear, whole) = hashes(&recording, &ReplayOptions::default());
    assert!(whole.identical && whole.part.is_none());
    for (from, to, part) in [
        // Just behind a snapshot, on it, just before it; within; to the end; from the beginning.
        (Some(2.101), Some(2.5), (2100, 2101, 2500)),
        (Some(2.1), Some(2.5), (1400, 2100, 2500)),
        (Some(2.0995), Some(2.1), (1400, 2100, 2100)),
        (Some(3.3), Some(3.3), (2800, 3300, 3300)),
        (Some(4.95), None, (4900, 4950, 5000)),
        (Some(4.95), Some(77.0), (4900, 4950, 5000)),
        (None, Some(0.65), (0, 1, 650)),
        (Some(0.0), Some(0.7), (0, 1, 700)),
        (Some(0.2), Some(1.5), (0, 200, 1500)),
    ] {
        let (found, report) = hashes(&recording, &span(from, to));
        let (snapshot_tick, from_tick, to_tick) = part;
        let part = Part {
            snapshot_tick,
            from_tick,
            to_tick,
        };
        assert_eq!(report.part, Some(part), "{from:?} {to:?}");
        let expected = linear
            .iter()
            .filter(|(tick, _)| *tick > snapshot_tick && *tick <= to_tick);
        assert!(found.iter().eq(expected), "{from:?} {to:?}");
        assert!(report.identical && report.chain_ok && !report.gradable);
        assert!(
            !report.is_finding(),
            "a part is what was asked for: {report:?}"
        );
        assert!(
            matches!(report.signature, Signature::Valid { .. }),
            "all of it is verified"
        );
        assert_eq!(report.ticks, found.len() as u64);
        let reason = report.reason.unwrap();
        assert!(reason.starts_with("only ticks "), "{reason}");
    }
}

#[test]
fn skipped_ticks_count_as_time() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let mut session = Session::begin(&path, key());
    for k in 0..300 {
        let mut given = input(k);
        given.skipped = if k == 100 { 500 } else { 0 };
        let row = session.tick(&given);
        session.recorder.push(&row).unwrap();
    }
    session.finish();
    let recording = Recording::open(&path).unwrap();
    // Tick 101 is the 601st of the clock.
    let (found, report) = hashes(&recording, &span(Some(0.65), None));
    assert_eq!(report.part.unwrap().from_tick, 650);
    assert!(report.identical);
    assert_eq!(found.last().unwrap().0, 800);
    let (found, _) = hashes(&recording, &span(None, Some(0.3)));
    assert_eq!(found.last().unwrap().0, 100);
}

#[test]
fn a_divergence_before_the_part_is_not_seen_in_it_and_one_within_is() {
    let mut k = 0;
    let bad = with_messages(&recorded_every(2000, 500), |topic, data| {
        k += u64::from(topic == "/exact/ticks");
        if topic == "/exact/ticks" && k == 800 {
            data[30] ^= 1;
        }
        true
    });
    let recording = Recording::from_bytes(bad).unwrap();
    let (_, within) = hashes(&recording, &span(Some(0.6), Some(0.9)));
    assert_eq!(within.first_divergent_tick, Some(800));
    let (_, after) = hashes(&recording, &span(Some(1.2), None));
    assert!(after.identical);
    assert!(after.is_finding(), "the chain is broken, and said so");
    assert!(matches!(after.signature, Signature::Invalid { .. }));
}

#[test]
fn a_part_that_is_not_there_is_refused_with_the_session_s_length() {
    let recording = session(2000, 700);
    let refused = |from, to| {
        let error = replay(&recording, &span(from, to), &mut |_| {}).unwrap_err();
        assert!(matches!(error, ReplayError::Span { .. }), "{error}");
        error.to_string()
    };
    assert_eq!(
        refused(Some(2.5), None),
        "from is 2.5, expected 0 to 2 s, the session's end"
    );
    assert!(refused(Some(-1.0), None).contains("from is -1"));
    assert!(refused(Some(f64::NAN), None).contains("from is NaN"));
    assert_eq!(
        refused(Some(1.5), Some(1.0)),
        "to is 1, expected at least 1.5 s, the start of the part"
    );
    assert!(refused(None, Some(f64::INFINITY)).contains("to is inf"));
    assert!(refused(None, Some(f64::NAN)).contains("to is NaN"));
    assert!(refused(Some(1.0002), Some(1.0008)).contains("expected a part with a tick"));
}
