//! Tables of the paper, part by part.

use super::table::{Table, number};
use crate::report::Beside;
use crate::report::paper::Part;

/// Maker of a table from the answers of a part.
type Make = fn(&Beside, Part) -> Table;

/// Parts, titles and makers of the tables, in the order of the paper.
pub(super) const TITLES: [(Part, &str, Make); 12] = [
    (Part::OneDof, "Paper: one degree of freedom", of_part),
    (
        Part::Trees,
        "Paper: sphere trees, springs and stiffnesses",
        of_part,
    ),
    (Part::Tongue, "Paper: a mirror on the tongue", of_part),
    (
        Part::Elements,
        "Paper: tissue against finite elements",
        of_part,
    ),
    (Part::Pocket, "Paper: a probe in the pocket", of_part),
    (Part::Ripple, "Paper: ripple of the spheres", of_part),
    (Part::Rates, "Paper: one loop against two rates", of_part),
    (
        Part::Rates,
        "One loop against two rates, in numbers",
        two_rates,
    ),
    (Part::ManyRows, "Paper: problems of 500 rows", of_part),
    (Part::Times, "Paper: times of the stages", of_part),
    (
        Part::WholeMouth,
        "Paper: the whole mouth and its contacts",
        of_part,
    ),
    (Part::Machine, "Paper: the machine", of_part),
];

/// Case of a part, for the caption.
fn case(part: Part) -> &'static str {
    match part {
        Part::Machine => "the machine of the report",
        Part::OneDof => {
            "a sphere on a spring, pressed by a coupled tool with one degree of freedom"
        }
        Part::Trees => "the shipped tongue and pocket at rest",
        Part::Tongue => "a mirror that presses the shipped tongue lightly, deeply and askance",
        Part::Pocket => {
            "a probe that is led into the shipped pocket, turned, and pressed to the floor"
        }
        Part::Ripple => "a probe's tip that slides over an ellipsoid",
        Part::Rates => "a mirror that slides on the shipped tongue",
        Part::Elements => "static loads on the built-in tongue",
        Part::ManyRows => "random contact problems of 500 rows",
        Part::Times => {
            "a mirror that presses the shipped tongue, with the same recorded hand for every row"
        }
        Part::WholeMouth => "two tools at work in a generated mouth",
    }
}

/// Printed values of a part beside the measured ones. Equal conditions share a note.
fn of_part(beside: &Beside, part: Part) -> Table {
    let mut notes: Vec<String> = Vec::new();
    let mut note = |how: &str| {
        let known = notes.iter().position(|note| note == how);
        let at = known.unwrap_or_else(|| {
            notes.push(how.to_owned());
            notes.len() - 1
        });
        format!("{}", at + 1)
    };
    let rows = beside.rows.iter().filter(|row| row.part == part);
    let rows: Vec<Vec<String>> = rows
        .map(|row| {
            vec![
                row.place.to_owned(),
                match row.conditions {
                    "" => row.what.to_owned(),
                    conditions => format!("{}; {conditions}", row.what),
                },
                row.printed.clone().unwrap_or_else(|| "unknown".to_owned()),
                row.measured.clone(),
                note(&row.how),
            ]
        })
        .collect();
    Table {
        caption: format!(
            "Case: {}, with the conditions of the notes; reference: the printed value of the paper, which is unknown where its text at hand has none; quantity: that of the row.",
            case(part)
        ),
        command: part.command(false),
        columns: vec![
            "place",
            "quantity",
            "printed, with unit",
            "measured, with unit",
            "note",
        ],
        rows,
        notes,
    }
}

/// One loop of 1 kHz against tissue at a slower rate.
fn two_rates(beside: &Beside, part: Part) -> Table {
    let rows = beside.multi_rate.iter().map(|rated| {
        vec![
            rated.scene.clone(),
            rated.rates.to_owned(),
            number(rated.rms_force_n),
            number(rated.rms_difference_n),
            number(rated.max_difference_n),
            number(rated.buzz_n * 1e3),
            number(rated.force_step_n * 1e3),
            number(rated.energy_mj),
            if rated.stable { "stable" } else { "not stable" }.to_owned(),
        ]
    });
    Table {
        caption: "Case: a mirror on the tongue, tissue at about 60 Hz and force at 1 kHz; reference: one loop of 1 kHz on the same recorded hand; quantities: difference of the force, and calm and energy with a hand that feels.".to_owned(),
        command: part.command(false),
        columns: vec![
            "scene",
            "rates",
            "force rms, N",
            "force difference rms, N",
            "force difference max, N",
            "buzz, mN",
            "force step max, mN",
            "energy put out, mJ",
            "state",
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}
