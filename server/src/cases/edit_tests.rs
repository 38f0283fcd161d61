use proptest::prelude::*;
use sulcus_scene::anatomy::patient::{Condition, Furcations, generate};

use super::*;

/// A file as a teacher writes one.
const BY_HAND: &str = "\
# Case of the second year.
name = \"Mrs Deep\"  # a label
missing = [46, 38]

# The molar of the exercise.
[[tooth]]
fdi = 36
depth_mm.buccal = [5, 4, 4]   # a pocket
depth_mm.lingual = [4, 3, 4]
recession_mm.buccal = [-1, 0, -1]
inflammation = 0.4
furcation.buccal = 1

[[tooth]]   # bleeds
fdi = 31
[tooth.bleeding]
buccal = [true, false, false]
";

fn parsed(text: &str) -> Patient {
    crate::exact::read(text).expect("a patient")
}

#[test]
fn a_change_of_one_value_changes_its_line_alone() {
    let mut new = parsed(BY_HAND);
    assert_eq!(edited(BY_HAND, &new).as_deref(), Some(BY_HAND), "no change");
    new.teeth[0].depth_mm.buccal = [6.0, 4.5, 4.0];
    let text = edited(BY_HAND, &new).expect("a form that can be edited");
    let expected = BY_HAND.replace("[5, 4, 4]", "[6, 4.5, 4]");
    assert_eq!(text, expected);
}

#[test]
fn comments_survive_a_new_tooth_a_lost_tooth_and_a_new_label() {
    let mut new = parsed(BY_HAND);
    new.name = "Mrs Deeper".into();
    new.missing = vec![46, 38, 31];
    new.teeth.pop();
    let mut molar = ToothChart::healthy(37);
    molar.furcation = Furcations {
        buccal: 2,
        lingual: 0,
    };
    molar.depth_mm.lingual = [3.0, 7.0, 3.0];
    new.teeth.push(molar);
    let text = edited(BY_HAND, &new).expect("a form that can be edited");
    for kept in [
        "# Case of the second year.",
        "name = \"Mrs Deeper\"  # a label",
        "# The molar of the exercise.",
        "# a pocket",
    ] {
        assert!(text.contains(kept), "{kept}: {text}");
    }
    assert!(is_same(&parsed(&text), &new), "{text}");
    assert!(!text.contains("fdi = 31"), "{text}");
}

#[test]
fn a_list_of_inline_tables_is_edited_too() {
    let text = "name = \"a\"\ntooth = [{ fdi = 36, mobility = 1 }]\n";
    let mut new = parsed(text);
    new.teeth[0].mobility = 2;
    new.teeth[0].furcation.buccal = 1;
    let mut other = ToothChart::healthy(35);
    other.bleeding.buccal = [true; 3];
    new.teeth.push(other);
    let text = edited(text, &new).expect("a form that can be edited");
    assert!(is_same(&parsed(&text), &new), "{text}");
}

#[test]
fn a_new_file_has_the_label_and_all_that_is_not_healthy() {
    let mut patient = generate(7, Condition::Periodontitis);
    patient.missing = vec![46];
    patient.teeth.retain(|tooth| tooth.fdi != 46);
    let text = written(&patient).expect("a file");
    assert!(is_same(&parsed(&text), &patient), "{text}");
    assert!(text.contains("depth_mm.buccal = ["), "{text}");
}

fn teeth() -> impl Strategy<Value = Vec<ToothChart>> {
    let tooth = (
        0..LOWER.len(),
        prop::array::uniform6(0_u8..40),
        prop::array::uniform6(any::<bool>()),
        0_u8..4,
        0_u8..4,
    );
    prop::collection::vec(tooth, 0..14).prop_map(|all| {
        let mut teeth: Vec<ToothChart> = Vec::new();
        for (k, depths, bleeding, furcation, mobility) in all {
            let mut tooth = ToothChart::healthy(LOWER[k]);
            tooth.depth_mm = Sides::from_round(depths.map(|depth| f64::from(depth) * 0.25));
            tooth.recession_mm = Sides::from_round(depths.map(|depth| f64::from(depth) - 4.0));
            tooth.bleeding = Sides::from_round(bleeding);
            tooth.furcation.lingual = furcation;
            tooth.mobility = mobility;
            if teeth.iter().all(|other| other.fdi != tooth.fdi) {
                teeth.push(tooth);
            }
        }
        teeth
    })
}

proptest! {
    /// Any patient can be written over any other, and both ways lead to the same patient.
    #[test]
    fn an_edit_gives_the_new_patient_whatever_the_old_one_was(
        before in teeth(), after in teeth(), name in "[^\\x00]{1,12}",
    ) {
        let patient = |teeth: Vec<ToothChart>| Patient { name: name.clone(), missing: vec![38], teeth };
        let (before, after) = (patient(before), patient(after));
        for text in [before.to_toml(), written(&before).expect("a file")] {
            let text = edited(&text, &after).expect("own forms can be edited");
            prop_assert!(is_same(&parsed(&text), &after), "{text}");
        }
    }

    /// No text makes the editor panic, and no edit loses a value silently.
    #[test]
    fn any_text_is_edited_right_or_not_at_all(text in "([a-z_]{1,9} ?= ?(1|\\[1\\]|\\{a=1\\}|\"x\")\n|\\[\\[tooth\\]\\]\n|fdi=36\n|name=\"n\"\n|.){0,12}") {
        let new = generate(3, Condition::Gingivitis);
        if let Some(text) = edited(&text, &new) {
            prop_assert!(is_same(&parsed(&text), &new), "{text}");
        }
    }
}
