//! Events of real sessions: what was told while they ran is what their replay tells, in virtual time and over a socket;
//! and what it costs.
#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::time::Instant;

use sulcus_cases::statistics::percentiles_us;
use sulcus_connection::device::{DeviceEvent, EventDevice};
use sulcus_connection::link::{Link, LinkConfig};
use sulcus_connection::perform::perform;
use sulcus_connection::progress::Steps;
use sulcus_core::tissue::gingiva::Site;
use sulcus_core::{
    MAX_TOOLS, NoProbe, Node, Scene, SphereTree, State, TickInput, ToolInput, Vec3, Workspace, tick,
};
use sulcus_demo::calls::{Called, event};
use sulcus_demo::exercise::{self, Asked, Prepared};
use sulcus_demo::{check, lockstep};
use sulcus_haptics::HandSource;
use sulcus_operator::{Operator, Shown};
use sulcus_scene::BuiltIn;
use sulcus_server::{SessionPlan, StationConfig};
use sulcus_sessions::exercise::Target;
use sulcus_sessions::exercise::events::call::{Call, READING_CALLED};
use sulcus_sessions::{
    Events, Exercise, Message, Occurrence, Recording, ReplayOptions, StationKey, replay_observed,
};

fn prepared(seconds: f64, seed: u64) -> Prepared {
    let asked = Asked {
        duration_s: Some(seconds),
        hand_seed: seed,
        ..Asked::of("probing")
    };
    exercise::prepare(&asked, &Steps).unwrap()
}

/// What a recording's log tells, but for what the client said.
fn logged(recording: &Recording) -> Vec<Occurrence> {
    let event = |message| match message {
        Ok(Message::Event(event)) => Occurrence::parse(&event.text),
        _ => None,
    };
    let all = recording.messages().filter_map(event);
    all.filter(|said| said.kind != READING_CALLED).collect()
}

/// What its replay tells.
fn replayed(recording: &Recording) -> Vec<Occurrence> {
    let scene = recording.scene().unwrap();
    let exercise = Exercise::recorded(&recording.header().exercise);
    let mut events = Events::new(&scene, &exercise);
    let mut all = Vec::new();
    let options = ReplayOptions::default();
    let report = replay_observed(
        recording,
        &options,
        &mut |_| {},
        &mut |scene, _, output, ws| {
            all.extend(events.observe(scene, output, ws));
        },
    );
    assert!(report.unwrap().identical);
    all
}

fn count(all: &[Occurrence], kind: &str) -> usize {
    all.iter().filter(|one| one.kind == kind).count()
}

#[test]
fn a_session_in_virtual_time_tells_what_its_replay_tells() {
    let folder = tempfile::tempdir().unwrap();
    let mut prepared = prepared(12.0, 3);
    let key = StationKey::from_seed([7; 32]);
    let ran = lockstep::run(&mut prepared, 3, folder.path(), key, &Steps).unwrap();
    let recording = Recording::open(&ran.recording).unwrap();
    let told = logged(&recording);
    assert_eq!(told, replayed(&recording));
    for kind in ["site_reached", "floor_felt", "left_site"] {
        assert!(count(&told, kind) >= 2, "{kind}: {told:?}");
    }
    assert_eq!(count(&told, "withdrawn"), 0, "it walks: {told:?}");
    let recorded = Exercise::recorded(&recording.header().exercise);
    assert_eq!(
        (recorded.name.as_str(), recorded.seed, recorded.duration_s),
        ("probing", Some(3), 12.0)
    );
    // The floor is felt where it is, by the deepest visit of each site: one that only crosses its border is shallower.
    let mut chart: std::collections::BTreeMap<String, f64> = std::collections::BTreeMap::new();
    for one in told.iter().filter(|one| one.kind == "left_site") {
        if let (Some(site), Some(mm)) = (one.data["site"].as_str(), one.data["deepest_mm"].as_f64())
        {
            let deepest = chart.entry(site.to_owned()).or_insert(mm);
            *deepest = deepest.max(mm);
        }
    }
    assert!(!chart.is_empty());
    for (site, mm) in chart {
        let prescribed = if site == "buccal" { 2.0 } else { 3.0 };
        assert!((mm - prescribed).abs() < 0.5, "{site}: {mm}");
    }
    let checked = check::check(&ran.recording, &Steps).unwrap();
    let summary = checked.events();
    for (kind, counted) in &summary.counts {
        assert_eq!(*counted as usize, count(&told, kind), "{kind}");
    }
    assert_eq!(summary.visible_share, None);
}

/// The simulated operator, who calls a depth now and then.
struct Calling(Operator, u32);

impl HandSource for Calling {
    fn name(&self) -> &str {
        "calling"
    }
    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        self.1 += 1;
        self.0.step(shown)
    }
}

impl EventDevice for Calling {
    fn events(&mut self) -> Vec<DeviceEvent> {
        let call = |tooth| Call {
            tooth,
            site: Site::Buccal,
            depth_mm: 2,
            recession_mm: None,
            bleeding: None,
            furcation: None,
        };
        match self.1 {
            // The second is about a tooth that is not there.
            2000 => [call(36), call(47)].iter().map(event).collect(),
            _ => Vec::new(),
        }
    }
}

#[test]
fn a_live_session_tells_what_its_replay_tells_and_keeps_what_was_called() {
    let folder = tempfile::tempdir().unwrap();
    let prepared = prepared(6.0, 4);
    let mut plan = SessionPlan::new(prepared.scene.clone(), prepared.scene_bytes.clone());
    plan.exercise = sulcus_server::Exercise {
        name: prepared.exercise.name.clone(),
        text: prepared.exercise.task.clone(),
        definition: prepared.definition(4).unwrap(),
        seed: 4,
    };
    let station = StationConfig::new(plan);
    let mut config = sulcus_server::ServerConfig::new(station, folder.path().to_owned()).unwrap();
    config.station_key = Some(folder.path().join("station.key"));
    let server = sulcus_server::Server::start(config).unwrap();
    let link = Link::connect(LinkConfig::new(
        server.local_addr(),
        server.ticket(),
        "calling",
    ))
    .unwrap();
    let device = Calling(prepared.operator, 0);
    let ran = perform(link, device, prepared.ticks, None, None, &Steps).unwrap();
    let summary = ran.goodbye.unwrap().summary;
    server.shutdown();
    server.join().unwrap();
    let recording = Recording::open(&folder.path().join(&summary.recording)).unwrap();
    let told = logged(&recording);
    // A machine so busy that rows are lost has another replay.
    assert_eq!(summary.rows_dropped, 0);
    assert_eq!(told, replayed(&recording));
    assert!(count(&told, "site_reached") >= 1, "{told:?}");
    let checked = check::check(&folder.path().join(&summary.recording), &Steps).unwrap();
    let known = Called {
        tooth: 36,
        site: "buccal",
        depth_mm: 2,
        truth_mm: 2.0,
    };
    assert_eq!(
        checked.calls,
        [known],
        "what makes no sense is logged and not counted"
    );
    let said = recording.messages().filter(|message| {
        matches!(message, Ok(Message::Event(event)) if event.text.starts_with(READING_CALLED))
    });
    assert_eq!(said.count(), 2);
}

/// The pocket's scene with the tongue beside the tooth, and a target to see.
fn with_tongue() -> (Scene, Exercise) {
    let mut scene = exercise::compile(None, BuiltIn::Pocket, None, &Steps)
        .unwrap()
        .scene;
    let tongue = exercise::compile(None, BuiltIn::Tongue, None, &Steps)
        .unwrap()
        .scene;
    for mut object in tongue.objects {
        let beside = Vec3::new(0.0, -35e-3, 0.0);
        let nodes = object.tree.nodes().iter().map(|node| Node {
            centre: node.centre + beside,
            ..*node
        });
        object.tree = SphereTree::with_bounds(nodes.collect()).unwrap();
        scene.objects.push(object);
    }
    let mut exercise = exercise::find("probing").unwrap();
    exercise.target = Some(Target {
        tooth: 36,
        eye_mm: [250.0, -120.0, 260.0],
        visible: 0.7,
    });
    (scene, exercise)
}

#[test]
fn from_a_snapshot_on_the_same_events_follow_and_a_tick_costs_little() {
    let (scene, exercise) = with_tongue();
    let mut operator = prepared(8.0, 5).operator;
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut events = Events::new(&scene, &exercise);
    assert!(events.missing().is_empty(), "{:?}", events.missing());
    assert!(events.look().len() > 50);
    let (mut shown, mut inputs, mut told) = (Shown::NOTHING, Vec::new(), Vec::new());
    let (mut kept, mut plain, mut looks) = (None, Vec::new(), Vec::new());
    for k in 1..=8000u64 {
        let mut input = TickInput::IDLE;
        input.tools = operator.step(&shown);
        let output = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        shown = Shown::from(&output);
        inputs.push(input);
        let begin = Instant::now();
        told.extend(events.observe(&scene, &output, &ws));
        let took = begin.elapsed().as_nanos() as u64;
        if events.look().is_due(output.tick) {
            looks.push(took)
        } else {
            plain.push(took)
        }
        if k == 4321 {
            kept = Some((state.to_bytes(), events.clone(), told.len()));
        }
    }
    assert!(count(&told, "site_reached") >= 2);
    assert_eq!(
        count(&told, "target_visible") + count(&told, "target_hidden"),
        1,
        "{told:?}"
    );
    for (what, times) in [("without a look", plain), ("with a look", looks)] {
        let at = percentiles_us(times);
        println!(
            "observe, tick {what}: p50 {:.2} us, p99 {:.2} us, max {:.2} us",
            at.p50, at.p99, at.max
        );
    }
    let (bytes, mut events, first) = kept.unwrap();
    let mut state = State::from_bytes(&scene, &bytes).unwrap();
    let mut ws = Workspace::new(&scene);
    let mut again = Vec::new();
    for input in &inputs[4321..] {
        let output = tick(&scene, &mut state, &mut ws, input, &mut NoProbe);
        again.extend(events.observe(&scene, &output, &ws));
    }
    assert_eq!(again, told[first..]);
}

#[test]
fn exercises_are_found_by_name_or_file_and_what_cannot_be_is_said() {
    let told = |name: &str, scene: Option<&Path>| {
        let asked = Asked {
            scene,
            ..Asked::of(name)
        };
        exercise::prepare(&asked, &Steps).err().unwrap().to_string()
    };
    assert!(
        told("scaling", None).contains("expected one of: crown, probing, retraction, bimanual")
    );
    assert!(told("no/such.toml", None).contains("no/such.toml"));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mine.toml");
    let text = exercise::find("probing").unwrap().definition(1).unwrap();
    let mine = text
        .replace("name = \"probing\"", "name = \"mine\"")
        .replace("40.0", "3.5");
    std::fs::write(&file, mine).unwrap();
    let found = exercise::find(file.to_str().unwrap()).unwrap();
    assert_eq!((found.name.as_str(), found.duration_s), ("mine", 3.5));
    std::fs::write(&file, text.replace("tooth = 36", "tooth = 99")).unwrap();
    let refused = told(file.to_str().unwrap(), None);
    assert!(
        refused.contains("zone[0].tooth is 99, expected an FDI number"),
        "{refused}"
    );
}
