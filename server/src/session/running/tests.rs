//! Sessions with threads, from the start to the end of their recordings.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use sulcus_sessions::{Ending, ReadError, Recording, ReplayOptions, ViewersPolicy, replay};
use tokio::sync::broadcast;

use super::*;
use crate::outlets::feed::FeedPublisher;
use crate::session::levels::Levels;
use crate::session::precedence::Places;
use crate::session::simulation::tests::scene;
use crate::station::config::SessionPlan;

fn running(folder: &std::path::Path, at_hand: bool) -> Running {
    let scene = scene();
    let bytes = scene.to_bytes().expect("bytes");
    let asked = Opening {
        plan: Arc::new(SessionPlan::new(Arc::new(scene), Arc::new(bytes))),
        softer: Vec::new(),
        folder: folder.to_owned(),
        viewers: ViewersPolicy::default(),
        key: Some(folder.join("station.key")),
        station: "station".to_owned(),
        learner: String::new(),
        client: "client of a test".to_owned(),
        devices: Vec::new(),
        epoch: 1,
        predecessor: None,
        live: Arc::default(),
        events: broadcast::channel(1).0,
        feed: Arc::new(Mutex::new(FeedPublisher::new().0)),
    };
    let begin = Begin {
        epoch: 1,
        levels: Levels::default(),
        real_time: false,
        places: Arc::new(Places::of(1)),
        core: None,
        at_hand,
    };
    Running::start(asked, begin).expect("started")
}

/// Waits up to 10 s.
fn wait_for(what: impl Fn() -> bool) {
    let until = Instant::now() + Duration::from_secs(10);
    while !what() {
        assert!(Instant::now() < until, "nothing has happened for 10 s");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn threads_tick_and_record_until_the_end() {
    let folder = tempfile::tempdir().expect("folder");
    let running = running(folder.path(), false);
    let (ports, name) = (running.ports().clone(), running.file_name().to_owned());
    wait_for(|| ports.tick() > 50);
    let (summary, text) = running.finish(SessionSummary::empty(EndReason::Instructor));
    assert_eq!(text, "The instructor ended the session.");
    assert!(summary.complete && summary.ticks > 0, "{summary:?}");
    assert_eq!(summary.recording, name);
    assert!(Flags::is_up(&ports.flags().simulation_over));
    let recording = Recording::open(&folder.path().join(name)).expect("readable");
    assert_eq!(*recording.ending(), Ending::Finished);
    assert_eq!(recording.facts().rows, summary.ticks);
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| ()).expect("replayed");
    assert!(report.identical && report.chain_ok);
}

#[test]
fn a_session_at_a_hand_that_never_ticks_ends_with_a_whole_recording() {
    let folder = tempfile::tempdir().expect("folder");
    let running = running(folder.path(), true);
    let name = running.file_name().to_owned();
    let (summary, text) = running.finish(SessionSummary::empty(EndReason::Stopped));
    assert_eq!(text, "The session was stopped.");
    assert!(summary.complete && summary.ticks == 0, "{summary:?}");
    // Readers refuse a file without ticks, and say that it is whole.
    let refused = Recording::open(&folder.path().join(name)).expect_err("no ticks");
    let is_whole = matches!(&refused, ReadError::NoRows { ending } if ending == "finished");
    assert!(is_whole, "{refused}");
}

#[test]
fn a_thread_that_panics_raises_its_flag_and_is_the_reason_of_the_end() {
    for (fault, end) in [
        (Provoked::Recorder, EndReason::Recording),
        (Provoked::Simulation, EndReason::Simulation),
    ] {
        let folder = tempfile::tempdir().expect("folder");
        let running = running(folder.path(), false);
        let ports = running.ports().clone();
        running.provoke(fault);
        let flag = match fault {
            Provoked::Recorder => &ports.flags().record_failed,
            _ => &ports.flags().simulation_over,
        };
        wait_for(|| Flags::is_up(flag));
        let (summary, text) = running.finish(SessionSummary::empty(EndReason::Stopped));
        assert_eq!((summary.end, summary.complete), (end, false), "{text}");
        assert!(text.contains("unexpectedly"), "{text}");
    }
}
