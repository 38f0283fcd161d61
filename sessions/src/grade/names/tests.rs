use proptest::prelude::*;

use super::*;

fn read(text: impl AsRef<[u8]>) -> Result<Names, NamesError> {
    Names::parse(text.as_ref(), Path::new("names.csv"))
}

fn refused(text: impl AsRef<[u8]>) -> String {
    read(text).expect_err("no table").to_string()
}

fn utf_16(text: &str, mark: bool, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    let mark = mark.then_some('\u{feff}');
    let text: String = mark.into_iter().chain(text.chars()).collect();
    text.encode_utf16().flat_map(bytes).collect()
}

#[test]
fn a_table_gives_names_and_a_bad_one_says_where() {
    let names = read("name,learner_id\n\"Doe, A.\", a7f3\nRoe,b1\n").expect("a table");
    assert_eq!(names.of("a7f3"), Some("Doe, A."));
    assert_eq!(names.label("b1"), "Roe (b1)");
    assert_eq!(names.label("c9"), "c9");
    assert_eq!(names.label(""), "(no id)");
    for (text, words) in [
        (
            "id,name\n1,x\n",
            "line 1: header is `id,name`, expected the columns `learner_id` and `name`",
        ),
        ("", "line 1: header is ``, expected the columns"),
        (
            "learner_id,name,Name\na,x,y\n",
            "header is `learner_id,name,Name`, expected the columns",
        ),
        (
            "learner_id,name\na,x\n,y\n",
            "line 3: learner_id is ``, expected an opaque id",
        ),
        (
            "learner_id,name\na,x\na,y\n",
            "line 3: learner_id is `a`, expected each id once",
        ),
        (
            "\nlearner_id,name\n\n\na,x\n\na,y\n",
            "line 7: learner_id is `a`, expected each id once",
        ),
        (
            "sep=;\r\n\r\nlearner_id;name\r\na;x\r\n'a;y\r\n",
            "line 5: learner_id is `a`, expected each id once",
        ),
        (
            "learner_id,name\na7,Doe, John\n",
            "line 2: a cell is `John`, expected a heading over it, or quotation marks",
        ),
        (
            "learner_id;name;;\na7;Doe;;Jr.\n",
            "line 2: a cell is `Jr.`, expected a heading",
        ),
        (
            "learner_id,name\na7,\"Doe\nb2,Roe\nc3,Poe\n",
            "line 2: a cell is `Doe\\nb2,Roe\\nc3,Poe`, expected one line of text",
        ),
    ] {
        let said = refused(text);
        assert!(said.contains(words), "{said}");
    }
    assert!(Names::open(Path::new("no/such.csv")).is_err());
}

/// Tables as Excel saves them. Earlier versions refused all but UTF-8 with commas.
#[test]
fn tables_are_read_as_spreadsheets_save_them() {
    let person = |id: &str, name: &str| (id.to_owned(), name.to_owned());
    let first = person("a7", "Test Person Ä");
    let second = person("b2", "Zweite, Person");
    for (file, people) in [
        (
            "good.csv",
            vec![first.clone(), second.clone(), person("007", "Third")],
        ),
        ("bom.csv", vec![first.clone()]),
        ("caps.csv", vec![person("a7", "Test Person")]),
        ("cp1252.csv", vec![first.clone()]),
        ("semicolon.csv", vec![first.clone(), second]),
        ("semicolon_bom.csv", vec![first.clone()]),
        ("sep_line.csv", vec![first.clone()]),
        ("tab_utf16.csv", vec![first.clone()]),
        ("trailing_empty.csv", vec![person("a7", "Test Person")]),
    ] {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/inputs/names/");
        let names = Names::open(Path::new(&format!("{path}{file}")));
        let names = names.unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(names, Names(people.into_iter().collect()), "{file}");
    }
}

#[test]
fn every_separator_encoding_and_heading_gives_the_same_people() {
    let table = |separator: char, end: &str| {
        let lines = [
            "Learner ID|Name|",
            "a7|Test Person Ä|",
            "'007|Dritte \"X\"|",
            "||",
            "||",
        ];
        let lines = lines.map(|line| line.replace('|', &separator.to_string()));
        lines.join(end)
    };
    let people = [("007", "Dritte \"X\""), ("a7", "Test Person Ä")];
    let people = people.map(|(id, name)| (id.to_owned(), name.to_owned()));
    let expected = Names(people.into_iter().collect());
    for separator in [',', ';', '\t', '|'] {
        for end in ["\n", "\r\n", "\r"] {
            for head in [
                String::new(),
                format!("sep={separator}{end}"),
                end.to_owned(),
            ] {
                let text = head + &table(separator, end);
                let windows = encoding_rs::WINDOWS_1252.encode(&text).0.into_owned();
                for bytes in [
                    text.clone().into_bytes(),
                    format!("\u{feff}{text}").into_bytes(),
                    windows,
                    utf_16(&text, true, u16::to_le_bytes),
                    utf_16(&text, true, u16::to_be_bytes),
                    utf_16(&text, false, u16::to_le_bytes),
                    utf_16(&text, false, u16::to_be_bytes),
                ] {
                    let names = read(&bytes).unwrap_or_else(|error| panic!("{error}: {text:?}"));
                    assert_eq!(names, expected, "{text:?}");
                }
            }
        }
    }
    for head in [
        "LEARNER_ID,NAME",
        "learner-id , name",
        "LearnerId,Name",
        "\"Learner ID\",\"Name\"",
    ] {
        let names = read(format!("{head}\na7,x\n")).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(names.of("a7"), Some("x"), "{head}");
    }
    // A separator in the first line that the table does not use.
    let names = read("sep=,\nlearner_id;name\na7;x, y\n").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(names.of("a7"), Some("x, y"));
}

#[test]
fn ids_are_read_with_and_without_their_marks() {
    let names =
        read("learner_id,name\n'007,A\n\"=\"\"1e5\"\"\",B\n'a9,C\nd1,'t Hooft\n").expect("a table");
    let of = ["007", "1e5", "a9", "d1"].map(|id| names.of(id));
    assert_eq!(of, [Some("A"), Some("B"), Some("C"), Some("'t Hooft")]);
}

#[test]
fn bytes_that_are_no_text_are_refused() {
    let mut odd = utf_16("learner_id,name\na7,x\n", true, u16::to_le_bytes);
    odd.push(0);
    assert!(refused(odd).contains("not UTF-16LE throughout"));
    assert!(refused(b"\xef\xbb\xbflearner_id,name\na7,\xc4\n").contains("not UTF-8 throughout"));
}

proptest! {
    #[test]
    fn any_bytes_are_a_table_or_an_error(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = read(&bytes);
    }

    #[test]
    fn any_bytes_behind_a_head_are_a_table_or_an_error(
        mark in 0_usize..4,
        separator in 0_usize..4,
        rest in proptest::collection::vec(any::<u8>(), 0..200),
    ) {
        let marks: [&[u8]; 4] = [b"", b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff"];
        let head = format!("learner_id{0}name\n", [',', ';', '\t', '|'][separator]);
        let _ = read([marks[mark], head.as_bytes(), &rest].concat());
        if mark >= 2 {
            let bytes = if mark == 2 { u16::to_le_bytes } else { u16::to_be_bytes };
            let _ = read([utf_16(&head, true, bytes), rest].concat());
        }
    }

    #[test]
    fn people_survive_every_way_of_saving(
        people in proptest::collection::btree_map("[a-z]{0,3}[0-9]{1,4}", "[A-Za-zÄé,;' -]{0,12}", 0..6),
        separator in 0_usize..3,
    ) {
        let separator = [b',', b';', b'\t'][separator];
        let mut writer = csv::WriterBuilder::new().delimiter(separator).from_writer(Vec::new());
        writer.write_record(["Learner ID", "Name"]).expect("written");
        for (id, name) in &people {
            writer.write_record([cells::text(id), cells::text(name)].map(|cell| cell.into_owned())).expect("written");
        }
        let text = writer.into_inner().expect("whole");
        let names = read(&text).unwrap_or_else(|error| panic!("{error}"));
        let trimmed = people.into_iter().map(|(id, name)| (id, name.trim().to_owned()));
        prop_assert_eq!(names, Names(trimmed.collect()));
    }
}
