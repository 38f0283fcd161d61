//! A clock that was set back by a year: sessions go on, no file is overwritten, no entry is lost.

use std::path::PathBuf;

use sulcus_support::Resource;
use sulcus_tests::{Place, Program, files_with};

use crate::snapshot::{audit, snapshot};

/// Library that shifts the clock of a program.
fn shifted() -> Result<PathBuf, String> {
    let machine = std::env::consts::ARCH;
    let path = format!("/usr/lib/{machine}-linux-gnu/faketime/libfaketimeMT.so.1");
    let path = PathBuf::from(path);
    let missing = || format!("{} is missing: apt-get install faketime", path.display());
    path.is_file().then(|| path.clone()).ok_or_else(missing)
}

#[test]
fn a_clock_that_was_set_back_by_a_year_overwrites_no_session_and_loses_no_entry() {
    let Some(library) = Resource::Image.or_skip(shifted()) else {
        return;
    };
    let mut place = Place::new();
    let session = |place: &Place| {
        let server = place.serve(&["--exercise", "crown"]);
        let ticket = std::fs::read_to_string(place.path("ticket")).expect("a ticket");
        let hand = [
            "run",
            "--server",
            &server.address,
            "--ticket",
            ticket.trim(),
            "--duration",
            "2",
            "--tick",
            "server",
        ];
        place.run(Program::Client, &hand).ok();
    };
    let grade = |place: &Place, file: &PathBuf| {
        let file = file.to_str().expect("plain");
        place
            .run(Program::Sessions, &["grade", file, "--json"])
            .stdout
    };
    let run = |place: &Place, line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        place.run(Program::Server, &words).ok()
    };
    std::fs::write(place.path("oak.csv"), "learner,class\ns-4f7k2,Oak\n").expect("a table");
    run(&place, "class import oak.csv");
    run(
        &place,
        "token add --role student --station station --out ticket",
    );
    session(&place);
    let recordings = place.path("recordings");
    let first = files_with(&recordings, "mcap").remove(0);
    let (before, graded) = (snapshot(&recordings), grade(&place, &first));
    let log = audit(&place.path("state"));

    place.set("LD_PRELOAD", library.to_str().expect("plain"));
    place.set("FAKETIME", "-365d");
    place.set("FAKETIME_DONT_FAKE_MONOTONIC", "1");
    session(&place);
    run(&place, "token add --role instructor --out teacher");
    run(&place, "backup back.backup");
    let now = snapshot(&recordings);
    assert_eq!(now.len(), before.len() + 1, "{:?}", now.keys());
    assert!(
        before
            .iter()
            .all(|(path, bytes)| now.get(path) == Some(bytes))
    );
    let earlier = files_with(&recordings, "mcap").remove(0);
    assert!(earlier < first, "the name has the wrong year: {earlier:?}");
    assert!(grade(&place, &earlier).contains("\"score\""));
    assert_eq!(grade(&place, &first), graded);

    place.unset();
    session(&place);
    assert_eq!(files_with(&recordings, "mcap").len(), before.len() + 2);
    assert_eq!(grade(&place, &first), graded);
    let after = audit(&place.path("state"));
    assert!(
        after.starts_with(&log) && after.len() > log.len(),
        "{after:?}"
    );
    let list = run(&place, "class list").stdout;
    assert!(list.contains("Oak"), "{list}");
}
