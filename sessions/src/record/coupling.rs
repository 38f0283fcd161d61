//! Couplings of a session as a value of the header.
//!
//! The value is JSON: `[{"n_per_m":"500","nm_per_rad":"0.5"}]`, in the order of the tools. The numbers are decimals in
//! text. A replay needs every bit, and the fast parser of JSON numbers may be off by the last one.

use serde::{Deserialize, Serialize};
use sulcus_core::{Coupling, MAX_TOOLS};

/// Coupling with its numbers as text.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    n_per_m: String,
    nm_per_rad: String,
}

/// Text of the couplings; `None` without couplings.
pub(crate) fn written(couplings: &[Coupling]) -> Option<String> {
    let of = |coupling: &Coupling| Written {
        n_per_m: coupling.n_per_m.to_string(),
        nm_per_rad: coupling.nm_per_rad.to_string(),
    };
    let all: Vec<Written> = couplings.iter().map(of).collect();
    // Texts always serialise.
    (!all.is_empty())
        .then(|| serde_json::to_string(&all).ok())
        .flatten()
}

/// Couplings of a text; `None` for a text that is none.
pub(crate) fn read(text: &str) -> Option<Vec<Coupling>> {
    let all: Vec<Written> = serde_json::from_str(text).ok()?;
    let of = |written: Written| {
        Some(Coupling {
            n_per_m: written.n_per_m.parse().ok()?,
            nm_per_rad: written.nm_per_rad.parse().ok()?,
        })
    };
    all.into_iter().map(of).collect()
}

/// Checks number and ranges of the couplings in a header.
pub(crate) fn check(couplings: &[Coupling]) -> Result<(), String> {
    if couplings.len() > MAX_TOOLS {
        let found = couplings.len();
        return Err(format!(
            "number of couplings is {found}, expected at most {MAX_TOOLS}"
        ));
    }
    for (tool, coupling) in couplings.iter().enumerate() {
        let part = format!("coupling of tool {tool}");
        coupling
            .validate(&part)
            .map_err(|error| error.to_string())?;
    }
    Ok(())
}

/// Coupling of the tool in slot `tool`, for people.
pub(crate) fn words(tool: usize, coupling: &Coupling) -> String {
    format!(
        "tool {tool}: {} N/m and {} N m/rad in force instead of the scene's",
        coupling.n_per_m, coupling.nm_per_rad
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_bit_survives(numbers in prop::collection::vec((1.0f64..1e5, 1e-4f64..1e3), 1..3)) {
            let of = |(n_per_m, nm_per_rad)| Coupling { n_per_m, nm_per_rad };
            let all: Vec<Coupling> = numbers.into_iter().map(of).collect();
            prop_assert_eq!(check(&all), Ok(()));
            let text = written(&all).expect("a text");
            prop_assert_eq!(read(&text), Some(all));
        }
    }

    #[test]
    fn another_text_is_none_and_a_wrong_number_is_named() {
        assert_eq!(written(&[]), None);
        for bad in [
            "7",
            r#"[{"n_per_m":500,"nm_per_rad":"0.5"}]"#,
            r#"[{"n_per_m":"x","nm_per_rad":"0.5"}]"#,
            r#"[{"n_per_m":"500"}]"#,
        ] {
            assert_eq!(read(bad), None, "{bad}");
        }
        let coupling = |n_per_m| Coupling {
            n_per_m,
            nm_per_rad: 0.5,
        };
        let said = check(&[coupling(500.0), coupling(f64::NAN)]).expect_err("refused");
        assert_eq!(
            said,
            "coupling of tool 1: stiffness_n_per_m is NaN, expected 1 to 1e5 N/m"
        );
        assert!(check(&[coupling(500.0); 3]).is_err());
    }
}
