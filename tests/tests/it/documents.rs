//! Commands in the documents: each is accepted by its program, and each bench, example and file of the checkout exists.

use std::path::{Path, PathBuf};
use std::process::Command;

use sulcus_tests::Program;

use crate::sources::root;

/// Documents with commands.
const DOCUMENTS: [&str; 15] = [
    "README.md",
    "CONTRIBUTING.md",
    "client/README.md",
    "client/screen/kit/README.md",
    "client/screen/kit/consent.md",
    "client/screen/kit/looks.md",
    "client/screen/kit/protocol.md",
    "client/screen/kit/sheet.md",
    "client/screen/kit/tasks.md",
    "docker/README.md",
    "docker/SCALE.md",
    "server/README.md",
    "server/lab/README.md",
    "sessions/README.md",
    "SECURITY.md",
];

/// Command lines of a document: indented lines, without the comment behind them.
fn commands(text: &str) -> impl Iterator<Item = Vec<String>> + '_ {
    let lines = text.lines().filter_map(|line| line.strip_prefix("    "));
    lines.filter_map(|line| {
        let line = line.split(" #").next().unwrap_or_default().trim();
        let first = line.split_whitespace().next()?;
        let ours = first == "cargo" || first.starts_with("sulcus-");
        ours.then(|| words(line))
    })
}

/// Words of a command line; double quotes hold words together.
fn words(line: &str) -> Vec<String> {
    let (mut found, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ' ' if !quoted => found.push(String::new()),
            c => found.last_mut().expect("one at least").push(c),
        }
    }
    found.retain(|word| !word.is_empty());
    found
}

/// Value behind an option.
fn behind<'a>(words: &'a [String], option: &str) -> Option<&'a str> {
    let at = words.iter().position(|word| word == option)?;
    words.get(at + 1).map(String::as_str)
}

/// Folder of a package, by its name.
fn folder(package: &str) -> Option<PathBuf> {
    let name = format!("name = \"{package}\"");
    let mut open = vec![root().to_owned()];
    while let Some(folder) = open.pop() {
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml"));
        if manifest.is_ok_and(|text| text.contains(&name)) {
            return Some(folder);
        }
        let inside = std::fs::read_dir(&folder).into_iter().flatten().flatten();
        open.extend(
            inside.map(|entry| entry.path()).filter(|path| {
                path.is_dir() && !path.ends_with("target") && !path.ends_with(".git")
            }),
        );
    }
    None
}

/// Fault of a command for a program: the words behind the program's name.
fn refused(program: Program, arguments: &[String]) -> Option<String> {
    // `review` hands its arguments to `sulcus-review`, which links Rerun: no other build makes it.
    if arguments.first().is_some_and(|first| first == "review") {
        return None;
    }
    // A program reads its arguments in order: a wrong one is refused before `--help` answers.
    let output = Command::new(program.path())
        .args(arguments)
        .arg("--help")
        .current_dir(root())
        .output()
        .expect("the program starts");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (!output.status.success()).then_some(said)
}

/// Fault of a `cargo` command: an unknown package, bench, example or argument.
fn cargo_fault(words: &[String]) -> Option<String> {
    let split = words.iter().position(|word| word == "--");
    let (ours, theirs) = words.split_at(split.unwrap_or(words.len()));
    let package = behind(ours, "-p");
    let place = match package {
        Some(package) => match folder(package) {
            Some(place) => place,
            None => return Some(format!("no package `{package}`")),
        },
        None => root().join("client"),
    };
    for (option, below) in [("--bench", "benches"), ("--example", "examples")] {
        if let Some(name) = behind(ours, option) {
            let file = place.join(below).join(format!("{name}.rs"));
            let module = place.join(below).join(name).join("main.rs");
            return (!file.exists() && !module.exists()).then(|| format!("no {option} {name}"));
        }
    }
    let program = match (ours.get(1).map(String::as_str), package) {
        (Some("run"), None | Some("sulcus-client")) => Program::Client,
        (Some("run"), Some("sulcus-server")) => Program::Server,
        (Some("run"), Some("sulcus-sessions")) => Program::Sessions,
        // Builds, tests, benches, and the program that links Rerun.
        _ => return None,
    };
    refused(program, theirs.get(1..).unwrap_or_default())
}

/// Files of the checkout that a command reads.
fn missing(words: &[String]) -> Option<String> {
    let inputs = [
        "server/scenes/",
        "client/tests/",
        "sessions/exercises/",
        "sessions/rubrics/",
    ];
    let named = words.iter().map(|word| word.trim_start_matches('+'));
    let mut read = named.filter(|word| inputs.iter().any(|folder| word.starts_with(folder)));
    let gone = read.find(|word| !root().join(word).exists())?;
    Some(format!("no file `{gone}`"))
}

#[test]
fn every_command_of_the_documents_is_accepted_by_its_program() {
    let (mut seen, mut found) = (0, Vec::new());
    for document in DOCUMENTS {
        let text = std::fs::read_to_string(root().join(document)).expect(document);
        for words in commands(&text) {
            seen += 1;
            let fault = match words[0].as_str() {
                "cargo" => cargo_fault(&words),
                "sulcus-client" => refused(Program::Client, &words[1..]),
                // The server, as the user of the service.
                "sulcus-server" | "sulcus-school" => refused(Program::Server, &words[1..]),
                "sulcus-sessions" => refused(Program::Sessions, &words[1..]),
                _ => None,
            };
            if let Some(fault) = fault.or_else(|| missing(&words)) {
                found.push(format!("{document}: {}: {fault}", words.join(" ")));
            }
        }
    }
    assert!(seen > 50, "{seen} commands");
    assert!(found.is_empty(), "{found:#?}");
}

/// Relative links of a document: targets in brackets behind `](`, without web addresses and anchors.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let targets = text.split("](").skip(1);
    let targets = targets.filter_map(|rest| rest.split([')', '#']).next());
    targets.filter(|target| !target.is_empty() && !target.contains("://"))
}

#[test]
fn every_link_between_the_documents_leads_somewhere() {
    let (mut seen, mut found) = (0, Vec::new());
    for document in DOCUMENTS.into_iter().chain(["CHANGELOG.md"]) {
        let place = root().join(document);
        let text = std::fs::read_to_string(&place).expect(document);
        let below = place.parent().unwrap_or(Path::new("/"));
        for target in links(&text) {
            seen += 1;
            if !below.join(target).exists() {
                found.push(format!("{document}: {target}"));
            }
        }
    }
    assert!(seen >= 8, "{seen} links");
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn a_wrong_command_is_found() {
    let wrong = "    sulcus-client demo --virtaul\n    cargo bench -p sulcus-core --bench none\n    \
                 cargo run -p sulcus-nobody\n    sulcus-client demo --habit heavy-hand   # a comment\n";
    let faults: Vec<bool> = commands(wrong)
        .map(|words| match words[0].as_str() {
            "cargo" => cargo_fault(&words).is_some(),
            _ => refused(Program::Client, &words[1..]).is_some(),
        })
        .collect();
    assert_eq!(faults, [true, true, true, false]);
}

#[test]
fn the_readme_is_short() {
    let text = std::fs::read_to_string(root().join("README.md")).expect("README.md");
    assert!(text.lines().count() <= 90, "{} lines", text.lines().count());
}
