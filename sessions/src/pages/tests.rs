use std::collections::BTreeSet;
use std::path::Path;

use proptest::prelude::*;

use super::*;
use crate::grade::class::Session;
use sample::{KINDS, Kind};

#[test]
fn dates_are_those_of_a_calendar() {
    for (seconds, said) in [
        (0, "1970-01-01 00:00 UTC"),
        (951_782_400, "2000-02-29 00:00 UTC"),
        (1_790_000_000, "2026-09-21 14:13 UTC"),
        (4_107_542_399, "2100-02-28 23:59 UTC"),
    ] {
        assert_eq!(date(seconds * 1_000_000_000), said);
    }
}

/// Pages of sessions of all kinds and of their class, with `text` in every text.
fn pages(text: &str, look: &Look<'_>) -> Vec<String> {
    let mut pages = Vec::new();
    let mut class: Vec<Session> = Vec::new();
    for kind in KINDS {
        for attempt in 1..=3 {
            let (session, graded) = sample::session(text, kind, attempt);
            let pictures = drawn(text, attempt);
            pages.push(student_page(&session, &graded, look, Some(&pictures)));
            class.push(session);
        }
    }
    let unread = [(text.to_owned(), text.to_owned())];
    pages.push(class_page(&class, &unread, look));
    pages
}

/// Pictures with `text` in every text.
fn drawn(text: &str, attempt: usize) -> Pictures {
    if attempt == 2 {
        return Pictures::Missing(text.into());
    }
    Pictures::Drawn(vec![Picture {
        instant: instants::Instant {
            tooth: 36,
            site: sulcus_core::tissue::gingiva::Site::DistoBuccal,
            tick: 75_000,
            view: "close-up",
            says: "the tip stood here.".into(),
        },
        at_s: 75,
        png: b"no PNG file".to_vec(),
    }])
}

/// All tags of a page, with their attributes.
fn tags(page: &str) -> Vec<&str> {
    let parts = page.split('<').skip(1);
    parts
        .map(|part| part.split_once('>').expect("an open tag").0)
        .collect()
}

/// Text of a page without its tags, entities replaced by their characters.
fn text_of(page: &str) -> String {
    let texts = page.split('<').filter_map(|part| part.split_once('>'));
    let text: String = texts.map(|(_, text)| text).collect();
    [
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&quot;", "\""),
        ("&#39;", "'"),
        ("&amp;", "&"),
    ]
    .iter()
    .fold(text, |text, (entity, is)| text.replace(entity, is))
}

/// Text with many characters that have a meaning in HTML or in templates, and with control characters. It begins with
/// markup or with a letter.
fn any_text() -> impl Strategy<Value = String> {
    const SPECIAL: &str = "<>&\"'/=;#{}%|!-\0\u{7}\n\r\t\u{1b}\u{7f}\u{85}bx";
    let special = proptest::sample::select(SPECIAL.chars().collect::<Vec<_>>());
    let c = prop_oneof![3 => special, 1 => any::<char>()];
    let start = proptest::sample::select(vec![
        "x",
        "</p>",
        "<script>",
        "<!--",
        "\"><b>",
        "' onload='",
        "&lt;b&gt;",
        "]]>",
        "{{ x }}",
    ]);
    let rest = proptest::collection::vec(c, 0..40);
    (start, rest).prop_map(|(start, rest)| start.chars().chain(rest).collect())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_text_becomes_markup_in_any_page(text in any_text(), truth in any::<bool>(), named in any::<bool>()) {
        let names = sample::names(&text);
        let plain_names = sample::names("x");
        let look = |names| Look {
            names: named.then_some(names),
            numbering: Numbering::Universal,
            truth,
        };
        let hostile = pages(&text, &look(&names));
        let plain = pages("x", &look(&plain_names));
        let printable = |c: char| if c.is_control() { '\u{fffd}' } else { c };
        let shown: String = text.chars().map(printable).collect();
        for (hostile, plain) in hostile.iter().zip(&plain) {
            prop_assert_eq!(tags(hostile), tags(plain));
            prop_assert_eq!(hostile.lines().count(), plain.lines().count());
            prop_assert!(hostile.chars().all(|c| c == '\n' || !c.is_control()));
            prop_assert!(text_of(hostile).contains(&shown), "{shown} in {hostile}");
        }
    }
}

/// Drawings are the only content that a template does not escape. No template uses a filter that bypasses the escaper,
/// and no module but `svg.rs` makes trusted text.
#[test]
fn only_drawings_are_not_escaped() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/pages");
    let mut folders = vec![folder.clone()];
    let mut trusting = BTreeSet::new();
    let mut templates = Vec::new();
    while let Some(inner) = folders.pop() {
        for entry in std::fs::read_dir(inner).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).expect("text");
            let name = path.strip_prefix(&folder).expect("a file of the folder");
            if path.extension().is_some_and(|ending| ending == "html") {
                templates.push(name.to_owned());
                for way in [
                    "|safe",
                    "| safe",
                    "|e(",
                    "|escape(",
                    "autoescape",
                    "|json",
                    "{% filter",
                ] {
                    assert!(!text.contains(way), "{}: {way}", name.display());
                }
            } else if text.contains("Safe") && !name.ends_with("tests.rs") {
                trusting.insert(name.display().to_string());
            }
        }
    }
    assert!(
        templates.contains(&Path::new("templates/student/head.html").into()),
        "{templates:?}"
    );
    assert_eq!(Vec::from_iter(trusting), ["svg.rs"]);
}

#[test]
fn a_page_shows_what_its_kind_may_show() {
    let look = Look {
        names: None,
        numbering: Numbering::Fdi,
        truth: false,
    };
    let page = |kind: Kind| {
        let (session, graded) = sample::session("x", kind, 3);
        student_page(&session, &graded, &look, Some(&drawn("no adapter", 1)))
    };
    let [practice, _, exam, without] = KINDS.map(page);
    for words in [
        "Practise next",
        "<th>reached</th>",
        "Force on the floor",
        "<b>1:15</b> 36 distobuccal: the tip stood here.",
        "src=\"data:image/png;base64,bm8gUE5HIGZpbGU=\"",
    ] {
        assert!(practice.contains(words), "{words}");
        assert!(!exam.contains(words), "{words}");
    }
    assert!(without.contains("No grade: x") && !without.contains("Definitions and sources"));
}

#[test]
fn a_page_without_pictures_says_so_if_they_were_asked_for() {
    let look = Look {
        names: None,
        numbering: Numbering::Fdi,
        truth: false,
    };
    let (session, graded) = sample::session("x", KINDS[0], 1);
    let page = |pictures| student_page(&session, &graded, &look, pictures);
    assert!(!page(None).contains("in pictures"));
    let missing = Pictures::Missing("no graphics adapter was found".into());
    let said = "<p>No pictures of the findings: no graphics adapter was found.</p>";
    assert!(page(Some(&missing)).contains(said));
    let none = page(Some(&Pictures::Drawn(Vec::new())));
    assert!(none.contains("No finding cost points") && !none.contains("<img"));
}
