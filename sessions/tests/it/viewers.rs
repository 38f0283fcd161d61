//! Channels for viewers on demand: made again from the exact record, they are those of a live recording, byte for byte.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use mcap::records::Record;
use sulcus_core::{NoProbe, State, TickInput, Workspace, tick};
use sulcus_sessions::record::times::longest_tick_us;
use sulcus_sessions::*;

use crate::common::program::{code, err, json_of, out, run, text_of};
use crate::common::{BEGAN, Edit, key, rewritten};

/// Topic of the channel that every recording has.
const KEPT: &str = "/session/metrics";

/// Two recordings of one session, and the folder with them.
struct Both {
    folder: tempfile::TempDir,
    recorded: PathBuf,
    on_demand: PathBuf,
}

/// Session with the motion of a recording of the corpus, written by both policies at once. A pause, events of the
/// network between ticks, skipped ticks, and late shapes that the recorder does not get are part of it.
fn both(name: &str) -> Both {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus");
    let motion = Recording::open(&corpus.join(format!("{name}.mcap"))).unwrap();
    let scene = motion.scene().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (recorded, on_demand) = (path("recorded.mcap"), path("on-demand.mcap"));
    let state = State::new(&scene);
    let mut writers = [
        (&recorded, ViewersPolicy::Recorded),
        (&on_demand, ViewersPolicy::OnDemand),
    ]
    .map(|(path, viewers)| {
        let header = SessionHeader {
            started_unix_ns: BEGAN,
            viewers,
            ..motion.header().clone()
        };
        let recorder = Recorder::create(path, &header, key()).unwrap();
        let opening = Some("client 0.1.0 with device simulated hand");
        let mut writer =
            SessionWriter::begin(recorder, &scene, BEGAN, &state.to_bytes(), opening).unwrap();
        let said = "before the first tick";
        writer.event(BEGAN + 77, Level::Info, said).unwrap();
        writer.flush().unwrap();
        writer
    });
    run_both(&motion, &scene, state, &mut writers);
    let end = |writer: &SessionWriter| SessionEnd {
        ticks: writer.rows(),
        ..SessionEnd::default()
    };
    for mut writer in writers {
        let said = "the session has ended";
        writer.event(BEGAN + (1 << 40), Level::Info, said).unwrap();
        let end = end(&writer);
        writer.finish(end).unwrap();
    }
    Both {
        recorded,
        on_demand,
        folder,
    }
}

fn run_both(
    motion: &Recording,
    scene: &sulcus_core::Scene,
    mut state: State,
    writers: &mut [SessionWriter; 2],
) {
    let mut workspace = Workspace::new(scene);
    let (mut sampler, mut shapes) = (writers[0].sampler(), Shapes::new(scene));
    let (mut skipped, mut copies) = (0, 0);
    let inputs: Vec<TickInput> = motion
        .messages()
        .filter_map(|message| match message.unwrap() {
            Message::Row(row) => Some(row.input),
            _ => None,
        })
        .collect();
    for (k, input) in inputs.iter().enumerate() {
        // The grid goes on while ticks are missed.
        if k % 300 == 299 || k % 300 == 298 {
            skipped += 1;
            continue;
        }
        let input = TickInput {
            skipped: std::mem::take(&mut skipped),
            paused: (400..450).contains(&k),
            ..*input
        };
        let output = tick(scene, &mut state, &mut workspace, &input, &mut NoProbe);
        let now = BEGAN + output.tick * scene.params.tick_ns() + 13;
        let row = Row::new(now, &input, &output);
        let due = sampler.is_due(output.tick);
        if due {
            sampler.read(output.tick, &workspace, &mut shapes);
            copies += 1;
        }
        let paused = k == 400 || k == 450;
        let occurrences = paused.then(|| Occurrence {
            kind: if k == 400 { "paused" } else { "resumed" }.into(),
            tick: output.tick,
            data: serde_json::json!({ "by": "station" }),
        });
        for writer in &mut *writers {
            let recorded = RecordedTick {
                row: &row,
                output: &output,
                // A number that no replay knows.
                cpu_ns: 50_000 + (k as u32).wrapping_mul(2_654_435_761) % 400_000,
                // Every seventh copy came late: its buffer was not free.
                shapes: (due && copies % 7 != 3).then_some(&shapes),
            };
            writer.tick(scene, &recorded, occurrences.clone()).unwrap();
            if k % 100 == 50 {
                let said = format!("reading-called at tick {}: {{}}", output.tick);
                writer.event(now + 4242, Level::Info, &said).unwrap();
            }
            if k % 500 == 499 {
                let state = state.to_bytes();
                writer.snapshot(now, output.tick, &state).unwrap();
            }
        }
    }
}

/// Messages of a file by topic: schema, sequence, log time, publication time, bytes.
type Messages = BTreeMap<String, Vec<(Vec<u8>, u32, u64, u64, Vec<u8>)>>;

fn messages(file: &Path, wanted: impl Fn(&str) -> bool) -> Messages {
    let bytes = std::fs::read(file).unwrap();
    let mut found = Messages::new();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let topic = &message.channel.topic;
        if wanted(topic) {
            let schema = message.channel.schema.as_ref().unwrap();
            let schema = [schema.name.as_bytes(), b" ", &schema.data].concat();
            found.entry(topic.clone()).or_default().push((
                schema,
                message.sequence,
                message.log_time,
                message.publish_time,
                message.data.to_vec(),
            ));
        }
    }
    found
}

fn is_exact(topic: &str) -> bool {
    topic.starts_with("/exact") || topic == "/events"
}

fn made(both: &Both) -> PathBuf {
    let out = both.folder.path().join("made.mcap");
    let recording = Recording::open(&both.on_demand).unwrap();
    let told = with_viewers(&recording, &out, &mut |_| {}).unwrap();
    assert_eq!(told.bytes, Some(std::fs::metadata(&out).unwrap().len()));
    out
}

#[test]
fn made_channels_are_those_of_a_live_recording_byte_for_byte() {
    for name in ["retraction", "bimanual", "probing"] {
        let both = both(name);
        let made = made(&both);
        let live = messages(&both.recorded, |topic| !is_exact(topic));
        let again = messages(&made, |topic| !is_exact(topic));
        let kinds = |all: &Messages| all.keys().cloned().collect::<Vec<_>>();
        assert_eq!(kinds(&live), kinds(&again), "{name}");
        for (topic, live) in &live {
            assert!(*live == again[topic], "{name}: {topic} differs");
        }
        let count = |topic: &str| live.get(topic).map_or(0, Vec::len);
        assert!(count("/log") > 5, "{name}: {:?}", kinds(&live));
        let moved = live
            .iter()
            .any(|(topic, messages)| topic.starts_with("/objects/") && messages.len() > 1);
        let touched = live.keys().any(|topic| topic.ends_with("/contacts"));
        assert!(moved && touched, "{name}: {:?}", kinds(&live));
        // The exact record is that of the original, message for message.
        let original = messages(&both.on_demand, is_exact);
        assert!(original == messages(&made, is_exact), "{name}");
        let kept = messages(&both.on_demand, |topic| !is_exact(topic));
        assert_eq!(kinds(&kept), [KEPT], "{name}");
        assert!(kept[KEPT] == live[KEPT], "{name}");
    }
}

#[test]
fn signatures_replay_and_tick_times_hold_with_and_without_the_channels() {
    let both = both("retraction");
    let made = made(&both);
    let mut times = Vec::new();
    for (file, viewers) in [
        (&both.recorded, Viewers::AsSigned),
        (&both.on_demand, Viewers::OnDemand),
        (&made, Viewers::AsSigned),
    ] {
        let recording = Recording::open(file).unwrap();
        assert_eq!(*recording.ending(), Ending::Finished);
        let verdict = verify(&recording, Some(&key().public())).unwrap();
        assert!(verdict.chain_ok && matches!(verdict.signature, Signature::Valid { .. }));
        let report = replay(&recording, &ReplayOptions::default(), &mut |_| {}).unwrap();
        assert!(
            report.identical && report.gradable && !report.is_finding(),
            "{report:?}"
        );
        assert_eq!(report.viewers, viewers);
        let info = info(file, &recording).unwrap();
        assert!(info.viewers == viewers && !info.is_finding());
        times.push(longest_tick_us(&recording).unwrap());
        // A comparison needs no channels in the file.
        let compared = compare_viewers(&recording, &mut |_| {}).unwrap();
        assert_eq!(compared.out, None);
        assert_eq!(compared.ticks, recording.facts().rows);
    }
    assert!(times[0].len() > 20 && times[0] == times[1] && times[0] == times[2]);
    let headers = [&both.on_demand, &made].map(|file| Recording::open(file).unwrap());
    assert_eq!(headers[0].header(), headers[1].header());
    assert_eq!(headers[0].facts(), headers[1].facts());
}

#[test]
fn a_recording_on_demand_has_a_small_part_of_the_messages_and_bytes() {
    let both = both("bimanual");
    let part = |file: &Path| {
        let sizes = info(file, &Recording::open(file).unwrap()).unwrap().sizes;
        let views = sizes.channels.iter().filter(|of| !of.exact);
        let (messages, bytes) = views.fold((0, 0), |sum, of| {
            (sum.0 + of.messages, sum.1 + of.message_bytes)
        });
        let exact = sizes.channels.iter().filter(|of| of.exact);
        let exact = exact.fold(0, |sum, of| sum + of.message_bytes);
        (messages, bytes, sizes.view_bytes, exact)
    };
    let (live, kept) = (part(&both.recorded), part(&both.on_demand));
    assert!(kept.0 * 10 < live.0, "messages: {kept:?} of {live:?}");
    assert!(kept.1 * 50 < live.1, "bytes: {kept:?} of {live:?}");
    assert!(kept.2 * 10.0 < live.2, "stored: {kept:?} of {live:?}");
    // The exact records differ by the length of the last line alone.
    assert!(kept.3.abs_diff(live.3) < 200, "{kept:?} {live:?}");
}

#[test]
fn a_recording_with_channels_or_without_its_end_is_refused() {
    let both = both("retraction");
    let out = both.folder.path().join("out.mcap");
    let refused = |file: &Path, words: &[&str]| {
        let recording = Recording::open(file).unwrap();
        let error = with_viewers(&recording, &out, &mut |_| {}).unwrap_err();
        for word in words {
            assert!(error.to_string().contains(word), "{word}: {error}");
        }
        assert!(!out.exists(), "{error}");
    };
    refused(&both.recorded, &["are in the recording", "`on-demand`"]);
    let made = made(&both);
    refused(&made, &["are in the recording"]);
    let bytes = std::fs::read(&both.on_demand).unwrap();
    let written = |bytes: &[u8]| {
        let file = both.folder.path().join("changed.mcap");
        std::fs::write(&file, bytes).unwrap();
        file
    };
    let torn = written(&bytes[..bytes.len() * 3 / 4]);
    refused(&torn, &["cut off", "expected a finished one"]);
    let edited = |change: &mut dyn FnMut(&str, &mut Vec<u8>) -> bool| {
        rewritten(
            &bytes,
            &mut Edit {
                message: change,
                metadata: &mut |_| {},
                attachment: &mut |_, _| {},
            },
        )
    };
    let mut rows = 0;
    let row = edited(&mut |topic, bytes| {
        rows += usize::from(topic == "/exact/ticks");
        // A wrench of one row.
        if topic == "/exact/ticks" && rows == 500 {
            bytes[100] ^= 1;
        }
        true
    });
    refused(
        &written(&row),
        &["signature is invalid", "differs from the signed"],
    );
    let kept = edited(&mut |topic, bytes| {
        if topic == KEPT {
            let last = bytes.len() - 1;
            bytes[last] ^= 1;
        }
        true
    });
    refused(&written(&kept), &["differ from the signed hash"]);
    let without = edited(&mut |topic, _| topic != KEPT);
    refused(&written(&without), &["differ from the signed hash"]);
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus");
    refused(
        &corpus.join("crown.mcap"),
        &["format 4", "expected format 7"],
    );
    let there = both.on_demand.clone();
    let recording = Recording::open(&there).unwrap();
    let error = with_viewers(&recording, &made, &mut |_| {}).unwrap_err();
    assert!(error.to_string().contains("made.mcap"), "{error}");
    assert!(made.exists());
}

/// A station that signs rows which the tick does not give: the signature is valid, and the replay differs.
#[test]
fn a_replay_that_differs_is_named_with_its_tick_and_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let (file, made) = (folder.path().join("a.mcap"), folder.path().join("b.mcap"));
    let scene = crate::common::scene();
    let header = SessionHeader {
        viewers: ViewersPolicy::OnDemand,
        ..crate::common::header(&scene)
    };
    let recorder = Recorder::create(&file, &header, key()).unwrap();
    let (mut state, mut workspace) = (State::new(&scene), Workspace::new(&scene));
    let mut writer =
        SessionWriter::begin(recorder, &scene, BEGAN, &state.to_bytes(), None).unwrap();
    for k in 0..100 {
        let input = crate::common::input(k);
        let output = tick(&scene, &mut state, &mut workspace, &input, &mut NoProbe);
        let mut row = Row::new(BEGAN + output.tick * 1_000_000, &input, &output);
        if output.tick == 60 {
            row.wrench[0][0] += 1.0;
        }
        let recorded = RecordedTick {
            row: &row,
            output: &output,
            cpu_ns: 1000,
            shapes: None,
        };
        writer.tick(&scene, &recorded, None).unwrap();
    }
    let end = SessionEnd {
        ticks: 100,
        ..SessionEnd::default()
    };
    writer.finish(end).unwrap();
    let recording = Recording::open(&file).unwrap();
    for error in [
        with_viewers(&recording, &made, &mut |_| {}).unwrap_err(),
        compare_viewers(&recording, &mut |_| {}).unwrap_err(),
    ] {
        let said = error.to_string();
        assert!(
            said.contains("replay differs from the record at tick 60"),
            "{said}"
        );
        assert!(error.is_finding() && !made.exists());
    }
}

#[test]
fn the_command_makes_compares_and_refuses() {
    let both = both("retraction");
    let made = both.folder.path().join("made.mcap");
    let (file, to) = (text_of(&both.on_demand), text_of(&made));
    let info = run(&["info", file, "--json"]);
    assert_eq!(json_of(&info)["viewers"], "on_demand");
    assert_eq!(json_of(&info)["viewers_policy"], "on-demand");
    assert!(out(&run(&["info", file])).contains("sulcus-sessions viewers FILE --out FILE2"));
    let done = run(&["viewers", file, "--out", to, "--json"]);
    assert_eq!(code(&done), 0, "{}", err(&done));
    assert_eq!(json_of(&done)["identical"], true);
    assert_eq!(
        json_of(&run(&["info", to, "--json"]))["viewers"],
        "as_signed"
    );
    let live = text_of(&both.recorded);
    for (args, expected, word) in [
        (&["viewers", file, live, to][..], 0, ""),
        (&["viewers", file, "--out", to], 2, "made.mcap"),
        (
            &["viewers", live, "--out", "new.mcap"],
            2,
            "are in the recording",
        ),
        (
            &["viewers", file, live, "--out", "new.mcap"],
            2,
            "takes one recording",
        ),
    ] {
        let done = run(args);
        assert_eq!(code(&done), expected, "{args:?}: {}", err(&done));
        assert!(err(&done).contains(word), "{args:?}: {}", err(&done));
    }
    // Any MCAP reader finds the schemas in the made file.
    let bytes = std::fs::read(&made).unwrap();
    let mut schemas = 0;
    for record in mcap::read::ChunkFlattener::new(&bytes).unwrap() {
        schemas += usize::from(matches!(record.unwrap(), Record::Schema { .. }));
    }
    assert!(schemas > 8);
}
