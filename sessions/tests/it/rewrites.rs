//! A recording that another MCAP tool wrote anew is the same recording, however legal its arrangement, or is refused with the
//! true reason.
#![allow(clippy::unwrap_used)]

use std::io::Cursor;

use mcap::records::{Metadata, Record, op};
use mcap::{Attachment, Compression, WriteOptions};
use sulcus_sessions::*;

use crate::common::*;

/// Where a tool puts attachments and metadata.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    First,
    /// In the middle of the messages.
    Between,
    Last,
}

/// All that a file holds, as a tool reads it.
#[derive(Default)]
struct Held {
    attachments: Vec<Attachment<'static>>,
    metadata: Vec<Metadata>,
    /// Schemas, channels and messages.
    data: Vec<Record<'static>>,
}

fn held(bytes: &[u8]) -> Held {
    let mut held = Held::default();
    for record in mcap::read::ChunkFlattener::new(bytes).unwrap() {
        match record.unwrap().into_owned() {
            Record::Attachment { header, data, .. } => held.attachments.push(Attachment {
                log_time: header.log_time,
                create_time: header.create_time,
                name: header.name,
                media_type: header.media_type,
                data,
            }),
            Record::Metadata(metadata) => held.metadata.push(metadata),
            Record::DataEnd(_) => break,
            record @ (Record::Schema { .. } | Record::Channel(_) | Record::Message { .. }) => {
                held.data.push(record);
            }
            _ => {}
        }
    }
    held
}

type Writer<'a> = mcap::Writer<Cursor<&'a mut Vec<u8>>>;

fn put(writer: &mut Writer<'_>, record: &Record<'_>) {
    match record {
        Record::Schema { header, data } => {
            writer
                .add_schema_with_id(header.id, &header.name, &header.encoding, data)
                .unwrap();
        }
        Record::Channel(c) => {
            writer
                .add_channel_with_id(
                    c.id,
                    c.schema_id,
                    &c.topic,
                    &c.message_encoding,
                    &c.metadata,
                )
                .unwrap();
        }
        Record::Message { header, data } => writer.write_to_known_channel(header, data).unwrap(),
        _ => unreachable!(),
    }
}

impl Held {
    fn written(&self, options: WriteOptions, attachments: Place, metadata: Place) -> Vec<u8> {
        let mut out = Vec::new();
        let mut writer = options.create(Cursor::new(&mut out)).unwrap();
        let (first, second) = self.data.split_at(self.data.len() / 2);
        for (place, data) in [
            (Place::First, first),
            (Place::Between, second),
            (Place::Last, &[]),
        ] {
            if metadata == place {
                for metadata in &self.metadata {
                    writer.write_metadata(metadata).unwrap();
                }
            }
            if attachments == place {
                for attachment in &self.attachments {
                    writer.attach(attachment).unwrap();
                }
            }
            for record in data {
                put(&mut writer, record);
            }
        }
        writer.finish().unwrap();
        drop(writer);
        out
    }
}

fn options() -> WriteOptions {
    WriteOptions::new().library("another tool")
}

/// Every way of writing that the crate has.
fn ways() -> Vec<(&'static str, WriteOptions, Place, Place)> {
    use Place::{Between, First, Last};
    let lz4 = Some(Compression::Lz4);
    vec![
        ("as it was", options(), First, First),
        (
            "uncompressed chunks",
            options().compression(None),
            First,
            First,
        ),
        ("lz4", options().compression(lz4), First, First),
        (
            "zstd at its slowest",
            options().compression_level(19),
            First,
            First,
        ),
        ("no chunks", options().use_chunks(false), First, First),
        (
            "no chunks, header last",
            options().use_chunks(false),
            Last,
            Last,
        ),
        (
            "small chunks",
            options().chunk_size(Some(300)),
            First,
            First,
        ),
        ("one chunk", options().chunk_size(None), First, First),
        ("attachments last", options(), Last, First),
        ("metadata last", options(), First, Last),
        ("both last", options(), Last, Last),
        ("both in the middle", options(), Between, Between),
        (
            "attachments last, metadata in the middle",
            options(),
            Last,
            Between,
        ),
        (
            "no summary",
            options()
                .emit_summary_records(false)
                .emit_summary_offsets(false),
            First,
            First,
        ),
        (
            "no summary, header last",
            options()
                .emit_summary_records(false)
                .emit_summary_offsets(false),
            Last,
            Last,
        ),
        (
            "no message index",
            options().emit_message_indexes(false),
            First,
            First,
        ),
        (
            "no chunk index",
            options().emit_chunk_indexes(false),
            First,
            First,
        ),
        (
            "schemas are not repeated",
            options().repeat_schemas(false).repeat_channels(false),
            First,
            First,
        ),
        (
            "no CRC",
            options()
                .calculate_chunk_crcs(false)
                .calculate_data_section_crc(false)
                .calculate_summary_section_crc(false)
                .calculate_attachment_crcs(false),
            First,
            First,
        ),
        (
            "nothing but messages",
            options()
                .use_chunks(false)
                .emit_summary_records(false)
                .emit_summary_offsets(false)
                .emit_message_indexes(false),
            Between,
            First,
        ),
    ]
}

fn replayed(recording: &Recording) -> ReplayReport {
    replay(recording, &ReplayOptions::default(), &mut |_| {}).unwrap()
}

fn messages(recording: &Recording) -> Vec<Message> {
    recording.messages().collect::<Result<_, _>>().unwrap()
}

#[test]
fn every_legal_rewrite_is_the_same_recording() {
    let bytes = recorded_with_views(1500, 300..320);
    let original = Recording::from_bytes(bytes.clone()).unwrap();
    let held = held(&bytes);
    for (way, options, attachments, metadata) in ways() {
        let written = held.written(options, attachments, metadata);
        let recording =
            Recording::from_bytes(written.clone()).unwrap_or_else(|error| panic!("{way}: {error}"));
        assert_eq!(*recording.ending(), Ending::Finished, "{way}");
        assert_eq!(recording.header(), original.header(), "{way}");
        assert_eq!(recording.facts(), original.facts(), "{way}");
        assert!(messages(&recording) == messages(&original), "{way}");
        let report = replayed(&recording);
        assert!(
            report.identical && report.gradable && !report.is_finding(),
            "{way}: {report:?}"
        );
        assert_eq!(report.viewers, Viewers::AsSigned, "{way}");
        let info = info(std::path::Path::new("x.mcap"), &recording).unwrap();
        let sizes = &info.sizes;
        let sum =
            sizes.header_bytes as f64 + sizes.exact_bytes + sizes.view_bytes + sizes.rest_bytes;
        assert!(
            (sum - written.len() as f64).abs() < 1e-3,
            "{way}: {sizes:?}"
        );
        assert!(
            sizes.header_bytes as usize > original.header().scene.len(),
            "{way}"
        );
        let rows = sizes.channels.iter().find(|of| of.topic == "/exact/ticks");
        assert_eq!(rows.unwrap().messages, 1480, "{way}");
        let times = sulcus_sessions::record::times::longest_tick_us(&recording).unwrap();
        assert!(times.len() > 80, "{way}: {}", times.len());
    }
}

#[test]
fn a_grade_of_a_rewrite_is_the_recordings_own() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus");
    let bytes = std::fs::read(folder.join("crown.mcap")).unwrap();
    let golden = std::fs::read_to_string(folder.join("crown.grade.json")).unwrap();
    let golden: serde_json::Value = serde_json::from_str(&golden).unwrap();
    let written = held(&bytes).written(options().use_chunks(false), Place::Last, Place::Last);
    let recording = Recording::from_bytes(written).unwrap();
    let found = grade::grade(&recording, &grade::Options::default(), &mut |_| {}).unwrap();
    assert_eq!(found.grade.to_json()["score"], golden["score"]);
}

#[test]
fn a_tool_that_sorts_by_time_keeps_the_order_of_the_chain() {
    // Lines of the log bear the time of a clock that is ahead of the ticks', or behind it.
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let mut session = Session::begin(&path, key());
    for (k, ahead) in [(300, 40), (300, -40), (300, 3), (300, 0)] {
        session.run(k);
        let now = BEGAN + session.state.tick * 1_000_000;
        let at = now.checked_add_signed(ahead * 1_000_000).unwrap();
        session.recorder.event(at, Level::Info, "said").unwrap();
    }
    session.finish();
    let bytes = std::fs::read(path).unwrap();
    let mut held = held(&bytes);
    let is_message = |record: &Record<'_>| matches!(record, Record::Message { .. });
    let (mut messages, declared): (Vec<_>, Vec<_>) = std::mem::take(&mut held.data)
        .into_iter()
        .partition(is_message);
    messages.sort_by_key(|record| match record {
        Record::Message { header, .. } => header.log_time,
        _ => unreachable!(),
    });
    held.data = declared.into_iter().chain(messages).collect();
    let recording = Recording::from_bytes(held.written(options(), Place::First, Place::First));
    let report = replayed(&recording.unwrap());
    assert!(report.gradable && !report.is_finding(), "{report:?}");
    assert_eq!(report.viewers, Viewers::AsSigned);
}

#[test]
fn torn_and_damaged_rewrites_are_read_as_far_as_they_are_whole() {
    let bytes = recorded_with_views(900, 0..0);
    let held = held(&bytes);
    for options in [
        options().use_chunks(false),
        options().compression(None).chunk_size(Some(2000)),
    ] {
        let written = held.written(options, Place::First, Place::First);
        for part in [3, 5, 7, 8] {
            let torn = Recording::from_bytes(written[..written.len() * part / 9].to_vec()).unwrap();
            assert!(matches!(torn.ending(), Ending::CutOff { .. }));
            let report = replayed(&torn);
            assert!(
                report.identical && report.chain_ok && report.ticks > 100,
                "{report:?}"
            );
            let (whole, _) = recover_to(&torn, Vec::new(), &mut |_| {}).unwrap();
            let again = Recording::from_bytes(whole).unwrap();
            assert_eq!(again.facts(), torn.facts());
        }
    }
    // A header at the end, and the file torn before it: nothing of it is left.
    let written = held.written(options(), Place::Last, Place::First);
    let error = Recording::from_bytes(written[..written.len() / 4].to_vec()).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("there is no attachment `scene.bin` in the readable part"),
        "{error}"
    );
    let options = options().library("sulcus x").chunk_size(Some(2000));
    let written = held.written(options, Place::First, Place::Last);
    let tear = written.len() / 2;
    let error = Recording::from_bytes(written[..tear].to_vec()).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("there is no metadata `sulcus` before byte"),
        "{error}"
    );
}

#[test]
fn what_is_refused_is_refused_with_the_true_reason() {
    let bytes = recorded_with_views(300, 0..0);
    let refused = |held: &Held| {
        let written = held.written(options(), Place::First, Place::First);
        Recording::from_bytes(written).unwrap_err().to_string()
    };
    let mut less = held(&bytes);
    less.attachments
        .retain(|attachment| attachment.name != "patient");
    assert!(refused(&less).ends_with("there is no attachment `patient`"));
    let mut less = held(&bytes);
    less.metadata.clear();
    assert!(refused(&less).starts_with("not a Sulcus recording"));
    let mut more = held(&bytes);
    more.metadata.push(Metadata {
        name: "tool".into(),
        metadata: [("by".to_owned(), "somebody".to_owned())].into(),
    });
    let written = more.written(options(), Place::First, Place::First);
    let error = Recording::from_bytes(written).unwrap_err().to_string();
    assert!(
        error.contains("there is metadata `tool` behind the header"),
        "{error}"
    );

    // What a chunk's header claims: its unpacked length stands behind two times, its compression behind the CRC.
    let chunk = records_of(&bytes, op::CHUNK)[0].start + 9;
    let mut large = bytes.clone();
    large[chunk + 16..chunk + 24].copy_from_slice(&(65_u64 << 20).to_le_bytes());
    let error = Recording::from_bytes(large).unwrap_err().to_string();
    assert!(
        error.contains(
            "a chunk has 68157440 unpacked bytes by its header, expected at most 67108864"
        ),
        "{error}"
    );
    let mut other = bytes.clone();
    assert_eq!(other[chunk + 32..chunk + 36], *b"zstd");
    other[chunk + 32..chunk + 36].copy_from_slice(b"lzma");
    let error = Recording::from_bytes(other).unwrap_err().to_string();
    assert!(
        error.contains("packed with `lzma`, expected `zstd`, `lz4` or no compression"),
        "{error}"
    );
}
