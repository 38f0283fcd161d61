//! The program from outside: exit codes, words and JSON.
#![allow(clippy::unwrap_used)]

use crate::common::program::*;
use crate::common::*;
use serde_json::{Value, json};

#[test]
fn a_good_file_gives_zero_and_the_promised_fields() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("good.mcap");
    record(&path, 500);
    let output = run(&["replay", text_of(&path), "--json"]);
    assert_eq!((code(&output), err(&output).as_str()), (0, ""));
    let json = json_of(&output);
    assert_eq!(json["ticks"], 500);
    assert_eq!(json["identical"], true);
    assert_eq!(json["first_divergent_tick"], Value::Null);
    assert!(json["realtime_factor"].as_f64().unwrap() > 1.0);
    assert_eq!(json["signature"]["kind"], "valid");
    assert_eq!(json["gradable"], true);
    let output = run(&["replay", text_of(&path)]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("identical  500 ticks"), "{text}");

    let output = run(&["info", text_of(&path), "--json"]);
    assert_eq!(code(&output), 0);
    let json = json_of(&output);
    assert_eq!(json["learner_id"], "a7f3");
    assert_eq!(json["scene"], "three balls");
    assert_eq!(json["ending"], json!({"kind": "finished"}));
    assert_eq!(json["ticks"], 500);
    let output = run(&["info", text_of(&path)]);
    assert!(
        String::from_utf8(output.stdout)
            .unwrap()
            .contains("station    bench 3")
    );
}

#[test]
fn a_finding_is_one_and_bad_input_is_two() {
    let dir = tempfile::tempdir().unwrap();
    let (good, bad) = (dir.path().join("good.mcap"), dir.path().join("bad.mcap"));
    record(&good, 300);
    let bytes = with_messages(&std::fs::read(&good).unwrap(), |topic, data| {
        if topic == "/exact/ticks" && data[..8] == 123u64.to_le_bytes() {
            data[31] ^= 4;
        }
        true
    });
    std::fs::write(&bad, bytes).unwrap();
    let output = run(&["replay", text_of(&bad), "--json"]);
    assert_eq!(code(&output), 1);
    assert_eq!(json_of(&output)["first_divergent_tick"], 123);

    let output = run(&["replay", text_of(&good), text_of(&bad), "--json"]);
    assert_eq!(code(&output), 1);
    let json = json_of(&output);
    assert_eq!(json["identical"], false);
    assert_eq!(json["ticks"], 600);
    assert_eq!(json["files"][0]["identical"], true);
    assert_eq!(json["files"][1]["first_divergent_tick"], 123);

    let none = dir.path().join("none.mcap");
    std::fs::write(&none, "hello").unwrap();
    let output = run(&["replay", text_of(&none), "--json"]);
    assert_eq!(code(&output), 2);
    let text = err(&output);
    assert!(
        text.starts_with("error: ") && text.contains("not an MCAP file"),
        "{text}"
    );
    assert_eq!(text.lines().count(), 1);
    assert_eq!(code(&run(&["info", text_of(dir.path())])), 2);
    let output = run(&["info", "no such file"]);
    assert_eq!(code(&output), 2);
    assert!(err(&output).starts_with("error: cannot read `no such file`: "));
    assert_eq!(err(&output).matches("os error").count(), 1);
    assert_eq!(code(&run(&["replay"])), 2);
    assert_eq!(code(&run(&["dance"])), 2);
    assert_eq!(code(&run(&["--help"])), 0);
}

#[test]
fn the_signer_can_be_given_as_file_or_digits() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("good.mcap");
    record(&path, 200);
    let mine = key().public().fingerprint();
    let file = dir.path().join("station.pub");
    std::fs::write(&file, format!("{mine}\n")).unwrap();
    assert_eq!(
        code(&run(&["replay", text_of(&path), "--signer", &mine])),
        0
    );
    assert_eq!(
        code(&run(&[
            "replay",
            text_of(&path),
            "--signer",
            text_of(&file)
        ])),
        0
    );
    let other = sulcus_sessions::StationKey::from_seed([1; 32])
        .public()
        .fingerprint();
    let output = run(&["replay", text_of(&path), "--signer", &other]);
    assert_eq!(code(&output), 1);
    assert!(
        String::from_utf8(output.stdout)
            .unwrap()
            .contains("not the trusted key")
    );
    let output = run(&["replay", text_of(&path), "--signer", text_of(&path)]);
    assert_eq!(code(&output), 2);
    assert!(
        err(&output).contains("is not a public key"),
        "{}",
        err(&output)
    );
}

#[test]
fn a_cut_off_file_is_sound_as_far_as_it_goes_and_cannot_be_graded() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("cut.mcap");
    let bytes = recorded(800);
    std::fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    let output = run(&["replay", text_of(&path), "--json"]);
    // Exit code 1 is a finding: not gradable is one.
    assert_eq!(code(&output), 1);
    let json = json_of(&output);
    assert_eq!(json["identical"], true);
    assert_eq!(json["gradable"], false);
    assert_eq!(json["ending"]["kind"], "cut_off");
    assert_eq!(code(&run(&["info", text_of(&path)])), 0);
}
