//! Folders of recordings as arguments, and names that are not UTF-8.

use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::OsStrExt as _;
use std::path::{Path, PathBuf};

use sulcus_tests::{Ended, Place, Program, files_with};

const CORPUS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../sessions/tests/corpus");

/// A name of Latin-1, as old archives have them: no UTF-8.
const NAME: &[u8] = b"\xdcbung \xe9";

/// A folder with two recordings, whose name is not UTF-8.
fn folder(place: &Place) -> PathBuf {
    let folder = place.path(".").join(OsStr::from_bytes(NAME));
    std::fs::create_dir(&folder).expect("made");
    for (from, to) in [("hard-wedge.mcap", "b.mcap"), ("crown.mcap", "a.mcap")] {
        std::fs::copy(Path::new(CORPUS).join(from), folder.join(to)).expect("copied");
    }
    std::fs::write(folder.join("notes.txt"), "no recording").expect("written");
    std::fs::write(folder.join("._a.mcap"), "left by a Mac").expect("written");
    folder
}

fn run(place: &Place, program: Program, arguments: &[&OsStr]) -> Ended {
    let output = place.command(program.path()).args(arguments).output();
    let ended = Ended::new(output.expect("it ends"));
    assert!(!ended.stderr.contains("panicked"), "{ended:#?}");
    assert!(!ended.stdout.contains('\u{fffd}'), "{ended:#?}");
    assert!(!ended.stderr.contains('\u{fffd}'), "{ended:#?}");
    ended
}

fn words(words: &[&str]) -> Vec<OsString> {
    words.iter().map(OsString::from).collect()
}

#[test]
fn a_folder_is_all_recordings_in_it() {
    let place = Place::new();
    let folder = folder(&place);
    for command in ["info", "replay", "grade", "export"] {
        let mut arguments = words(&[command]);
        arguments.push(folder.clone().into());
        if command == "export" {
            arguments.extend(words(&["--out", "out", "--every-ticks", "1000"]));
        }
        arguments.push("--json".into());
        let arguments: Vec<&OsStr> = arguments.iter().map(OsString::as_os_str).collect();
        let ended = run(&place, Program::Sessions, &arguments);
        assert!(ended.code <= 1, "{command}: {ended:#?}");
        let said = ended.json();
        let files = said["files"].as_array().expect("an object for each file");
        let names: Vec<&str> = files
            .iter()
            .map(|file| file["file"].as_str().expect("a name"))
            .collect();
        assert_eq!(names.len(), 2, "{command}: {said}");
        assert!(names[0].contains("a.mcap") && names[1].contains("b.mcap"));
    }
    assert!(place.path("out/a/ticks.csv").is_file());
    assert!(place.path("out/b/ticks.csv").is_file());
}

#[test]
fn a_folder_without_recordings_is_named_and_costs_the_others_nothing() {
    let place = Place::new();
    std::fs::create_dir(place.path("empty")).expect("made");
    for command in ["info", "replay", "grade", "export"] {
        let mut arguments = vec![command, "empty"];
        if command == "export" {
            arguments.extend(["--out", "out"]);
        }
        place
            .run(Program::Sessions, &arguments)
            .refused(&["empty: no recording in this folder", ".mcap"]);
    }
    let good = format!("{CORPUS}/crown.mcap");
    let ended = place.run(Program::Sessions, &["info", "empty", &good]);
    assert!(ended.stdout.contains("crown.mcap"), "{ended:#?}");
    ended.refused(&["empty: no recording in this folder"]);
}

/// `serde` refuses a path that is not UTF-8: a demo's session was recorded, replayed, graded, and its summary lost.
#[test]
fn a_demo_records_into_a_folder_whose_name_is_not_utf_8() {
    let place = Place::new();
    let recordings = OsStr::from_bytes(NAME);
    let demo = words(&[
        "demo",
        "--virtual",
        "--exercise",
        "probing",
        "--duration",
        "3",
        "--recordings",
    ]);
    let mut arguments: Vec<&OsStr> = demo.iter().map(OsString::as_os_str).collect();
    arguments.push(recordings);
    let ended = run(&place, Program::Client, &arguments);
    assert_eq!(ended.code, 0, "{ended:#?}");
    arguments.push(OsStr::new("--json"));
    let said = run(&place, Program::Client, &arguments).json();
    let found = files_with(&place.path(".").join(recordings), "mcap");
    assert_eq!(found.len(), 2);
    // The text is the file's name for a shell.
    let shown = said["recording"].as_str().expect("a path");
    assert!(shown.starts_with(r"$'\334bung \351/"), "{shown}");
    let list = place
        .command(Path::new("bash"))
        .args(["-c", &format!("test -f {shown}")])
        .status();
    assert!(list.expect("bash").success(), "{shown}");
    let page = said["page"].as_str().expect("a page");
    assert!(page.ends_with(".html'"), "{page}");

    // Pages, tables, a grade beside the recording, a recovered file.
    let [file, ..] = &found[..] else {
        panic!("no recording")
    };
    let file = file.as_os_str();
    let html = OsStr::from_bytes(b"pages-\xff");
    let csv = OsStr::from_bytes(b"class-\xff.csv");
    let [grade, to_html, to_csv] = ["grade", "--html", "--csv"].map(OsStr::new);
    let graded = [grade, file, to_html, html, to_csv, csv];
    let ended = run(&place, Program::Sessions, &graded);
    assert_eq!(ended.code, 0, "{ended:#?}");
    assert_eq!(files_with(&place.path(".").join(html), "html").len(), 2);
    let whole = std::fs::read(file).expect("read");
    let torn = place.path(".").join(OsStr::from_bytes(b"torn-\xff.mcap"));
    std::fs::write(&torn, &whole[..whole.len() - 300]).expect("written");
    let out = OsStr::from_bytes(b"whole-\xff.mcap");
    let [info, recover] = ["info", "--recover"].map(OsStr::new);
    let recovered = [info, torn.as_os_str(), recover, out];
    let ended = run(&place, Program::Sessions, &recovered);
    assert_eq!(ended.code, 0, "{ended:#?}");
    // An error names the file.
    let missing = OsStr::from_bytes(b"none-\xff.mcap");
    run(&place, Program::Sessions, &[info, missing]).refused(&[r"$'none-\377.mcap'"]);
}

#[test]
fn a_server_and_a_scene_in_such_a_folder() {
    let place = Place::new();
    let folder = place.path(".").join(OsStr::from_bytes(NAME));
    std::fs::create_dir(&folder).expect("made");
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../server/scenes/crown.toml");
    let copy = folder.join(OsStr::from_bytes(b"crown-\xff.toml"));
    std::fs::copy(scene, &copy).expect("copied");
    let arguments = ["scene", "check", "--json"].map(OsStr::new);
    let arguments = [&arguments[..2], &[copy.as_os_str()], &arguments[2..]].concat();
    let ended = run(&place, Program::Server, &arguments);
    assert_eq!(ended.code, 0, "{ended:#?}");
    let said = ended.json();
    assert!(
        said["file"]
            .as_str()
            .expect("text")
            .ends_with(r"crown-\377.toml'")
    );
    let missing = folder.join("none.toml");
    let arguments = [arguments[0], arguments[1], missing.as_os_str()];
    run(&place, Program::Server, &arguments).refused(&[r"\334bung \351/none.toml'"]);
}
