//! Damage in the middle of a recording: every whole chunk behind it is recovered, and each stretch replays from its own snapshot.
#![allow(clippy::unwrap_used)]

use std::ops::Range;

use mcap::records::op;
use proptest::prelude::*;
use proptest::sample::Index;
use sulcus_sessions::*;

use crate::common::program::{code, err, json_of, out, run, text_of};
use crate::common::*;

/// Ticks of the session, and from one of its snapshots to the next.
const TICKS: u64 = 24_000;
const EVERY: u64 = 4_000;

/// A session with signatures after ticks 10001 and 20001 and at the end.
fn session() -> &'static [u8] {
    static BYTES: std::sync::LazyLock<Vec<u8>> =
        std::sync::LazyLock::new(|| recorded_every(TICKS, EVERY));
    &BYTES
}

/// Salvaged recording from a file with these bytes.
fn salvaged(bytes: &[u8]) -> Result<Recording, ReadError> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("bad.mcap");
    std::fs::write(&path, bytes).unwrap();
    Recording::salvage(&path)
}

fn recovered(bytes: &[u8]) -> (Recovered, Recording) {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("whole.mcap");
    let bad = Recording::from_bytes(bytes.to_vec()).unwrap();
    let found = recover(&bad, &out, &mut |_| {}).unwrap();
    let again = Recording::from_bytes(std::fs::read(&out).unwrap()).unwrap();
    (found, again)
}

fn replayed(recording: &Recording) -> ReplayReport {
    replay(recording, &ReplayOptions::default(), &mut |_| {}).unwrap()
}

/// The chunk at this share of the file, and the ticks of its rows.
fn chunk_at(bytes: &[u8], share: f64) -> (Range<usize>, Vec<u64>) {
    let chunks = records_of(bytes, op::CHUNK);
    let chunk = chunks[(chunks.len() as f64 * share) as usize].clone();
    let summary = mcap::Summary::read(bytes).unwrap().unwrap();
    let index = summary
        .chunk_indexes
        .iter()
        .find(|index| index.chunk_start_offset == chunk.start as u64)
        .unwrap();
    let ticks = summary
        .stream_chunk(bytes, index)
        .unwrap()
        .map(Result::unwrap)
        .filter(|message| message.channel.topic == "/exact/ticks")
        .map(|message| Row::from_bytes(&inner(&message.data)).unwrap().tick)
        .collect();
    (chunk, ticks)
}

/// A kind of damage to a chunk.
type Damage = fn(&mut Vec<u8>, Range<usize>);

const DAMAGES: [(&str, Damage); 5] = [
    ("a flipped bit", |bytes, chunk| {
        bytes[chunk.start + chunk.len() / 2] ^= 0x10;
    }),
    ("a length that is wrong", |bytes, chunk| {
        bytes[chunk.start + 1..chunk.start + 9].copy_from_slice(&77_u64.to_le_bytes());
    }),
    ("a length beyond the file", |bytes, chunk| {
        bytes[chunk.start + 8] = 0x7f;
    }),
    ("zeros", |bytes, chunk| bytes[chunk].fill(0)),
    ("cut out in the middle", |bytes, chunk| {
        bytes.drain(chunk.start + 20..chunk.end - 20);
    }),
];

#[test]
fn what_is_whole_behind_damage_is_recovered_and_replays_from_the_next_snapshot() {
    let whole = session();
    let (chunk, lost) = chunk_at(whole, 0.55);
    let (first, last) = (lost[0], lost[lost.len() - 1]);
    assert!(first > 12_001 && last < 15_999, "{first} {last}");
    for (what, damage) in DAMAGES {
        let mut bad = whole.to_vec();
        damage(&mut bad, chunk.clone());
        // Read as ever, up to the damage.
        let before = Recording::from_bytes(bad.clone()).unwrap();
        assert_eq!(before.facts().ticks.unwrap().1, first - 1, "{what}");
        let (found, again) = recovered(&bad);
        assert_eq!(found.ticks, TICKS - lost.len() as u64, "{what}: {found}");
        assert_eq!((found.first_tick, found.last_tick), (1, TICKS));
        let gap = &found.lost.gaps[..];
        assert_eq!(gap.len(), 1, "{what}: {found}");
        assert_eq!(
            (gap[0].from_tick, gap[0].to_tick),
            (Some(first), Some(last)),
            "{what}"
        );
        assert_eq!(gap[0].at_byte, chunk.start as u64);
        assert!(gap[0].bytes > 100);
        assert_eq!(found.lost.ticks, Some(lost.len() as u64));
        assert!(!found.lost.end_is_missing);
        let said = found.lost.to_string();
        assert!(
            said.starts_with(&format!("ticks {first} to {last} ({} ticks)", lost.len())),
            "{said}"
        );
        assert!(
            matches!(found.was, Ending::Damaged { .. } | Ending::CutOff { .. }),
            "{what}"
        );
        assert!(matches!(again.ending(), Ending::Recovered { .. }));
        assert_eq!(again.gaps(), gap);

        let report = replayed(&again);
        assert!(report.identical && report.chain_ok && !report.gradable && report.is_finding());
        let [one, two] = &report.stretches[..] else {
            panic!("{what}: {report:?}")
        };
        assert_eq!(
            (one.from_tick, one.to_tick, one.snapshot_tick),
            (1, first - 1, Some(0))
        );
        assert_eq!(
            (one.ticks, one.not_run, one.identical),
            (first - 1, 0, true)
        );
        assert_eq!(one.signed, [(1, 10_001)]);
        assert_eq!(
            (two.from_tick, two.to_tick, two.snapshot_tick),
            (last + 1, TICKS, Some(16_000))
        );
        assert_eq!((two.ticks, two.not_run), (TICKS - 16_000, 16_000 - last));
        assert!(two.identical);
        // Between two statements of the station: it signed the end, and all from its statement before that one.
        assert_eq!(two.signed, [(20_002, TICKS)]);
        assert!(matches!(
            report.signature,
            Signature::Unsigned {
                last_valid_tick: Some(10_001),
                ..
            }
        ));
        let reason = report.reason.unwrap();
        assert!(
            reason.contains("recovered from a damaged file")
                && reason.contains(&format!("ticks {first} to {last}")),
            "{reason}"
        );
        // There is nothing more to do.
        let error = recover_to(&again, Vec::new(), &mut |_| {}).unwrap_err();
        assert!(matches!(error, RecoverError::Whole(_)));
    }
}

#[test]
fn several_gaps_make_as_many_stretches_and_more_damage_adds_to_them() {
    let mut bad = session().to_vec();
    for share in [0.2, 0.21, 0.7] {
        let (chunk, _) = chunk_at(session(), share);
        bad[chunk.start + chunk.len() / 2] ^= 1;
    }
    let (found, again) = recovered(&bad);
    let gaps = found.lost.gaps.len();
    assert!((2..=3).contains(&gaps), "{found}");
    let report = replayed(&again);
    assert!(
        report.identical && report.stretches.len() == gaps + 1,
        "{report:?}"
    );
    // What was recovered is damaged again, and torn.
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("again.mcap");
    recover(&Recording::from_bytes(bad).unwrap(), &path, &mut |_| {}).unwrap();
    let mut worse = std::fs::read(&path).unwrap();
    let chunks = records_of(&worse, op::CHUNK);
    let chunk = &chunks[chunks.len() / 2];
    worse[chunk.start + chunk.len() / 2] ^= 1;
    worse.truncate(chunks[chunks.len() - 3].start + 30);
    let (found, again) = recovered(&worse);
    assert_eq!(found.lost.gaps.len(), gaps + 1, "{found}");
    assert!(found.lost.end_is_missing);
    let report = replayed(&again);
    assert!(
        report.identical && report.stretches.len() == gaps + 2,
        "{report:?}"
    );
}

#[test]
fn damage_to_the_first_chunks_leaves_what_follows() {
    let whole = session();
    let chunks = records_of(whole, op::CHUNK);
    // The first names the channels, the second begins with the first snapshot.
    for until in [1, 3] {
        let mut bad = whole.to_vec();
        bad[chunks[0].start..chunks[until - 1].end].fill(0);
        let strict = Recording::from_bytes(bad.clone()).unwrap_err();
        assert!(matches!(strict, ReadError::NoRows { .. }), "{strict}");
        let salvaged = salvaged(&bad).unwrap();
        let (copy, lost) = recover_to(&salvaged, Vec::new(), &mut |_| {}).unwrap();
        let again = Recording::from_bytes(copy).unwrap();
        assert!(again.facts().rows > TICKS - 500, "{lost}");
        let report = replayed(&again);
        assert!(
            report.identical && report.ticks >= TICKS - EVERY,
            "{report:?}"
        );
        assert!(!report.gradable || report.chain_ok && again.gaps().is_empty());
    }
}

#[test]
fn bytes_put_in_between_chunks_cost_nothing_that_is_signed() {
    let whole = recorded_every(2_000, 500);
    let chunk = records_of(&whole, op::CHUNK)[7].start;
    let put_in = [&whole[..chunk], &[6; 777], &whole[chunk..]].concat();
    let before = Recording::from_bytes(put_in.clone()).unwrap();
    assert!(before.facts().rows < 1000);
    let (found, again) = recovered(&put_in);
    assert_eq!((found.ticks, found.lost.gaps.len()), (2_000, 0), "{found}");
    // The chain goes on over the place to the station's last statement: nothing is missing.
    let report = replayed(&again);
    assert!(
        report.gradable && report.identical && report.stretches.is_empty(),
        "{report:?}"
    );
}

#[test]
fn rows_outside_of_chunks_are_found_again_too() {
    let whole = recorded_every(3_000, 500);
    let mut out = Vec::new();
    let mut writer = mcap::WriteOptions::new()
        .use_chunks(false)
        .create(std::io::Cursor::new(&mut out))
        .unwrap();
    for record in mcap::read::ChunkFlattener::new(&whole).unwrap() {
        use mcap::records::Record;
        match record.unwrap() {
            Record::Schema { header, data } => drop(
                writer
                    .add_schema_with_id(header.id, &header.name, &header.encoding, &data)
                    .unwrap(),
            ),
            Record::Channel(c) => drop(
                writer
                    .add_channel_with_id(
                        c.id,
                        c.schema_id,
                        &c.topic,
                        &c.message_encoding,
                        &c.metadata,
                    )
                    .unwrap(),
            ),
            Record::Message { header, data } => {
                writer.write_to_known_channel(&header, &data).unwrap()
            }
            Record::Metadata(metadata) => writer.write_metadata(&metadata).unwrap(),
            Record::Attachment { header, data, .. } => writer
                .attach(&mcap::Attachment {
                    log_time: header.log_time,
                    create_time: header.create_time,
                    name: header.name,
                    media_type: header.media_type,
                    data,
                })
                .unwrap(),
            Record::DataEnd(_) => break,
            _ => {}
        }
    }
    writer.finish().unwrap();
    drop(writer);
    let at = out.len() / 2;
    out[at..at + 1000].fill(0xaa);
    let (found, again) = recovered(&out);
    assert!(found.ticks > 2_980 && found.lost.gaps.len() == 1, "{found}");
    let report = replayed(&again);
    assert!(
        report.identical && report.stretches.len() == 2,
        "{report:?}"
    );
    assert!(report.ticks > 2_400);
}

#[test]
fn an_export_and_a_comparison_know_of_the_gap() {
    let (chunk, lost) = chunk_at(session(), 0.55);
    let mut bad = session().to_vec();
    bad[chunk.start + chunk.len() / 2] ^= 1;
    let (_, again) = recovered(&bad);
    let dir = tempfile::tempdir().unwrap();
    let options = sulcus_sessions::export::ExportOptions {
        tables: true,
        every_ticks: 1,
        meshes: None,
        at_s: Vec::new(),
        every_s: None,
    };
    let exported =
        sulcus_sessions::export::export(&again, &options, &dir.path().join("out"), &mut |_| {})
            .unwrap();
    assert!(exported.identical && exported.unsound.is_some());
    let table = std::fs::read_to_string(dir.path().join("out/ticks.csv")).unwrap();
    let ticks: Vec<u64> = table
        .lines()
        .skip(1)
        .map(|line| line.split(',').next().unwrap().parse().unwrap())
        .collect();
    let expected: Vec<u64> = (1..lost[0]).chain(16_001..=TICKS).collect();
    assert!(ticks == expected, "{} of {}", ticks.len(), expected.len());
    // Both scenes would have to be run over the gap.
    let what_if = WhatIf {
        level: Some(1),
        ..WhatIf::default()
    };
    let span = |from_s, to_s| ReplayOptions {
        span: Span { from_s, to_s },
        ..ReplayOptions::default()
    };
    let compared = |options: &ReplayOptions| compare(&again, &what_if, options, &mut |_| {});
    let error = compared(&ReplayOptions::default()).unwrap_err().to_string();
    assert!(error.contains("has a gap (ticks "), "{error}");
    assert!(
        compared(&span(None, Some(9.0)))
            .unwrap()
            .recorded_side_identical
    );
}

#[test]
fn the_program_recovers_and_replays_by_stretch() {
    let dir = tempfile::tempdir().unwrap();
    let (bad, out_path) = (dir.path().join("bad.mcap"), dir.path().join("whole.mcap"));
    let (chunk, lost) = chunk_at(session(), 0.55);
    let mut bytes = session().to_vec();
    bytes[chunk.start + 5] ^= 0x40;
    std::fs::write(&bad, &bytes).unwrap();
    let output = run(&[
        "info",
        text_of(&bad),
        "--recover",
        text_of(&out_path),
        "--json",
    ]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    let json = json_of(&output);
    assert_eq!(json["lost"]["gaps"][0]["from_tick"], lost[0]);
    assert_eq!(json["lost"]["ticks"], lost.len());
    let output = run(&["replay", text_of(&out_path), "--json"]);
    assert_eq!(code(&output), 1);
    let json = json_of(&output);
    assert_eq!(json["stretches"].as_array().unwrap().len(), 2);
    assert_eq!(
        (&json["identical"], &json["gradable"]),
        (&true.into(), &false.into())
    );
    let text = out(&run(&["replay", text_of(&out_path)]));
    assert!(
        text.contains("stretch    ticks 1 to ") && text.contains("from the snapshot of tick 16000"),
        "{text}"
    );
    // Damage before the first row.
    let chunks = records_of(session(), op::CHUNK);
    let mut bytes = session().to_vec();
    bytes[chunks[0].start + 30..chunks[1].end].fill(0);
    std::fs::write(&bad, &bytes).unwrap();
    let other = dir.path().join("other.mcap");
    let output = run(&["info", text_of(&bad), "--recover", text_of(&other)]);
    assert_eq!(code(&output), 0, "{}", err(&output));
    assert_eq!(code(&run(&["replay", text_of(&other)])), 1);
}

#[test]
fn gaps_that_a_note_makes_up_buy_nothing() {
    // Rows taken out, and a note that says a disk did it.
    let whole = recorded_every(2_000, 500);
    let without = with_messages(&whole, |topic, data| {
        let tick = || u64::from_le_bytes(data[..8].try_into().unwrap());
        !(topic == "/exact/ticks" && (700..720).contains(&tick()))
    });
    let cut = Recording::from_bytes(without.clone()).unwrap();
    assert!(
        !replayed(&cut).identical,
        "rows are missing, and it says so"
    );
    for note in [
        r#"[{"messages":702,"from_tick":700,"to_tick":719,"bytes":1,"at_byte":1}]"#,
        r#"[{"messages":1,"from_tick":null,"to_tick":null,"bytes":1,"at_byte":1}]"#,
    ] {
        let noted = with_note(&without, note);
        let recording = Recording::from_bytes(noted).unwrap();
        assert!(matches!(recording.ending(), Ending::Recovered { .. }));
        let report = replayed(&recording);
        assert!(!report.gradable && report.is_finding(), "{report:?}");
    }
    for nonsense in [
        "",
        "[{}]",
        r#"[{"messages":999999,"from_tick":1,"to_tick":2,"bytes":1,"at_byte":1}]"#,
    ] {
        let recording = Recording::from_bytes(with_note(&whole, nonsense)).unwrap();
        let Ending::Damaged { why, .. } = recording.ending() else {
            panic!("{}", recording.ending())
        };
        assert!(why.contains("gaps that the recording cannot have"), "{why}");
    }
}

#[test]
fn ticks_missing_between_the_last_row_kept_and_the_last_statement_are_a_gap() {
    let mut bytes = recorded_every(4_000, 400);
    let chunks = records_of(&bytes, op::CHUNK);
    // The last statement has a chunk of its own.
    let [.., third, second, last] = &chunks[..] else {
        panic!("{} chunks", chunks.len())
    };
    let (middle, end) = (third.start + third.len() / 2, second.end);
    assert!(end < last.start);
    bytes[middle..end].fill(0);
    let bad = salvaged(&bytes).unwrap();
    let kept = bad.facts().rows;
    assert!(bad.facts().end.is_some() && kept < 4_000);
    let (whole, lost) = recover_to(&bad, Vec::new(), &mut |_| {}).unwrap();
    assert_eq!(lost.ticks, Some(4_000 - kept));
    let again = Recording::from_bytes(whole).unwrap();
    let [gap] = again.gaps() else {
        panic!("{:?}", again.gaps())
    };
    assert_eq!((gap.from_tick, gap.to_tick), (Some(kept + 1), Some(4_000)));
    let report = replayed(&again);
    assert!(
        report.identical && report.chain_ok && !report.gradable,
        "{report:?}"
    );
}

/// The file with a recovery's note that lists these gaps.
fn with_note(bytes: &[u8], gaps: &str) -> Vec<u8> {
    let string = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let pairs = [string("gaps"), string(gaps)].concat();
    let length = (pairs.len() as u32).to_le_bytes();
    let body = [&string("sulcus.recovered")[..], &length, &pairs].concat();
    let record = [
        &[op::METADATA][..],
        &(body.len() as u64).to_le_bytes(),
        &body,
    ]
    .concat();
    let at = records_of(bytes, op::DATA_END)[0].start;
    [&bytes[..at], &record, &bytes[at..]].concat()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn whatever_is_damaged_what_is_whole_is_recovered_and_replays(
        holes in proptest::collection::vec((any::<Index>(), 1usize..30_000, any::<u8>()), 1..4),
        out in proptest::option::of((any::<Index>(), 1usize..5_000)),
    ) {
        static BYTES: std::sync::LazyLock<Vec<u8>> = std::sync::LazyLock::new(|| recorded_every(4_000, 400));
        let mut bytes = BYTES.clone();
        let begin = records_of(&BYTES, op::CHUNK)[0].start;
        let length = bytes.len() - begin;
        for (at, n, value) in holes {
            let at = begin + at.index(length);
            let end = (at + n).min(bytes.len());
            bytes[at..end].fill(value);
        }
        if let Some((at, n)) = out {
            let at = begin + at.index(length);
            let end = (at + n).min(bytes.len());
            bytes.drain(at..end);
        }
        let Ok(bad) = salvaged(&bytes) else { return Ok(()) };
        let strict = Recording::from_bytes(bytes).map(|strict| strict.facts().rows).unwrap_or(0);
        prop_assert!(bad.facts().rows >= strict);
        match recover_to(&bad, Vec::new(), &mut |_| {}) {
            Ok((whole, lost)) => {
                let again = Recording::from_bytes(whole).unwrap();
                prop_assert_eq!(again.facts().rows, bad.facts().rows);
                prop_assert!(!lost.to_string().is_empty());
                match replay(&again, &ReplayOptions::default(), &mut |_| {}) {
                    Ok(report) => {
                        prop_assert!(report.identical && report.chain_ok, "{:?}", report);
                        let rows: u64 = report.stretches.iter().map(|of| of.ticks + of.not_run).sum();
                        prop_assert!(again.gaps().is_empty() || rows == again.facts().rows);
                        let missing = lost.ticks.unwrap_or(0) + again.facts().rows;
                        prop_assert!(report.gradable <= (missing == 4_000), "{}", lost);
                    }
                    Err(error) => prop_assert!(!again.gaps().is_empty(), "{}", error),
                }
            }
            Err(RecoverError::Whole(_)) => prop_assert_eq!(bad.facts().rows, 4_000),
            Err(error) => prop_assert!(false, "{}", error),
        }
    }
}
