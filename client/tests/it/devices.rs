//! Two haptic devices of a stand-in service in a whole session: server, link, doors, recording, replay.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use sulcus_client::devices::choose::Named;
use sulcus_client::devices::opened::open_by;
use sulcus_client::devices::settings::{DeviceSettings, Hand, Settings};
use sulcus_connection::device::{DeviceEvent, EventDevice, Glance};
use sulcus_connection::device_loop::run;
use sulcus_connection::link::Link;
use sulcus_connection::report::LoopReport;
use sulcus_connection::threaded::DeviceHands;
use sulcus_core::{MAX_TOOLS, ToolInput, Vec3};
use sulcus_devices::Backend;
use sulcus_devices::haply::Haply;
use sulcus_haptics::{HandSource, Merger, Shown, Stage};
use sulcus_server::SessionPlan;
use sulcus_sessions::replay::{ReplayOptions, replay};
use sulcus_sessions::{Message, Occurrence, Recording};
use sulcus_standin_haply::{
    ArmOptions, Fault, Handedness, Log, Motion, Options, Point, Service, Violation,
};

use crate::common::{Raised, Station, scene, until};

/// Ids of the arms: probe, mirror.
const ARMS: [&str; 2] = ["049D", "04A1"];
/// Distance between the resting places of both tools, metres.
const ASIDE: f64 = 0.05;
/// Way from the resting place of the first tool to a press of 0.6 mm, metres: the ball touches 18 mm below.
const DOWN: f64 = 0.0186;

/// The plate of the other tests, with a second ball that finds no plate under it.
fn two_balls() -> SessionPlan {
    let mut scene = scene();
    let mut second = scene.tools[0].clone();
    second.name = "second".into();
    second.park.position += Vec3::new(0.0, ASIDE, 0.0);
    scene.tools.push(second);
    let bytes = scene.to_bytes().expect("small");
    SessionPlan::new(Arc::new(scene), Arc::new(bytes))
}

/// Hand on a spring that follows `path` again and again, times in ms and heights above the resting place in metres.
fn held(path: &[(f64, f64)]) -> Motion {
    let points = path
        .iter()
        .map(|&(ms, up)| Point {
            t_s: ms / 1e3,
            at: [0.0, 0.0, up],
        })
        .collect();
    Motion::Held {
        anchor: Box::new(Motion::Path {
            points,
            repeat: true,
        }),
        mass_kg: 0.12,
        stiffness_n_per_m: 300.0,
        damping_n_s_per_m: 8.0,
    }
}

/// Hand that rests for a second, goes down, presses for two seconds and goes up, again and again. An arm that a busy
/// machine has stopped needs a free tool before it has a force again.
fn pressing() -> Motion {
    held(&[
        (0.0, 0.0),
        (1000.0, 0.0),
        (2500.0, -DOWN),
        (4500.0, -DOWN),
        (5500.0, 0.0),
    ])
}

/// Service with two arms without grips, whose hands rest: their tools keep the orientation of the resting place.
fn service() -> Service {
    let mut options = Options {
        arms: vec![
            ArmOptions::new(ARMS[0], Handedness::Right),
            ArmOptions::new(ARMS[1], Handedness::Left),
        ],
        grips: Vec::new(),
        realtime: true,
        ..Options::default()
    };
    for arm in &mut options.arms {
        arm.motion = held(&[(0.0, 0.0), (1.0, 0.0)]);
    }
    Service::start(options).expect("a service")
}

/// Devices whose person presses a key for the force when the devices ask for it, until the session is over.
struct Pressing<'a> {
    device: DeviceHands,
    waits: [bool; MAX_TOOLS],
    over: &'a AtomicBool,
}

impl HandSource for Pressing<'_> {
    fn name(&self) -> &str {
        self.device.name()
    }
    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        self.device.exchange(shown)
    }
    fn is_done(&self) -> bool {
        self.over.load(Ordering::Relaxed)
    }
}

impl EventDevice for Pressing<'_> {
    fn events(&mut self) -> Vec<DeviceEvent> {
        self.device.events()
    }
    fn glance(&mut self, glance: &Glance) {
        self.waits = glance.stages.map(|stage| stage == Some(Stage::Waiting));
        self.device.glance(glance);
    }
    fn threaded(&mut self) -> Option<&mut Merger> {
        let merger = self.device.threaded()?;
        for (slot, waits) in self.waits.iter_mut().enumerate() {
            if std::mem::take(waits) {
                merger.press(slot);
            }
        }
        Some(merger)
    }
}

/// Session of both arms.
struct Ran {
    report: LoopReport,
    log: Log,
    recording: Recording,
    _station: Station,
}

/// Performs a session with both arms, until `meanwhile` has acted on the service.
fn perform(meanwhile: impl FnOnce(&Service, &Station) + Send) -> Ran {
    let service = service();
    let station = Station::with(|config| config.stations[0].plan = two_balls());
    let backends: Vec<Box<dyn Backend>> =
        vec![Box::new(Haply::at(format!("127.0.0.1:{}", service.port())))];
    let mut settings = Settings::default();
    for (arm, hand) in ARMS.into_iter().zip([Hand::Right, Hand::Left]) {
        settings.store(DeviceSettings {
            hand: Some(hand),
            seat_hour: 9.0,
            ..DeviceSettings::new("haply", arm)
        });
    }
    let named: Vec<Named> = ARMS
        .iter()
        .map(|arm| arm.parse().expect("a name"))
        .collect();
    let opened = open_by(&backends, &named, &settings, Hand::Right).expect("both arms");
    let mut config = station.config();
    config.devices = opened.describe(1e-3);
    let mut link = Link::connect(config).expect("connected");
    let device = opened.begin(link.hello(), None).expect("threads");
    let over = AtomicBool::new(false);
    let mut device = Pressing {
        device,
        waits: [false; MAX_TOOLS],
        over: &over,
    };
    assert!(link.start());
    let report = std::thread::scope(|scope| {
        scope.spawn(|| {
            let _over = Raised(&over);
            meanwhile(&service, &station);
        });
        run(&mut link, &mut device, u64::MAX, None, &AtomicU64::new(0))
    });
    drop(device);
    let summary = link.finish().expect("a goodbye");
    assert!(summary.complete);
    let log = service.stop().expect("a log");
    let recording = Recording::open(&station.recording(&summary.recording)).expect("a recording");
    Ran {
        report,
        log,
        recording,
        _station: station,
    }
}

/// Stage of the device of a tool, as the station's status names it.
fn stage(station: &Station, tool: usize) -> String {
    let status = station.server().status().swap_remove(0);
    status.tools[tool].device_stage.clone()
}

/// Waits until both devices have their whole force, then moves the hand of the probe.
fn begin(service: &Service, station: &Station) {
    until("both devices", || {
        (0..2).all(|tool| stage(station, tool) == "live")
    });
    service.set_hand(ARMS[0], pressing()).expect("an arm");
}

/// Waits for a force at the probe.
fn feels(service: &Service) {
    until("a force at the probe", || {
        let arm = service.arm(ARMS[0]).expect("an arm");
        arm.displayed[2].abs() > 0.1
    });
}

/// Largest wrench of a tool that the server computed, newtons.
fn most(recording: &Recording, tool: usize) -> f64 {
    let rows = recording.messages().filter_map(|message| match message {
        Ok(Message::Row(row)) => Some(row.wrench[tool]),
        _ => None,
    });
    rows.map(|[x, y, z, ..]| f64::from(x.hypot(y).hypot(z)))
        .fold(0.0, f64::max)
}

/// Mean time between two commands to an arm, microseconds.
fn period_us(log: &Log, arm: &str) -> f64 {
    let forces = log.forces(arm);
    let (first, last) = (forces.first(), forces.last());
    let whole_ns = last.zip(first).map_or(0, |(b, a)| b.t_ns - a.t_ns);
    whole_ns as f64 / 1e3 / forces.len() as f64
}

fn stages(recording: &Recording) -> Vec<(u64, String)> {
    let events = recording.messages().filter_map(|message| match message {
        Ok(Message::Event(event)) => Occurrence::parse(&event.text),
        _ => None,
    });
    events
        .filter(|event| event.kind == "device")
        .filter_map(|event| {
            let stage = event.data["stage"].as_str()?.to_owned();
            Some((event.data["tool"].as_u64()?, stage))
        })
        .collect()
}

fn replays(recording: &Recording) {
    let report = replay(recording, &ReplayOptions::default(), &mut |_| {});
    assert!(report.expect("a replay").identical);
}

#[test]
fn two_arms_feel_each_its_own_force_and_the_recording_says_what_they_are() {
    let ran = perform(|service, station| {
        begin(service, station);
        feels(service);
        until("the end of the press", || {
            let arm = service.arm(ARMS[0]).expect("an arm");
            arm.position[2] > -0.1 * DOWN
        });
    });
    let (probe, mirror) = (
        ran.log.largest_displayed(ARMS[0]),
        ran.log.largest_displayed(ARMS[1]),
    );
    assert!(probe > 0.1, "the probe presses: {probe} N");
    assert!(mirror < 1e-3, "the mirror is free: {mirror} N");
    assert!(most(&ran.recording, 1) < 1e-3);
    // Along z, in the axes of the arm; the largest force is up. On the way up the controller may brake the hand.
    let mut strongest = (0.0, 0.0);
    for sent in ran
        .log
        .forces(ARMS[0])
        .iter()
        .filter(|sent| sent.norm() > 0.05)
    {
        let up = sent.force.map_or(0.0, |force| force[2]);
        assert!(up.abs() > 0.9 * sent.norm(), "{:?}", sent.force);
        if sent.norm() > strongest.0 {
            strongest = (sent.norm(), up);
        }
    }
    assert!(strongest.1 > 0.0, "{strongest:?}");
    // The coupling of 500 N/m is displayable; the slew limit is 0.5 N/ms, seen over windows of 1 ms.
    let change = ran.log.largest_change_per_ms(ARMS[0]);
    assert!(change <= 0.55, "{change} N/ms");
    assert_eq!(ran.log.count(Violation::ProfileMissing), 0);
    assert_eq!(ran.log.count(Violation::WrongField), 0);
    // Age that the door adds: on an idle machine at most the period of the device.
    for (age_us, arm) in ran.report.pose_age_us.iter().zip(ARMS) {
        println!("{age_us:?} of {} us", period_us(&ran.log, arm));
    }
    let devices = &ran.recording.header().devices;
    assert_eq!(devices.len(), 2);
    assert_eq!(
        (devices[0].library.as_str(), devices[0].serial.as_str()),
        ("haply", ARMS[0])
    );
    assert_eq!(
        (devices[1].serial.as_str(), devices[1].torque_axes),
        (ARMS[1], 0)
    );
    let stages = stages(&ran.recording);
    for tool in [0, 1] {
        let of_tool: Vec<&str> = stages
            .iter()
            .filter(|(t, _)| *t == tool)
            .map(|(_, stage)| stage.as_str())
            .collect();
        let at = |name: &str| of_tool.iter().position(|stage| *stage == name);
        let (waiting, live) = (at("waiting"), at("live"));
        assert!(waiting.is_some() && waiting < live, "{of_tool:?}");
        // A loop that stalls for the half second of the rise sees none.
        let rising = at("rising");
        assert!(rising.is_none() || waiting < rising, "{of_tool:?}");
    }
    replays(&ran.recording);
}

#[test]
fn an_arm_unplugged_in_contact_comes_back_without_a_kick() {
    let ran = perform(|service, station| {
        begin(service, station);
        feels(service);
        let device = || ARMS[0].to_owned();
        service
            .fault(Fault::Disconnect { device: device() })
            .expect("a fault");
        until("an absent arm", || stage(station, 0) == "absent");
        service
            .fault(Fault::Reconnect { device: device() })
            .expect("a fault");
        until("the arm again", || stage(station, 0) == "live");
    });
    let [(unplugged, _), (plugged, _)] = ran.log.faults()[..] else {
        panic!("two faults: {:?}", ran.log.faults());
    };
    let forces = ran.log.forces(ARMS[0]);
    let before = forces.iter().filter(|sent| sent.t_ns < unplugged);
    assert!(before.map(|sent| sent.norm()).fold(0.0, f64::max) > 0.1);
    // The person presses a button at once: the force then grows within the ramp, never faster.
    for sent in forces.iter().filter(|sent| sent.t_ns > plugged) {
        let x = ((sent.t_ns - plugged) as f64 / 5e8).min(1.0);
        let most = 3.3 * x * x * (3.0 - 2.0 * x);
        assert!(
            sent.norm() <= most + 1e-9,
            "{} N at {x} of the ramp",
            sent.norm()
        );
    }
    let stages = stages(&ran.recording);
    let is = |name: &str| {
        stages
            .iter()
            .any(|(tool, stage)| *tool == 0 && stage == name)
    };
    assert!(is("absent") && is("live"), "{stages:?}");
    replays(&ran.recording);
}
