//! A torn recording is made whole as far as it goes, and says so.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use crate::common::*;
use mcap::records::op;
use sulcus_sessions::*;

/// Recovers bytes; gives the report and the new file's bytes.
fn recovered(bytes: &[u8]) -> (Recovered, Vec<u8>) {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("whole.mcap");
    let torn = Recording::from_bytes(bytes.to_vec()).unwrap();
    let mut last = 0;
    let found = recover(&torn, &out, &mut |bytes| {
        assert!(bytes >= last);
        last = bytes;
    })
    .unwrap();
    (found, std::fs::read(out).unwrap())
}

fn replayed(bytes: &[u8]) -> ReplayReport {
    let recording = Recording::from_bytes(bytes.to_vec()).unwrap();
    replay(&recording, &ReplayOptions::default(), &mut |_| {}).unwrap()
}

/// Whether an MCAP reader that knows nothing of ours opens it by its index, and how many messages it finds.
fn by_index(bytes: &[u8]) -> Option<u64> {
    let summary = mcap::Summary::read(bytes).ok()??;
    let messages = mcap::MessageStream::new(bytes).ok()?;
    let n = messages.collect::<Result<Vec<_>, _>>().ok()?.len() as u64;
    assert_eq!(summary.stats?.message_count, n);
    Some(n)
}

/// The middle of the first chunk (opcode 6) that begins at byte `from` or later. (A tear in the index behind a chunk loses no row.)
fn middle_of_chunk_after(bytes: &[u8], from: usize) -> usize {
    let mut at = 8;
    loop {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
        if bytes[at] == 6 && at >= from {
            return at + 9 + length / 2;
        }
        at += 9 + length;
    }
}

#[test]
fn a_torn_file_becomes_whole_keeps_its_signatures_and_says_what_is_missing() {
    let whole = recorded(12_000);
    // Well behind the first signature.
    let at = middle_of_chunk_after(&whole, whole.len() * 9 / 10);
    let torn = &whole[..at];
    assert_eq!(by_index(torn), None);
    let before = replayed(torn);
    let (found, bytes) = recovered(torn);
    let after = replayed(&bytes);
    assert!(by_index(&bytes).unwrap() > before.ticks);
    assert_eq!((found.ticks, found.last_tick), (before.ticks, before.ticks));
    assert!(
        after.identical && after.chain_ok && !after.gradable,
        "{after:?}"
    );
    assert_eq!(after.ticks, before.ticks);
    let signed_to = |report: &ReplayReport| match report.signature {
        Signature::Unsigned {
            last_valid_tick, ..
        } => last_valid_tick,
        _ => panic!("{report:?}"),
    };
    assert_eq!(
        (signed_to(&before), signed_to(&after)),
        (Some(10_001), Some(10_001))
    );

    let Ending::Recovered { was, missing } = &after.ending else {
        panic!("{after:?}")
    };
    assert!(was.starts_with("cut off after"), "{was}");
    // The torn chunk's header still names its last time: 100 ms are flushed at once.
    let lost = &found.lost;
    assert!(lost.bytes > 0 && lost.end_is_missing, "{lost:?}");
    let (ticks, ms) = (lost.ticks.unwrap(), lost.ms.unwrap());
    assert!(
        (1..=101).contains(&ticks) && (ms - ticks as f64).abs() < 0.5,
        "{lost:?}"
    );
    assert_eq!(*missing, lost.to_string());
    assert!(
        missing.contains(&format!("{ticks} ticks")) && missing.contains("the end of the session")
    );
    let topics: Vec<&str> = lost.channels.iter().map(|c| c.topic.as_str()).collect();
    assert!(topics.contains(&"/exact/ticks"), "{topics:?}");
    assert!(
        after
            .reason
            .unwrap()
            .contains("recovered from a file that was cut off")
    );

    // Once recovered it is whole.
    let again = Recording::from_bytes(bytes.clone()).unwrap();
    let error = recover_to(&again, Vec::new(), &mut |_| {}).unwrap_err();
    assert!(
        error
            .to_string()
            .starts_with("nothing to recover: the recording is recovered")
    );
    // Torn again, it can be recovered again.
    let (twice, bytes) = recovered(&bytes[..bytes.len() * 3 / 4]);
    assert!(twice.ticks < found.ticks && replayed(&bytes).identical);
}

#[test]
fn wherever_it_is_torn_what_was_read_before_is_read_after() {
    let whole = recorded(600);
    let mut recoveries = 0;
    for at in (0..whole.len()).filter(|at| at % 97 == 0 || at + 120 > whole.len()) {
        let Ok(torn) = Recording::from_bytes(whole[..at].to_vec()) else {
            continue;
        };
        let (bytes, _) = recover_to(&torn, Vec::new(), &mut |_| {}).unwrap();
        let again = Recording::from_bytes(bytes.clone()).unwrap();
        assert_eq!(again.facts(), torn.facts(), "{at}");
        assert_eq!(again.header(), torn.header());
        // The last statement may be there, and only the index behind it torn: then nothing is missing.
        let complete = torn.facts().end.is_some();
        assert_eq!(
            *again.ending() == Ending::Finished,
            complete,
            "{at}: {}",
            again.ending()
        );
        assert_eq!(replayed(&bytes).gradable, complete, "{at}");
        recoveries += 1;
    }
    assert!(recoveries > 50, "{recoveries}");
}

#[test]
fn damage_is_left_behind_and_the_index_after_it_tells_what_is_missing() {
    let whole = recorded(2000);
    let mut bad = whole.clone();
    bad[whole.len() / 2] ^= 16;
    let (found, bytes) = recovered(&bad);
    assert!(matches!(found.was, Ending::Damaged { .. }), "{found:?}");
    assert!(replayed(&bytes).identical);
    // Behind the damage everything is there, and counted: the chain is broken, so none of it is taken.
    let lost = &found.lost;
    assert_eq!(lost.ticks, Some(2000 - found.ticks));
    let rows = lost
        .channels
        .iter()
        .find(|c| c.topic == "/exact/ticks")
        .unwrap();
    assert_eq!(rows.messages, lost.ticks);
}

#[test]
fn a_whole_recording_or_a_file_that_exists_is_left_alone() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out.mcap");
    let whole = Recording::from_bytes(recorded(200)).unwrap();
    let error = recover(&whole, &out, &mut |_| {}).unwrap_err();
    assert_eq!(
        error.to_string(),
        "nothing to recover: the recording is finished"
    );
    assert!(!out.exists());
    let bytes = recorded(600);
    let torn = Recording::from_bytes(bytes[..bytes.len() / 2].to_vec()).unwrap();
    std::fs::write(&out, "mine").unwrap();
    let error = recover(&torn, &out, &mut |_| {}).unwrap_err().to_string();
    assert!(
        error.starts_with("cannot write `") && error.contains("exists"),
        "{error}"
    );
    assert_eq!(std::fs::read(&out).unwrap(), b"mine");
    let error = recover(&torn, Path::new("no/such/folder/x.mcap"), &mut |_| {});
    assert!(matches!(error, Err(RecoverError::Write { .. })));
}

#[test]
fn a_recovery_that_is_made_up_is_no_finished_session() {
    // Who takes the last statement away and writes that it was recovered has a session without an end.
    let whole = recorded(300);
    let forged = with_messages(&whole, |topic, _| topic != "/exact/chain");
    let torn = Recording::from_bytes(forged).unwrap();
    let (bytes, _) = recover_to(&torn, Vec::new(), &mut |_| {}).unwrap();
    let report = replayed(&bytes);
    assert!(
        matches!(report.ending, Ending::Recovered { .. }) && !report.gradable,
        "{report:?}"
    );
    assert!(matches!(
        report.signature,
        Signature::Unsigned {
            last_valid_tick: None,
            ..
        }
    ));
}

#[test]
fn of_a_finished_session_with_its_last_bytes_cut_nothing_but_the_index_is_missing() {
    let whole = recorded_with_views(600, 0..0);
    let index = records_of(&whole, op::DATA_END)[0].start;
    for at in [index, index + 20, whole.len() - 40, whole.len() - 1] {
        let (found, bytes) = recovered(&whole[..at]);
        let lost = &found.lost;
        assert!(lost.channels.is_empty() && lost.ticks.is_none(), "{lost:?}");
        assert!(!lost.end_is_missing && lost.damaged_views == 0, "{lost:?}");
        let said = if at == index {
            "no exact message"
        } else {
            "only the file's index"
        };
        assert_eq!(lost.to_string(), said);
        let report = replayed(&bytes);
        assert!(report.gradable && report.viewers == Viewers::AsSigned);
        assert!(by_index(&bytes).is_some());
    }
}

#[test]
fn a_damaged_chunk_of_viewers_is_left_behind_and_said_so_in_a_finished_file_too() {
    let whole = recorded_with_views(2000, 0..0);
    let mut bad = whole.clone();
    // Where its packed bytes begin, behind frame, times, lengths, CRC and `zstd`: others stop there.
    bad[view_chunks(&whole)[1].start + 53] ^= 0x10;
    assert_eq!(by_index(&bad), None);
    let (found, bytes) = recovered(&bad);
    assert_eq!(
        (found.was, found.ending),
        (Ending::Finished, Ending::Finished)
    );
    assert_eq!(found.lost.damaged_views, 1);
    assert_eq!(
        found.lost.to_string(),
        "no exact message, and a damaged chunk of the channels for viewers"
    );
    let (kept, all) = (by_index(&bytes).unwrap(), by_index(&whole).unwrap());
    assert!(kept < all && kept > all / 2, "{kept} of {all}");
    let report = replayed(&bytes);
    assert!(report.identical && report.gradable && report.chain_ok);
    // It is not all that was signed.
    assert_eq!(report.viewers, Viewers::Changed);
    // Torn as well.
    let (found, bytes) = recovered(&bad[..middle_of_chunk_after(&whole, whole.len() * 8 / 10)]);
    assert_eq!(found.lost.damaged_views, 1);
    let said = found.lost.to_string();
    assert!(
        said.ends_with(", and a damaged chunk of the channels for viewers"),
        "{said}"
    );
    assert!(by_index(&bytes).is_some());
    // And whole again, there is nothing more to do.
    let again = Recording::from_bytes(bytes).unwrap();
    assert!(matches!(
        recover_to(&again, Vec::new(), &mut |_| {}),
        Err(RecoverError::Whole(_))
    ));
}
