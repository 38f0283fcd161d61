//! A server with a tiny scene on loopback, and a hand that presses on it.
#![allow(dead_code, clippy::unwrap_used)]

pub mod raw;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use sulcus_connection::link::{Link, LinkConfig, LinkError, PosePacket, now_ns};
use sulcus_core::tissue::TissueModel;
use sulcus_core::{DisplayMesh, Object, Params, Pose, Quat, Scene, Sphere, SphereTree, Tool, Vec3};
use sulcus_proto::datagram::{ToolPose, WirePose};
use sulcus_server::{Server, ServerConfig, ServerHandle, SessionPlan, StationConfig};
use sulcus_sessions::{Message, Occurrence, Recording, Row};
use tempfile::TempDir;

/// Radius of every sphere, metres.
pub const RADIUS: f64 = 1e-3;

/// Limit of every wait for a condition, far beyond the time that a busy machine needs.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// Waits until a condition holds.
pub fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !holds() {
        assert!(begun.elapsed() < PATIENCE, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Flag that is raised at the end of a scope, also after a panic: a thread that waits for the flag then ends.
pub struct Raised<'a>(pub &'a AtomicBool);

impl Drop for Raised<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// A ball over a plate of balls, level with z = 0.
pub fn scene() -> Scene {
    let plate: Vec<Sphere> = (-3..=3)
        .flat_map(|x| (-3..=3).map(move |y| Vec3::new(f64::from(x), f64::from(y), 0.0) * RADIUS))
        .map(|centre| Sphere {
            centre,
            radius: RADIUS,
        })
        .collect();
    let ball = [Sphere {
        centre: Vec3::zeros(),
        radius: RADIUS,
    }];
    Scene {
        name: "plate".into(),
        source_hash: "none".into(),
        params: Params::default(),
        tools: vec![Tool {
            name: "ball".into(),
            tree: SphereTree::over_leaves(&ball).unwrap(),
            level: 3,
            working_point: Vec3::zeros(),
            tip: Vec3::new(0.0, 0.0, -RADIUS),
            tip_axis: -Vec3::z(),
            stiffness_n_per_m: 500.0,
            stiffness_nm_per_rad: 0.5,
            park: Pose::new(Vec3::new(0.0, 0.0, 0.02), Quat::identity()),
            bands: vec![],
            mesh: DisplayMesh::default(),
        }],
        objects: vec![Object {
            name: "plate".into(),
            fdi: 0,
            tree: SphereTree::over_leaves(&plate).unwrap(),
            level: 3,
            tissue: TissueModel::Rigid,
            mesh: DisplayMesh::default(),
            carriers: Vec::new(),
        }],
    }
}

/// Free exploration of [`scene`].
pub fn plan() -> SessionPlan {
    let scene = scene();
    let bytes = scene.to_bytes().unwrap();
    SessionPlan::new(Arc::new(scene), Arc::new(bytes))
}

/// A server whose files go when this does.
pub struct Station {
    pub server: Option<ServerHandle>,
    pub folder: TempDir,
}

impl Station {
    pub fn new() -> Self {
        Self::with(|_| ())
    }

    /// A station whose plan `change` has changed.
    pub fn planned(change: impl FnOnce(&mut SessionPlan)) -> Self {
        Self::with(|config| change(&mut config.stations[0].plan))
    }

    pub fn with(change: impl FnOnce(&mut ServerConfig)) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let station = StationConfig::new(plan());
        let mut config = ServerConfig::new(station, folder.path().join("recordings")).unwrap();
        config.station_key = Some(folder.path().join("station.key"));
        change(&mut config);
        let server = Server::start(config).unwrap();
        Self {
            server: Some(server),
            folder,
        }
    }

    pub fn server(&self) -> &ServerHandle {
        self.server.as_ref().unwrap()
    }

    pub fn config(&self) -> LinkConfig {
        let server = self.server();
        LinkConfig {
            timeout: PATIENCE,
            ..LinkConfig::new(server.local_addr(), server.ticket(), "test")
        }
    }

    pub fn connect(&self) -> Result<Link, LinkError> {
        Link::connect(self.config())
    }

    pub fn recording(&self, name: &str) -> PathBuf {
        self.folder.path().join("recordings").join(name)
    }
}

/// The ball held at `height` above the plate's centre plane, metres: below 2 mm it presses.
pub fn pose(height: f64) -> PosePacket {
    let mut packet = PosePacket::default();
    packet.tools[0] = ToolPose {
        present: true,
        device_time_ns: now_ns(),
        // A number of its own for each reading: time passes between two.
        sequence: (now_ns() / 1000) as u32,
        pose: WirePose {
            position: [1e-4, 2e-4, height as f32],
            ..WirePose::IDENTITY
        },
        ..ToolPose::default()
    };
    packet
}

/// Sends poses at about 1 kHz, coming down from 12 mm to press 1 mm deep, until `done` says so.
pub fn press(link: &mut Link, mut done: impl FnMut(&mut Link, u64) -> bool) {
    let begun = Instant::now();
    for k in 0.. {
        let height = (0.012 - 2e-5 * k as f64).max(0.001);
        link.send_pose(&pose(height));
        if done(link, k) {
            return;
        }
        assert!(
            begun.elapsed() < PATIENCE,
            "waited in vain after {k} poses: {:?}",
            link.stats()
        );
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Upward force of the newest wrench, newtons.
pub fn force_up(link: &mut Link) -> f32 {
    link.latest_wrench()
        .map_or(0.0, |packet| packet.datagram.tools[0].wrench.force[2])
}

/// Poses of a hand that stays pressed, until `done`.
pub fn press_on(link: &mut Link, mut done: impl FnMut(&mut Link) -> bool) {
    let begun = Instant::now();
    loop {
        link.send_pose(&pose(0.001));
        if done(link) {
            return;
        }
        assert!(
            begun.elapsed() < PATIENCE,
            "waited in vain: {:?}, {:?}",
            link.latest_wrench(),
            link.stats()
        );
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Status bits of the newest wrench.
pub fn status_of(link: &mut Link) -> u16 {
    link.latest_wrench()
        .map_or(0, |packet| packet.datagram.tools[0].status)
}

/// Session epoch of the newest wrench; 0 before the first one.
pub fn epoch_of(link: &mut Link) -> u32 {
    link.latest_wrench()
        .map_or(0, |packet| packet.datagram.epoch)
}

/// Tick of the newest wrench on the grid of the server's clock; 0 before the first one.
pub fn tick_of(link: &mut Link) -> u64 {
    link.latest_wrench()
        .map_or(0, |packet| packet.datagram.tick)
}

/// Points of the clock's grid in some rows of a recording: each tick with the points that were skipped before it.
pub fn points<'a>(rows: impl IntoIterator<Item = &'a Row>) -> u64 {
    let of = |row: &Row| 1 + u64::from(row.input.skipped);
    rows.into_iter().map(of).sum()
}

/// All rows and occurrences of a recording.
pub fn rows_and_events(recording: &Recording) -> (Vec<Row>, Vec<Occurrence>) {
    let (mut rows, mut events) = (Vec::new(), Vec::new());
    for message in recording.messages() {
        match message.unwrap() {
            Message::Row(row) => rows.push(row),
            Message::Event(event) => events.extend(Occurrence::parse(&event.text)),
            _ => {}
        }
    }
    (rows, events)
}
