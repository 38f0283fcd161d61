//! Who edits a recording is found out, however carefully.
#![allow(clippy::unwrap_used)]

use crate::common::*;
use mcap::records::op;
use sulcus_core::{NoProbe, State, TickInput, Workspace, tick};
use sulcus_sessions::*;

/// Changes a message of a topic; `false` leaves it out.
type Change<'a> = &'a dyn Fn(&str, &mut Vec<u8>) -> bool;

fn replayed(bytes: Vec<u8>, trust: Option<PublicKey>) -> ReplayReport {
    let recording = Recording::from_bytes(bytes).unwrap();
    replay(
        &recording,
        &ReplayOptions {
            trust,
            ..ReplayOptions::default()
        },
        &mut |_| {},
    )
    .unwrap()
}

/// Runs the simulation again with gentler inputs and rewrites rows, hashes and snapshots; then, for
/// every statement, calls `restate` with the heads as they should now be.
fn simulated_again(
    bytes: &[u8],
    mut restate: impl FnMut(Statement, [u8; 64]) -> SignedStatement,
) -> Vec<u8> {
    let scene = scene();
    let (mut state, mut workspace) = (State::new(&scene), Workspace::new(&scene));
    let mut head = Recording::from_bytes(bytes.to_vec())
        .unwrap()
        .messages()
        .find_map(|message| match message.unwrap() {
            Message::Signed(signed) => Some(signed.statement.header),
            _ => None,
        })
        .unwrap();
    let link = |kind: u8, data: &[u8], head: &mut [u8; 32]| {
        *head = *blake3::hash(&[&head[..], &[kind], data].concat()).as_bytes();
    };
    with_messages(bytes, |topic, data| {
        match topic {
            "/exact/ticks" => {
                let mut row = Row::from_bytes(data).unwrap();
                let mut gentler: TickInput = row.input;
                gentler.tools[0].pose.position[2] += 2e-4;
                let out = tick(&scene, &mut state, &mut workspace, &gentler, &mut NoProbe);
                row = Row::new(row.time_unix_ns, &gentler, &out);
                *data = row.to_bytes().to_vec();
                link(1, data, &mut head);
            }
            "/exact/snapshots" => {
                *data = [&state.tick.to_le_bytes()[..], &state.to_bytes()].concat();
                link(2, data, &mut head);
            }
            "/events" => link(3, data, &mut head),
            "/exact/chain" => {
                let mut signed = SignedStatement::from_bytes(data).unwrap();
                signed.statement.head = head;
                *data = restate(signed.statement, signed.signature)
                    .to_bytes()
                    .to_vec();
            }
            "/log" => {}
            other => unreachable!("{other}"),
        }
        true
    })
}

#[test]
fn a_session_simulated_again_replays_but_its_signature_does_not_hold() {
    let original = recorded(10_500);
    let forged = simulated_again(&original, |statement, signature| SignedStatement {
        statement,
        signature,
    });
    let report = replayed(forged, None);
    assert!(
        report.identical,
        "the forger knows the simulation: {report:?}"
    );
    assert!(report.chain_ok, "and the chain");
    let Signature::Invalid {
        reason,
        at: Some(tick),
    } = &report.signature
    else {
        panic!("{report:?}")
    };
    assert!(reason.contains("forged or altered"), "{reason}");
    // The first statement comes with the first row ten seconds after the first one.
    assert_eq!(*tick, 10_001);
    assert!(report.is_finding() && !report.gradable);
}

#[test]
fn another_key_is_no_help_to_a_forger_when_the_stations_is_known() {
    let other = StationKey::from_seed([66; 32]);
    let original = recorded(300);
    let forged = simulated_again(&original, |statement, _| statement.sign(&other));
    let report = replayed(forged.clone(), None);
    assert!(
        matches!(report.signature, Signature::Invalid { .. }),
        "the header still names the station"
    );

    // Exchanging the header's key as well changes the header's digest, so everything is made anew:
    // an honest recording by somebody else, which only a trusted key can tell apart.
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let mut session = Session::begin(&path, StationKey::from_seed([66; 32]));
    session.run(300);
    session.finish();
    let theirs = std::fs::read(path).unwrap();
    let report = replayed(theirs.clone(), None);
    assert_eq!(
        report.signature,
        Signature::Valid {
            fingerprint: other.public().fingerprint()
        }
    );
    let report = replayed(theirs, Some(key().public()));
    let Signature::Invalid { reason, at: None } = &report.signature else {
        panic!("{report:?}")
    };
    assert!(reason.contains("not the trusted key"), "{reason}");
    assert!(report.is_finding() && !report.gradable);
    assert!(replayed(original, Some(key().public())).gradable);
}

#[test]
fn nothing_in_the_header_can_be_exchanged() {
    let original = recorded(200);
    for field in [
        "learner_id",
        "station",
        "exercise_name",
        "seed",
        "program_version",
        "build",
        "tick_source",
        "started_unix_ns",
    ] {
        let forged = rewritten(
            &original,
            &mut Edit {
                message: &mut |_, _| true,
                metadata: &mut |pairs| {
                    pairs.insert(field.to_owned(), "9".to_owned());
                },
                attachment: &mut |_, _| {},
            },
        );
        let report = replayed(forged, None);
        assert!(
            matches!(report.signature, Signature::Invalid { .. }),
            "{field}: {report:?}"
        );
    }
}

#[test]
fn an_exam_cannot_be_made_of_practice_nor_the_other_way() {
    let original = recorded(200);
    for said in [Some("exam"), Some("self-assessment"), None] {
        let forged = rewritten(
            &original,
            &mut Edit {
                message: &mut |_, _| true,
                metadata: &mut |pairs| {
                    assert_eq!(pairs.remove("mode").as_deref(), Some("practice"));
                    pairs.extend(said.map(|mode| ("mode".to_owned(), mode.to_owned())));
                },
                attachment: &mut |_, _| {},
            },
        );
        let report = replayed(forged, None);
        assert!(
            matches!(report.signature, Signature::Invalid { .. }),
            "{said:?}: {report:?}"
        );
    }
}

#[test]
fn an_event_or_a_snapshot_cannot_be_changed_left_out_or_added() {
    let original = recorded(200);
    let edits: [Change<'_>; 3] = [
        &|topic, _| topic != "/events",
        &|topic, data| {
            if topic == "/events" {
                let text = String::from_utf8(data.clone())
                    .unwrap()
                    .replace("begins", "ends");
                *data = text.into_bytes();
            }
            true
        },
        &|topic, data| {
            let last = topic == "/exact/ticks" && data[..8] == 200u64.to_le_bytes();
            !last
        },
    ];
    for edit in edits {
        let report = replayed(with_messages(&original, edit), None);
        assert!(
            matches!(report.signature, Signature::Invalid { .. }),
            "{report:?}"
        );
        assert!(!report.chain_ok);
    }
}

#[test]
fn leaving_out_the_last_statement_does_not_make_a_finished_session() {
    let original = recorded(200);
    let forged = with_messages(&original, |topic, _| topic != "/exact/chain");
    let report = replayed(forged, None);
    assert!(
        matches!(report.ending, Ending::Damaged { .. }),
        "{report:?}"
    );
    assert!(matches!(
        report.signature,
        Signature::Unsigned {
            last_valid_tick: None,
            ..
        }
    ));
    assert!(report.is_finding() && !report.gradable);
}

/// The reason of an invalid signature, and its place.
fn invalid(report: &ReplayReport) -> (&str, Option<u64>) {
    match &report.signature {
        Signature::Invalid { reason, at } => (reason, *at),
        _ => panic!("{report:?}"),
    }
}

#[test]
fn an_attachment_cannot_be_exchanged() {
    let original = recorded(200);
    for (name, said) in [
        ("scene.bin", "the scene differs from the signed one"),
        ("exercise", "the exercise differs from the signed one"),
        (
            "patient",
            "the header (learner, station, patient, rubric, ...) differs from the signed one",
        ),
        (
            "rubric",
            "the header (learner, station, patient, rubric, ...) differs from the signed one",
        ),
    ] {
        let change = |data: &mut Vec<u8>| {
            if name == "scene.bin" {
                // A scene that is one: a softer tool.
                let mut scene = sulcus_core::Scene::from_bytes(data).unwrap();
                scene.tools[0].stiffness_n_per_m *= 0.9;
                *data = scene.to_bytes().unwrap();
            } else {
                data.push(b'#');
            }
        };
        // Clumsily: the header's hash is not the attachment's.
        let error =
            Recording::from_bytes(with_attachment(&original, name, false, change)).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!(
                "recording's header is damaged: attachment `{name}` does not match the hash that the header gives"
            )
        );
        // Carefully: then it is not what was signed.
        let report = replayed(with_attachment(&original, name, true, change), None);
        assert_eq!(invalid(&report), (said, Some(200)), "{name}");
        assert!(report.is_finding() && !report.gradable && !report.chain_ok);
        assert_eq!(report.identical, name != "scene.bin");
    }
}

#[test]
fn a_changed_pose_wrench_snapshot_or_event_is_found_with_its_place() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let mut session = Session::begin(&path, key());
    session.snapshot_every = 700;
    session.run(11_000);
    session
        .recorder
        .event(BEGAN + 11_000_000_000, Level::Info, "late")
        .unwrap();
    session.finish();
    let original = std::fs::read(path).unwrap();
    // In the second stretch: the first one is still good, and the signature says so.
    let row = |k: u64, at: usize| {
        with_messages(&original, move |topic, data| {
            if topic == "/exact/ticks" && data[..8] == k.to_le_bytes() {
                data[at] ^= 1;
            }
            true
        })
    };
    let between =
        "between ticks 10001 and 11000: a row, snapshot or event differs from the signed record";
    let pose = replayed(row(10_400, 30), None);
    assert_eq!(pose.first_divergent_tick, Some(10_400));
    assert_eq!(pose.divergence.as_ref().unwrap().what, Difference::Hash);
    assert_eq!(invalid(&pose), (between, Some(11_000)));
    let wrench = replayed(row(10_500, Row::BYTES - 8 - 2 * 26 + 8), None);
    assert_eq!(wrench.first_divergent_tick, Some(10_500));
    assert_eq!(wrench.divergence.as_ref().unwrap().what, Difference::Output);
    assert_eq!(invalid(&wrench), (between, Some(11_000)));
    let edited = with_messages(&original, |topic, data| {
        if topic == "/exact/snapshots" && data[..8] == 10_500u64.to_le_bytes() {
            data[60] ^= 1;
        }
        true
    });
    let snapshot = replayed(edited, None);
    assert_eq!(snapshot.first_divergent_tick, Some(10_500));
    assert_eq!(
        snapshot.divergence.as_ref().unwrap().what,
        Difference::Snapshot
    );
    assert_eq!(invalid(&snapshot), (between, Some(11_000)));
    // An event is in no state: only the signature over its stretch tells.
    for change in ["lame", "late\u{7}"] {
        let edited = with_messages(&original, |topic, data| {
            if topic == "/events" {
                *data = String::from_utf8(data.clone())
                    .unwrap()
                    .replace("late", change)
                    .into_bytes();
            }
            true
        });
        // (A raw control character is no JSON.)
        let event = match Recording::from_bytes(edited.clone()).map(|r| r.ending().clone()) {
            Ok(Ending::Finished) => replayed(edited, None),
            other => {
                assert!(
                    change.contains('\u{7}') && matches!(other, Ok(Ending::Damaged { .. })),
                    "{other:?}"
                );
                continue;
            }
        };
        assert!(event.identical);
        assert_eq!(invalid(&event), (between, Some(11_000)));
    }
}

#[test]
fn a_chunk_cut_out_of_the_file_is_missed() {
    let original = recorded(3000);
    let chunks = records_of(&original, op::CHUNK);
    assert!(chunks.len() > 20);
    let gone = chunks[chunks.len() / 2].clone();
    let mut edited = original[..gone.start].to_vec();
    edited.extend_from_slice(&original[gone.end..]);
    let rows = |bytes: &[u8]| Recording::from_bytes(bytes.to_vec()).unwrap().facts().rows;
    let missing = rows(&original) - rows(&edited);
    assert!(missing > 50, "{missing}");
    let report = replayed(edited, None);
    let tick = report.first_divergent_tick.unwrap();
    assert_eq!(report.divergence.as_ref().unwrap().what, Difference::Tick);
    assert!(
        tick > missing && tick < 3000,
        "the first row behind the gap: {tick}"
    );
    let (reason, at) = invalid(&report);
    assert_eq!(
        reason,
        "up to tick 3000: a row, snapshot or event differs from the signed record"
    );
    assert_eq!(at, Some(3000));
    assert!(
        !report.gradable
            && report
                .reason
                .unwrap()
                .contains(&format!("differs from tick {tick}"))
    );
}

#[test]
fn dropped_rows_are_not_gradable_even_when_signed() {
    // The station itself says so: nothing is forged, and still no grade may rest on it.
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let mut session = Session::begin(&path, key());
    session.run(300);
    let end = SessionEnd {
        ticks: 307,
        dropped_rows: 7,
        ..SessionEnd::default()
    };
    session.recorder.finish(end).unwrap();
    let report = replayed(std::fs::read(path).unwrap(), Some(key().public()));
    assert!(matches!(report.signature, Signature::Valid { .. }) && report.identical);
    assert_eq!(
        report.reason.as_deref(),
        Some("7 rows were dropped while recording")
    );
    assert!(report.is_finding() && !report.gradable);
}

/// A metadata record of one pair, as it stands in a file.
fn metadata(name: &str, key: &str, value: &str) -> Vec<u8> {
    let string = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let pairs = [string(key), string(value)].concat();
    let body = [
        string(name),
        (pairs.len() as u32).to_le_bytes().to_vec(),
        pairs,
    ]
    .concat();
    let length = (body.len() as u64).to_le_bytes();
    [&[op::METADATA][..], &length, &body].concat()
}

/// The file with a record put in before byte `at`.
fn with(bytes: &[u8], at: usize, record: &[u8]) -> Vec<u8> {
    [&bytes[..at], record, &bytes[at..]].concat()
}

#[test]
fn nothing_that_nobody_signed_can_be_put_behind_the_header() {
    let original = recorded(400);
    // A rubric from elsewhere, under the same name and under another.
    let rubric = original[records_of(&original, op::ATTACHMENT)[3].clone()].to_vec();
    let at = rubric.windows(6).position(|six| six == b"rubric").unwrap();
    let mut renamed = rubric.clone();
    renamed[at] = b'R';
    let recovered = metadata("sulcus.recovered", "missing", "nothing");
    let (said, twice) = (
        metadata("grade", "score", "100"),
        [&recovered[..], &recovered[..]].concat(),
    );
    let second = original[records_of(&original, op::METADATA)[0].clone()].to_vec();
    let chunks = records_of(&original, op::CHUNK);
    let middle = chunks[chunks.len() / 2].start;
    let end = records_of(&original, op::DATA_END)[0].start;
    for (record, says) in [
        (&rubric, "an attachment `rubric` behind the header"),
        (&renamed, "an attachment `Rubric` behind the header"),
        (&said, "metadata `grade` behind the header"),
        (&second, "a second header"),
        (&twice, "metadata `sulcus.recovered` twice"),
    ] {
        for at in [middle, end] {
            let report = replayed(with(&original, at, record), None);
            let Ending::Damaged { why, .. } = &report.ending else {
                panic!("{says}: {report:?}")
            };
            assert!(why.contains(says), "{why}");
            assert!(report.is_finding() && !report.gradable, "{says}");
        }
    }
    // What a recovery says of itself is said by it alone, and takes nothing from a finished session.
    let noted = replayed(with(&original, end, &recovered), None);
    assert!(noted.gradable && noted.ending == Ending::Finished);
}

#[test]
fn nothing_that_nobody_asks_for_can_be_put_before_the_header() {
    let original = recorded(200);
    let first = records_of(&original, op::ATTACHMENT)[0].clone();
    let rubric = &original[records_of(&original, op::ATTACHMENT)[3].clone()];
    let at = rubric.windows(6).position(|six| six == b"rubric").unwrap();
    let mut renamed = rubric.to_vec();
    renamed[at] = b'R';
    for (record, says) in [
        (
            &renamed[..],
            "there is an attachment `Rubric`, expected `scene.bin`, `exercise`, `patient`, `rubric` alone",
        ),
        (rubric, "there are two attachments `rubric`"),
        (
            &metadata("grade", "score", "100"),
            "there is metadata `grade`, expected `sulcus` alone",
        ),
    ] {
        let error = Recording::from_bytes(with(&original, first.start, record)).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("recording's header is damaged: {says}")
        );
    }
}
