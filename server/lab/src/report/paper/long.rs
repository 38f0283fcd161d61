//! Every printed number of the paper beside a measured one, in short.

use std::time::Instant;

use sulcus_support::long;

use super::printed::{PRINTED, Value};
use super::*;
use crate::tissue::against_fem::against_fem;

fn value(rows: &[Beside], id: &str, name: &str) -> f64 {
    let row = rows.iter().find(|row| row.printed.id == id);
    let row = row.expect("a printed id");
    let found = row.values.iter().find(|(key, _)| *key == name);
    found.expect("a value of that name").1
}

/// What the report says, line by line: `cargo test ... paper -- --nocapture`.
fn show(paper: &Paper) {
    for row in &paper.rows {
        let p = row.printed;
        let measured = &row.measured;
        println!(
            "{:14} {:28} {:?} {} | {measured} | {}",
            p.place, p.id, p.value, p.unit, row.how
        );
    }
    for curve in &paper.curves {
        let sizes: Vec<String> = curve
            .series
            .iter()
            .map(|(name, points)| format!("{name} ({})", points.len()))
            .collect();
        println!(
            "{}: {} [{}; {}]: {}",
            curve.place,
            curve.title,
            curve.x,
            curve.y,
            sizes.join(", ")
        );
        println!("    {}", curve.note);
    }
}

fn measured() -> Paper {
    let begin = Instant::now();
    let elements = against_fem(true, &|_, _| ()).expect("an equilibrium");
    let paper = paper_beside(true, &elements, &|what, share| {
        println!(
            "{:6.1} s {:5.1} % {what}",
            begin.elapsed().as_secs_f64(),
            share * 100.0
        );
    });
    show(&paper);
    paper
}

#[test]
fn everything_printed_is_answered_once_and_measured_where_it_can_be() {
    if !long::selected("paper-in-short") {
        return;
    }
    let paper = measured();
    let ids: Vec<&str> = paper.rows.iter().map(|row| row.printed.id).collect();
    let printed: Vec<&str> = PRINTED.iter().map(|printed| printed.id).collect();
    assert_eq!(ids, printed);
    for row in &paper.rows {
        assert!(!row.how.is_empty(), "{}", row.printed.id);
        let odd = row.values.iter().find(|(_, x)| !x.is_finite());
        assert!(odd.is_none(), "{}: {odd:?}", row.printed.id);
    }
    // What the text lost stays lost, whatever was measured.
    let unknown = |id: &str| {
        PRINTED
            .iter()
            .any(|p| p.id == id && p.value == Value::Unknown)
    };
    for id in [
        "table2-case1-collision-ms",
        "table3-data",
        "fig17-torque",
        "table1-spring-n-per-m",
    ] {
        assert!(unknown(id), "{id}");
    }
    let rows = &paper.rows;

    // One degree of freedom: Eq. 9 holds, on both sides of its limit.
    for id in ["eq9-underdamped", "eq9-critical", "eq9-overdamped"] {
        assert!(value(rows, id, "worst_share_off") < 0.01, "{id}");
        assert_eq!(value(rows, id, "grow_at_0.9"), 0.0, "{id}");
    }
    assert!(value(rows, "eq9-table1-limit-ms", "worst_share_off") < 0.01);
    assert_eq!(value(rows, "eq9-underdamped", "grow_at_1.01"), 3.0);

    // The tongue: deep is more than light, and nothing is gone through.
    assert!(value(rows, "fig14-force-n", "b") > 2.0 * value(rows, "fig14-force-n", "a"));
    assert!(value(rows, "fig14-penetration", "um") < 1.0);
    // Local, global, in several places.
    let state = |name| value(rows, "fig14-states", name);
    assert!(state("extent_percent_a") < 0.5 * state("extent_percent_b"));
    assert_eq!((state("regions_a"), state("regions_b")), (1.0, 1.0));
    assert!(state("regions_c") >= 2.0);
    // The pocket: the torque is against the turn, the floor is felt.
    assert!(value(rows, "fig17-sequence", "against_percent") > 90.0);
    assert!(
        value(rows, "fig18-bottom-force", "floor_n")
            > value(rows, "fig18-bottom-force", "before_n")
    );
    // Finer spheres are felt less, and both within the paper's bounds when blended.
    let ripple = |id, name| value(rows, id, name);
    assert!(
        ripple("ripple-level3-percent", "plain_rms_percent")
            < ripple("ripple-level2-percent", "plain_rms_percent")
    );
    assert!(ripple("ripple-level3-percent", "blended_rms_percent") < 5.0);
    // Every time has an interval about it.
    for id in [
        "table2-case1-collision-ms",
        "table2-case2-optimisation-ms",
        "table2-case2-level",
    ] {
        let (mean, half) = (
            value(rows, id, "coupled_ms"),
            value(rows, id, "coupled_ms_half"),
        );
        assert!(mean > 0.0 && half >= 0.0, "{id}: {mean} {half}");
    }
    assert!(value(rows, "solve-500-ms", "solved_share_least") > 0.99);
    // Two rates cost force and calm.
    let rate = |name| value(rows, "open-multirate", name);
    assert!(rate("compliance_buzz_n_k2") > 5.0 * rate("single_buzz_n_k2"));
    assert!(rate("shape_rms_n_k2") > rate("compliance_rms_n_k2"));

    // What is measured says by which command, and that command answers it again, the same.
    for part in [Part::OneDof, Part::Trees] {
        let again = paper_part(part, true, &|_, _| ()).expect("no elements are asked for");
        let first = rows.iter().filter(|row| row.part == part);
        assert!(first.clone().count() > 5, "{part:?}");
        let numbers = |row: &Beside| (row.printed.id, row.values.clone(), row.how.clone());
        let again: Vec<_> = again.rows.iter().map(numbers).collect();
        assert_eq!(first.map(numbers).collect::<Vec<_>>(), again, "{part:?}");
    }

    assert_eq!(paper.multi_rate.map(|found| found.studies.len()), Some(2));
    let places: Vec<&str> = paper.curves.iter().map(|curve| curve.place).collect();
    for place in ["Fig. 14", "Fig. 17", "Fig. 18", "multi-rate"] {
        assert!(places.contains(&place), "{place}");
    }
    for curve in &paper.curves {
        assert!(
            curve.series.iter().all(|(_, points)| points.len() > 50),
            "{}",
            curve.title
        );
    }
}
