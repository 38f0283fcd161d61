//! Who edits a recording is found out, however carefully.
#![allow(clippy::unwrap_used)]

mod common;

use common::*;
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
        "started_unix_ns",
    ] {
        let forged = rewritten(
            &original,
            &mut Edit {
                message: &mut |_, _| true,
                metadata: &mut |pairs| {
                    pairs.insert(field.to_owned(), "9".to_owned());
                },
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
