//! Server, client and both devices of a session.

use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;

use sulcus_cases::mouth::mouth;
use sulcus_client::devices::opened::open;
use sulcus_client::devices::settings::{DeviceSettings, Hand, Settings};
use sulcus_connection::device::{DeviceEvent, EventDevice, Glance};
use sulcus_connection::device_loop::run;
use sulcus_connection::link::{Link, LinkConfig};
use sulcus_connection::threaded::DeviceHands;
use sulcus_core::{MAX_TOOLS, ToolInput};
use sulcus_haptics::{HandSource, Merger, Shown, Stage};
use sulcus_server::{Server, ServerConfig, SessionPlan, StationConfig};

use crate::messages::{DEVICES, MARK, Performed, SEAT_HOUR, Said};
use crate::{allocations, place};

/// Threads that call the devices: that of the driver's scheduler, and that of the back-end for each omega.6.
const DEVICE_THREADS: [&str; 2] = ["standin-hd", "dhd-"];

/// Tells the test.
fn tell(said: &Said) {
    let text = serde_json::to_string(said).expect("JSON");
    let mut output = std::io::stdout().lock();
    writeln!(output, "\n{MARK}{text}").expect("output");
    output.flush().expect("output");
}

/// Devices whose person presses a key for the force when the devices ask for it.
struct Person {
    device: DeviceHands,
    stages: [Option<Stage>; MAX_TOOLS],
    /// Number of watched threads, from the moment at which both devices pass the whole force.
    threads: Option<usize>,
    heard: Vec<(u64, u64)>,
}

impl HandSource for Person {
    fn name(&self) -> &str {
        self.device.name()
    }

    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        self.device.exchange(shown)
    }
}

impl EventDevice for Person {
    fn events(&mut self) -> Vec<DeviceEvent> {
        self.device.events()
    }

    fn glance(&mut self, glance: &Glance) {
        self.stages = glance.stages;
        self.heard.push((glance.now_ns, glance.tick));
        if self.threads.is_none() && self.stages == [Some(Stage::Live); MAX_TOOLS] {
            self.threads = Some(allocations::watch(&DEVICE_THREADS));
            tell(&Said::Live);
        }
        self.device.glance(glance);
    }

    fn threaded(&mut self) -> Option<&mut Merger> {
        let merger = self.device.threaded()?;
        for (slot, stage) in self.stages.iter_mut().enumerate() {
            if stage.take() == Some(Stage::Waiting) {
                merger.press(slot);
            }
        }
        Some(merger)
    }
}

/// Runs a session of `seconds` in `folder`.
pub fn run_in(folder: PathBuf, seconds: u64) {
    let scene = mouth(1, false, 3);
    let poses = [0, 1].map(|slot| place::over_a_tooth(&scene, slot));
    tell(&Said::Placed(
        [0, 1].map(|slot| place::drop(&scene, slot, &poses[slot])),
    ));

    let mut settings = Settings::default();
    for ((name, hand), pose) in DEVICES.iter().zip([Hand::Right, Hand::Left]).zip(&poses) {
        let (library, serial) = name.split_once(':').expect("library and serial number");
        settings.store(DeviceSettings {
            hand: Some(hand),
            seat_hour: SEAT_HOUR,
            origin_mm: Some((pose.position * 1e3).into()),
            ..DeviceSettings::new(library, serial)
        });
    }
    let named = DEVICES.map(|name| name.parse().expect("a name"));
    let opened = open(&named, &settings, Hand::Right).expect("both devices");

    let bytes = scene.to_bytes().expect("small");
    let plan = SessionPlan::new(Arc::new(scene), Arc::new(bytes));
    let recordings = folder.join("recordings");
    let mut config = ServerConfig::new(StationConfig::new(plan), recordings.clone()).expect("free");
    config.station_key = Some(folder.join("station.key"));
    let server = Server::start(config).expect("a server");
    let mut link = LinkConfig::new(server.local_addr(), server.ticket(), "test");
    link.devices = opened.describe(1e-3);
    let mut link = Link::connect(link).expect("connected");
    let device = opened.begin(link.hello(), None).expect("threads");
    // The vector holds all periods from the beginning: the loop allocates nothing for it.
    let mut person = Person {
        device,
        stages: [None; MAX_TOOLS],
        threads: None,
        heard: Vec::with_capacity(2 * 1000 * (seconds as usize + 10)),
    };
    assert!(link.start());
    let periods = 1000 * (seconds + 3);
    let report = run(&mut link, &mut person, periods, None, &AtomicU64::new(0));
    let allocations = allocations::counted();
    let Person {
        device,
        threads,
        heard,
        ..
    } = person;
    drop(device);
    let summary = link.finish().expect("a goodbye");
    assert!(summary.complete);
    tell(&Said::Performed(Performed {
        recording: recordings.join(&summary.recording),
        pose_age_us: report.pose_age_us,
        trips: report.trips,
        threads: threads.expect("both devices with their whole force"),
        allocations,
        heard,
    }));
}
