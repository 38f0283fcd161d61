//! Samples of devices: exact, signed, decoded by the schema in the file, exported.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use prost::Message as _;
use prost_reflect::{DescriptorPool, DynamicMessage, Value};
use sulcus_core::{NoProbe, State, TickOutput, Workspace, tick};
use sulcus_sessions::record::channels::v1::{self, ExactRow};
use sulcus_sessions::{
    Absence, Detached, DeviceFacts, DeviceSample, Limits, Message, Occurrence, PlanFacts,
    RecordedTick, Recorder, Recording, ReplayOptions, ReplayReport, Row, SessionEnd, SessionHeader,
    SessionWriter, Signature, info, replay,
};

use crate::common::program::*;
use crate::common::*;

/// Sample of the pose for tick `k`. Every third tick uses the pose of the tick before.
fn sample(k: u64) -> DeviceSample {
    let pose = k - u64::from(k.is_multiple_of(3));
    DeviceSample {
        sequence: pose as u32,
        device_time_ns: pose * 1_000_000 + 17,
        age_us: 300,
        displayed: [0.0, -0.0, 0.25 + pose as f32 * 1e-3, 0.0, -0.01, 0.0],
    }
}

fn facts(header: &mut SessionHeader) {
    header.devices = vec![DeviceFacts {
        tool: 0,
        name: "bench stylus".into(),
        period_ns: 1_000_000,
        workspace_scale: 0.8,
        max_force_n: 3.3,
        max_torque_nm: 0.0,
        force_dof: 3,
        ..DeviceFacts::default()
    }];
    header.limits = Some(Limits {
        max_force_n: 3.0,
        max_torque_nm: 0.2,
        max_force_step_n: 0.5,
        max_torque_step_nm: 0.03,
    });
    header.plan = Some(PlanFacts {
        name: "monday".into(),
        revision: "4".into(),
        resume_within_s: 30.0,
        clock_runs_in_gaps: false,
        changed: None,
    });
    header.attach_epoch = Some(2);
}

/// A session of `ticks` ticks by the writer of live sessions, with a gap of the connection at its end.
fn recorded(ticks: u64) -> Vec<u8> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("session.mcap");
    let scene = scene();
    let mut header = header(&scene);
    facts(&mut header);
    let recorder = Recorder::create(&path, &header, key()).unwrap();
    let (mut state, mut shapes) = (State::new(&scene), Workspace::new(&scene));
    let mut writer =
        SessionWriter::begin(recorder, &scene, BEGAN, &state.to_bytes(), None).unwrap();
    for k in 1..=ticks {
        let input = input(k);
        let output: TickOutput = tick(&scene, &mut state, &mut shapes, &input, &mut NoProbe);
        let row = Row::new(BEGAN + k * 1_000_000, &input, &output);
        let row = row.with_device([Some(sample(k)), None]);
        let gone = (k + 5 == ticks).then(|| Occurrence::detached(k, Detached::ConnectionLost));
        let back = (k + 2 == ticks).then(|| Occurrence::attached(k, 3, 3));
        let tick = RecordedTick {
            row: &row,
            output: &output,
            cpu_ns: 1000,
            shapes: None,
        };
        writer
            .tick(&scene, &tick, gone.into_iter().chain(back))
            .unwrap();
    }
    let end = SessionEnd {
        ticks,
        ..SessionEnd::default()
    };
    writer.finish(end).unwrap();
    std::fs::read(path).unwrap()
}

fn replayed(bytes: Vec<u8>) -> ReplayReport {
    let recording = Recording::from_bytes(bytes).unwrap();
    replay(&recording, &ReplayOptions::default(), &mut |_| {}).unwrap()
}

fn samples(bytes: &[u8]) -> Vec<(u64, DeviceSample)> {
    let recording = Recording::from_bytes(bytes.to_vec()).unwrap();
    let rows = recording.messages().filter_map(|message| match message {
        Ok(Message::Row(row)) => Some((row.tick, row.device[0]?)),
        _ => None,
    });
    rows.collect()
}

#[test]
fn every_pose_is_recorded_once_with_what_the_hand_felt() {
    let bytes = recorded(300);
    let found = samples(&bytes);
    // The third tick of three has no new pose.
    assert_eq!(found.len(), 200);
    for (k, found) in &found {
        assert!(!k.is_multiple_of(3), "{k}");
        assert_eq!(*found, sample(*k));
    }
    let report = replayed(bytes.clone());
    assert!(
        report.identical && report.gradable && !report.is_finding(),
        "{report:?}"
    );
    let recording = Recording::from_bytes(bytes).unwrap();
    assert_eq!(recording.format(), 7);
    let told = info(Path::new("x.mcap"), &recording).unwrap();
    assert_eq!(told.device_samples, 200);
    assert_eq!(
        told.absences,
        [Absence {
            from: 295,
            to: Some(298)
        }]
    );
    assert_eq!(told.attach_epoch, Some(2));
    let text = told.to_string();
    for words in [
        "device     tool 0: bench stylus, 1000 Hz, workspace scale 0.8, up to 3.3 N",
        "samples    200 poses",
        "limits     3 N, 0.2 N m",
        "plan       monday, revision 4",
        "gap        ticks 295 to 297",
    ] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

/// The recording with the samples of every row changed, and encoded anew.
fn changed(bytes: &[u8], change: &dyn Fn(&mut ExactRow)) -> Vec<u8> {
    let mut ticks = None;
    with_records(bytes, &mut |record| match record {
        mcap::records::Record::Channel(c) if c.topic == "/exact/ticks" => ticks = Some(c.id),
        mcap::records::Record::Message { header, data } if Some(header.channel_id) == ticks => {
            let mut row = ExactRow::decode(&data[..]).unwrap();
            change(&mut row);
            *data = row.encode_to_vec().into();
        }
        _ => {}
    })
}

#[test]
fn no_sample_can_be_changed_left_out_or_added_unseen() {
    let bytes = recorded(100);
    let of = |tick: u64| move |row: &ExactRow| row.row[..8] == tick.to_le_bytes();
    assert!(replayed(changed(&bytes, &|_| {})).gradable);
    let edits: [&dyn Fn(&mut ExactRow); 6] = [
        &|row| {
            if of(50)(row) {
                row.samples.clear();
            }
        },
        &|row| {
            if of(51)(row) {
                row.samples.push(added());
            }
        },
        &|row| {
            if of(50)(row) {
                row.samples[0].age_us += 1;
            }
        },
        &|row| {
            if of(50)(row) {
                row.samples[0].sequence ^= 1 << 31;
            }
        },
        &|row| {
            if of(50)(row) {
                row.samples[0].device_time_ns += 1;
            }
        },
        &|row| {
            if of(50)(row) {
                row.samples[0].force_n[2] = 0.1;
            }
        },
    ];
    for (k, edit) in edits.into_iter().enumerate() {
        let report = replayed(changed(&bytes, edit));
        // The replay does not need a sample; the signature covers it.
        assert!(report.identical && !report.chain_ok, "{k}: {report:?}");
        assert!(matches!(report.signature, Signature::Invalid { .. }), "{k}");
        assert!(!report.gradable, "{k}");
    }
    // A sample of half a wrench, of no tool, or a second one is damage.
    let broken: [&dyn Fn(&mut ExactRow); 3] = [
        &|row| row.samples.iter_mut().for_each(|of| of.torque_nm.clear()),
        &|row| row.samples.iter_mut().for_each(|of| of.tool = 2),
        &|row| row.samples.extend(row.samples.clone()),
    ];
    for edit in broken {
        let error = Recording::from_bytes(changed(&bytes, edit)).unwrap_err();
        assert!(error.to_string().contains("cannot be decoded"), "{error}");
    }
}

/// A sample as a forger would add it.
fn added() -> v1::DeviceSample {
    v1::DeviceSample {
        force_n: vec![0.0; 3],
        torque_nm: vec![0.0; 3],
        ..v1::DeviceSample::default()
    }
}

#[test]
fn a_stock_decoder_reads_the_fields_and_may_write_them_anew() {
    let bytes = recorded(30);
    let mut seen = 0;
    let mut pool = None;
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        if message.channel.topic != "/exact/ticks" {
            continue;
        }
        let schema = message.channel.schema.as_ref().unwrap();
        let pool = pool.get_or_insert_with(|| DescriptorPool::decode(&schema.data[..]).unwrap());
        let of = pool.get_message_by_name("sulcus.v1.ExactRow").unwrap();
        let decoded = DynamicMessage::decode(of, &message.data[..]).unwrap();
        assert_eq!(decoded.unknown_fields().count(), 0);
        let row = decoded.get_field_by_name("row").unwrap().into_owned();
        let row = row.as_bytes().unwrap().to_vec();
        let tick = u64::from_le_bytes(row[..8].try_into().unwrap());
        let Value::List(list) = decoded.get_field_by_name("samples").unwrap().into_owned() else {
            panic!("samples are no list");
        };
        for one in list {
            let Value::Message(one) = one else {
                panic!("no message")
            };
            let field = |name: &str| one.get_field_by_name(name).unwrap().into_owned();
            let z = sample(tick).displayed[2];
            let force = [0.0, 0.0, z].map(Value::F32).to_vec();
            assert_eq!(field("force_n"), Value::List(force));
            assert_eq!(field("age_us"), Value::U32(300));
            seen += 1;
        }
    }
    assert_eq!(seen, 20);
    // Another encoder keeps zeros with their sign, or adds fields: the same recording.
    let again = changed(&bytes, &|row| {
        for sample in &mut row.samples {
            sample.force_n[0] = -0.0;
        }
    });
    assert!(again != bytes);
    assert!(replayed(again).gradable);
}

#[test]
fn the_samples_are_exported_as_a_table() {
    let dir = tempfile::tempdir().unwrap();
    let (path, out) = (dir.path().join("a.mcap"), dir.path().join("out"));
    std::fs::write(&path, recorded(60)).unwrap();
    let output = run(&["export", text_of(&path), "--out", text_of(&out), "--json"]);
    assert_eq!((code(&output), err(&output).as_str()), (0, ""));
    assert_eq!(json_of(&output)["device_lines"], 40);
    let table = std::fs::read_to_string(out.join("devices.csv")).unwrap();
    let mut lines = table.lines();
    assert!(
        lines
            .next()
            .unwrap()
            .starts_with("tick,time_s,tool,name,sequence,")
    );
    assert_eq!(
        lines.next(),
        Some("1,0,0,rod,1,1000017,300,0,0,0.251,0,-0.01,0")
    );
    assert_eq!(lines.count(), 39);
    // A recording without samples has no such table.
    let (plain, none) = (dir.path().join("b.mcap"), dir.path().join("none"));
    record(&plain, 50);
    let output = run(&["export", text_of(&plain), "--out", text_of(&none)]);
    assert_eq!(code(&output), 0);
    assert!(!none.join("devices.csv").exists() && none.join("ticks.csv").exists());
}

#[test]
fn the_facts_of_the_header_are_signed() {
    let bytes = recorded(50);
    for key in ["devices", "limits", "plan", "attach_epoch"] {
        let forged = rewritten(
            &bytes,
            &mut Edit {
                message: &mut |_, _| true,
                metadata: &mut |pairs| {
                    pairs.remove(key).expect("it is there");
                },
                attachment: &mut |_, _| {},
            },
        );
        let report = replayed(forged);
        assert!(
            matches!(report.signature, Signature::Invalid { .. }),
            "{key}"
        );
    }
    let broken = rewritten(
        &bytes,
        &mut Edit {
            message: &mut |_, _| true,
            metadata: &mut |pairs| {
                pairs.insert("plan".to_owned(), "[]".to_owned());
            },
            attachment: &mut |_, _| {},
        },
    );
    let error = Recording::from_bytes(broken).unwrap_err().to_string();
    assert!(error.contains("field `plan`"), "{error}");
}

#[test]
fn a_header_that_no_reader_would_take_is_not_written() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.mcap");
    let mut header = header(&scene());
    facts(&mut header);
    header.devices[0].workspace_scale = f64::NAN;
    let error = Recorder::create(&path, &header, key()).err().unwrap();
    assert_eq!(
        error.to_string(),
        "recording's header: device workspace_scale is NaN, expected a finite number above 0"
    );
    assert!(!path.exists());
}
