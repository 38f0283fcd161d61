//! The program: pages, tables, copies, and what it writes over.

use serde_json::Value;
use sulcus_sessions::{Exercise, Rubric};

use super::place::{Place, REVISE};

#[test]
fn the_program_writes_the_same_bytes_again_and_pages_that_need_no_network() {
    let place = Place::new();
    place.session();
    std::fs::write(place.path("names.csv"), "learner_id,name\na7f3,Doe & Co\n").unwrap();
    let json = ["grade", "session.mcap", "--json"];
    let (code, once, _) = place.run(&json);
    assert_eq!((code, &once), (0, &place.run(&json).1));
    let object: Value = serde_json::from_str(once.lines().last().unwrap()).unwrap();
    assert!(object["score"].is_f64());
    for key in [
        "name",
        "value",
        "unit",
        "target",
        "score",
        "definition",
        "source",
    ] {
        assert!(object["metrics"][0].get(key).is_some(), "{key}");
    }
    assert!(!once.contains("Doe"));
    let args = [
        "grade",
        "session.mcap",
        "--html",
        "pages",
        "--csv",
        "class.csv",
        "--names",
        "names.csv",
    ];
    let (code, table, _) = place.run(&args);
    assert_eq!(code, 0);
    let version = Rubric::of(&Exercise::built_in()[0]).unwrap().version;
    let says = format!("rubric     crown, version {version}");
    assert!(table.contains(&says), "{table}");
    for page in ["session.html", "class.html"] {
        let page = std::fs::read_to_string(place.path("pages").join(page)).unwrap();
        for outside in ["http:", "https:", "<script", "url(h", "@import", "src="] {
            assert!(!page.contains(outside), "{outside}");
        }
        assert!(
            page.contains("Doe &amp; Co (a7f3)") && page.contains("crown"),
            "{page}"
        );
        assert!(!page.contains("<b>7</b>"));
    }
    let table = std::fs::read_to_string(place.path("class.csv")).unwrap();
    assert!(
        table.starts_with("file,learner_id,name,exercise,attempt,"),
        "{table}"
    );
    assert!(
        table.contains("session.mcap,a7f3,Doe & Co,crown,1,"),
        "{table}"
    );
}

#[test]
fn pictures_change_neither_the_grade_nor_its_json() {
    let place = Place::new();
    let corpus = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/corpus/probing.mcap");
    std::fs::copy(corpus, place.path("session.mcap")).unwrap();
    let grade = |folder: &str, more: &[&str]| {
        let args = ["grade", "session.mcap", "--json", "--html", folder];
        let (code, out, _) = place.run(&[&args[..], more].concat());
        let page = place.path(folder).join("session.html");
        (code, out, std::fs::read_to_string(page).unwrap())
    };
    let (code, out, page) = grade("plain", &[]);
    let (code_drawn, out_drawn, page_drawn) = grade("drawn", &["--pictures"]);
    assert_eq!((code, out), (code_drawn, out_drawn));
    let title = "The findings in pictures";
    assert!(!page.contains(title) && page_drawn.contains(title));
    // The rest of the page is the same, too.
    let (before, rest) = page_drawn
        .split_once("<section class=\"pictures\">")
        .unwrap();
    let (_, after) = rest.split_once("</section>").unwrap();
    let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(words(&format!("{before}{after}")), words(&page));
}

/// The pages and the JSON of a whole class were lost with a table that could not be written, and the cause was not said.
#[test]
fn a_table_that_cannot_be_written_takes_nothing_else_with_it() {
    let place = Place::new();
    place.session();
    let args = [
        "grade",
        "session.mcap",
        "--csv",
        "absent/class.csv",
        "--html",
        "pages",
        "--json",
    ];
    let (code, once, said) = place.run(&args);
    assert_eq!(code, 2);
    assert!(said.contains("class.csv`: No such file"), "{said}");
    let object: Value = serde_json::from_str(once.lines().last().unwrap()).unwrap();
    assert!(object["score"].is_f64(), "{object}");
    assert!(place.path("pages").join("class.html").exists());
}

/// `--csv class/*.mcap` wrote the table over the first recording, and said nothing.
#[test]
fn no_recording_and_nothing_that_is_read_is_written_over() {
    let place = Place::new();
    let path = place.session();
    let before = std::fs::read(&path).unwrap();
    std::fs::copy(&path, place.path("other.mcap")).unwrap();
    let names = "learner_id,name\na7f3,Doe\n";
    std::fs::write(place.path("session.mcap.grade.json"), "kept").unwrap();
    std::fs::write(place.path("names.csv"), names).unwrap();
    let around = format!(
        "./../{}/session.mcap",
        place.0.path().file_name().unwrap().display()
    );
    for (table, word) in [
        ("session.mcap", "which is read as"),
        (around.as_str(), "which is read as"),
        ("names.csv", "which is read as"),
        ("other.mcap", "which is a recording"),
        ("session.mcap.grade.json", "which is read as"),
    ] {
        let args = [
            "grade",
            "session.mcap",
            "--names",
            "names.csv",
            "--csv",
            table,
        ];
        let told = place.told(&args);
        assert!(told.contains("--csv is") && told.contains(word), "{told}");
    }
    assert!(std::fs::read(&path).unwrap() == before);
    assert!(std::fs::read(place.path("other.mcap")).unwrap() == before);
    assert_eq!(
        std::fs::read_to_string(place.path("names.csv")).unwrap(),
        names
    );
}

/// The first of two copies counted, torn or not, and whatever an instructor had said beside the other was not seen.
#[test]
fn of_copies_the_one_that_says_most_counts() {
    let place = Place::new();
    let bytes = std::fs::read(place.session()).unwrap();
    std::fs::write(place.path("a-torn.mcap"), &bytes[..bytes.len() / 2]).unwrap();
    std::fs::copy(place.path("session.mcap"), place.path("b-copy.mcap")).unwrap();
    assert_eq!(
        place
            .run(&[&["grade", "session.mcap"][..], &REVISE].concat())
            .0,
        0
    );
    let all = ["a-torn.mcap", "b-copy.mcap", "session.mcap"];
    for order in [[0, 1, 2], [2, 1, 0], [1, 0, 2]] {
        let files = order.map(|k| all[k]);
        let args = [&["grade"][..], &files, &["--csv", "class.csv"]].concat();
        let (code, _, said) = place.run(&args);
        assert_eq!(code, 1, "{said}");
        assert_eq!(said.matches("counted once").count(), 2, "{said}");
        let table = std::fs::read_to_string(place.path("class.csv")).unwrap();
        let row = table.lines().nth(1).unwrap();
        assert!(
            row.starts_with("session.mcap,") && row.contains(",81,true,"),
            "{row}"
        );
        assert_eq!(table.lines().count(), 2);
    }
    let told = place.told(&[
        "grade",
        "session.mcap",
        "--revise",
        "8",
        "--by",
        "Dr. Doe",
        "--at",
        "x",
        "--reason",
        "y",
    ]);
    assert!(told.contains("never a name"), "{told}");
}

#[test]
fn what_cannot_be_kept_does_not_hide_the_grade() {
    let place = Place::new();
    place.session();
    // Where the draft would be written is a folder.
    std::fs::create_dir(place.path("session.mcap.grade.json.new")).unwrap();
    let (code, table, said) = place.run(&[&["grade", "session.mcap"][..], &REVISE].concat());
    assert_eq!(code, 2);
    assert!(
        table.contains("score      ") && !table.contains("REVISED"),
        "{table}"
    );
    assert!(said.contains("to keep the score, grade a copy"), "{said}");
    // What is wrong with the word itself is said before anything is done.
    let mut blank = REVISE;
    blank[7] = " ";
    let told = place.told(&[&["grade", "session.mcap"][..], &blank].concat());
    assert!(
        told.contains("session.mcap: revision: reason is 1 bytes long"),
        "{told}"
    );
    assert!(!told.contains("grade a copy"), "{told}");
}

#[test]
fn a_revision_says_what_was_proposed_then_where_that_was_something_else() {
    let place = Place::new();
    place.session();
    let (_, table, _) = place.run(&[&["grade", "session.mcap"][..], &REVISE].concat());
    assert!(!table.contains("THEN"), "{table}");
    let mut other = Rubric::of(&Exercise::built_in()[0]).unwrap();
    let was = other.version;
    other.version = 77;
    std::fs::write(place.path("other.toml"), other.definition().unwrap()).unwrap();
    let args = [
        "grade",
        "session.mcap",
        "--rubric",
        "other.toml",
        "--html",
        "pages",
    ];
    let (_, table, _) = place.run(&args);
    let then = format!("by rubric crown, version {was} was proposed");
    assert!(table.contains(&then), "{table}");
    let page = std::fs::read_to_string(place.path("pages/session.html")).unwrap();
    assert!(page.contains(&then), "{page}");
}
