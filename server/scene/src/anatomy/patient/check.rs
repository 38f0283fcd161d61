//! Ranges of the values of a patient file.

use std::fmt;

use sulcus_core::tissue::gingiva::Site;

use super::chart::{Patient, THIRD_MOLARS, ToothChart};
use crate::file::LOWER;
use crate::hand_written::{Checked, Wrong};

/// Least and largest probing depth, mm. The model's roots are long enough for it.
pub const DEPTH_MM: [f64; 2] = [0.5, 10.0];
/// Highest and lowest margin below the cemento-enamel junction, mm; negative above it.
pub const RECESSION_MM: [f64; 2] = [-4.0, 8.5];
/// Largest attachment loss, mm. The jaw begins below it.
pub const MOST_LOSS_MM: f64 = 9.0;

/// Value of a patient that is refused, with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct PatientFault {
    /// FDI number of the tooth; `None` for a value of the whole patient.
    pub fdi: Option<u8>,
    /// Site; `None` for a value of a whole tooth or patient.
    pub site: Option<Site>,
    /// Key in the file: `depth_mm`, or `loss` for the sum of depth and recession.
    pub key: &'static str,
    /// Key, tooth and site as text.
    pub field: String,
    /// Value found.
    pub found: String,
    /// Value expected.
    pub expected: String,
}

impl fmt::Display for PatientFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (field, found, expected) = (&self.field, &self.found, &self.expected);
        write!(f, "{field} is {found}, expected {expected}")
    }
}

/// Faults of a patient in the order of the file.
#[derive(Default)]
struct Faults(Vec<(PatientFault, &'static str)>);

impl Faults {
    fn add(
        &mut self,
        (fdi, site, key): (Option<u8>, Option<Site>, &'static str),
        field: String,
        found: impl ToString,
        expected: &'static str,
    ) {
        let fault = PatientFault {
            fdi,
            site,
            key,
            field,
            found: found.to_string(),
            expected: expected.to_owned(),
        };
        self.0.push((fault, expected));
    }
}

/// Returns whether an FDI number is that of an upper tooth, permanent or deciduous.
fn is_upper(fdi: u8) -> bool {
    matches!(fdi / 10, 1 | 2) && (1..=8).contains(&(fdi % 10))
        || matches!(fdi / 10, 5 | 6) && (1..=5).contains(&(fdi % 10))
}

/// Value expected instead of an upper tooth.
const LOWER_ONLY: &str = "teeth of the lower jaw";

/// Refuses a patient with its first fault.
pub(super) fn patient(patient: &Patient) -> Checked {
    match all(patient).0.into_iter().next() {
        None => Ok(()),
        Some((fault, expected)) => Err(Wrong {
            field: fault.field,
            found: fault.found,
            expected,
        }),
    }
}

/// Returns all values out of range.
pub(super) fn faults(patient: &Patient) -> Vec<PatientFault> {
    let found = all(patient).0.into_iter();
    found.map(|(fault, _)| fault).collect()
}

fn all(patient: &Patient) -> Faults {
    let mut faults = Faults::default();
    if patient.name.trim().is_empty() {
        faults.add((None, None, "name"), "`name`".into(), "empty", "a name");
    }
    missing(patient, &mut faults);
    for (k, tooth) in patient.teeth.iter().enumerate() {
        let fdi = tooth.fdi;
        let mut at = |found: String, expected| {
            let place = (Some(fdi), None, "fdi");
            faults.add(place, "`fdi` of a [[tooth]]".into(), found, expected);
        };
        if is_upper(fdi) {
            at(format!("{fdi}, of the upper jaw"), LOWER_ONLY);
            continue;
        }
        if !LOWER.contains(&fdi) {
            let expected = "31 to 37 or 41 to 47: the model has no third molars";
            at(fdi.to_string(), expected);
            continue;
        }
        if patient.teeth[..k].iter().any(|earlier| earlier.fdi == fdi) {
            at(format!("{fdi} twice"), "each once");
            continue;
        }
        if patient.missing.contains(&fdi) {
            let found = "both in `missing` and charted";
            let place = (Some(fdi), None, "missing");
            faults.add(place, format!("tooth {fdi}"), found, "one of the two");
        }
        self::tooth(tooth, &mut faults);
    }
    faults
}

fn missing(patient: &Patient, faults: &mut Faults) {
    let is_known = |fdi: &u8| LOWER.contains(fdi) || THIRD_MOLARS.contains(fdi);
    let upper = |fdi: &&u8| is_upper(**fdi) && !is_known(fdi);
    let upper: Vec<String> = patient
        .missing
        .iter()
        .filter(upper)
        .map(u8::to_string)
        .collect();
    let place = (None, None, "missing");
    if let [teeth @ .., last] = upper.as_slice() {
        let teeth = match teeth {
            [] => last.clone(),
            teeth => format!("{} and {last}", teeth.join(", ")),
        };
        let found = format!("{teeth} of the upper jaw");
        faults.add(place, "`missing`".into(), found, LOWER_ONLY);
        return;
    }
    for (k, fdi) in patient.missing.iter().enumerate() {
        if !is_known(fdi) {
            let expected = "31 to 37 or 41 to 47, or a third molar (18, 28, 38, 48)";
            faults.add(place, "`missing`".into(), fdi, expected);
        } else if patient.missing[..k].contains(fdi) {
            let found = format!("{fdi} twice");
            faults.add(place, "`missing`".into(), found, "each once");
        }
    }
}

fn tooth(tooth: &ToothChart, faults: &mut Faults) {
    let fdi = tooth.fdi;
    for site in Site::ALL {
        let field = |key: &str| format!("{key} of tooth {fdi}, {}", site.name());
        let place = |key| (Some(fdi), Some(site), key);
        let (depth, recession) = (tooth.depth_mm.of(site), tooth.recession_mm.of(site));
        let [least, most] = DEPTH_MM;
        let [highest, lowest] = RECESSION_MM;
        // The comparisons fail for a NaN.
        if !(least..=most).contains(&depth) {
            faults.add(
                place("depth_mm"),
                field("`depth_mm`"),
                depth,
                "0.5 to 10 mm",
            );
        } else if !(highest..=lowest).contains(&recession) {
            let expected = "-4 to 8.5 mm (negative: above the CEJ)";
            faults.add(
                place("recession_mm"),
                field("`recession_mm`"),
                recession,
                expected,
            );
        } else if depth + recession > MOST_LOSS_MM {
            faults.add(
                place("loss"),
                field("`depth_mm` plus `recession_mm`"),
                format!("{} mm", depth + recession),
                "an attachment loss of at most 9 mm",
            );
        }
    }
    let mut add = |key: &'static str, found: String, expected| {
        let field = format!("`{key}` of tooth {fdi}");
        faults.add((Some(fdi), None, key), field, found, expected);
    };
    if !(0.0..=1.0).contains(&tooth.inflammation) {
        add("inflammation", tooth.inflammation.to_string(), "0 to 1");
    }
    let (buccal, lingual) = (tooth.furcation.buccal, tooth.furcation.lingual);
    let worst = buccal.max(lingual);
    if worst > 3 {
        add("furcation", worst.to_string(), "0 to 3 (Hamp)");
    } else if worst > 0 && fdi % 10 < 6 {
        let expected = "0: only molars have roots that divide";
        add("furcation", worst.to_string(), expected);
    } else if (buccal == 3) != (lingual == 3) {
        let expected = "3 on both sides or on neither: at degree 3 a probe goes through";
        add("furcation", "3 on one side only".into(), expected);
    }
    if tooth.mobility > 3 {
        add("mobility", tooth.mobility.to_string(), "0 to 3 (Miller)");
    }
}
