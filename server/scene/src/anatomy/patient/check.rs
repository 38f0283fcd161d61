//! Ranges of the values of a patient file.

use sulcus_core::tissue::gingiva::Site;

use super::chart::{Patient, THIRD_MOLARS, ToothChart};
use crate::file::LOWER;
use crate::hand_written::{Checked, wrong};

/// Deepest pocket, mm. The model's roots are long enough for it.
const DEEPEST: f64 = 10.0;
/// Largest attachment loss, mm. The jaw begins below it.
const MOST_LOSS: f64 = 9.0;

/// Returns whether an FDI number is that of an upper tooth, permanent or deciduous.
fn is_upper(fdi: u8) -> bool {
    matches!(fdi / 10, 1 | 2) && (1..=8).contains(&(fdi % 10))
        || matches!(fdi / 10, 5 | 6) && (1..=5).contains(&(fdi % 10))
}

/// Value expected instead of an upper tooth.
const LOWER_ONLY: &str = "teeth of the lower jaw";

pub(super) fn patient(patient: &Patient) -> Checked {
    if patient.name.trim().is_empty() {
        return wrong("`name`".into(), "empty", "a name");
    }
    let is_known = |fdi: &u8| LOWER.contains(fdi) || THIRD_MOLARS.contains(fdi);
    let upper = |fdi: &&u8| is_upper(**fdi) && !is_known(fdi);
    let upper: Vec<String> = patient
        .missing
        .iter()
        .filter(upper)
        .map(u8::to_string)
        .collect();
    if let [teeth @ .., last] = upper.as_slice() {
        let teeth = match teeth {
            [] => last.clone(),
            teeth => format!("{} and {last}", teeth.join(", ")),
        };
        let found = format!("{teeth} of the upper jaw");
        return wrong("`missing`".into(), found, LOWER_ONLY);
    }
    for (k, fdi) in patient.missing.iter().enumerate() {
        if !is_known(fdi) {
            let expected = "31 to 37 or 41 to 47, or a third molar (18, 28, 38, 48)";
            return wrong("`missing`".into(), fdi, expected);
        }
        if patient.missing[..k].contains(fdi) {
            return wrong("`missing`".into(), format!("{fdi} twice"), "each once");
        }
    }
    for (k, tooth) in patient.teeth.iter().enumerate() {
        let fdi = tooth.fdi;
        if is_upper(fdi) {
            let found = format!("{fdi}, of the upper jaw");
            return wrong("`fdi` of a [[tooth]]".into(), found, LOWER_ONLY);
        }
        if !LOWER.contains(&fdi) {
            let expected = "31 to 37 or 41 to 47: the model has no third molars";
            return wrong("`fdi` of a [[tooth]]".into(), fdi, expected);
        }
        if patient.teeth[..k].iter().any(|earlier| earlier.fdi == fdi) {
            return wrong(
                "`fdi` of a [[tooth]]".into(),
                format!("{fdi} twice"),
                "each once",
            );
        }
        if patient.missing.contains(&fdi) {
            let found = "both in `missing` and charted";
            return wrong(format!("tooth {fdi}"), found, "one of the two");
        }
        self::tooth(tooth)?;
    }
    Ok(())
}

fn tooth(tooth: &ToothChart) -> Checked {
    let fdi = tooth.fdi;
    let field = |key: &str, site: Site| format!("`{key}` of tooth {fdi}, {}", site.name());
    for site in Site::ALL {
        let (depth, recession) = (tooth.depth_mm.of(site), tooth.recession_mm.of(site));
        // The comparison fails for a NaN.
        if !(0.5..=DEEPEST).contains(&depth) {
            return wrong(field("depth_mm", site), depth, "0.5 to 10 mm");
        }
        if !(-4.0..=8.5).contains(&recession) {
            let expected = "-4 to 8.5 mm (negative: above the CEJ)";
            return wrong(field("recession_mm", site), recession, expected);
        }
        if depth + recession > MOST_LOSS {
            return wrong(
                format!(
                    "`depth_mm` plus `recession_mm` of tooth {fdi}, {}",
                    site.name()
                ),
                format!("{} mm", depth + recession),
                "an attachment loss of at most 9 mm",
            );
        }
    }
    if !(0.0..=1.0).contains(&tooth.inflammation) {
        return wrong(
            format!("`inflammation` of tooth {fdi}"),
            tooth.inflammation,
            "0 to 1",
        );
    }
    let worst = tooth.furcation.buccal.max(tooth.furcation.lingual);
    if worst > 3 {
        return wrong(
            format!("`furcation` of tooth {fdi}"),
            worst,
            "0 to 3 (Hamp)",
        );
    }
    if worst > 0 && fdi % 10 < 6 {
        return wrong(
            format!("`furcation` of tooth {fdi}"),
            worst,
            "0: only molars have roots that divide",
        );
    }
    if (tooth.furcation.buccal == 3) != (tooth.furcation.lingual == 3) {
        return wrong(
            format!("`furcation` of tooth {fdi}"),
            "3 on one side only",
            "3 on both sides or on neither: at degree 3 a probe goes through",
        );
    }
    if tooth.mobility > 3 {
        return wrong(
            format!("`mobility` of tooth {fdi}"),
            tooth.mobility,
            "0 to 3 (Miller)",
        );
    }
    Ok(())
}
