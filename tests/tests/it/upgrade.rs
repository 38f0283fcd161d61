//! State of another release: a newer one is refused with a sentence, and no byte of it changes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use sulcus_tests::{Place, Program};

/// Commands that read or change the files of the state, with the file that each needs.
const COMMANDS: [(&str, &str); 7] = [
    ("token list", "tokens.json"),
    ("token add --role instructor --out new.txt", "tokens.json"),
    ("class list", "classes.json"),
    ("class import elm.csv", "classes.json"),
    ("person list", "people.json"),
    ("certificate show", "identity.toml"),
    (
        "serve --listen 127.0.0.1:0 --exercise crown",
        "identity.toml",
    ),
];

/// Bytes of the files of a folder.
fn bytes(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let entries = std::fs::read_dir(folder).expect("a folder").flatten();
    let files = entries
        .map(|entry| entry.path())
        .filter(|path| path.is_file() && path.extension().is_none_or(|kind| kind != "lock"));
    files
        .map(|path| (path.clone(), std::fs::read(&path).expect("a file")))
        .collect()
}

#[test]
fn the_state_of_a_newer_release_is_refused_with_a_sentence_and_stays_as_it_is() {
    let place = Place::new();
    let run = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        place.run(Program::Server, &words)
    };
    std::fs::write(place.path("oak.csv"), "learner,class\ns-4f7k2,Oak\n").expect("a table");
    std::fs::write(place.path("elm.csv"), "learner,class\ns-9q2m7,Elm\n").expect("a table");
    run("class import oak.csv").ok();
    run("token add --role student --station station --out ticket").ok();
    run("person add mueller --role instructor").ok();
    let state = place.path("state");
    for (command, file) in COMMANDS {
        let path = state.join(file);
        let own = std::fs::read_to_string(&path).expect(file);
        let newer = own
            .replacen("\"version\": 1", "\"version\": 2", 1)
            .replacen("\"version\":1", "\"version\":2", 1)
            .replacen("version = 1", "version = 2", 1);
        assert_ne!(newer, own, "{file} has a version");
        std::fs::write(&path, newer).expect(file);
        let before = bytes(&state);
        run(command).refused(&[file, "version is 2, expected 1"]);
        assert!(bytes(&state) == before, "{command} has changed the state");
        std::fs::write(&path, own).expect(file);
    }
    run("token list").ok();
}
