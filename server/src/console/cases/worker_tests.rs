use std::time::{Duration, Instant};

use proptest::prelude::*;

use super::*;

fn shell(script: &str) -> Command {
    let mut command = Command::new("sh");
    command.args(["-c", script]);
    command
}

fn until(worker: &Worker, what: &str, is_so: impl Fn(&Work) -> bool) -> Work {
    let begin = Instant::now();
    loop {
        let work = worker.work();
        if is_so(&work) {
            return work;
        }
        assert!(
            begin.elapsed() < Duration::from_secs(20),
            "{what}: {work:?}"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn one_child_runs_at_a_time_and_its_stage_is_seen() {
    let place = tempfile::tempdir().expect("temporary folder");
    let flag = place.path().join("go");
    let worker = Worker::default();
    let script = format!(
        "echo ' 42 %  tooth 43' >&2; while [ ! -e {} ]; do sleep 0.02; done",
        flag.display()
    );
    worker.add("a", shell(&script));
    worker.add("b", shell("true"));
    worker.add("b", shell("exit 3"));
    let work = until(&worker, "a stage", |work| {
        work.running
            .as_ref()
            .is_some_and(|running| running.percent == 42)
    });
    assert_eq!(
        work.running.map(|running| running.stage).as_deref(),
        Some("tooth 43")
    );
    assert_eq!(work.waiting, ["b"], "once");
    std::fs::write(&flag, "").expect("writes");
    let work = until(&worker, "both", |work| {
        work.ended == 2 && work.running.is_none()
    });
    assert!(
        work.failed.is_empty() && work.waiting.is_empty(),
        "{work:?}"
    );
    // The thread of the first two has ended.
    worker.add("c", shell("true"));
    until(&worker, "a third", |work| {
        work.ended == 3 && work.running.is_none()
    });
}

#[test]
fn a_child_that_fails_crashes_or_is_missing_is_told_in_a_sentence() {
    let worker = Worker::default();
    worker.add(
        "said",
        shell("echo ' 6 %  tooth' >&2; echo 'error: the tooth is odd' >&2; exit 2"),
    );
    worker.add("crashed", shell("kill -SEGV $$"));
    worker.add("silent", shell("exit 7"));
    worker.add("missing", Command::new("/no/such/program"));
    let work = until(&worker, "all", |work| work.ended == 4);
    let failed: BTreeMap<_, _> = work.failed.into_iter().collect();
    assert_eq!(failed["said"], "the tooth is odd");
    assert!(failed["crashed"].contains("signal 11"), "{failed:?}");
    assert!(failed["silent"].contains('7'), "{failed:?}");
    assert!(failed["missing"].contains("does not start"), "{failed:?}");
    worker.forget("said");
    assert_eq!(worker.work().failed.len(), 3);
}

#[test]
fn a_stopped_compilation_ends_at_once_and_is_no_failure() {
    let worker = Worker::default();
    // Without `exec` a grandchild would keep the pipe.
    worker.add("long", shell("echo ' 1 %  x' >&2; exec sleep 600"));
    worker.add("next", shell("exec sleep 600"));
    until(&worker, "its start", |work| {
        work.running
            .as_ref()
            .is_some_and(|running| running.percent == 1)
    });
    worker.cancel("other");
    worker.cancel("next");
    worker.cancel("long");
    let work = until(&worker, "its end", |work| work.running.is_none());
    assert!(work.failed.is_empty(), "{work:?}");
    assert_eq!(work.ended, 1);
}

proptest! {
    #[test]
    fn any_output_of_a_child_is_read(bytes in prop::collection::vec(any::<u8>(), 0..9000)) {
        let mut longest = 0;
        each_line(&bytes[..], |line| {
            longest = longest.max(line.chars().count());
            let _ = progress(line);
        });
        prop_assert!(longest <= LINE as usize);
    }
}
