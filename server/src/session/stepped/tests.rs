//! A stepped session is a whole one, and the same inputs make the same bytes.

use sulcus_link::clock::SetClock;
use sulcus_proto::WrenchDatagram;
use sulcus_proto::control::{Command, Event};
use sulcus_sessions::{Detached, Ending, Recording, ReplayOptions, replay};

use super::*;
use crate::session::simulation::tests::scene;

/// Time from a pose to its tick, nanoseconds.
const BEFORE: u64 = 300_000;

fn plan() -> SessionPlan {
    let scene = scene();
    let bytes = scene.to_bytes().expect("bytes");
    SessionPlan::new(Arc::new(scene), Arc::new(bytes))
}

fn begun(folder: &Path, key: &Path) -> (SteppedSession, Arc<SetClock>) {
    let set = Arc::new(SetClock::new(12_345_678, 1_795_241_730_000_000_000));
    let clock = Clock::Set(set.clone());
    let session = SteppedSession::begin(plan(), folder, key, 1, clock).expect("begun");
    (session, set)
}

fn pose(epoch: u32, k: u32) -> Vec<u8> {
    let mut pose = PoseDatagram {
        epoch,
        sequence: k,
        ..PoseDatagram::default()
    };
    pose.tools[0].present = true;
    pose.tools[0].sequence = k;
    pose.tools[0].pose.position[2] = 0.006 - 2.8e-5 * k as f32;
    pose.to_bytes().expect("a pose").to_vec()
}

/// 200 ticks with a pause, a gap, presses and events; the hash of the last state.
fn run(folder: &Path, key: &Path) -> (SteppedEnd, u64) {
    let (mut session, set) = begun(folder, key);
    let hello = session.hello();
    assert_eq!(
        (hello.epoch, hello.tick_ns, hello.tools.len()),
        (1, 1_000_000, 1)
    );
    for k in 0..200 {
        let due_ns = session.next_tick_ns();
        set.set_ns(due_ns - BEFORE);
        assert!(session.tick().is_none(), "not due");
        match k {
            30 => session.press(0, 1),
            40 => session.event(Event {
                tick: session.tick_number(),
                kind: "note".into(),
                json: "{}".into(),
            }),
            50 => assert_eq!(session.instructor(Command::Pause), Taken::Set),
            60 => {
                assert_eq!(session.instructor(Command::Resume), Taken::Lifted);
                session.begin_epoch(2);
            }
            70 => assert_eq!(session.student(Command::ForceLimit(0.5)), Taken::Set),
            100 => session.let_go(Detached::ConnectionLost),
            110 => session.begin_epoch(3),
            _ => {}
        }
        assert_eq!(session.levels_in_force().paused(), (50..60).contains(&k));
        let is_here = !(100..110).contains(&k);
        if is_here {
            let arrived =
                session.datagram(&pose(session.epoch(), k), due_ns - BEFORE, Duration::ZERO);
            assert!(arrived.is_some());
        }
        set.set_ns(due_ns);
        set.spend_cpu_ns(1_000);
        let ticked = session.tick().expect("due");
        assert_eq!(ticked.output.hash, session.state_hash());
        assert_eq!(ticked.input.tools[0].present, is_here);
        assert_eq!(
            ticked.used.map(|(pose, _)| pose.sequence),
            is_here.then_some(k)
        );
        let sent = session
            .wrench(due_ns + 1_000)
            .expect("a wrench of each tick");
        let sent = WrenchDatagram::from_bytes(&sent).expect("a wrench");
        assert_eq!((sent.tick, sent.sequence), (u64::from(k) + 1, k));
        let echo = &sent.tools[0].echo;
        assert_eq!(echo.valid, is_here);
        if echo.valid {
            assert_eq!((echo.wait_us, echo.hold_us), (300, 301));
        }
        if k % 7 == 0 {
            assert_eq!(session.record(), Some(Duration::from_millis(5)));
        }
    }
    assert_eq!(session.tick_number(), 200);
    assert!(session.waiting() >= 3, "the ticks since the last step");
    assert_eq!(
        (session.commands_obeyed(), session.record_failed()),
        (2, false)
    );
    let hash = session.state_hash();
    (session.finish(EndReason::Stopped), hash)
}

#[test]
fn the_same_inputs_make_the_same_recording_to_the_byte() {
    let folder = tempfile::tempdir().expect("folder");
    let key = folder.path().join("station.key");
    let ends = ["a", "b"].map(|name| {
        let folder = folder.path().join(name);
        std::fs::create_dir(&folder).expect("created");
        let (end, hash) = run(&folder, &key);
        (folder.join(&end.file_name), end, hash)
    });
    for (path, end, hash) in &ends {
        let summary = &end.summary;
        assert!(summary.complete && end.error.is_none(), "{end:?}");
        assert_eq!(end.text, "The session was stopped.");
        assert_eq!(
            (summary.ticks, summary.skipped, summary.deadline_misses),
            (200, 0, 0)
        );
        assert_eq!((summary.poses.accepted, summary.foreign), (190, 0));
        assert!(summary.max_force_n > 0.1, "it did press: {summary:?}");
        assert_eq!(*hash, ends[0].2);
        let recording = Recording::open(path).expect("readable");
        assert_eq!(recording.facts().rows, 200);
        assert_eq!(*recording.ending(), Ending::Finished);
        let report = replay(&recording, &ReplayOptions::default(), &mut |_| ()).expect("replayed");
        assert!(report.identical && report.chain_ok);
    }
    let [a, b] = ends.map(|(path, ..)| std::fs::read(path).expect("read"));
    assert!(a == b, "{} and {} bytes", a.len(), b.len());
}

#[test]
fn a_late_step_skips_points_as_a_late_thread_does() {
    let folder = tempfile::tempdir().expect("folder");
    let (mut session, set) = begun(folder.path(), &folder.path().join("station.key"));
    set.set_ns(session.next_tick_ns() + 5_400_000);
    assert_eq!(session.tick().map(|ticked| ticked.input.skipped), Some(5));
    assert!(session.tick().is_none());
    assert_eq!(session.tick_number(), 6);
    // Events wait for a recorder that is not stepped, and its channel has an end.
    for _ in 0..300 {
        session.event(Event {
            tick: 6,
            kind: "note".into(),
            json: "{}".into(),
        });
    }
    let end = session.finish(EndReason::TimeUp);
    assert_eq!((end.summary.ticks, end.summary.skipped), (1, 5));
    assert_eq!(
        (end.summary.edges_dropped, end.summary.complete),
        (44, true)
    );
}
