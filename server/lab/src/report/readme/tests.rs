//! The marked part of a document, from small reports.

use sulcus_cases::find;
use sulcus_core::optimise::SolverKind;

use super::*;
use crate::report::{Growth, Loops, Machine, Mouth, row};

fn small() -> Report {
    let case = find("teleport").expect("in the table");
    Report {
        program: "this",
        quick: false,
        machine: Machine::here(),
        rows: vec![row(case, false, SolverKind::ActiveSet, true)],
        mouth: Mouth {
            patient: 1,
            objects: 0,
            levels: Vec::new(),
        },
        matrix: Vec::new(),
        rates: Vec::new(),
        growth: Growth { lines: Vec::new() },
        random_poses: Vec::new(),
        passivity: Loops {
            loops: Vec::new(),
            hours: Vec::new(),
        },
        devices: Vec::new(),
        one_dof: Vec::new(),
        finite_elements: Vec::new(),
        peers: None,
        screen: None,
        networks: None,
        paper: None,
        took_s: 1.0,
        parts_s: Vec::new(),
    }
}

fn kind(quick: bool, paper: Option<Option<Part>>) -> Kind {
    Kind { quick, paper }
}

#[test]
fn a_report_without_all_parts_is_refused_with_the_missing_tables() {
    let document = Path::new("none.md");
    let said = |kind| {
        let refused = Readme::open(document, kind).err().expect("refused");
        format!("{refused:#}")
    };
    let quick = said(kind(true, Some(None)));
    for (title, _) in TABLES {
        assert!(quick.contains(title), "{title}");
    }
    for (_, title, _) in paper::TITLES {
        assert!(quick.contains(title), "{title}");
    }
    let plain = said(kind(false, None));
    assert!(plain.contains("`Paper: a probe in the pocket`") && !plain.contains("`Hard cases`"));
    let part = said(kind(false, Some(Some(Part::Pocket))));
    assert!(part.contains("`Hard cases`") && !part.contains("`Paper: a probe in the pocket`"));
    assert!(missing(kind(false, Some(None))).is_empty());
}

#[test]
fn a_table_without_rows_is_named_and_nothing_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.md");
    let text = format!("head\n{}\nold\n{}\ntail", markers::BEGIN, markers::END);
    std::fs::write(&path, &text).expect("written");
    let origin = Origin::now(folder.path());
    let readme = Readme {
        path: path.clone(),
        origin,
    };
    let refused = readme.write(&small()).expect_err("refused");
    let said = format!("{refused:#}");
    assert!(said.contains("`Rates`") && said.contains("`Paper: the machine`"));
    assert!(!said.contains("`Hard cases`"), "{said}");
    assert_eq!(std::fs::read_to_string(&path).expect("read"), text);
    let wrong = folder.path().join("wrong.md");
    std::fs::write(&wrong, "no markers").expect("written");
    let readme = Readme {
        path: wrong,
        ..readme
    };
    let refused = readme.with("").expect_err("refused");
    assert!(format!("{refused:#}").contains("wrong.md"));
}

#[test]
fn a_hard_case_stands_in_the_summary_with_times_and_residual() {
    let report = small();
    let table = rows::summary(&report);
    let [row] = &table.rows[..] else {
        panic!("{} rows", table.rows.len());
    };
    assert_eq!(row.len(), table.columns.len());
    assert_eq!(&row[..2], ["coupled", "active set"]);
    assert_eq!(row[3], "1 of 1");
    assert!(row[6].ends_with("(`teleport`)"), "{}", row[6]);
    assert_eq!(rows::slowest(&report).rows.len(), 1);
}

#[test]
fn every_part_of_the_paper_has_a_table() {
    for (part, _) in Part::ALL {
        assert!(paper::TITLES.iter().any(|(of, ..)| *of == part), "{part:?}");
    }
}

#[test]
fn rows_of_a_part_share_the_notes_of_equal_conditions() {
    let found = crate::report::paper::paper_part(Part::OneDof, true, &|_, _| ());
    let beside = crate::report::Beside::of(found.expect("springs"), false);
    let (_, title, make) = paper::TITLES[0];
    let table = make(&beside, Part::OneDof);
    assert_eq!(table.rows.len(), beside.rows.len());
    assert!(table.notes.len() < table.rows.len());
    for row in &table.rows {
        assert_eq!(row.len(), table.columns.len());
        let note: usize = row[4].parse().expect("a number");
        assert!((1..=table.notes.len()).contains(&note));
    }
    let text = table.markdown(title);
    assert!(text.contains("Command: `sulcus-server report --paper=one-dof`."));
    let lines: Vec<&str> = text.lines().filter(|line| line.starts_with('|')).collect();
    assert_eq!(lines.len(), table.rows.len() + 2);
}
