//! Patient text of a recording: missing teeth and furcations, for the chart and the grade.
//!
//! The text comes from others. An entry of another form is left out.

use toml::{Table, Value};

/// Missing teeth and furcations of a patient.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PatientChart {
    /// FDI numbers of missing teeth.
    pub missing: Vec<u8>,
    /// Tooth, whether the side is buccal, and grade after Hamp 1975, 1 to 3.
    furcations: Vec<(u8, bool, u8)>,
}

impl PatientChart {
    /// Chart from the text of a patient. None for an empty text.
    pub fn of(text: &str) -> Option<Self> {
        (!text.trim().is_empty()).then(|| Self::read(text))
    }

    /// Chart from the text of a patient.
    pub fn read(text: &str) -> Self {
        let table: Table = toml::from_str(text).unwrap_or_default();
        let small = |value: &Value| value.as_integer().and_then(|x| u8::try_from(x).ok());
        let list = |key: &str| table.get(key).and_then(Value::as_array);
        let missing = list("missing").into_iter().flatten().filter_map(small);
        let mut furcations = Vec::new();
        for tooth in list("tooth").into_iter().flatten() {
            let Some(fdi) = tooth.get("fdi").and_then(small) else {
                continue;
            };
            for (side, buccal) in [("buccal", true), ("lingual", false)] {
                let grade = tooth.get("furcation").and_then(|all| all.get(side));
                let grade = grade
                    .and_then(small)
                    .filter(|grade| (1..=3).contains(grade));
                furcations.extend(grade.map(|grade| (fdi, buccal, grade)));
            }
        }
        Self {
            missing: missing.collect(),
            furcations,
        }
    }

    /// Grade of a furcation, 0 to 3; 0 without a furcation.
    pub fn furcation(&self, fdi: u8, buccal: bool) -> u8 {
        let found = self
            .furcations
            .iter()
            .find(|one| (one.0, one.1) == (fdi, buccal));
        found.map_or(0, |one| one.2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_teeth_and_furcations_are_found_and_nonsense_is_nothing() {
        let text = "name = \"p\"\nmissing = [46, 999, \"x\"]\n[[tooth]]\nfdi = 36\nfurcation.buccal = 2\nfurcation.lingual = 9\n[[tooth]]\nfdi = 37\n";
        let chart = PatientChart::read(text);
        assert_eq!(chart.missing, [46]);
        assert_eq!(chart.furcation(36, true), 2);
        assert_eq!(
            (chart.furcation(36, false), chart.furcation(37, true)),
            (0, 0)
        );
        for text in ["", "missing = 3", "tooth = [1, 2]", "{{{"] {
            assert_eq!(PatientChart::read(text), PatientChart::default());
        }
    }
}
