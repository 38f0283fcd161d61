//! What others make of a recording: their programs are really run on it, and what they found is counted. (Several of them
//! report success on channels that they could not decode.)

mod decoded;
mod python;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use decoded::{Channel, decoded};
use serde_json::Value;
use sulcus_core::output::status;
use sulcus_core::{Scene, Vec3};
use sulcus_sessions::{Cadence, FRAMES_HZ, Recording, ReplayOptions, replay_observed};
use sulcus_tests::{Place, Program};

/// A session of two hands in the whole mouth: long enough that both touch tissue.
const SECONDS: &str = "12";

/// The same for all tests here.
fn recording() -> &'static Path {
    static MADE: OnceLock<(Place, PathBuf)> = OnceLock::new();
    let (_, path) = MADE.get_or_init(|| {
        let place = Place::new();
        place
            .run(
                Program::Client,
                &["demo", "--virtual", "--duration", SECONDS, "--json"],
            )
            .ok();
        let path = place.recording();
        (place, path)
    });
    path
}

fn ours() -> &'static BTreeMap<String, Channel> {
    static READ: OnceLock<BTreeMap<String, Channel>> = OnceLock::new();
    READ.get_or_init(|| decoded(recording()))
}

/// Channels as `info` counts them.
fn counted(path: &Path) -> Value {
    let place = Place::new();
    let path = path.to_str().expect("a plain path");
    place
        .run(Program::Sessions, &["info", path, "--json"])
        .ok()
        .json()
}

#[test]
fn foxgloves_reader_decodes_every_message_and_info_counts_as_many() {
    let ours = ours();
    let info = counted(recording());
    let listed = info["sizes"]["channels"].as_array().expect("channels");
    let mut with_messages = 0;
    for of in listed {
        let topic = of["topic"].as_str().expect("a topic");
        let messages = of["messages"].as_u64().expect("a number");
        assert_eq!(of["encoding"], "protobuf", "{topic}");
        let read = ours.get(topic).map_or(0, |channel| channel.times_ns.len());
        assert_eq!(read as u64, messages, "{topic}");
        with_messages += usize::from(messages > 0);
    }
    assert_eq!(with_messages, ours.len());
    // Every kind is there, of both hands.
    for tool in ["probe", "mirror"] {
        for kind in [
            "haptic", "graphic", "wrench", "contacts", "metrics", "spheres",
        ] {
            let topic = format!("/tools/{tool}/{kind}");
            assert!(ours.contains_key(&topic), "{topic}");
        }
    }
    for topic in ["/tf", "/log", "/session/metrics", "/objects/tongue/spheres"] {
        assert!(ours.contains_key(topic), "{topic}");
    }
    assert_eq!(
        ours["/log"].lines.len() as u64,
        info["events"].as_u64().expect("events")
    );
    let per_minute = |field: &str| info["sizes"][field].as_f64().expect("a rate");
    let (exact, view) = (
        per_minute("exact_mb_per_minute"),
        per_minute("view_mb_per_minute"),
    );
    assert!(exact <= 9.0, "{exact} MB of exact rows a minute");
    assert!(view <= 30.0, "{view} MB for viewers a minute");
    assert!(per_minute("gb_per_station_hour") < 3.0);
}

#[test]
fn all_of_a_tick_has_one_time_and_rates_are_as_said() {
    let ours = ours();
    let recording = Recording::open(recording()).expect("a recording");
    let times: BTreeMap<u64, u64> = sulcus_tests::rows(&recording)
        .iter()
        .map(|row| (row.tick, row.time_unix_ns))
        .collect();
    let began = recording.header().started_unix_ns;
    let all: BTreeSet<u64> = times.values().copied().chain([began]).collect();
    let seconds = SECONDS.parse::<f64>().expect("a number");
    for (topic, channel) in ours {
        assert!(
            channel.times_ns.iter().all(|time| all.contains(time)),
            "{topic}"
        );
        assert!(channel.times_ns.is_sorted(), "{topic}");
        let rate = channel.times_ns.len() as f64 / seconds;
        let most = match topic.as_str() {
            "/exact/ticks" => 1001.0,
            topic if topic.ends_with("/wrench") => 126.0,
            _ => 64.0,
        };
        assert!(rate <= most, "{topic}: {rate} Hz");
    }
    for tool in ["probe", "mirror"] {
        let wrenches = &ours[&format!("/tools/{tool}/wrench")];
        for (wrench, time) in wrenches.wrenches.iter().zip(&wrenches.times_ns) {
            assert_eq!(times[&wrench.tick], *time);
        }
        assert!(wrenches.times_ns.len() as f64 >= 124.0 * seconds);
        for kind in ["haptic", "graphic", "metrics"] {
            let channel = &ours[&format!("/tools/{tool}/{kind}")];
            assert!(channel.times_ns.len() as f64 >= 62.0 * seconds);
        }
    }
    // No cloud floats in a frame that nothing places.
    let placed: BTreeSet<&str> = ours["/tf"].frames.iter().map(String::as_str).collect();
    for cloud in ours.values().flat_map(|channel| &channel.clouds) {
        let frame = cloud.frame_id.as_str();
        assert!(frame == "world" || placed.contains(frame), "{frame}");
    }
}

/// The points of a cloud of moving spheres.
fn points(data: &[u8]) -> Vec<Vec3> {
    let number = |bytes: &[u8]| f64::from(f32::from_le_bytes(bytes.try_into().expect("four")));
    data.chunks_exact(12)
        .map(|point| {
            Vec3::new(
                number(&point[..4]),
                number(&point[4..8]),
                number(&point[8..]),
            )
        })
        .collect()
}

#[test]
fn what_is_shown_is_what_a_replay_comes_to() {
    let ours = ours();
    let recording = Recording::open(recording()).expect("a recording");
    let scene = recording.scene().expect("its scene");
    let tongue = scene
        .objects
        .iter()
        .position(|object| object.name == "tongue");
    let tongue = tongue.expect("a tongue");
    let clouds = &ours["/objects/tongue/spheres"];
    let mut by_time: BTreeMap<u64, Vec<Vec3>> = BTreeMap::new();
    for (cloud, time) in clouds.clouds.iter().zip(&clouds.times_ns) {
        if cloud.point_stride == 12 {
            by_time.insert(*time, points(&cloud.data));
        }
    }
    let object = &scene.objects[tongue];
    let shown = by_time.values().next().expect("it moved").len();
    let level = (0..=object.level).find(|level| object.tree.shape_at(*level).count() == shown);
    let ids: Vec<u32> = object
        .tree
        .shape_at(level.expect("a level with as many spheres"))
        .map(|(id, _)| id)
        .collect();
    let probe = scene.tools.iter().position(|tool| tool.name == "probe");
    let probe = probe.expect("a probe");
    let metrics: BTreeMap<u64, _> = ours["/tools/probe/metrics"]
        .tools
        .iter()
        .map(|of| (of.tick, of))
        .collect();
    let contacts: BTreeMap<u64, _> = ours["/tools/probe/contacts"]
        .contacts
        .iter()
        .map(|of| (of.tick, of))
        .collect();
    let times: BTreeMap<u64, u64> = sulcus_tests::rows(&recording)
        .iter()
        .map(|row| (row.tick, row.time_unix_ns))
        .collect();
    let (mut worst, mut moved, mut compared, mut touching, mut peak) = (0.0f64, 0.0f64, 0, 0, 0.0);
    let mut peaks = BTreeMap::new();
    let mut centres = vec![Vec3::zeros(); ids.len()];
    let options = ReplayOptions::default();
    let report = replay_observed(
        &recording,
        &options,
        &mut |_| {},
        &mut |_: &Scene, _, out, ws| {
            let tool = &out.tools[probe];
            peak = f64::max(peak, tool.wrench.force.norm());
            if out.tick == 1 || out.tick.is_multiple_of(8) {
                peaks.insert(out.tick, std::mem::take(&mut peak));
            }
            if let Some(there) = by_time.get(&times[&out.tick]) {
                assert!(ws.centres_of(tongue, &ids, &mut centres));
                for ((there, here), id) in there.iter().zip(&centres).zip(&ids) {
                    worst = worst.max((there - here).norm());
                    let rest = object.tree.nodes()[*id as usize].centre;
                    moved = moved.max((here - rest).norm());
                }
                compared += 1;
            }
            if let Some(of) = metrics.get(&out.tick) {
                assert_eq!(of.status, u32::from(tool.status));
                assert_eq!(of.rows, u32::from(tool.rows));
                assert_eq!(of.pocket.is_some(), tool.pocket.is_some());
                if let (Some(said), Some(is)) = (&of.pocket, &tool.pocket) {
                    assert!((f64::from(said.depth_mm) - is.depth * 1e3).abs() < 1e-4);
                }
            }
            if let Some(of) = contacts.get(&out.tick) {
                // Loads along the normals are the force: minus what the hand is sent before its limits.
                let sum = of.contacts.iter().fold(Vec3::zeros(), |sum, contact| {
                    let n = contact.normal.as_ref().expect("a normal");
                    let n = Vec3::new(f64::from(n.x), f64::from(n.y), f64::from(n.z));
                    sum + n * f64::from(contact.load_n)
                });
                if of.bearing as usize == of.contacts.len() && tool.status & status::EXHAUSTED == 0
                {
                    let off = (sum - tool.raw_wrench.force).norm();
                    assert!(off < 1e-3, "tick {}: {off} N", out.tick);
                    touching += usize::from(sum.norm() > 0.05);
                }
            }
        },
    )
    .expect("replays");
    assert!(report.identical);
    assert_eq!(compared, by_time.len());
    assert!(moved > 1e-3, "the mirror pressed it by {moved} m");
    // Half a step of rounding along each axis.
    let half = 0.5 / 131_072.0;
    assert!(worst <= half * 3f64.sqrt() * 1.01, "{worst} m");
    assert!(touching > 50, "{touching} ticks with contacts that press");
    for wrench in &ours["/tools/probe/wrench"].wrenches {
        let is = peaks[&wrench.tick];
        assert!(
            (f64::from(wrench.peak_force_n) - is).abs() < 1e-6,
            "tick {}",
            wrench.tick
        );
    }
}

#[test]
fn pythons_mcap_decodes_every_message() {
    let packages = ["mcap==1.6.0", "mcap-protobuf-support==0.6.0"];
    let Some(programs) = python::environment("mcap", &packages) else {
        return;
    };
    let found = python::ask(&programs, "count_messages.py", recording());
    let found = found.as_object().expect("topics");
    for (topic, channel) in ours() {
        let theirs = &found[topic];
        assert_eq!(theirs["schema"], channel.schema, "{topic}");
        assert_eq!(theirs["messages"], channel.times_ns.len(), "{topic}");
        assert_eq!(theirs["inner"], channel.inner, "{topic}");
        assert_eq!(
            theirs["last_ns"].as_u64(),
            channel.times_ns.last().copied(),
            "{topic}"
        );
    }
    assert_eq!(found.len(), ours().len());
}

#[test]
fn what_pythons_mcap_writes_anew_is_the_same_recording() {
    let packages = ["mcap==1.6.0", "mcap-protobuf-support==0.6.0"];
    let Some(programs) = python::environment("mcap", &packages) else {
        return;
    };
    let place = Place::new();
    let short = [
        "demo",
        "--virtual",
        "--exercise",
        "crown",
        "--duration",
        "2",
        "--json",
    ];
    place.run(Program::Client, &short).ok();
    let original = place.recording();
    let folder = place.path("rewritten");
    std::fs::create_dir(&folder).expect("a folder");
    let written = python::ask_with(&programs, "rewrite.py", &original, &[folder.as_path()]);
    let names = written.as_array().expect("names");
    assert!(names.len() >= 6, "{written}");
    let facts = |path: &Path| Recording::open(path).expect("opens").facts().clone();
    let before = facts(&original);
    for name in names {
        let name = name.as_str().expect("a name");
        let path = folder.join(name);
        assert_eq!(facts(&path), before, "{name}");
        let recording = Recording::open(&path).expect("opens");
        let report = replay_observed(
            &recording,
            &ReplayOptions::default(),
            &mut |_| {},
            &mut |_, _, _, _| {},
        )
        .expect("replays");
        assert!(
            report.identical && report.gradable && !report.is_finding(),
            "{name}: {report:?}"
        );
    }
}

#[test]
fn rerun_opens_it_unaided_with_a_row_for_every_message() {
    let Some(programs) = python::environment("rerun", &["rerun-sdk==0.36.3"]) else {
        return;
    };
    let place = Place::new();
    let converted = place.path("session.rrd");
    let run = Command::new(programs.join("rerun"))
        .args(["mcap", "convert", "-o"])
        .arg(&converted)
        .arg(recording())
        .env("HOME", place.path("home"))
        .output()
        .expect("rerun starts");
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success() && !said.contains("ERROR"), "{said}");
    let found = python::ask(&programs, "count_rows.py", &converted);
    for (topic, channel) in ours() {
        let messages = channel.times_ns.len() as u64;
        let (component, rows) = match channel.schema.as_str() {
            "foxglove.PointCloud" => ("Points3D:positions".to_owned(), messages),
            "foxglove.PoseInFrame" => ("InstancePoses3D:translations".to_owned(), messages),
            // A row for each frame.
            "foxglove.FrameTransforms" => ("Transform3D:translation".to_owned(), channel.inner),
            "foxglove.Log" => ("TextLog:text".to_owned(), messages),
            own => (format!("{own}:message"), messages),
        };
        assert_eq!(
            found[topic][&component].as_u64(),
            Some(rows),
            "{topic}: {}",
            found[topic]
        );
    }
}

#[test]
fn a_live_session_has_the_same_channels() {
    let place = Place::new();
    place
        .run(Program::Client, &["demo", "--duration", "3", "--json"])
        .ok();
    let live = place.recording();
    let channels = |path: &Path| -> BTreeSet<String> {
        let info = counted(path);
        let channels = info["sizes"]["channels"]
            .as_array()
            .expect("channels")
            .clone();
        let name = |of: &Value| format!("{} {} {}", of["topic"], of["schema"], of["encoding"]);
        channels.iter().map(name).collect()
    };
    assert_eq!(channels(&live), channels(recording()));
    // Each due tick of a held tool has its message, however many ticks a busy machine has skipped.
    let recording = Recording::open(&live).expect("a recording");
    let scene = recording.scene().expect("its scene");
    let probe = scene.tools.iter().position(|tool| tool.name == "probe");
    let probe = probe.expect("a probe");
    let rows = sulcus_tests::rows(&recording);
    let due = |hz: f64| {
        let mut cadence = Cadence::new(hz, scene.tick_s());
        let is_held = |of: u16| of & status::ABSENT == 0;
        let due = rows.iter().filter(|row| cadence.is_due(row.tick));
        due.filter(|row| is_held(row.status[probe])).count()
    };
    let live = decoded(&live);
    for (kind, hz) in [
        ("haptic", FRAMES_HZ),
        ("graphic", FRAMES_HZ),
        ("metrics", FRAMES_HZ),
        ("wrench", 2.0 * FRAMES_HZ),
    ] {
        let read = live[&format!("/tools/probe/{kind}")].times_ns.len();
        assert!(read > 0, "{kind}");
        assert_eq!(read, due(hz), "{kind}");
    }
}
