//! Channels for viewers beside the exact record: what they add, and what they leave alone.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use crate::common::*;
use mcap::records::{Record, op};
use sulcus_sessions::*;

fn replayed(bytes: Vec<u8>) -> ReplayReport {
    let recording = Recording::from_bytes(bytes).unwrap();
    let options = ReplayOptions::default();
    replay(&recording, &options, &mut |_| {}).unwrap()
}

/// Messages by topic, with their times.
fn messages(bytes: &[u8]) -> BTreeMap<String, Vec<u64>> {
    let mut found: BTreeMap<String, Vec<u64>> = BTreeMap::new();
    for message in mcap::MessageStream::new(bytes).unwrap() {
        let message = message.unwrap();
        let topic = message.channel.topic.clone();
        found.entry(topic).or_default().push(message.log_time);
    }
    found
}

#[test]
fn a_grade_does_not_rest_on_them_and_whoever_changes_them_is_found_out() {
    let bytes = recorded_with_views(2000, 0..0);
    let report = replayed(bytes.clone());
    assert!(report.identical && report.gradable, "{report:?}");
    assert_eq!(report.viewers, Viewers::AsSigned);
    assert!(!report.is_finding());
    // An editor that takes them out, or alters them, changes nothing that a grade rests on, and what people see.
    let without = with_messages(&bytes, |topic, _| {
        topic.starts_with("/exact") || topic == "/events"
    });
    let without = replayed(without);
    assert!(without.gradable && without.is_finding());
    assert_eq!(without.viewers, Viewers::Changed);
    let altered = with_messages(&bytes, |topic, data| {
        if topic.starts_with("/tools") {
            data.reverse();
        }
        true
    });
    let altered = replayed(altered);
    assert!(altered.gradable && altered.is_finding());
    assert_eq!(altered.viewers, Viewers::Changed);
}

#[test]
fn whoever_changes_how_they_are_read_is_found_out() {
    let bytes = recorded_with_views(600, 0..0);
    assert_eq!(replayed(bytes.clone()).viewers, Viewers::AsSigned);
    let is_pose = |name: &str| name == "foxglove.PoseInFrame";
    // Under another schema the same bytes say something else: x for y, and nobody touched a message.
    let swapped = |data: &mut Vec<u8>| {
        let at = data
            .windows(10)
            .position(|ten| ten == b"quaternion")
            .unwrap_or(40);
        data[at] ^= 1;
    };
    let mut schema_data = |record: &mut Record<'_>| match record {
        Record::Schema { header, data } if is_pose(&header.name) => swapped(data.to_mut()),
        _ => {}
    };
    let mut schema_name = |record: &mut Record<'_>| match record {
        Record::Schema { header, .. } if is_pose(&header.name) => header.name.push('2'),
        _ => {}
    };
    let mut published = |record: &mut Record<'_>| {
        if let Record::Message { header, .. } = record {
            header.publish_time += 1;
        }
    };
    let mut topic = |record: &mut Record<'_>| match record {
        Record::Channel(channel) if channel.topic == "/tools/rod/haptic" => {
            channel.topic = "/tools/rod/graphic2".to_owned();
        }
        _ => {}
    };
    let edits: [&mut dyn FnMut(&mut Record<'_>); 4] = [
        &mut schema_data,
        &mut schema_name,
        &mut published,
        &mut topic,
    ];
    for (k, edit) in edits.into_iter().enumerate() {
        let report = replayed(with_records(&bytes, edit));
        assert!(report.gradable && report.is_finding(), "{k}: {report:?}");
        assert_eq!(report.viewers, Viewers::Changed, "{k}");
    }
    // Written anew and not changed, by another tool in other chunks, it is what was signed.
    let same = replayed(with_records(&bytes, &mut |_| {}));
    assert_eq!(same.viewers, Viewers::AsSigned);
}

#[test]
fn a_summary_that_says_otherwise_than_the_messages_is_found_out() {
    let bytes = recorded_with_views(600, 0..0);
    let data_end = records_of(&bytes, op::DATA_END)[0].start;
    // Readers that go by the index take schemas and topics from there.
    let mut changed = 0;
    for (opcode, of) in [
        (op::SCHEMA, "foxglove.PoseInFrame"),
        (op::CHANNEL, "/tools/rod/haptic"),
    ] {
        for record in records_of(&bytes, opcode) {
            let found = bytes[record.clone()]
                .windows(of.len())
                .position(|part| part == of.as_bytes());
            let Some(at) = found.filter(|_| record.start > data_end) else {
                continue;
            };
            let mut edited = bytes.clone();
            edited[record.start + at + of.len() - 1] ^= 1;
            let report = replayed(edited);
            assert_eq!(report.viewers, Viewers::Changed, "{of}");
            assert!(report.gradable && report.is_finding(), "{of}");
            changed += 1;
        }
    }
    assert_eq!(changed, 2);
}

#[test]
fn a_damaged_chunk_of_theirs_costs_nobody_the_session() {
    let bytes = recorded_with_views(2000, 0..0);
    let whole = Recording::from_bytes(bytes.clone()).unwrap();
    let chunk = view_chunks(&bytes)[0].clone();
    let mut bad = bytes.clone();
    // The middle of its packed bytes.
    bad[chunk.start + chunk.len() / 2] ^= 0x10;
    let recording = Recording::from_bytes(bad.clone()).unwrap();
    assert_eq!(recording.facts().rows, whole.facts().rows);
    assert_eq!(recording.facts().damaged_views, 1);
    let said = info(std::path::Path::new("x.mcap"), &recording).unwrap();
    assert!(said.is_finding() && said.damaged_views == 1, "{said}");
    let report = replayed(bad.clone());
    assert!(report.gradable && report.is_finding(), "{report:?}");
    assert_eq!(report.viewers, Viewers::Changed);
    // Torn as well, all of the exact record up to the tear is recovered.
    let tear = records_of(&bytes, op::CHUNK).last().unwrap().start + 100;
    let torn = Recording::from_bytes(bad[..tear].to_vec()).unwrap();
    assert_eq!(torn.facts().damaged_views, 1);
    let (copy, _) = recover_to(&torn, Vec::new(), &mut |_| {}).unwrap();
    let copy = Recording::from_bytes(copy).unwrap();
    assert_eq!(copy.facts().rows, torn.facts().rows);
    assert_eq!(copy.facts().damaged_views, 0);
}

#[test]
fn rates_hold_over_ticks_that_were_missed() {
    let bytes = recorded_with_views(1600, 500..700);
    let found = messages(&bytes);
    let frames = found["/tools/rod/haptic"].len();
    // Every sixteenth of 1600 ticks, and the first; a hole of 200 takes twelve or thirteen.
    assert!((88..=90).contains(&frames), "{frames}");
    let wrenches = found["/tools/rod/wrench"].len();
    assert!((175..=178).contains(&wrenches), "{wrenches}");
    // The hash over what viewers read is in the signed log alone.
    assert_eq!(found["/log"].len() + 1, found["/events"].len());
    // Nothing here yields: what rests is shown once.
    assert_eq!(found["/objects/balls/spheres"], [BEGAN]);
    assert_eq!(found["/tools/rod/spheres"], [BEGAN]);
    let rows: Vec<u64> = found["/exact/ticks"].clone();
    for (topic, times) in &found {
        let there = |time: &u64| *time == BEGAN || rows.binary_search(time).is_ok();
        assert!(times.iter().all(there), "{topic}");
    }
}

#[test]
fn exact_and_other_messages_never_share_a_chunk() {
    let bytes = recorded_with_views(3000, 0..0);
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let mut kinds = [0; 2];
    for chunk in &summary.chunk_indexes {
        let topics: Vec<bool> = summary
            .stream_chunk(&bytes, chunk)
            .unwrap()
            .map(|message| message.unwrap().channel.topic.clone())
            .map(|topic| topic.starts_with("/exact") || topic == "/events")
            .collect();
        assert!(topics.windows(2).all(|pair| pair[0] == pair[1]));
        if let Some(exact) = topics.first() {
            kinds[usize::from(*exact)] += 1;
        }
    }
    // Every 100 ms and every 500 ms.
    assert!(
        kinds[1] >= 30 && (6..kinds[1]).contains(&kinds[0]),
        "{kinds:?}"
    );
}

#[test]
fn info_says_where_every_byte_is() {
    let bytes = recorded_with_views(3000, 0..0);
    let recording = Recording::from_bytes(bytes.clone()).unwrap();
    let info = info(std::path::Path::new("x.mcap"), &recording).unwrap();
    let sizes = &info.sizes;
    let sum = sizes.header_bytes as f64 + sizes.exact_bytes + sizes.view_bytes + sizes.rest_bytes;
    assert!(
        (sum - bytes.len() as f64).abs() < 1e-3,
        "{sum} of {}",
        bytes.len()
    );
    let found = messages(&bytes);
    for channel in &sizes.channels {
        let there = found.get(&channel.topic).map_or(0, Vec::len);
        assert_eq!(channel.messages, there as u64, "{}", channel.topic);
        let exact = channel.topic.starts_with("/exact") || channel.topic == "/events";
        assert_eq!(channel.exact, exact);
    }
    assert!(
        found
            .keys()
            .all(|topic| sizes.channels.iter().any(|of| of.topic == *topic))
    );
    let rows = sizes
        .channels
        .iter()
        .find(|of| of.topic == "/exact/ticks")
        .unwrap();
    // With the key and the length of the field of bytes.
    assert_eq!(rows.message_bytes, 3000 * (Row::BYTES as u64 + 3));
    // One hand, no tissue.
    let exact = sizes.exact_mb_per_minute.unwrap();
    assert!(exact > 1.0 && exact < 9.0, "{exact}");
    let text = info.to_string();
    for words in [
        "exact ",
        "viewers ",
        "foxglove.PoseInFrame",
        "per station hour",
    ] {
        assert!(text.contains(words), "{words} in {text}");
    }
}
