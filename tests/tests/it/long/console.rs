//! Twenty pages of the console, a stalled and a flooding one, and the compilation of a case, beside a station at work.

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader};
use std::process::Stdio;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use sulcus_connection::instructor::{Heard, Instructor};
use sulcus_connection::link::LinkConfig;
use sulcus_proto::station::Phase;
use sulcus_proto::{Role, Ticket};
use sulcus_support::{Resource, long};
use sulcus_tests::page::{self, Page};
use sulcus_tests::{Place, Program, Serving};

/// Number of ordinary pages.
const PAGES: usize = 20;
/// Time without pages, and with them.
const ALONE: Duration = Duration::from_secs(40);
const TOGETHER: Duration = Duration::from_secs(110);
/// Time after which the memory of open pages is the ordinary one.
const SETTLED: Duration = Duration::from_secs(30);
/// Largest growth of the server's memory from then on, kibibytes.
const GROWTH_KIB: u64 = 8 * 1024;
/// Largest ratio of the tick's 99th percentiles with and without pages.
const RATIO: f32 = 1.1;
/// Largest median of the time by which a page hears later than an instructor's own connection.
const LATER: Duration = Duration::from_millis(50);

fn memory_kib(server: &Serving) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{}/status", server.process.id()));
    let status = status.expect("the server runs");
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let digits = line.expect("VmRSS").trim().trim_end_matches(" kB");
    digits.trim().parse().expect("a number")
}

fn median<T: PartialOrd + Copy>(mut all: Vec<T>) -> T {
    all.sort_by(|a, b| a.partial_cmp(b).expect("finite"));
    all[all.len() / 2]
}

/// Statuses of the station for some time: 99th percentiles of the tick, and the time of each tick's arrival.
fn hear(instructor: &mut Instructor, time: Duration) -> (Vec<f32>, BTreeMap<u64, Instant>) {
    let (mut ticks, mut heard) = (Vec::new(), BTreeMap::new());
    let end = Instant::now() + time;
    while Instant::now() < end {
        if let Some(Heard::Status(status)) = instructor.next(Duration::from_secs(1))
            && status.phase == Phase::Running
            && status.tick > 1000
        {
            ticks.push(status.tick_p99_us);
            heard.entry(status.tick).or_insert_with(Instant::now);
        }
    }
    (ticks, heard)
}

#[test]
fn twenty_pages_a_stalled_and_a_flooding_one_cost_no_tick() {
    if !long::selected("twenty-pages") || Resource::Curl.or_skip(page::can()).is_none() {
        return;
    }
    let place = Place::new();
    std::fs::write(
        place.path("stations.toml"),
        "[[station]]\nname = \"chair\"\nplan = { exercise = \"crown\", rate_hz = 250 }\n",
    )
    .expect("stations");
    let ticket = |arguments: &[&str], out: &str| -> String {
        let add = [&["token", "add", "--out", out], arguments].concat();
        place.run(Program::Server, &add).ok();
        let text = std::fs::read_to_string(place.path(out)).expect("a ticket");
        text.trim().to_owned()
    };
    let student = ticket(&["--role", "student", "--station", "chair"], "student");
    let teacher: Ticket = ticket(&["--role", "instructor"], "teacher")
        .parse()
        .expect("a ticket");
    let server = place.serve(&[
        "--config",
        "stations.toml",
        "--console",
        "127.0.0.1:0",
        "--no-admission",
    ]);
    let link = LinkConfig {
        role: Role::Instructor,
        ..LinkConfig::new(server.address.parse().expect("an address"), &teacher, "")
    };
    let mut instructor = Instructor::connect(link).expect("the instructor joins");
    let mut hand = place
        .command(Program::Client.path())
        .env("SULCUS_TICKET", student)
        .args(["run", "--server", &server.address, "--exercise", "crown"])
        .args(["--duration", "900", "--rate-hz", "250", "--json"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the client starts");
    let (alone, _) = hear(&mut instructor, ALONE);

    let token = &teacher.token;
    let pages: Vec<Page> = (0..PAGES)
        .map(|k| Page::follow(&place, &server, token, &format!("page-{k}.txt")))
        .collect();
    let stalled = Page::piped(&place, &server, token);
    let (measured, pipe) = Page::piped(&place, &server, token);
    let shown: Arc<Mutex<BTreeMap<u64, Instant>>> = Arc::default();
    let seen = shown.clone();
    let reader = std::thread::spawn(move || {
        let lines = BufReader::new(pipe).lines().map_while(Result::ok);
        for (kind, data) in page::events(lines) {
            if let Some(tick) = data["status"]["tick"].as_u64().filter(|_| kind == "status") {
                let now = Instant::now();
                seen.lock().expect("no panic").entry(tick).or_insert(now);
            }
        }
    });
    let ask = |path: &str, body: Value| page::posted(&place, &server, token, path, &body);
    ask(
        "/api/cases",
        json!({ "name": "a", "condition": "periodontitis", "seed": 1 }),
    );
    ask("/api/cases/a/compile", json!({}));
    let work = || page::asked(&place, &server, token, "/api/cases-work");
    assert!(
        work().contains("\"name\":\"a\""),
        "no compilation: {}",
        work()
    );
    let stop = AtomicBool::new(false);
    let (together, heard, settled, last) = std::thread::scope(|scope| {
        scope.spawn(|| {
            while !stop.load(Ordering::Acquire) {
                let told = page::asked(&place, &server, token, "/api/stations");
                assert!(told.contains("chair"), "{told}");
            }
        });
        let (mut together, mut heard) = hear(&mut instructor, SETTLED);
        let settled = memory_kib(&server);
        let (more, later) = hear(&mut instructor, TOGETHER - SETTLED);
        together.extend(more);
        heard.extend(later);
        stop.store(true, Ordering::Release);
        (together, heard, settled, memory_kib(&server))
    });
    assert!(
        !work().contains("[\"a\","),
        "the compilation failed: {}",
        work()
    );
    drop(measured);
    reader.join().expect("the reader ends");
    drop(stalled);
    for page in pages {
        let statuses = page.close(&place).len();
        assert!(statuses > 200, "{statuses} events on a page");
    }
    hand.kill().expect("the client runs");
    hand.wait().expect("it ends");

    let (alone, together) = (median(alone), median(together));
    let ratio = together / alone;
    eprintln!("tick p99: {alone:.0} us alone, {together:.0} us with pages, ratio {ratio:.3}");
    eprintln!("memory: {settled} KiB, then {last} KiB");
    let shown = shown.lock().expect("no panic");
    let later: Vec<Duration> = heard
        .iter()
        .filter_map(|(tick, at)| Some(shown.get(tick)?.saturating_duration_since(*at)))
        .collect();
    assert!(later.len() > 100, "{} statuses on both ways", later.len());
    let later = median(later);
    eprintln!("a page hears {later:?} after the instructor's connection, p50");
    assert!(last <= settled + GROWTH_KIB, "{settled} then {last} KiB");
    assert!(later < LATER, "{later:?}");
    assert!(ratio <= RATIO, "{alone} us alone, {together} us with pages");
}
