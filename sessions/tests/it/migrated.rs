//! What a recording of a former version of the format is held to: a grade rests on its inputs, run by the present tick, and only while what
//! was recorded is close to that. Whoever holds a station's key can sign whatever he likes under an older number.
#![allow(clippy::unwrap_used)]

use std::cell::Cell;

use crate::common::*;
use sulcus_core::State;
use sulcus_sessions::*;

/// The version before the present one, which is migrated.
const FORMER: &str = "3";

/// The file as whoever holds the key would make it: of that version, with messages changed, and all of it signed anew.
fn signed_anew(bytes: &[u8], version: &str, change: &mut dyn FnMut(&str, &mut Vec<u8>)) -> Vec<u8> {
    let header = Cell::new([0_u8; 32]);
    let mut head = None;
    let mut message = |topic: &str, data: &mut Vec<u8>| {
        let head = head.get_or_insert_with(|| header.get());
        change(topic, data);
        let kind = match topic {
            "/exact/ticks" => 1_u8,
            "/exact/snapshots" => 2,
            "/events" => 3,
            "/exact/chain" => {
                let mut statement = SignedStatement::from_bytes(data).unwrap().statement;
                (statement.header, statement.head) = (header.get(), *head);
                *data = statement.sign(&key()).to_bytes().to_vec();
                return true;
            }
            _ => return true,
        };
        *head = *blake3::hash(&[&head[..], &[kind], data].concat()).as_bytes();
        true
    };
    rewritten(
        bytes,
        &mut Edit {
            message: &mut message,
            metadata: &mut |pairs| {
                pairs.insert("format_version".to_owned(), version.to_owned());
                let mut hasher = blake3::Hasher::new();
                for text in pairs.iter().flat_map(|(key, value)| [key, value]) {
                    hasher.update(&(text.len() as u64).to_le_bytes());
                    hasher.update(text.as_bytes());
                }
                header.set(*hasher.finalize().as_bytes());
            },
            attachment: &mut |_, _| {},
        },
    )
}

fn replayed(bytes: Vec<u8>) -> ReplayReport {
    let recording = Recording::from_bytes(bytes).unwrap();
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| {}).unwrap();
    // Signed by the station, every one of them.
    assert!(
        matches!(report.signature, Signature::Valid { .. }) && report.chain_ok,
        "{report:?}"
    );
    report
}

/// A session with a snapshot every 700 ticks.
fn session() -> Vec<u8> {
    recorded_every(3_000, 700)
}

/// Moves the tool in the snapshots from tick 1 on, each time `by` metres farther.
fn moved(by: f64) -> impl FnMut(&str, &mut Vec<u8>) {
    let scene = scene();
    let mut far = 0.0;
    move |topic, data| {
        if topic != "/exact/snapshots" || data[..8] == 0_u64.to_le_bytes() {
            return;
        }
        far += by;
        let mut state = State::from_bytes(&scene, &data[8..]).unwrap();
        state.tools[0].graphic.position.x += far;
        *data = [&data[..8], &state.to_bytes()].concat();
    }
}

fn refused(report: &ReplayReport) {
    assert!(
        !report.gradable && report.is_finding() && !report.is_close(),
        "{report:?}"
    );
    let reason = report.reason.as_ref().unwrap();
    assert!(
        reason.contains("beyond the tolerance of the migration from format 3"),
        "{reason}"
    );
}

#[test]
fn one_that_the_present_tick_gives_the_same_is_graded() {
    let report = replayed(signed_anew(&session(), FORMER, &mut |_, _| {}));
    assert!(report.identical && report.gradable, "{report:?}");
    assert_eq!(report.migration.unwrap().from, FORMER);
}

#[test]
fn forces_that_were_never_there_are_refused() {
    let report = replayed(signed_anew(&session(), FORMER, &mut |topic, data| {
        if topic == "/exact/ticks" {
            let mut row = Row::from_bytes(data).unwrap();
            // Half a second of half a newton, in a session of three.
            if (2_000..2_500).contains(&row.tick) {
                row.wrench[0][0] += 0.5;
                *data = row.to_bytes().to_vec();
            }
        }
    }));
    refused(&report);
    assert!(report.deviation.rms_force_n > 0.2, "{report:?}");
}

#[test]
fn a_snapshot_that_is_no_state_is_refused() {
    let report = replayed(signed_anew(&session(), FORMER, &mut |topic, data| {
        if topic == "/exact/snapshots" && data[..8] != 0_u64.to_le_bytes() {
            data.truncate(40);
        }
    }));
    refused(&report);
    assert!(report.deviation.out_of_step >= 4, "{report:?}");
}

#[test]
fn snapshots_lead_no_replay_of_a_former_version_astray() {
    // A fiftieth of a millimetre each, 0.08 in the last: close enough, and never gone on from.
    let report = replayed(signed_anew(&session(), FORMER, &mut moved(2e-5)));
    assert!(!report.identical && report.gradable, "{report:?}");
    let snapshots = Recording::from_bytes(session()).unwrap().facts().snapshots;
    assert_eq!(
        report.divergence.as_ref().unwrap().ticks,
        1,
        "no row differs: {report:?}"
    );
    assert_eq!(report.deviation.max_force_n, 0.0, "{report:?}");
    // A walk in steps of that size is found out as soon as it has led somewhere.
    assert!(snapshots >= 5);
    refused(&replayed(signed_anew(&session(), FORMER, &mut moved(6e-5))));
}

#[test]
fn the_present_version_is_held_to_every_bit() {
    let own = record::header::FORMAT_VERSION;
    for mut change in [moved(2e-5), moved(6e-5)] {
        let report = replayed(signed_anew(&session(), own, &mut change));
        assert!(!report.gradable && report.is_finding(), "{report:?}");
        assert!(report.migration.is_none());
    }
    assert!(replayed(signed_anew(&session(), own, &mut |_, _| {})).identical);
}

#[test]
fn without_the_key_no_number_can_be_put_in_the_header() {
    let forged = rewritten(
        &session(),
        &mut Edit {
            message: &mut |_, _| true,
            metadata: &mut |pairs| {
                pairs.insert("format_version".to_owned(), FORMER.to_owned());
            },
            attachment: &mut |_, _| {},
        },
    );
    let recording = Recording::from_bytes(forged).unwrap();
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| {}).unwrap();
    assert!(matches!(report.signature, Signature::Invalid { .. }));
    assert!(
        !report.gradable && !report.chain_ok && report.is_finding(),
        "{report:?}"
    );
}
