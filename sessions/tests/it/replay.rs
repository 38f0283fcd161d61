//! A recorded session runs again bit for bit, and what does not is named.
#![allow(clippy::unwrap_used)]

use crate::common::*;
use sulcus_core::output::status;
use sulcus_sessions::*;

fn replayed(bytes: &[u8]) -> ReplayReport {
    let recording = Recording::from_bytes(bytes.to_vec()).unwrap();
    replay(&recording, &ReplayOptions::default(), &mut |_| {}).unwrap()
}

#[test]
fn a_finished_session_replays_identically_and_is_gradable() {
    let bytes = recorded(12_345);
    let report = replayed(&bytes);
    assert!(
        report.identical && report.chain_ok && report.gradable,
        "{report:?}"
    );
    assert_eq!(
        (
            report.ticks,
            report.first_divergent_tick,
            report.reason.clone()
        ),
        (12_345, None, None)
    );
    assert_eq!(
        report.signature,
        Signature::Valid {
            fingerprint: key().public().fingerprint()
        }
    );
    assert_eq!(report.max_force_deviation_n, 0.0);
    assert!(!report.is_finding());
    let recording = Recording::from_bytes(bytes).unwrap();
    let facts = recording.facts();
    assert_eq!(
        (facts.rows, facts.snapshots, facts.events, facts.ticks),
        (12_345, 2, 1, Some((1, 12_345)))
    );
    assert_eq!(facts.signatures, 2, "one after ten seconds, one at the end");
    assert_eq!(recording.header(), &header(&scene()));
    assert_eq!(*recording.ending(), Ending::Finished);
}

#[test]
fn the_session_has_contact_or_these_tests_show_nothing() {
    let recording = Recording::from_bytes(recorded(3000)).unwrap();
    let pressed = recording
        .messages()
        .filter(|m| matches!(m, Ok(Message::Row(r)) if r.wrench[0][2] > 0.2));
    assert!(pressed.count() > 1000);
}

#[test]
fn one_flipped_bit_in_an_input_names_its_tick() {
    let bytes = recorded(2500);
    for (row, bit) in [(1, 0), (700, 3), (2499, 7)] {
        let mut k = 0;
        let bad = with_messages(&bytes, |topic, data| {
            if topic == "/exact/ticks" {
                k += 1;
                if k == row {
                    data[30] ^= 1 << bit; // within the first tool's x, past time, level and limit
                }
            }
            true
        });
        let report = replayed(&bad);
        assert_eq!(report.first_divergent_tick, Some(row));
        assert_eq!(report.divergence.as_ref().unwrap().what, Difference::Hash);
        assert!(!report.chain_ok && !report.identical && !report.gradable && report.is_finding());
        assert!(
            matches!(report.signature, Signature::Invalid { at: Some(2500), .. }),
            "{report:?}"
        );
    }
}

#[test]
fn a_changed_force_or_snapshot_is_found_though_the_hashes_agree() {
    let bytes = recorded_every(1200, 500);
    let mut k = 0;
    let bad = with_messages(&bytes, |topic, data| {
        k += u64::from(topic == "/exact/ticks");
        if topic == "/exact/ticks" && k == 800 {
            data[Row::BYTES - 8 - 2 * 26 + 10] ^= 1; // force z of the first tool
        }
        true
    });
    let report = replayed(&bad);
    assert_eq!(report.first_divergent_tick, Some(800));
    let divergence = report.divergence.unwrap();
    assert_eq!((divergence.what, divergence.ticks), (Difference::Output, 1));
    assert!(report.max_force_deviation_n > 0.0);

    let bad = with_messages(&bytes, |topic, data| {
        if topic == "/exact/snapshots" && data[0..8] == 500u64.to_le_bytes() {
            data[40] ^= 1;
        }
        true
    });
    let report = replayed(&bad);
    assert_eq!(report.first_divergent_tick, Some(500));
    assert_eq!(report.divergence.unwrap().what, Difference::Snapshot);
}

#[test]
fn a_missing_row_is_named_and_the_next_snapshot_heals_the_replay() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let mut session = Session::begin(&path, key());
    session.snapshot_every = 500;
    session.run(300);
    let _dropped = session.tick(&input(300));
    session.run(900);
    let end = SessionEnd {
        ticks: 1201,
        dropped_rows: 1,
        ..SessionEnd::default()
    };
    session.recorder.finish(end).unwrap();
    let report = replayed(&std::fs::read(path).unwrap());
    assert_eq!(report.first_divergent_tick, Some(302));
    let divergence = report.divergence.unwrap();
    assert_eq!((divergence.what, divergence.ticks), (Difference::Tick, 199));
    assert!(matches!(report.signature, Signature::Valid { .. }));
    assert!(!report.gradable);
}

#[test]
fn dropped_rows_at_the_end_or_a_wrong_count_make_it_ungradable() {
    for (end, words) in [
        (
            SessionEnd {
                ticks: 102,
                dropped_rows: 2,
                ..SessionEnd::default()
            },
            "2 rows were dropped",
        ),
        (
            SessionEnd {
                ticks: 102,
                ..SessionEnd::default()
            },
            "the session ran 102 ticks, the recording has 100",
        ),
    ] {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("session.mcap");
        let mut session = Session::begin(&path, key());
        session.run(100);
        session.recorder.finish(end).unwrap();
        let report = replayed(&std::fs::read(path).unwrap());
        assert!(report.identical && !report.gradable);
        let reason = report.reason.unwrap();
        assert!(reason.contains(words), "{reason}");
    }
}

#[test]
fn skipped_ticks_commands_and_nonsense_poses_replay() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let mut session = Session::begin(&path, key());
    for k in 0..2000u64 {
        let mut given = input(k);
        given.skipped = if k % 97 == 0 { (k % 13) as u16 } else { 0 };
        given.paused = (600..700).contains(&k);
        given.force_limit_n = if (800..900).contains(&k) { 0.05 } else { 0.0 };
        given.tools[0].present = !(1000..1100).contains(&k);
        given.tools[0].stale = (1300..1320).contains(&k);
        if k % 251 == 0 {
            given.tools[0].pose.position[0] = f32::from_bits(0x7fc0_1234);
        }
        let row = session.tick(&given);
        session.recorder.push(&row).unwrap();
    }
    session.finish();
    let bytes = std::fs::read(path).unwrap();
    let report = replayed(&bytes);
    assert!(report.identical && report.gradable, "{report:?}");
    // The commands did something.
    let recording = Recording::from_bytes(bytes).unwrap();
    let felt = |k: &dyn Fn(&Row) -> bool| {
        let forces = recording
            .messages()
            .filter_map(|message| match message.unwrap() {
                Message::Row(row) if k(&row) => Some(row.wrench[0][2].abs()),
                _ => None,
            });
        forces.fold(0.0, f32::max)
    };
    assert!(felt(&|row| row.input.paused && row.status[0] & status::RAMPING == 0) == 0.0);
    let limited =
        felt(&|row| row.input.force_limit_n > 0.0 && row.status[0] & status::SLEW_LIMITED == 0);
    assert!((0.04..=0.0501).contains(&limited), "{limited}");
    assert!(felt(&|_| true) > 0.2);
}

#[test]
fn another_programs_replay_says_how_far_it_is_off() {
    // As if another version had recorded: its tick let the tool sink a little deeper, and signed what it gave.
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let mut session = Session::begin_by(&path, key(), "0.0.9");
    session.scene.tools[0].stiffness_n_per_m *= 1.01;
    session.snapshot_every = 500;
    session.run(1500);
    session.finish();
    let report = replayed(&std::fs::read(path).unwrap());
    assert!(
        !report.identical && !report.gradable && report.chain_ok,
        "{report:?}"
    );
    assert!(
        matches!(report.signature, Signature::Valid { .. }),
        "it is genuine"
    );
    assert_eq!(
        (report.recorded_by.version.as_str(), report.replayed_by),
        ("0.0.9", Program::this())
    );
    let deviation = report.deviation;
    assert!(
        deviation.max_force_n > 1e-3 && deviation.max_force_n < 0.1,
        "{deviation:?}"
    );
    assert!(deviation.rms_force_n > 0.0 && deviation.rms_force_n < deviation.max_force_n);
    assert!(deviation.max_force_tick >= report.first_divergent_tick);
    assert!(
        deviation.max_pose_mm.is_some_and(|mm| mm < 0.1),
        "{deviation:?}"
    );
    let reason = report.reason.unwrap();
    for word in ["differs from tick", "recorded by 0.0.9", "force by up to"] {
        assert!(reason.contains(word), "`{word}` is not in: {reason}");
    }
}

#[test]
fn a_scene_of_another_version_names_who_could_read_it() {
    let bytes = recorded(50);
    let recording = Recording::from_bytes(bytes).unwrap();
    let mut scene = recording.header().scene.clone();
    scene[8] = scene[8].wrapping_add(1); // the layout's version
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let header = SessionHeader {
        program_version: "0.0.9".into(),
        ..SessionHeader::new(scene)
    };
    let mut recorder = Recorder::create(&path, &header, key()).unwrap();
    for message in recording.messages() {
        match message.unwrap() {
            Message::Row(row) => recorder.push(&row).unwrap(),
            Message::Snapshot { tick, state } => recorder.snapshot(BEGAN, tick, &state).unwrap(),
            _ => {}
        }
    }
    recorder
        .finish(SessionEnd {
            ticks: 50,
            ..SessionEnd::default()
        })
        .unwrap();
    let recording = Recording::open(&path).unwrap();
    let error = replay(&recording, &ReplayOptions::default(), &mut |_| {})
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("the program that recorded it, 0.0.9")
            && error.contains(&format!(
                "scene has version {}",
                sulcus_core::scene::SCENE_VERSION + 1
            )),
        "{error}"
    );
}

#[test]
fn progress_reaches_the_number_of_ticks() {
    let recording = Recording::from_bytes(recorded(1234)).unwrap();
    let mut last = 0;
    replay(&recording, &ReplayOptions::default(), &mut |ticks| {
        assert!(ticks >= last);
        last = ticks;
    })
    .unwrap();
    assert_eq!(last, 1234);
}

#[test]
fn the_judge_agrees_with_the_tick() {
    let recording = Recording::from_bytes(recorded(1500)).unwrap();
    let options = ReplayOptions {
        audit: true,
        ..ReplayOptions::default()
    };
    let report = replay(&recording, &options, &mut |_| {}).unwrap();
    let audit = report.audit.unwrap();
    assert!(report.identical && audit.ticks > 500, "{audit:?}");
    assert!(audit.unjudged * 100 <= audit.ticks, "{audit:?}");
    assert!(
        audit.max_pose_error_mm < 1e-3 && audit.max_kkt_residual < 1e-6,
        "{audit:?}"
    );
}

/// A row counts at most 65,535 skipped ticks. A longer suspension is in several rows, and no tick of the grid is lost.
#[test]
fn a_suspension_of_three_minutes_loses_no_tick_of_the_grid() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let mut session = Session::begin(&path, key());
    session.run(100);
    let (mut left, mut skipped) = (180_000_u64, Vec::new());
    while left > 0 {
        let now = u16::try_from(left).unwrap_or(u16::MAX);
        left -= u64::from(now);
        // The tick itself is a point of the grid, too.
        left = left.saturating_sub(1);
        let mut input = input(100);
        input.skipped = now;
        input.tools[0].stale = true;
        let row = session.tick(&input);
        session.recorder.push(&row).unwrap();
        skipped.push(now);
    }
    session.run(100);
    let last = session.state.tick;
    session.finish();
    assert_eq!(skipped, [65_535, 65_535, 48_928]);
    let counted: u64 = skipped.iter().map(|n| u64::from(*n) + 1).sum();
    assert_eq!(last, 200 + counted);
    let recording = Recording::open(&path).unwrap();
    assert_eq!(recording.facts().ticks, Some((1, last)));
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| {}).unwrap();
    assert!(report.identical && report.gradable, "{report:?}");
    assert_eq!(report.ticks, 203);
    // Skipped ticks are no damage.
    let salvaged = Recording::salvage(&path).unwrap();
    assert!(salvaged.gaps().is_empty(), "{:?}", salvaged.gaps());
}
