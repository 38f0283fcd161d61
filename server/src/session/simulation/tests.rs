//! Single steps of the ticker: no allocation, no uncounted loss.

#[path = "../../../core/tests/counting/mod.rs"]
mod counting;

use counting::calls;
use rtrb::{Consumer, Producer, RingBuffer};
use sulcus_core::tissue::TissueModel;
use sulcus_core::{DisplayMesh, Object, Params, Pose, Quat, Sphere, SphereTree, State, Tool, Vec3};
use sulcus_link::clock::monotonic_ns;
use sulcus_proto::PoseDatagram;
use sulcus_sessions::exercise::events::Look;
use sulcus_sessions::{Sampler, Shapes};
use triple_buffer::triple_buffer;

use super::*;
use crate::outlets::recording::{Entry, Ticked};

#[test]
fn status_bits_are_the_same_in_core_and_on_the_wire() {
    use sulcus_core::output::status as core;
    use sulcus_proto::status as wire;
    let pairs = [
        (core::ABSENT, wire::ABSENT),
        (core::STALE, wire::STALE),
        (core::PAUSED, wire::PAUSED),
        (core::SATURATED, wire::SATURATED),
        (core::SLEW_LIMITED, wire::SLEW_LIMITED),
        (core::EXHAUSTED, wire::EXHAUSTED),
        (core::SOLVER_FAILED, wire::SOLVER_FAILED),
        (core::BAD_INPUT, wire::BAD_INPUT),
        (core::SPEED_CLAMPED, wire::SPEED_CLAMPED),
        (core::CONTACTS_FULL, wire::CONTACTS_FULL),
        (core::TWIST_SATURATED, wire::TWIST_SATURATED),
        (core::RAMPING, wire::RAMPING),
        (core::FAULT, wire::FAULT),
        (core::SETTLING, wire::SETTLING),
        (core::FREE, wire::FREE),
        (core::NOT_MET, wire::NOT_MET),
    ];
    assert!(pairs.iter().all(|(core, wire)| core == wire));
}

/// A ball over another.
pub(crate) fn scene() -> Scene {
    let ball = SphereTree::over_leaves(&[Sphere {
        centre: Vec3::zeros(),
        radius: 1e-3,
    }])
    .expect("a ball");
    Scene {
        name: "two balls".into(),
        source_hash: String::new(),
        params: Params::default(),
        tools: vec![Tool {
            name: "ball".into(),
            tree: ball.clone(),
            level: 3,
            working_point: Vec3::zeros(),
            tip: Vec3::zeros(),
            tip_axis: -Vec3::z(),
            stiffness_n_per_m: 500.0,
            stiffness_nm_per_rad: 0.5,
            park: Pose::new(Vec3::new(0.0, 0.0, 0.01), Quat::identity()),
            bands: vec![],
            mesh: DisplayMesh::default(),
        }],
        objects: vec![Object {
            name: "ball".into(),
            fdi: 0,
            tree: ball,
            level: 3,
            tissue: TissueModel::Rigid,
            mesh: DisplayMesh::default(),
            carriers: Vec::new(),
        }],
    }
}

/// Waits for the next grid point, as the thread does, and steps.
fn step(ticker: &mut Ticker) {
    sleep_until(ticker.next_ns());
    assert_eq!(ticker.step(), ticker.next_ns());
}

struct Bench {
    ticker: Ticker,
    poses: triple_buffer::Input<Option<PoseIn>>,
    pressed: Arc<Pressed>,
    entries: Consumer<Entry>,
    buffers: Producer<Vec<u8>>,
}

fn bench(rows: usize) -> Bench {
    let scene = Arc::new(scene());
    let (poses, poses_out) = triple_buffer(&None);
    let (wrenches, _) = triple_buffer(&WrenchOut::default());
    let pressed = Arc::<Pressed>::default();
    let (entries_in, entries) = RingBuffer::new(rows);
    let (mut buffers, buffers_out) = RingBuffer::new(1);
    buffers
        .push(Vec::with_capacity(State::most_bytes(&scene)))
        .expect("room");
    let look = Look::new(&scene);
    let (mut looks, looks_out) = RingBuffer::new(16);
    while looks.push(vec![Vec3::zeros(); look.len()]).is_ok() {}
    let sampler = Sampler::new(&scene);
    let (mut shapes, shapes_out) = RingBuffer::new(32);
    while shapes.push(Box::new(Shapes::new(&scene))).is_ok() {}
    let simulation = Simulation {
        scene,
        poses: poses_out,
        levels: Levels::default(),
        pressed: pressed.clone(),
        wrenches,
        bell: Bell::new().expect("eventfd"),
        flags: Arc::default(),
        progress: Arc::default(),
        detail: Detail::default(),
        clock: Clock::System,
        real_time: false,
        places: Arc::new(Places::of(1)),
        core: None,
    };
    let rings = Rings {
        entries: entries_in,
        buffers: buffers_out,
        look,
        looks: looks_out,
        sampler,
        shapes: shapes_out,
    };
    let mut ticker = Ticker::new(simulation, rings, Metrics::new());
    ticker.begin(false);
    Bench {
        ticker,
        poses,
        pressed,
        entries,
        buffers,
    }
}

fn pose(height: f32) -> Option<PoseIn> {
    let mut datagram = PoseDatagram::default();
    datagram.tools[0].present = true;
    datagram.tools[0].pose.position[2] = height;
    Some(PoseIn {
        datagram,
        arrived_ns: monotonic_ns(),
    })
}

#[test]
fn a_step_allocates_nothing() {
    let mut bench = bench(1024);
    bench.ticker.queue.next_snapshot = 100;
    let before = calls();
    for k in 0..300 {
        bench.poses.write(pose(0.006 - 2e-5 * k as f32));
        bench.pressed.press(0, 1);
        step(&mut bench.ticker);
    }
    assert_eq!(calls(), before);
    assert!(bench.ticker.metrics.ticks == 300 && bench.ticker.state.tick >= 300);
    let mut summary =
        sulcus_proto::SessionSummary::empty(sulcus_proto::control::EndReason::Stopped);
    bench.ticker.metrics.fill(&mut summary);
    assert!(summary.max_force_n > 0.1, "it did press: {summary:?}");
}

#[test]
fn rows_follow_the_grid_and_a_snapshot_follows_its_row() {
    let mut bench = bench(1024);
    bench.ticker.queue.next_snapshot = 3;
    for k in 0..10 {
        if k == 5 {
            // A delay, in which grid points pass.
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        step(&mut bench.ticker);
    }
    let (mut tick, mut snapshots) = (0, 0);
    while let Ok(entry) = bench.entries.pop() {
        match entry {
            Entry::Tick(Ticked { row, output, .. }) => {
                tick += 1 + u64::from(row.input.skipped);
                assert_eq!((row.tick, row.hash), (tick, output.hash));
                assert_eq!(output.tick, tick);
            }
            Entry::Look(of, _) => {
                assert!(
                    of > tick && of.is_multiple_of(50),
                    "a look comes before its tick"
                );
            }
            Entry::Shapes(shapes) => {
                assert!(shapes.tick() > tick, "shapes come before their tick");
            }
            Entry::Snapshot {
                tick: of, bytes, ..
            } => {
                assert_eq!(of, tick);
                assert_eq!(
                    State::from_bytes(&bench.ticker.scene, &bytes).map(|state| state.tick),
                    Ok(tick)
                );
                snapshots += 1;
                bench.buffers.push(bytes).expect("room");
            }
        }
    }
    assert_eq!(snapshots, 1);
    assert!(bench.ticker.metrics.skipped >= 5);
    assert_eq!(
        tick,
        bench.ticker.metrics.ticks + bench.ticker.metrics.skipped
    );
}

#[test]
fn a_recorder_that_stalls_costs_rows_and_says_so() {
    let mut bench = bench(4);
    // On a busy machine one of ten ticks may read shapes, which would take a slot.
    bench.ticker.queue.rings.look = Look::default();
    bench.ticker.queue.rings.shapes = RingBuffer::new(1).1;
    // No snapshot may come before the ring is full, at any position of the clock's grid.
    bench.ticker.queue.next_snapshot = u64::MAX;
    for _ in 0..4 {
        step(&mut bench.ticker);
    }
    bench.ticker.queue.next_snapshot = 0;
    for _ in 0..6 {
        step(&mut bench.ticker);
    }
    assert_eq!(bench.ticker.metrics.rows_dropped, 6);
    assert_eq!(bench.ticker.metrics.snapshots_dropped, 1);
    assert_eq!(bench.ticker.metrics.ticks, 10);
}
