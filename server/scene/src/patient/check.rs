//! The ranges of a patient file's values.

use sulcus_core::tissue::gingiva::Site;

use super::{LOWER, Patient, ToothChart};
use crate::validate::{Checked, wrong};

/// Deepest pocket, mm: as deep as the model's roots are laid out for.
const DEEPEST: f64 = 10.0;
/// Most attachment loss, mm: below it begins the jaw.
const MOST_LOSS: f64 = 9.0;

pub(super) fn patient(patient: &Patient) -> Checked {
    if patient.name.trim().is_empty() {
        return wrong("`name`".into(), "empty", "a name");
    }
    for (k, fdi) in patient.missing.iter().enumerate() {
        if !LOWER.contains(fdi) {
            return wrong("`missing`".into(), fdi, "31 to 37 or 41 to 47");
        }
        if patient.missing[..k].contains(fdi) {
            return wrong("`missing`".into(), format!("{fdi} twice"), "each once");
        }
    }
    for (k, tooth) in patient.teeth.iter().enumerate() {
        let fdi = tooth.fdi;
        if !LOWER.contains(&fdi) {
            let expected = "31 to 37 or 41 to 47 (a lower tooth without wisdom teeth)";
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
        // Written so that a NaN fails.
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
