//! Erasure of one learner from outside: recordings, grades and names go, those of others stay to the byte.

use sulcus_support::Resource;
use sulcus_tests::page;
use sulcus_tests::{Place, Program, files_with};

/// Learners with their stations.
const LEARNERS: [(&str, &str); 2] = [("s-4f7k2", "chair-1"), ("s-9q2m7", "chair-2")];

#[test]
fn the_sessions_of_one_learner_are_erased_and_those_of_another_stay() {
    if Resource::Curl.or_skip(page::can()).is_none() {
        return;
    }
    let place = Place::new();
    let run = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        place.run(Program::Server, &words).ok()
    };
    let mut roster = String::from("learner;station\n");
    let mut stations = String::from("[defaults]\nexercise = \"crown\"\n");
    for (learner, station) in LEARNERS {
        roster += &format!("{learner};{station}\n");
        stations += &format!("\n[[station]]\nname = \"{station}\"\n");
    }
    std::fs::write(place.path("roster.csv"), roster).expect("a roster");
    std::fs::write(place.path("stations.toml"), stations).expect("stations");
    run("token add --class roster.csv --out tickets.csv");
    run("token add --role admin --out admin.txt");
    let tickets = std::fs::read_to_string(place.path("tickets.csv")).expect("tickets");
    let server = place.serve(&[
        "--config",
        "stations.toml",
        "--no-admission",
        "--console",
        "127.0.0.1:0",
    ]);
    for (learner, _) in LEARNERS {
        let line = tickets.lines().find(|line| line.contains(learner));
        let ticket = line.and_then(|line| line.rsplit([',', ';']).next());
        let ticket = ticket.expect("a ticket").trim_matches('"');
        let hand = [
            "run",
            "--server",
            &server.address,
            "--ticket",
            ticket,
            "--duration",
            "2",
        ];
        place.run(Program::Client, &hand).ok();
    }
    let of = |learner: &str| {
        let files = files_with(&place.path("recordings"), "mcap").into_iter();
        let mut own = files.filter(|file| {
            let file = file.to_str().expect("plain");
            let info = place.run(Program::Sessions, &["info", file, "--json"]);
            info.json()["learner_id"] == learner
        });
        let file = own.next();
        file.map(|file| (std::fs::read(&file).expect("a file"), file))
    };
    let kept = of(LEARNERS[1].0).expect("a recording");
    assert!(of(LEARNERS[0].0).is_some());

    let admin = std::fs::read_to_string(place.path("admin.txt")).expect("a ticket");
    let token = admin.trim().split('.').next().expect("a token");
    let path = format!("/learners/{}/erase", LEARNERS[0].0);
    let wrong = page::sent(&place, &server, token, &path, "confirm=s-other");
    assert!(
        of(LEARNERS[0].0).is_some(),
        "no erasure without the right id: {wrong}"
    );
    page::sent(
        &place,
        &server,
        token,
        &path,
        &format!("confirm={}", LEARNERS[0].0),
    );
    assert!(of(LEARNERS[0].0).is_none(), "the recording is there");
    assert_eq!(of(LEARNERS[1].0), Some(kept), "that of another learner");
    let log = std::fs::read_to_string(place.path("state").join("audit.jsonl")).expect("a log");
    let entries = log.lines().filter(|line| line.contains("eras"));
    assert_eq!(entries.count(), 1, "{log}");
}
