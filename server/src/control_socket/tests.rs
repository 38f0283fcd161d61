//! The control socket over real sockets: requests, refusals, limits, a crashed server.

use std::io::{Read as _, Write as _};
use std::os::unix::fs::PermissionsExt as _;
use std::os::unix::net::UnixStream;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use proptest::prelude::*;
use serde_json::json;
use sulcus_sessions::Mode;

use super::*;
use crate::plan::{PlanBook, Running, Station};
use crate::state::StateFolder;

/// Longest wait for a condition.
const LIMIT: Duration = Duration::from_secs(120);

/// Server with a station `a`, and a station `b` at which an exam runs.
struct Stations(Mutex<PlanBook>);

impl Stations {
    fn of(folder: &StateFolder) -> Arc<dyn Control> {
        let stations = ["a", "b"].map(|name| Station {
            name: name.into(),
            plan: crate::plan::Plan::default(),
        });
        let book = PlanBook::open(&stations, Some(folder)).expect("opens");
        Arc::new(Self(Mutex::new(book)))
    }
}

fn running(station: &str) -> Option<Running> {
    (station == "b").then_some(Running { mode: Mode::Exam })
}

impl Control for Stations {
    fn plans(&self) -> Vec<StationPlan> {
        self.0.lock().expect("no panic").all(running)
    }

    fn set_plan(
        &self,
        station: &str,
        change: &PlanChange,
        by: &str,
    ) -> Result<StationPlan, PlanError> {
        let mut book = self.0.lock().expect("no panic");
        book.set(station, change, by, running(station), 7_000_000_000)
    }

    fn reset_plan(&self, station: &str, by: &str) -> Result<StationPlan, PlanError> {
        let mut book = self.0.lock().expect("no panic");
        book.reset(station, by, running(station), 7_000_000_000)
    }

    fn status(&self) -> Value {
        json!({ "stations": 2 })
    }

    fn command(&self, station: &str, command: StationCommand, by: &str) -> Result<Value, String> {
        match station {
            "a" => Ok(json!({ "command": command, "by": by })),
            other => Err(format!("station `{other}` is unknown")),
        }
    }
}

fn state() -> (tempfile::TempDir, StateFolder) {
    let place = tempfile::tempdir().expect("temporary folder");
    // Longer than the path of a socket may be.
    let path = place
        .path()
        .join("a-long-name-of-a-folder/".repeat(6))
        .join("state");
    let folder = StateFolder::open(Some(&path)).expect("creates");
    (place, folder)
}

fn listening(folder: &StateFolder) -> Listening {
    serve(claim(folder).expect("free"), Stations::of(folder)).expect("threads")
}

/// Lines that the server answers to `bytes`; the connection is then closed by this end.
fn answers(folder: &StateFolder, bytes: &[u8]) -> Vec<Reply> {
    let mut stream: UnixStream = place::connect(folder).expect("connects").expect("runs");
    stream.write_all(bytes).expect("writes");
    stream.shutdown(std::net::Shutdown::Write).expect("shuts");
    let mut text = String::new();
    stream.read_to_string(&mut text).expect("reads");
    let reply = |line: &str| serde_json::from_str(line).expect("a reply");
    text.lines().map(reply).collect()
}

#[test]
fn requests_are_answered_by_the_running_server() {
    let (_place, folder) = state();
    assert!(
        ask(&folder, &Request::Status {})
            .expect("no server")
            .is_none()
    );
    let _listening = listening(&folder);
    let mode = std::fs::metadata(folder.file("control.sock")).expect("there");
    assert_eq!(mode.permissions().mode() & 0o777, 0o600);
    let status = ask(&folder, &Request::Status {}).expect("answers");
    assert_eq!(status, Some(json!({ "stations": 2 })));

    let set = Request::SetPlan {
        station: "a".into(),
        change: PlanChange {
            exercise: Some("probing".into()),
            ..PlanChange::default()
        },
    };
    let plan = ask(&folder, &set).expect("sets").expect("runs");
    let plan: StationPlan = serde_json::from_value(plan).expect("a plan");
    let user = rustix::process::geteuid().as_raw();
    assert_eq!(plan.revision.by, format!("shell (uid {user})"));
    let plans = ask(&folder, &Request::Plans {})
        .expect("answers")
        .expect("runs");
    let plans: Vec<StationPlan> = serde_json::from_value(plans).expect("plans");
    assert_eq!((plans.len(), &plans[0]), (2, &plan));
    let reset = Request::ResetPlan {
        station: "a".into(),
    };
    let plan = ask(&folder, &reset).expect("resets").expect("runs");
    assert_eq!(plan["plan"]["exercise"], "crown");

    for (station, told) in [("b", "exam"), ("c", "a, b")] {
        let reset = Request::ResetPlan {
            station: station.into(),
        };
        let error = ask(&folder, &reset).expect_err(station).to_string();
        assert!(error.contains(told), "{error}");
    }
    for command in [StationCommand::Pause, StationCommand::ForceLimit(1.5)] {
        let request = |station: &str| Request::Command {
            station: station.into(),
            command,
        };
        let done = ask(&folder, &request("a")).expect("takes").expect("runs");
        assert_eq!(done["command"], json!(command));
        ask(&folder, &request("z")).expect_err("unknown");
    }
}

#[test]
fn bad_lines_are_refused_and_the_connection_goes_on() {
    let (_place, folder) = state();
    let _listening = listening(&folder);
    let lines = b"{}\n\xff\n{\"do\":\"status\",\"spare\":1}\n{\"do\":\"command\",\"station\":\"a\",\"command\":{\"force_limit\":-1}}\n{\"do\":\"status\"}\n{\"do\":\"status\"}";
    let replies = answers(&folder, lines);
    // The last line has no end, so it is no request.
    assert_eq!(replies.len(), 5, "{replies:?}");
    for reply in &replies[..4] {
        assert!(matches!(reply, Reply::Error(_)), "{reply:?}");
    }
    assert!(
        matches!(&replies[3], Reply::Error(why) if why.contains("-1")),
        "{replies:?}"
    );
    assert_eq!(replies[4], Reply::Ok(json!({ "stations": 2 })));
}

#[test]
fn a_line_without_end_is_cut_off() {
    let (_place, folder) = state();
    let _listening = listening(&folder);
    let mut stream = place::connect(&folder).expect("connects").expect("runs");
    // The server closes while this end still writes, so an error is no fault here.
    let _ = stream.write_all(&vec![b' '; MOST_LINE + 1]);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    let text = String::from_utf8_lossy(&answer);
    assert!(text.contains("longer than 65536"), "{text}");
    assert!(
        ask(&folder, &Request::Status {}).is_ok(),
        "others are served"
    );
}

#[test]
fn too_many_connections_are_told_so_and_leave_room_when_they_end() {
    let (_place, folder) = state();
    let _listening = listening(&folder);
    let connect = || place::connect(&folder).expect("connects").expect("runs");
    let held: Vec<UnixStream> = (0..8).map(|_| connect()).collect();
    // The server accepts in order, so these eight have their places before the next one.
    let error = ask(&folder, &Request::Status {})
        .expect_err("full")
        .to_string();
    assert!(error.contains("more than 8"), "{error}");
    drop(held);
    let begin = Instant::now();
    while ask(&folder, &Request::Status {}).is_err() {
        assert!(begin.elapsed() < LIMIT, "no place is free");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn one_server_has_a_folder_and_the_rest_of_a_crash_is_removed() {
    let (_place, folder) = state();
    let claimed = claim(&folder).expect("free");
    let error = claim(&folder).expect_err("claimed").to_string();
    assert!(error.contains("--state"), "{error}");
    drop(claimed);
    // A killed server leaves its socket.
    let left = std::os::unix::net::UnixListener::bind(
        std::path::Path::new("/proc/self/fd")
            .join({
                use std::os::fd::AsRawFd as _;
                let open = std::fs::File::open(folder.path()).expect("opens");
                let path = open.as_raw_fd().to_string();
                std::mem::forget(open);
                path
            })
            .join("control.sock"),
    );
    drop(left.expect("binds"));
    assert!(folder.file("control.sock").exists());
    assert!(
        ask(&folder, &Request::Status {})
            .expect("nobody listens")
            .is_none()
    );
    let _listening = listening(&folder);
    assert!(
        ask(&folder, &Request::Status {})
            .expect("answers")
            .is_some()
    );
}

#[test]
fn the_end_of_the_server_ends_open_connections() {
    let (_place, folder) = state();
    let listening = listening(&folder);
    let mut idle = place::connect(&folder).expect("connects").expect("runs");
    // An answer shows that the server has accepted the connection.
    idle.write_all(b"{}\n").expect("writes");
    let mut first = [0; 64];
    assert_ne!(idle.read(&mut first).expect("an answer"), 0);
    drop(listening);
    assert!(!folder.file("control.sock").exists());
    let mut text = String::new();
    idle.read_to_string(&mut text).expect("closed");
    assert!(text.is_empty() || text.ends_with('\n'), "{text}");
}

proptest! {
    #[test]
    fn no_line_panics(bytes in proptest::collection::vec(any::<u8>(), 0..100), text in "\\{\"do\":\"(plans|set_plan|status|command|reset_plan)\"(,\"[a-z]{1,8}\":[0-9a-z\"{}.]{0,12}){0,3}\\}") {
        let _ = Request::parse(&bytes);
        let _ = Request::parse(text.as_bytes());
    }
}
