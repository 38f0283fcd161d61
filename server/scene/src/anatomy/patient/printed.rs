//! Chart of a patient as text for people.

use super::chart::{Patient, ToothChart};
use super::sides::Sides;
use crate::file::LOWER;

/// Returns the chart as text, a line for each tooth. Sides read mesio-, mid-, disto-.
pub fn as_text(patient: &Patient) -> String {
    let mut text = format!(
        "{}\ntooth  depth, mm        margin below the CEJ, mm      bleeding     inflammation  furcation\n       buccal  lingual  buccal         lingual        bucc. ling.                buccal lingual\n",
        patient.name
    );
    for fdi in LOWER {
        text += &match patient.tooth(fdi) {
            Some(tooth) => line(&tooth),
            None => format!("{fdi}     missing\n"),
        };
    }
    text
}

fn line(tooth: &ToothChart) -> String {
    let numbers = |sides: &Sides<f64>, width: usize| {
        [sides.buccal, sides.lingual].map(|side| {
            let all = side.map(|mm| format!("{mm:>width$}"));
            all.join(" ")
        })
    };
    let [depth, depth_inside] = numbers(&tooth.depth_mm, 1);
    let [margin, margin_inside] = numbers(&tooth.recession_mm, 4);
    let [bleeds, bleeds_inside] = [tooth.bleeding.buccal, tooth.bleeding.lingual]
        .map(|side| side.map(|bleeds| if bleeds { '*' } else { '.' }))
        .map(|side| side.iter().collect::<String>());
    format!(
        "{}     {depth:7} {depth_inside:8} {margin:14} {margin_inside:14} {bleeds:5} {bleeds_inside:5} {:12}  {:6} {}\n",
        tooth.fdi, tooth.inflammation, tooth.furcation.buccal, tooth.furcation.lingual
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chart_has_a_line_for_each_tooth() {
        let mut patient = Patient::healthy("one");
        patient.missing.push(46);
        let text = as_text(&patient);
        assert_eq!(text.lines().count(), 3 + LOWER.len());
        let healthy = "36     3 2 3   3 2 3    -2.5   -2 -2.5";
        assert!(text.contains(healthy), "{text}");
        assert!(text.contains("46     missing"), "{text}");
    }
}
