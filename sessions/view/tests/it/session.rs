//! Session as a file for the viewer: rows read back, counted against the replay.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::path::Path;

use crate::common::program::*;
use crate::common::*;
use crate::rows::count_rows;
use serde_json::Value;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::{Gingiva, GingivaParams, Place, Prescribed, ToothFrame};
use sulcus_core::{DisplayMesh, NoProbe, Scene, State, Vec3, Workspace, tick};
use sulcus_sessions::{
    Level, Occurrence, Recorder, Recording, ReplayOptions, Row, SessionEnd, replay_observed,
};
use sulcus_view::session::{ReviewError, Slider, Window, review};

/// Window of the whole session.
const ALL: Window = Window {
    from_s: 0.0,
    to_s: f64::INFINITY,
};
/// Number of ticks of the sessions.
const TICKS: u64 = 2500;
/// Number of ticks from one picture to the next, 30 a second.
const EVERY: u64 = 33;

/// Scene of the balls as a yielding gingiva with a mesh. The rod's tip is in its pocket while it is low.
fn soft() -> Scene {
    let mut scene = scene();
    let object = &mut scene.objects[0];
    let place = Place {
        away: Vec3::x(),
        on_surface: Vec3::zeros(),
        spread: 0.0,
        height: 0.0,
        floor: false,
    };
    let centres = object.tree.nodes().iter().map(|node| node.centre);
    let places = centres.map(|on_surface| Place {
        on_surface,
        ..place
    });
    object.tissue = TissueModel::Gingiva(Box::new(Gingiva {
        params: GingivaParams::default(),
        tooth: ToothFrame {
            origin: Vec3::new(0.0, 0.0, -0.01),
            axis: Vec3::z(),
            mesial: Vec3::x(),
            buccal: Vec3::y(),
        },
        margin: vec![9.5e-3; 8],
        proximal: 50f64.to_radians(),
        sites: [Prescribed {
            depth: 3e-3,
            ..Prescribed::default()
        }; 6],
        places: places.collect(),
        level: 3,
    }));
    object.name = "gingiva 36".into();
    object.mesh = DisplayMesh {
        vertices: vec![
            [-0.006, 0.0, 0.0],
            [0.006, 0.0, 0.0],
            [0.0, 0.004, 0.0],
            [0.0, 0.0, -0.009],
        ],
        triangles: vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]],
        colour: [220, 120, 120, 255],
        vertex_colours: Vec::new(),
    };
    scene.tools[0].mesh = DisplayMesh {
        vertex_colours: vec![[255; 4], [0, 0, 0, 255], [255; 4], [9; 4]],
        ..object.mesh.clone()
    };
    scene
}

/// Records a session of the scene, with four lines in its log.
fn record_soft(path: &Path) {
    let scene = soft();
    let mut recorder = Recorder::create(path, &header(&scene), key()).unwrap();
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    recorder.snapshot(BEGAN, 0, &state.to_bytes()).unwrap();
    let say = |recorder: &mut Recorder, tick: u64, kind: &str, data: Value| {
        let what = Occurrence {
            kind: kind.into(),
            tick,
            data,
        };
        let time = BEGAN + tick * 1_000_000;
        let text = what.to_string();
        recorder.event(time, Level::Info, &text).unwrap();
    };
    let site = serde_json::json!({"tool": 0, "tooth": 36, "site": "buccal", "depth_mm": 3});
    recorder
        .event(BEGAN, Level::Info, "session begins")
        .unwrap();
    for k in 0..TICKS {
        let input = input(k);
        let output = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        let row = Row::new(BEGAN + output.tick * 1_000_000, &input, &output);
        recorder.push(&row).unwrap();
        match output.tick {
            500 => say(&mut recorder, 500, "site_reached", site.clone()),
            1500 => say(&mut recorder, 1500, "reading_called", site.clone()),
            2000 => say(&mut recorder, 2000, "left_site", site.clone()),
            _ => {}
        }
    }
    let end = SessionEnd {
        ticks: recorder.rows(),
        ..SessionEnd::default()
    };
    recorder.finish(end).unwrap();
}

fn frames(from: u64, to: u64) -> u64 {
    // The first tick, then the multiples.
    (from..=to)
        .filter(|tick| *tick == 1 || tick % EVERY == 0)
        .count() as u64
}

#[test]
fn what_is_read_back_has_a_row_for_every_tick_picture_and_event() {
    let dir = tempfile::tempdir().unwrap();
    let (path, out) = (dir.path().join("a.mcap"), dir.path().join("a.rrd"));
    record_soft(&path);
    let recording = Recording::open(&path).unwrap();
    let mut told = Vec::new();
    let report = review(&recording, &out, ALL, Slider::Start, &mut |ticks| {
        told.push(ticks)
    })
    .unwrap();
    assert_eq!(told.last(), Some(&TICKS));
    assert!(told.windows(2).all(|pair| pair[0] <= pair[1]));

    let (rows, blueprints) = count_rows(&out).unwrap();
    assert_eq!(blueprints, 1);
    let timed: BTreeMap<String, u64> = rows
        .iter()
        .filter(|(path, of)| of.timed > 0 && !path.starts_with("/plots/floor_force/"))
        .map(|(path, of)| (path.clone(), of.timed))
        .collect();
    assert_eq!(timed, report.rows);
    for plot in ["force", "torque", "depth", "floor_force", "work"] {
        assert_eq!(rows[&format!("/plots/{plot}")].timed, TICKS, "{plot}");
    }
    let pictures = frames(1, TICKS);
    assert_eq!(report.frames, pictures);
    for entity in [
        "/tools/rod",
        "/hands/rod",
        "/offsets/rod",
        "/contacts/rod",
        "/forces/on_rod",
        "/close_up",
    ] {
        assert_eq!(rows[entity].timed, pictures, "{entity}");
    }
    assert_eq!((rows["/events"].timed, report.events), (4, 4));
    assert_eq!(rows["/lanes/site"].timed, 2);
    assert_eq!(rows["/plots/depth/called"].timed, 1);
    assert_eq!(rows["/plots/floor_force/band"].timed, 2);

    // Expected shapes: the pictures in which the tissue does not rest, or has just come to rest.
    let (mut awake, mut rested) = (0, true);
    replay_observed(
        &recording,
        &ReplayOptions::default(),
        &mut |_| {},
        &mut |_, _, output, ws| {
            if output.tick == 1 || output.tick % EVERY == 0 {
                let rests = ws.shape_of(0).iter().all(|x| *x == 0.0);
                awake += u64::from(!(rests && rested));
                rested = rests;
            }
        },
    )
    .unwrap();
    assert_eq!(report.shapes, awake);
    assert!(awake > pictures / 4, "{awake} of {pictures}");
    // The patches of its mesh are written at the beginning, and at most as often as it moves.
    let patches = rows.iter();
    let patches = patches.filter(|(path, _)| path.starts_with("/mouth/gingiva/gingiva_36/"));
    let of: Vec<u64> = patches.map(|(_, of)| of.timed).collect();
    let most = of.iter().max().copied().unwrap_or(0);
    assert!(of.len() > 1 && of.iter().all(|rows| *rows >= 1), "{of:?}");
    assert!((5..=awake + 1).contains(&most), "{of:?}, {awake} awake");

    // Two and a half seconds in columns are at most four chunks of an entity.
    let many = rows.iter().find(|(_, of)| of.chunks > 5);
    assert_eq!(many, None);
    assert_eq!(report.bytes, std::fs::metadata(&out).unwrap().len());
}

#[test]
fn a_window_shows_its_part_and_what_was_so_when_it_began() {
    let dir = tempfile::tempdir().unwrap();
    let (path, out) = (dir.path().join("a.mcap"), dir.path().join("a.rrd"));
    record_soft(&path);
    let recording = Recording::open(&path).unwrap();
    let window = Window {
        from_s: 1.0,
        to_s: 2.0,
    };
    let report = review(&recording, &out, window, Slider::End, &mut |_| {}).unwrap();
    assert_eq!((report.ticks, report.frames), (1001, frames(1000, 2000)));
    // A call at 1.5 s, and the end of a visit at 2 s.
    assert_eq!(report.events, 2);
    let (rows, _) = count_rows(&out).unwrap();
    assert_eq!(
        rows["/lanes/site"].timed, 2,
        "in the zone since 0.5 s, and left"
    );
    assert!(
        rows.keys()
            .any(|path| path.starts_with("/mouth/gingiva/gingiva_36/"))
    );

    let late = Window {
        from_s: 3.0,
        to_s: 9.0,
    };
    let error = review(&recording, &out, late, Slider::Start, &mut |_| {}).unwrap_err();
    assert!(matches!(error, ReviewError::Empty { .. }));
    assert_eq!(
        error.to_string(),
        "window is 3 s to 9 s, expected a part of the session, 0.001 s to 2.5 s"
    );
}

#[test]
fn what_did_not_happen_is_not_shown() {
    let dir = tempfile::tempdir().unwrap();
    let (good, bad) = (dir.path().join("good.mcap"), dir.path().join("bad.mcap"));
    record(&good, 300);
    let bytes = with_messages(&std::fs::read(&good).unwrap(), |topic, data| {
        if topic == "/exact/ticks" && data[..8] == 123u64.to_le_bytes() {
            data[31] ^= 4;
        }
        true
    });
    std::fs::write(&bad, bytes).unwrap();
    let output = run(&[bad.to_str().unwrap(), "--json"]);
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8(output.stderr.clone()).unwrap();
    assert!(
        told.contains("bad.mcap: the replay differs from tick 123 on"),
        "{told}"
    );
    assert_eq!(json_of(&output)["first_divergent_tick"], 123);
    // The incomplete file is gone, too.
    let left: Vec<_> = std::fs::read_dir(dir.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert_eq!(left.len(), 2, "{left:?}");
}

#[test]
fn the_program_writes_beside_the_recording_and_says_how_to_look() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("good.mcap");
    record(&path, 300);
    let output = run(&[path.to_str().unwrap(), "--json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let json = json_of(&output);
    assert_eq!(
        (&json["ticks"], &json["identical"]),
        (&300.into(), &true.into())
    );
    assert_eq!(json["rows"]["/plots/force"], 300);
    assert_eq!(json["opened"], false);
    let note = json["note"].as_str().unwrap();
    assert!(note.contains("pip install rerun-sdk=="), "{note}");
    let (rows, _) = count_rows(&dir.path().join("good.rrd")).unwrap();
    assert_eq!(rows["/plots/force"].timed, 300);

    for (args, words) in [
        (&["--from", "3"][..], "window is 3 s"),
        (&["--from", "0.2", "--to", "0.1"], "--from is 0.2 s"),
        (&["--from", "nan"], "--from is NaN s"),
        (&["--out", path.to_str().unwrap()], "--out is the recording"),
        (&["--out", "no/such/folder/a.rrd"], "cannot write"),
    ] {
        let all = [&[path.to_str().unwrap()], args].concat();
        let output = run(&all);
        let told = String::from_utf8(output.stderr.clone()).unwrap();
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(told.contains(words) && told.lines().count() == 1, "{told}");
    }
}

/// A replay does not know the duration of a tick during the recording. The channels for viewers do.
#[test]
fn tick_times_come_from_the_session_and_not_from_its_replay() {
    let dir = tempfile::tempdir().unwrap();
    let longest = |bytes: Vec<u8>| {
        let recording = Recording::from_bytes(bytes).unwrap();
        let out = dir.path().join("times.rrd");
        review(&recording, &out, ALL, Slider::Start, &mut |_| {})
            .unwrap()
            .longest_tick_us
    };
    // Every recorded tick has a duration of a microsecond.
    assert_eq!(longest(recorded_with_views(300, 0..0)), Some(1.0));
    assert_eq!(longest(recorded(300)), None);
}
