//! A shell script in the place of the program: parts to all viewers, ends of every kind, nothing that waits.

use std::os::unix::fs::PermissionsExt as _;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use tokio::sync::broadcast::error::RecvError;

use super::*;

/// Time in which anything of a test must happen.
const SOON: Duration = Duration::from_secs(20);
/// First part `begin`, then nothing but the ends of the pipe.
const BEGIN: &str = "printf '\\005\\000\\000\\000\\101begin'";
/// A further part `12`.
const FURTHER: &str = "printf '\\002\\000\\000\\000\\10212'";

struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        Self {
            folder: tempfile::tempdir().expect("a folder"),
        }
    }

    fn program(&self, script: &str) -> PathBuf {
        let path = self.folder.path().join("program");
        std::fs::write(&path, format!("#!/bin/sh\n{script}\n")).expect("a script");
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o700))
            .expect("executable");
        path
    }
}

/// Source whose tick rises until `over`.
fn source(over: &Arc<AtomicBool>, asked: &Arc<AtomicU64>) -> Source {
    let (over, asked) = (over.clone(), asked.clone());
    Source {
        begun: 1,
        scene: vec![7; 60_000].into(),
        newest: Box::new(move || {
            let tick = asked.fetch_add(1, Ordering::Relaxed);
            let hands = Hands {
                tick,
                ..Hands::default()
            };
            (!over.load(Ordering::Relaxed)).then_some(Some(hands))
        }),
    }
}

fn start(place: &Place, script: &str, unwatched: Duration) -> (Drawing, Arc<AtomicBool>) {
    let over = Arc::new(AtomicBool::new(false));
    let program = place.program(script);
    let source = source(&over, &Arc::default());
    let drawing = Drawing::start_with(&program, "a".into(), source, unwatched);
    (drawing.expect("started"), over)
}

fn run(test: impl Future<Output = ()>) {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    let timed = async { tokio::time::timeout(SOON, test).await };
    runtime
        .expect("a runtime")
        .block_on(timed)
        .expect("in time");
}

fn until(holds: impl Fn() -> bool) {
    let begin = Instant::now();
    while !holds() {
        assert!(begin.elapsed() < SOON);
        std::thread::sleep(LOOK);
    }
}

#[test]
fn two_viewers_get_the_same_parts_and_a_late_one_the_first_part_too() {
    let place = Place::new();
    let script = format!("{BEGIN}\nwhile sleep 0.05; do {FURTHER}; done & cat >/dev/null; kill $!");
    let (drawing, over) = start(&place, &script, SOON);
    run(async {
        let mut all = [
            drawing.watch().expect("open"),
            drawing.watch().expect("open"),
        ];
        for live in &mut all {
            let begin = live.begin.wait_for(Option::is_some).await.expect("begun");
            assert_eq!(begin.as_deref(), Some(b"begin".as_slice()));
        }
        for live in &mut all {
            assert_eq!(&*live.further.recv().await.expect("a part"), b"12");
        }
        let mut late = drawing.watch().expect("open");
        assert!(late.begin.borrow().is_some());
        assert_eq!(&*late.further.recv().await.expect("a part"), b"12");
        over.store(true, Ordering::Relaxed);
        while !matches!(late.further.recv().await, Err(RecvError::Closed)) {}
        assert!(drawing.is_over() && drawing.watch().is_none());
    });
}

#[test]
fn a_viewer_that_takes_nothing_holds_four_parts_and_delays_nobody() {
    let place = Place::new();
    let script = format!("{BEGIN}\nwhile sleep 0.01; do {FURTHER}; done & cat >/dev/null; kill $!");
    let (drawing, _over) = start(&place, &script, SOON);
    run(async {
        let (mut stalled, mut quick) = (
            drawing.watch().expect("open"),
            drawing.watch().expect("open"),
        );
        for _ in 0..50 {
            match quick.further.recv().await {
                Ok(_) | Err(RecvError::Lagged(_)) => {}
                Err(RecvError::Closed) => panic!("the stream has ended"),
            }
        }
        assert!(
            stalled.further.len() > QUEUE,
            "counted with those that are gone"
        );
        let Err(RecvError::Lagged(missed)) = stalled.further.recv().await else {
            panic!("nothing was dropped");
        };
        assert!(missed > 30, "{missed}");
        // A further part may have come in the meantime.
        assert!(stalled.further.len() <= QUEUE + 1);
    });
}

#[test]
fn a_program_that_ends_or_sends_nonsense_ends_the_stream_of_its_viewers() {
    let place = Place::new();
    for script in [
        "exit 3",
        BEGIN,
        "printf 'nonsense, not a message'",
        FURTHER,
        &format!("{BEGIN}\n{BEGIN}\nexec cat >/dev/null"),
        // Longer than a part may be.
        "printf '\\377\\377\\377\\377\\102'; exec cat >/dev/null",
    ] {
        let (drawing, _over) = start(&place, script, SOON);
        run(async {
            let Some(mut live) = drawing.watch() else {
                return;
            };
            while !matches!(live.further.recv().await, Err(RecvError::Closed)) {}
        });
        until(|| drawing.is_over());
    }
}

#[test]
fn a_program_without_viewers_ends_and_one_that_hangs_is_ended() {
    let place = Place::new();
    // Reads no end of its input, and lives on.
    let marker = place.folder.path().join("pid");
    let script = format!("echo $$ >{}\n{BEGIN}\nexec sleep 600", marker.display());
    let (drawing, _over) = start(&place, &script, Duration::from_millis(200));
    until(|| drawing.is_over());
    let text = std::fs::read_to_string(&marker).expect("it ran");
    let id = text
        .trim()
        .parse()
        .ok()
        .and_then(rustix::process::Pid::from_raw)
        .expect("an id");
    until(|| rustix::process::test_kill_process(id).is_err());
}

#[test]
fn a_missing_program_is_an_error_with_a_reason() {
    let place = Place::new();
    let source = source(&Arc::default(), &Arc::default());
    let told = Drawing::start(&place.folder.path().join("none"), "a".into(), source);
    let told = told.err().expect("there is none");
    assert!(told.contains("cannot be started"), "{told}");
}
