//! Events of real sessions: what was told while they ran is what their replay tells, in virtual time and over a socket;
//! and what it costs.
#![allow(clippy::unwrap_used)]

use std::cell::Cell;
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
use sulcus_proto::SessionSummary;
use sulcus_proto::device::PHASE_EVENT;
use sulcus_scene::BuiltIn;
use sulcus_server::{Server, ServerConfig, ServerHandle, SessionPlan, StationConfig};
use sulcus_sessions::exercise::Target;
use sulcus_sessions::exercise::events::call::{Call, READING_CALLED};
use sulcus_sessions::{
    Events, Exercise, Message, Occurrence, Recording, ReplayOptions, StationKey, replay_observed,
};

use crate::common::{PATIENCE, Station, rows_and_events, until};

fn prepared(seconds: f64, seed: u64) -> Prepared {
    let asked = Asked {
        duration_s: Some(seconds),
        hand_seed: seed,
        ..Asked::of("probing")
    };
    exercise::prepare(&asked, &Steps).unwrap()
}

/// Events in a recording's log, without those that the client sent.
fn logged(recording: &Recording) -> Vec<Occurrence> {
    let event = |message| match message {
        Ok(Message::Event(event)) => Occurrence::parse(&event.text),
        _ => None,
    };
    let all = recording.messages().filter_map(event);
    all.filter(|said| ![READING_CALLED, PHASE_EVENT].contains(&said.kind.as_str()))
        .collect()
}

/// Events that the replay of a recording finds.
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

/// The simulated operator, who calls two depths, and ends when the server has seen the probe in a pocket.
struct Calling<'a> {
    operator: Operator,
    server: &'a ServerHandle,
    periods: u32,
    has_called: bool,
    has_probed: bool,
}

impl HandSource for Calling<'_> {
    fn name(&self) -> &str {
        "calling"
    }
    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        self.periods += 1;
        if self.periods.is_multiple_of(100) {
            let status = self.server.status();
            self.has_probed |= status[0].tools.iter().any(|tool| !tool.site.is_empty());
        }
        self.operator.step(shown)
    }
    fn is_done(&self) -> bool {
        self.has_called && self.has_probed
    }
}

impl EventDevice for Calling<'_> {
    fn events(&mut self) -> Vec<DeviceEvent> {
        if self.has_called || self.periods < 2000 {
            return Vec::new();
        }
        self.has_called = true;
        let call = |tooth| Call {
            tooth,
            site: Site::Buccal,
            depth_mm: 2,
            recession_mm: None,
            bleeding: None,
            furcation: None,
        };
        // The second is about a tooth that is not there.
        [call(36), call(47)].iter().map(event).collect()
    }
}

/// A live session with its recording in `folder`, until the probe is in a pocket.
fn live(folder: &Path) -> SessionSummary {
    let prepared = prepared(100.0, 4);
    let mut plan = SessionPlan::new(prepared.scene.clone(), prepared.scene_bytes.clone());
    plan.exercise = sulcus_server::Exercise {
        name: prepared.exercise.name.clone(),
        text: prepared.exercise.task.clone(),
        definition: prepared.definition(4).unwrap(),
        seed: 4,
    };
    let mut config = ServerConfig::new(StationConfig::new(plan), folder.to_owned()).unwrap();
    config.station_key = Some(folder.join("station.key"));
    let server = Server::start(config).unwrap();
    let link = Link::connect(LinkConfig {
        timeout: PATIENCE,
        ..LinkConfig::new(server.local_addr(), server.ticket(), "calling")
    })
    .unwrap();
    let device = Calling {
        operator: prepared.operator,
        server: &server,
        periods: 0,
        has_called: false,
        has_probed: false,
    };
    let ran = perform(link, device, prepared.ticks, None, None, &Steps).unwrap();
    let summary = ran.goodbye.unwrap().summary;
    server.shutdown();
    server.join().unwrap();
    summary
}

#[test]
fn a_live_session_tells_what_its_replay_tells_and_keeps_what_was_called() {
    let folder = tempfile::tempdir().unwrap();
    let mut summary = None;
    // A replay knows neither lost rows nor gaps of the connection. Both are the work of a machine that stalls.
    until("a session with all its rows and without a gap", || {
        let ended = live(folder.path());
        println!("{ended:#?}");
        let is_whole = ended.rows_dropped == 0 && ended.gaps == 0;
        summary = Some(ended);
        is_whole
    });
    let summary = summary.unwrap();
    let recording = Recording::open(&folder.path().join(&summary.recording)).unwrap();
    let told = logged(&recording);
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

/// Hand at rest whose person calls a depth and leaves the session between two passes.
struct Leaving {
    periods: u32,
    /// Whether the person has left.
    left: Cell<bool>,
}

impl HandSource for Leaving {
    fn name(&self) -> &str {
        "leaving"
    }
    fn exchange(&mut self, _: &Shown) -> [ToolInput; MAX_TOOLS] {
        self.periods += 1;
        [ToolInput::ABSENT; MAX_TOOLS]
    }
    fn is_done(&self) -> bool {
        self.left.set(self.periods >= 500);
        self.left.get()
    }
}

impl EventDevice for Leaving {
    fn events(&mut self) -> Vec<DeviceEvent> {
        let call = Call {
            tooth: 36,
            site: Site::Buccal,
            depth_mm: 2,
            recession_mm: None,
            bleeding: None,
            furcation: None,
        };
        let is_called = self.left.replace(false);
        is_called.then(|| event(&call)).into_iter().collect()
    }
}

#[test]
fn a_depth_that_is_called_after_the_last_pass_of_the_loop_is_recorded() {
    let station = Station::new();
    let device = Leaving {
        periods: 0,
        left: Cell::new(false),
    };
    let link = station.connect().unwrap();
    let ran = perform(link, device, 60_000, None, None, &Steps).unwrap();
    let summary = ran.goodbye.unwrap().summary;
    let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
    let (_, events) = rows_and_events(&recording);
    assert_eq!(count(&events, READING_CALLED), 1, "{events:?}");
}
