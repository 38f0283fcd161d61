//! The first failure of a recorder, and its panic.

use std::sync::Mutex;

use sulcus_core::output::ToolOutput;
use sulcus_core::{Pose, Scene, TickOutput};
use sulcus_proto::SessionSummary;
use sulcus_sessions::{Events, Exercise, Recorder, Row, SessionHeader, StationKey};
use tokio::sync::broadcast;

use super::*;
use crate::outlets::feed::FeedPublisher;
use crate::outlets::status::StatusOutlet;
use crate::session::levels::InForce;

/// Output of a tick in which no hand holds a tool.
fn output(tick: u64) -> TickOutput {
    let idle = ToolOutput::absent(Pose::identity());
    TickOutput {
        tick,
        hash: 0,
        tools: [idle; sulcus_core::MAX_TOOLS],
        work: 0,
    }
}

#[test]
fn the_first_failure_is_told_and_the_file_stays_whole() {
    let folder = tempfile::tempdir().expect("folder");
    let path = folder.path().join("session.mcap");
    let key = || StationKey::from_seed([1; 32]);
    let recorder = Recorder::create(&path, &SessionHeader::new(vec![]), key()).expect("created");
    let (mut entries, entries_out) = rtrb::RingBuffer::new(8);
    let (snapshots, _snapshots) = rtrb::RingBuffer::new(1);
    let (looks, _looks) = rtrb::RingBuffer::new(1);
    let (shapes, _shapes) = rtrb::RingBuffer::new(1);
    let (network, network_out) = std::sync::mpsc::sync_channel(EVENTS);
    let (flags, bell) = (Arc::new(Flags::default()), Bell::new().expect("eventfd"));
    let row = |tick| Row {
        tick,
        time_unix_ns: tick,
        input: sulcus_core::TickInput::IDLE,
        hash: 0,
        wrench: Default::default(),
        status: Default::default(),
        device: Default::default(),
    };
    for tick in [1, 2, 2] {
        entries
            .push(Entry::Tick(Ticked {
                row: row(tick),
                output: output(tick),
                cpu_ns: 0,
                in_force: InForce::default(),
                gone: false,
            }))
            .expect("room");
    }
    let scene = Arc::new(Scene {
        name: String::new(),
        source_hash: String::new(),
        params: Default::default(),
        tools: vec![],
        objects: vec![],
    });
    let narrator = Narrator {
        events: Events::new(&scene, &Exercise::free("free", 1.0)),
        scene,
    };
    let writer = SessionWriter::begin(recorder, &narrator.scene, 0, &[], None);
    let listeners = Listeners {
        station: "station".into(),
        status: StatusOutlet::new(&narrator.scene, Arc::default()),
        events: broadcast::channel(1).0,
        session: None,
        feed: Arc::new(Mutex::new(FeedPublisher::new().0)),
    };
    let open = Open(
        writer.expect("begun"),
        "session.mcap".into(),
        narrator,
        listeners,
    );
    let ends = Ends {
        entries: entries_out,
        returned: Returned {
            snapshots,
            looks,
            shapes,
        },
        network: network_out,
        flags: flags.clone(),
        attachment: Arc::default(),
        bell,
        clock: Clock::System,
    };
    let thread = RecorderLoop::new(open, ends).spawn().expect("thread");
    while !Flags::is_up(&flags.record_failed) {
        std::thread::sleep(POLL);
    }
    let summary = SessionSummary::empty(sulcus_proto::control::EndReason::Recording);
    network
        .send(FromNetwork::End(Box::new(summary)))
        .expect("heard");
    let report = thread.join().expect("no panic");
    assert!(report.error.expect("an error").contains("in order"));
    let recording = sulcus_sessions::Recording::open(&path).expect("readable");
    assert_eq!(recording.facts().rows, 2);
}

#[test]
fn a_recorder_that_panics_is_told_at_once() {
    let (flags, bell) = (Arc::new(Flags::default()), Bell::new().expect("eventfd"));
    let alarm = || Alarm {
        flags: flags.clone(),
        bell: bell.clone(),
    };
    drop(alarm());
    assert!(!Flags::is_up(&flags.record_failed), "nothing happened");
    let alarm = alarm();
    let thread: JoinHandle<()> = std::thread::spawn(move || {
        let _alarm = alarm;
        panic!("a recorder that panics");
    });
    assert!(thread.join().is_err());
    assert!(Flags::is_up(&flags.record_failed));
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .expect("runtime");
    runtime.block_on(async {
        let mut heard = bell.listen().expect("registered");
        let rung = tokio::time::timeout(Duration::from_secs(5), heard.rung());
        assert!(rung.await.is_ok());
    });
}
