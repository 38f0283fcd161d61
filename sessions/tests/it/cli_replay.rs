//! `replay` and `info --recover` from outside: parts, comparisons, many files, recovery.
#![allow(clippy::unwrap_used)]

use std::path::PathBuf;

use crate::common::program::*;
use crate::common::*;
use serde_json::json;

#[test]
fn a_part_is_no_finding_and_says_which_it_was() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("good.mcap");
    record(&path, 1500);
    let output = run(&[
        "replay",
        text_of(&path),
        "--from",
        "0.5",
        "--to",
        "1.2",
        "--json",
    ]);
    assert_eq!((code(&output), err(&output).as_str()), (0, ""));
    let json = json_of(&output);
    assert_eq!(json["identical"], true);
    assert_eq!(json["gradable"], false);
    assert_eq!(
        json["part"],
        json!({"snapshot_tick": 0, "from_tick": 500, "to_tick": 1200})
    );
    let output = run(&["replay", text_of(&path), "--from", "0.5"]);
    let text = out(&output);
    assert!(
        text.contains("part       ticks 500 to 1500, from the snapshot of tick 0"),
        "{text}"
    );
    let output = run(&["replay", text_of(&path), "--from", "2"]);
    assert_eq!(code(&output), 2);
    let said = "from is 2, expected 0 to 1.5 s, the session's end";
    assert!(err(&output).contains(said), "{}", err(&output));
}

#[test]
fn what_if_is_a_comparison_and_never_identical() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("good.mcap");
    record(&path, 800);
    let output = run(&["replay", text_of(&path), "--solver", "clarabel", "--json"]);
    assert_eq!((code(&output), err(&output).as_str()), (0, ""));
    let json = json_of(&output);
    assert_eq!(
        (&json["comparison"], &json["identical"]),
        (&json!(true), &json!(false))
    );
    assert_eq!(json["changed"], json!(["solver clarabel"]));
    assert!(json["apart"]["max_force_n"].as_f64().unwrap() > 0.0);
    assert_eq!(json["ticks"], 800);
    let output = run(&[
        "replay",
        text_of(&path),
        "--solver",
        "active-set",
        "--level",
        "0",
    ]);
    assert_eq!(code(&output), 0);
    let text = out(&output);
    assert!(
        text.contains(
            "COMPARISON, not a replay: with 1 rigid objects at level 0, solver active-set"
        ),
        "{text}"
    );
    assert!(!text.contains("identical"), "{text}");
    let output = run(&["replay", text_of(&path), "--tissue", "rigid"]);
    assert_eq!(code(&output), 2);
    assert!(
        err(&output).contains("expected a scene with soft tissue"),
        "{}",
        err(&output)
    );
    // The judge judges what the tick did, not what it might have done.
    let output = run(&["replay", text_of(&path), "--level", "0", "--audit"]);
    assert_eq!(code(&output), 2);
    assert!(
        err(&output).contains("cannot be used with"),
        "{}",
        err(&output)
    );
}

#[test]
fn many_files_come_out_in_their_order_however_many_at_once() {
    let dir = tempfile::tempdir().unwrap();
    let mut files: Vec<PathBuf> = Vec::new();
    // Long ones first, so that later ones are done before them; one that differs, one that is none.
    for (k, ticks) in [3000, 200, 1500, 100, 700, 50].into_iter().enumerate() {
        let path = dir.path().join(format!("{k}.mcap"));
        record(&path, ticks);
        files.push(path);
    }
    let differs = with_messages(&std::fs::read(&files[1]).unwrap(), |topic, data| {
        if topic == "/exact/ticks" && data[..8] == 77u64.to_le_bytes() {
            data[31] ^= 4;
        }
        true
    });
    std::fs::write(&files[1], differs).unwrap();
    std::fs::write(&files[3], "hello").unwrap();
    let names: Vec<&str> = files.iter().map(|path| text_of(path)).collect();
    let told = |jobs: &str| {
        let output = run(&[&["replay", "--jobs", jobs, "--json"], &names[..]].concat());
        assert_eq!(code(&output), 2);
        assert_eq!(err(&output).lines().count(), 1, "{}", err(&output));
        let mut json = json_of(&output);
        for file in json["files"].as_array_mut().unwrap() {
            file.as_object_mut().unwrap().remove("realtime_factor");
        }
        json.as_object_mut().unwrap().remove("realtime_factor");
        json
    };
    let alone = told("1");
    assert_eq!(alone, told("4"));
    let found = alone["files"].as_array().unwrap();
    let order: Vec<&str> = found
        .iter()
        .map(|file| file["file"].as_str().unwrap())
        .collect();
    assert_eq!(order, names);
    assert_eq!(alone["ticks"], 3000 + 200 + 1500 + 700 + 50);
    assert_eq!(alone["first_divergent_tick"], 77);
    assert!(
        found[3]["error"]
            .as_str()
            .unwrap()
            .contains("not an MCAP file")
    );
    // As text, too.
    let output = run(&[&["replay"], &names[..]].concat());
    let text = out(&output);
    let at: Vec<usize> = [0, 1, 2, 4, 5]
        .map(|k| text.find(names[k]).unwrap())
        .to_vec();
    assert!(at.is_sorted(), "{text}");
    assert_eq!(code(&run(&["replay", "--jobs", "0", names[0]])), 2);
}

#[test]
fn a_torn_file_is_recovered_and_a_whole_one_is_not_touched() {
    let dir = tempfile::tempdir().unwrap();
    let [whole, torn, made] = ["whole", "torn", "made"].map(|name| dir.path().join(name));
    record(&whole, 900);
    let bytes = std::fs::read(&whole).unwrap();
    std::fs::write(&torn, &bytes[..bytes.len() * 2 / 3]).unwrap();
    let output = run(&[
        "info",
        text_of(&torn),
        "--recover",
        text_of(&made),
        "--json",
    ]);
    assert_eq!((code(&output), err(&output).as_str()), (0, ""));
    let json = json_of(&output);
    assert_eq!(json["was"]["kind"], "cut_off");
    assert_eq!(json["ending"]["kind"], "recovered");
    let (kept, lost) = (
        json["ticks"].as_u64().unwrap(),
        json["lost"]["ticks"].as_u64().unwrap(),
    );
    assert!(kept > 100 && lost > 0, "{json}");
    let output = run(&["replay", text_of(&made), "--json"]);
    assert_eq!(code(&output), 1, "not the whole session");
    let replay = json_of(&output);
    assert_eq!(
        (&replay["identical"], &replay["ticks"]),
        (&json!(true), &json!(kept))
    );
    let reason = replay["reason"].as_str().unwrap();
    assert!(
        reason.starts_with("the recording was recovered from a file that was cut off"),
        "{reason}"
    );
    let info = out(&run(&["info", text_of(&made)]));
    assert!(info.contains(&format!("missing: {lost} ticks")), "{info}");

    let output = run(&["info", text_of(&torn), "--recover", text_of(&made)]);
    assert_eq!(code(&output), 2, "it exists");
    assert!(
        err(&output).starts_with("error: cannot write `"),
        "{}",
        err(&output)
    );
    let other = dir.path().join("other");
    let output = run(&["info", text_of(&whole), "--recover", text_of(&other)]);
    assert_eq!(code(&output), 2);
    assert!(err(&output).contains("nothing to recover: the recording is finished"));
    assert!(!other.exists());
    let output = run(&[
        "info",
        text_of(&torn),
        text_of(&whole),
        "--recover",
        text_of(&other),
    ]);
    assert_eq!(code(&output), 2);
    assert!(err(&output).contains("--recover takes one recording, found 2"));
}
