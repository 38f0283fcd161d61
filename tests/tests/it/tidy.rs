//! Form of the sources: length of files, comments of the folders that have been reworded, front pages of crates.

use std::path::Path;

use crate::sources::{MEMBERS, root, walk};

/// Longest source file, lines.
const LONGEST_FILE: usize = 600;
/// Widest comment line, columns.
const WIDEST: usize = 120;
/// Longest sentence of a comment, words. The aim is 25; a formula or a list of names may take a few more.
const LONGEST_SENTENCE: usize = 30;
/// Folders whose comments follow "How to write" of CONTRIBUTING.md. Each change of a further folder adds it.
const REWORDED: [&str; 25] = [
    "server/core",
    "server/display",
    "server/fem",
    "server/scene",
    "server/src",
    "server/console",
    "server/cases/src/table",
    "server/cases/src/multi_rate",
    "proto",
    "client/haptics",
    "client/connection/src",
    "client/demo/src",
    "client/operator/src",
    "client/src",
    "sessions/src/grade",
    "sessions/src/record",
    "sessions/src/replay",
    "sessions/src/exercise",
    "sessions/src/export",
    "sessions/src/cli",
    "sessions/view",
    "sessions/fuzz",
    "tests/relay",
    "tests/simulation",
    "tests/support",
];
/// First words of a comment whose subject is no noun.
const PRONOUNS: [&str; 12] = [
    "What", "Who", "Whose", "Whoever", "How", "Where", "Which", "Those", "As", "It", "They", "That",
];

/// A comment without its marks, with the line on which it begins.
struct Comment {
    line: usize,
    text: String,
}

/// Comments of a source: successive comment lines as one; list items, tables, headings and code blocks apart.
fn comments(source: &str) -> Vec<Comment> {
    let mut found: Vec<Comment> = Vec::new();
    let (mut open, mut code) = (false, false);
    for (k, line) in source.lines().enumerate() {
        let line = line.trim_start();
        let marks = ["//!", "///", "//"]
            .into_iter()
            .find(|marks| line.starts_with(marks));
        let Some(text) = marks.map(|marks| line[marks.len()..].trim()) else {
            (open, code) = (false, false);
            continue;
        };
        if text.starts_with("```") {
            (open, code) = (false, !code);
            continue;
        }
        if code || text.is_empty() || text.starts_with(['|', '#']) {
            open = false;
            continue;
        }
        let item = text.strip_prefix("- ").or_else(|| text.strip_prefix("* "));
        match found.last_mut() {
            Some(last) if open && item.is_none() => {
                last.text.push(' ');
                last.text.push_str(text);
            }
            _ => found.push(Comment {
                line: k + 1,
                text: item.unwrap_or(text).to_owned(),
            }),
        }
        open = true;
    }
    found
}

/// Faults of a comment.
fn faults(comment: &Comment) -> Vec<String> {
    let mut found = Vec::new();
    let first = comment.text.split(|c: char| !c.is_alphanumeric()).next();
    if first.is_some_and(|first| PRONOUNS.contains(&first)) {
        found.push("its first word is a pronoun or a question word".to_owned());
    }
    if comment.text.starts_with('(') {
        found.push("it is an afterthought in brackets".to_owned());
    }
    // A formula in backticks counts as one word.
    let plain = comment.text.split('`').enumerate();
    let plain = plain.map(|(k, part)| if k % 2 == 0 { part } else { "x" });
    let plain = plain.collect::<String>();
    let mut words = 0;
    for word in plain.split_whitespace() {
        words += 1;
        if words == LONGEST_SENTENCE + 1 {
            found.push(format!("a sentence has more than {LONGEST_SENTENCE} words"));
        }
        if word.ends_with(['.', ':', ';', '?', '!']) {
            words = 0;
        }
    }
    found
}

#[test]
fn no_source_is_longer_than_600_lines() {
    let mut long = Vec::new();
    for member in MEMBERS {
        walk(&root().join(member), &mut |path, text| {
            let lines = text.lines().count();
            if lines > LONGEST_FILE {
                long.push(format!("{}: {lines} lines", path.display()));
            }
        });
    }
    assert!(long.is_empty(), "{long:#?}");
}

#[test]
fn comments_of_the_reworded_folders_name_their_subject() {
    let (mut seen, mut found) = (0, Vec::new());
    for folder in REWORDED {
        walk(&root().join(folder), &mut |path, text| {
            let place = path.strip_prefix(root()).unwrap_or(path).display();
            for (k, line) in text.lines().enumerate() {
                let wide = line.chars().count() > WIDEST && line.trim_start().starts_with("//");
                // A table cannot be broken.
                if wide && !line.contains('|') {
                    found.push(format!("{place}:{}: wider than {WIDEST} columns", k + 1));
                }
            }
            for comment in comments(text) {
                seen += 1;
                for fault in faults(&comment) {
                    found.push(format!(
                        "{place}:{}: {fault}: {}",
                        comment.line, comment.text
                    ));
                }
            }
        });
    }
    assert!(seen > 1500, "{seen} comments");
    assert!(found.is_empty(), "{} faults: {found:#?}", found.len());
}

#[test]
fn faults_of_a_comment_are_found() {
    let source = "//! What was near is kept.\n\n/// (An afterthought.)\nfn a() {}\n/// Length, metres.\nfn b() {}\n";
    let found: Vec<usize> = comments(source)
        .iter()
        .map(|comment| faults(comment).len())
        .collect();
    assert_eq!(found, [1, 1, 0]);
    let long = format!("// {}.", ["word"; LONGEST_SENTENCE + 1].join(" "));
    assert_eq!(faults(&comments(&long)[0]).len(), 1);
    let two = format!("// {0}. {0}.", ["word"; LONGEST_SENTENCE].join(" "));
    assert!(faults(&comments(&two)[0]).is_empty());
}

/// A front page says in three lines or more what the crate is and where to begin.
#[test]
fn every_crate_has_a_front_page() {
    let mut short = Vec::new();
    let mut crates = 0;
    for member in MEMBERS {
        walk(&root().join(member), &mut |path, text| {
            if path.ends_with("src/lib.rs") {
                crates += 1;
                let lines = text
                    .lines()
                    .take_while(|line| line.starts_with("//!"))
                    .count();
                if lines < 3 {
                    short.push(format!("{}: {lines} lines", path.display()));
                }
            }
        });
    }
    assert!(crates >= 15, "{crates} crates");
    assert!(short.is_empty(), "{short:#?}");
}

#[test]
fn every_reworded_folder_is_there() {
    for folder in REWORDED {
        assert!(Path::new(&root().join(folder)).exists(), "{folder}");
    }
}

/// Names of the workspace's packages.
fn packages() -> Vec<String> {
    let text = std::fs::read_to_string(root().join("Cargo.toml")).expect("the workspace");
    let members = text.split("members = [").nth(1).expect("members");
    let members = members.split(']').next().expect("members");
    let package = |folder: &str| {
        let text = std::fs::read_to_string(root().join(folder).join("Cargo.toml")).expect(folder);
        let name = text.lines().find_map(|line| line.strip_prefix("name = \""));
        name.expect("a name").trim_end_matches('"').to_owned()
    };
    members.split('"').skip(1).step_by(2).map(package).collect()
}

#[test]
fn the_checks_have_an_exit_code_for_each_crate() {
    let script = std::fs::read_to_string(root().join(".ci/run")).expect("the script");
    let rows = script.split("CRATES=(").nth(1).expect("the rows");
    let rows = rows.split(')').next().expect("the rows");
    let rows: Vec<&str> = rows.split_whitespace().collect();
    assert!(rows.is_sorted() && rows.len() < 30, "{rows:?}");
    let mut packages = packages();
    packages.sort();
    assert_eq!(rows, packages);
}

#[test]
fn the_quarantine_names_at_most_forty_tests_that_exist() {
    let text = std::fs::read_to_string(root().join("tests/quarantine.txt")).expect("the file");
    let rows = text
        .lines()
        .map(|line| line.split('#').next().unwrap_or_default().trim());
    let rows: Vec<&str> = rows.filter(|row| !row.is_empty()).collect();
    assert!(rows.len() <= 40, "{} tests", rows.len());
    let mut sources = String::new();
    for member in MEMBERS {
        walk(&root().join(member), &mut |_, source| sources += source);
    }
    let packages = packages();
    for row in rows {
        let [package, _, test] = row.split(' ').collect::<Vec<_>>()[..] else {
            panic!("`{row}`, expected a package, a target and a test");
        };
        assert!(packages.iter().any(|one| one == package), "{row}");
        let name = test.rsplit("::").next().expect("a name");
        assert!(sources.contains(&format!("fn {name}(")), "{row}");
    }
}
