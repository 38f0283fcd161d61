//! Every channel of a recording decodes by the schema in the file alone, and the exact bytes are what counts, however the message
//! around them is encoded.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use mcap::records::Record;
use prost_reflect::{DescriptorPool, DynamicMessage, Value};
use sulcus_sessions::*;

use crate::common::*;

fn replayed(bytes: Vec<u8>) -> ReplayReport {
    let recording = Recording::from_bytes(bytes).unwrap();
    replay(&recording, &ReplayOptions::default(), &mut |_| {}).unwrap()
}

/// A session with all channels, a signature in the middle and a snapshot.
fn session() -> Vec<u8> {
    recorded_with_views(10_200, 0..0)
}

#[test]
fn every_message_decodes_by_the_schema_in_the_file() {
    let bytes = session();
    let mut pools: BTreeMap<String, DescriptorPool> = BTreeMap::new();
    let mut exact: BTreeMap<String, Vec<Vec<u8>>> = BTreeMap::new();
    let mut topics: BTreeMap<String, u64> = BTreeMap::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let (channel, topic) = (&message.channel, message.channel.topic.clone());
        assert_eq!(channel.message_encoding, "protobuf", "{topic}");
        let schema = channel.schema.as_ref().unwrap();
        assert_eq!(schema.encoding, "protobuf", "{topic}");
        let pool = pools
            .entry(schema.name.clone())
            .or_insert_with(|| DescriptorPool::decode(&schema.data[..]).unwrap());
        let descriptor = pool.get_message_by_name(&schema.name).unwrap();
        let decoded = DynamicMessage::decode(descriptor, &message.data[..]).unwrap();
        assert_eq!(decoded.unknown_fields().count(), 0, "{topic}");
        *topics.entry(topic.clone()).or_default() += 1;
        if topic.starts_with("/exact") || topic == "/events" {
            let Value::Bytes(inner) = decoded.get_field_by_number(1).unwrap().into_owned() else {
                panic!("{topic}: field 1 is no field of bytes");
            };
            exact.entry(topic).or_default().push(inner.to_vec());
        }
    }
    // All that `info` counts.
    let recording = Recording::from_bytes(bytes.clone()).unwrap();
    let info = info(std::path::Path::new("x.mcap"), &recording).unwrap();
    for channel in &info.sizes.channels {
        let found = topics.get(&channel.topic).copied().unwrap_or_default();
        assert_eq!(channel.messages, found, "{}", channel.topic);
    }
    // The inner bytes are the rows, and all the others.
    let rows: Vec<Row> = exact["/exact/ticks"]
        .iter()
        .map(|inner| Row::from_bytes(inner).unwrap())
        .collect();
    assert_eq!(rows.len(), 10_200);
    assert!(rows.windows(2).all(|two| two[0].tick + 1 == two[1].tick));
    for inner in &exact["/exact/chain"] {
        let signed = SignedStatement::from_bytes(inner).unwrap();
        assert!(signed.is_signed_by(&key().public()));
    }
    assert_eq!(exact["/exact/chain"].len(), 2);
    let text = String::from_utf8(exact["/events"][0].clone()).unwrap();
    assert!(text.contains("\"level\":\"warning\""), "{text}");
    // The layout of the inner bytes stands in the file.
    let row = std::str::from_utf8(&bytes[..]).is_err();
    assert!(row, "a binary file");
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    for (name, words) in [
        ("sulcus.v1.ExactRow", "xxh3, chained"),
        ("sulcus.v1.ExactState", "sulcus_core::State"),
        ("sulcus.v1.ExactStatement", "ed25519 over"),
        ("sulcus.v1.ExactEvent", "JSON in UTF-8"),
    ] {
        let schema = summary.schemas.values().find(|of| of.name == name).unwrap();
        let said = String::from_utf8_lossy(&schema.data);
        assert!(said.contains(words), "{name}: {said}");
    }
}

/// A way to encode the message around exact bytes.
type Encode<'a> = dyn Fn(&[u8]) -> Vec<u8> + 'a;

/// The recording with every exact message encoded otherwise.
fn encoded(bytes: &[u8], encode: &Encode<'_>) -> Vec<u8> {
    let mut exact = BTreeMap::new();
    with_records(bytes, &mut |record| match record {
        Record::Channel(c) => {
            exact.insert(c.id, is_sealed(&c.topic, &c.message_encoding));
        }
        Record::Message { header, data } if exact[&header.channel_id] => {
            *data = encode(&inner(data)).into();
        }
        _ => {}
    })
}

#[test]
fn another_encoding_of_the_outer_message_changes_nothing() {
    let bytes = session();
    let plain = |inner: &[u8]| sealed(inner);
    let unknown_before = |inner: &[u8]| [&[0x98, 0x06, 0x2a][..], &sealed(inner)].concat();
    let unknown_behind = |inner: &[u8]| [&sealed(inner)[..], &[0x1a, 2, 7, 7]].concat();
    let group = |inner: &[u8]| [&[0x23, 0x08, 1, 0x24][..], &sealed(inner)].concat();
    let long_length = |inner: &[u8]| {
        let n = inner.len();
        let length = [n & 127 | 128, n >> 7 & 127 | 128, n >> 14 & 127 | 128, 0];
        [&[0x0a][..], &length.map(|b| b as u8), inner].concat()
    };
    let twice = |inner: &[u8]| [&[0x0a, 3, 1, 2, 3][..], &sealed(inner)].concat();
    let encodings: [(&str, &Encode<'_>); 6] = [
        ("as it was", &plain),
        ("an unknown field before", &unknown_before),
        ("an unknown field behind", &unknown_behind),
        ("a group", &group),
        ("a length that is not minimal", &long_length),
        ("the field twice, the last counts", &twice),
    ];
    let before = replayed(bytes.clone());
    assert!(before.gradable && matches!(before.signature, Signature::Valid { .. }));
    for (what, encode) in encodings {
        let edited = encoded(&bytes, encode);
        assert!(edited != bytes);
        let after = replayed(edited.clone());
        assert_eq!(after.signature, before.signature, "{what}");
        assert!(
            after.identical && after.gradable && after.chain_ok && !after.is_finding(),
            "{what}: {after:?}"
        );
        assert_eq!(after.viewers, Viewers::AsSigned, "{what}");
    }
    // What is inside is what is signed.
    let changed = |inner: &[u8]| {
        let mut inner = inner.to_vec();
        if inner.len() == Row::BYTES && inner[..8] == 77_u64.to_le_bytes() {
            inner[31] ^= 4;
        }
        sealed(&inner)
    };
    let report = replayed(encoded(&bytes, &changed));
    assert_eq!(report.first_divergent_tick, Some(77));
    assert!(matches!(report.signature, Signature::Invalid { .. }));
    // What is no message, or has no exact bytes in it, is damage.
    for broken in [&[][..], &[0x0a, 200], &[0x12, 1, 1]] {
        let error = Recording::from_bytes(encoded(&bytes, &|_| broken.to_vec())).unwrap_err();
        assert!(error.to_string().contains("cannot be decoded"), "{error}");
    }
}

#[test]
fn a_recording_with_bare_messages_reads_as_one_with_protobuf_around_them() {
    // As version 4 wrote it; and its channels may not name an encoding that never was.
    let bytes = session();
    let bare = |encodings: [&'static str; 4]| {
        let mut exact = BTreeMap::new();
        with_records(&bytes, &mut |record| match record {
            Record::Channel(c) if is_sealed(&c.topic, &c.message_encoding) => {
                exact.insert(c.id, ());
                c.message_encoding = match c.topic.as_str() {
                    "/exact/ticks" => encodings[0],
                    "/exact/snapshots" => encodings[1],
                    "/exact/chain" => encodings[2],
                    _ => encodings[3],
                }
                .to_owned();
            }
            Record::Message { header, data } if exact.contains_key(&header.channel_id) => {
                *data = inner(data).into();
            }
            _ => {}
        })
    };
    let report = replayed(bare(["sulcus-row", "sulcus-state", "sulcus-chain", "json"]));
    assert!(report.identical && report.gradable, "{report:?}");
    let error = Recording::from_bytes(bare(["cdr", "sulcus-state", "sulcus-chain", "json"]));
    let error = error.unwrap_err().to_string();
    assert!(
        error.contains("channel /exact/ticks has encoding") && error.contains("`cdr`"),
        "{error}"
    );
}
