//! The server is killed with -9 in mid-session: the hand is let go gently, the record is kept.

use sulcus_sessions::{Ending, Recording};
use sulcus_tests::{Ended, Place, Program, rows};

#[test]
fn a_killed_server_lets_the_hand_go_gently_and_leaves_a_recording_that_replays() {
    let place = Place::new();
    // The client would try for 30 s to return to a server that is gone.
    let mut server = place.serve(&["--resume-within", "1"]);
    let session = place.join(&server);
    place.touched();
    server.process.kill().expect("SIGKILL");
    server.process.wait().expect("it is gone");
    let ended = Ended::new(
        session
            .wait_with_output()
            .expect("the client ends by itself"),
    );

    assert_eq!(ended.code, 1, "{ended:#?}");
    let said = ended.json();
    let device = &said["device"];
    let number = |field: &str| {
        device[field]
            .as_f64()
            .unwrap_or_else(|| panic!("`{field}` in {said}"))
    };
    assert_eq!(said["server_lost"], true, "{said}");
    assert!(number("max_displayed_n") > 0.05, "it never touched: {said}");
    assert_eq!(number("last_displayed_n"), 0.0, "{said}");
    // No faster than the watchdog's ramp (at most 15 % of the force a step) and the tick's own slew.
    assert!(
        number("max_displayed_step_n") <= 0.5 + 0.15 * number("max_displayed_n"),
        "{said}"
    );

    let recording = Recording::open(&place.recording()).expect("the recording opens");
    assert!(
        matches!(recording.ending(), Ending::CutOff { .. }),
        "{:?}",
        recording.ending()
    );
    let last_recorded = rows(&recording).last().expect("rows").tick;
    let last_heard = device["last_tick"].as_u64().expect("a tick");
    println!("recorded to tick {last_recorded}, heard of {last_heard}");
    assert!(last_recorded > 0 && last_heard > 0);

    let file = place.recording();
    let replay = place.run(
        Program::Sessions,
        &["replay", "--json", file.to_str().expect("plain")],
    );
    // Identical as far as it goes, and not the whole session: a finding.
    assert_eq!(replay.code, 1, "{replay:#?}");
    let replay = replay.json();
    assert_eq!(replay["identical"], true, "{replay}");
    assert_eq!(replay["gradable"], false, "{replay}");
    let info = place
        .run(Program::Sessions, &["info", file.to_str().expect("plain")])
        .ok();
    assert!(info.stdout.contains("cut off"), "{info:#?}");
}

#[test]
fn a_server_stopped_properly_signs_and_the_next_client_can_come() {
    let place = Place::new();
    let server = place.serve(&[]);
    let session = |n: usize| {
        let ended = place.perform(&server, &["--duration", "1"]).ok().json();
        assert_eq!(ended["server_lost"], false, "{ended}");
        let found = sulcus_tests::files_with(&place.path("recordings"), "mcap");
        assert_eq!(found.len(), n, "{found:?}");
    };
    session(1);
    session(2);
    for file in sulcus_tests::files_with(&place.path("recordings"), "mcap") {
        let replay = place
            .run(
                Program::Sessions,
                &["replay", "--json", file.to_str().expect("plain")],
            )
            .ok()
            .json();
        assert_eq!(
            (&replay["identical"], &replay["gradable"]),
            (&true.into(), &true.into()),
            "{replay}"
        );
    }
}
