//! Upgrade from an earlier release: a school's state and sessions, made by the programs of that release.

use std::path::{Path, PathBuf};
use std::process::Command;

use sulcus_support::long;
use sulcus_tests::{Place, Program, files_with, signal};

/// Commit of the earlier release: protocol version 6, before the ghost, backups and archived classes.
const BEFORE: &str = "5b4e9e81";

/// Builds the programs of the earlier release in a folder of their own. A later call finds them.
fn earlier() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = root.join("target/before");
    let source = folder.join("source");
    std::fs::create_dir_all(&folder).expect("a folder");
    let run = |command: &mut Command| {
        let ended = command.status().expect("the program starts");
        assert!(ended.success(), "{command:?}");
    };
    if !source.join("Cargo.toml").is_file() {
        let mut checkout = Command::new("git");
        checkout
            .current_dir(&root)
            .args(["worktree", "add", "--force", "--detach"]);
        run(checkout.arg(&source).arg(BEFORE));
    }
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut build = Command::new(cargo);
    build
        .current_dir(&source)
        .args(["build", "--locked", "--no-default-features", "--bins"])
        // Persons belong to the console.
        .args(["--features", "sulcus-server/console"])
        .arg("--target-dir")
        .arg(folder.join("target"));
    for program in [Program::Server, Program::Client, Program::Sessions] {
        build.args(["--package", program.name()]);
    }
    run(&mut build);
    folder.join("target/debug")
}

/// Text of a grade without the hash of the sources that measured it, which each release has of its own.
fn measured(grade: &str) -> String {
    let key = "\"measures\":\"";
    let (before, rest) = grade.split_once(key).expect("a hash of the sources");
    let (hash, after) = rest.split_once('"').expect("a text");
    assert_eq!(hash.len(), 16, "{hash}");
    format!("{before}{key}{after}")
}

#[test]
fn a_school_of_the_earlier_release_goes_on_with_its_tickets_sessions_and_grades() {
    if !long::selected("upgrade") {
        return;
    }
    let earlier = earlier();
    let place = Place::new();
    let old = |program: Program, line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        place.run_path(&earlier.join(program.name()), &words)
    };
    let new = |program: Program, line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        place.run(program, &words)
    };
    std::fs::write(place.path("oak.csv"), "learner,class\ns-4f7k2,Oak\n").expect("a table");
    old(Program::Server, "class import oak.csv").ok();
    old(
        Program::Server,
        "token add --role student --station station --out ticket",
    )
    .ok();
    old(Program::Server, "person add mueller --role instructor").ok();
    let ticket = std::fs::read_to_string(place.path("ticket")).expect("a ticket");
    let run = |address: &str| {
        format!(
            "run --server {address} --ticket {} --duration 3",
            ticket.trim()
        )
    };
    let arguments = ["--exercise", "crown", "--mode", "exam"];
    let server = place.serve_by(&earlier.join("sulcus-server"), "127.0.0.1:0", &arguments);
    old(Program::Client, &run(&server.address)).ok();
    signal("-TERM", &server.process);
    let mut server = server;
    assert!(server.process.wait().expect("an end").success());
    let session = place.recording();
    let grade = format!("grade {} --json", session.to_str().expect("plain"));
    let graded = old(Program::Sessions, &grade);
    let lists = [
        "token list",
        "class list",
        "person list",
        "certificate show",
    ];
    let listed = lists.map(|line| old(Program::Server, line).ok().stdout);

    // The programs are replaced; the folders stay.
    for (line, before) in lists.iter().zip(&listed) {
        assert_eq!(&new(Program::Server, line).ok().stdout, before, "{line}");
    }
    let server = place.serve(&arguments);
    let refused = old(Program::Client, &run(&server.address));
    refused.refused(&["install the client of release"]);
    new(Program::Client, &run(&server.address)).ok();
    drop(server);
    let recordings = files_with(&place.path("recordings"), "mcap");
    assert_eq!(recordings.len(), 2, "{recordings:?}");
    let again = new(Program::Sessions, &grade);
    assert_eq!(
        (again.code, measured(&again.stdout)),
        (graded.code, measured(&graded.stdout)),
        "the same bytes"
    );
    assert!(
        again.stdout.contains("\"signer_trusted\":true"),
        "{}",
        again.stdout
    );
    new(Program::Server, "backup after.backup").ok();
}
