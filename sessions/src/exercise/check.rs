//! Valid values of an exercise.

use super::{Exercise, Kind};
use crate::record::written::{Written, WrittenError};

/// Largest number of entries of the tour.
const MOST_ZONES: usize = 64;

impl Exercise {
    /// Checks every value.
    ///
    /// # Errors
    /// A field is out of range: the first such field, the value found and the values expected.
    pub fn validate(&self) -> Result<(), WrittenError> {
        Self::check_name(&self.name)?;
        for (field, text, most) in [
            ("about", &self.about, 1024),
            ("task", &self.task, 16 * 1024),
            ("scene", &self.scene, 256),
        ] {
            if text.len() > most {
                return wrong(
                    field,
                    format!("{} bytes long", text.len()),
                    format!("at most {most} bytes"),
                );
            }
        }
        within("duration_s", self.duration_s, 0.1, 86_400.0, "s")?;
        if self.zones.len() > MOST_ZONES {
            return wrong(
                "zone",
                format!("{} entries", self.zones.len()),
                format!("at most {MOST_ZONES}"),
            );
        }
        for (k, zones) in self.zones.iter().enumerate() {
            fdi(&format!("zone[{k}].tooth"), zones.tooth)?;
            if zones.sites.is_empty() || zones.sites.len() > 6 {
                let found = format!("{} sites", zones.sites.len());
                return wrong(&format!("zone[{k}].sites"), found, "1 to 6 sites");
            }
        }
        if self.zones.is_empty() && matches!(self.kind, Kind::Probing | Kind::Bimanual) {
            return wrong(
                "zone",
                "missing",
                "at least one tooth with its sites, for this kind",
            );
        }
        let probing = &self.probing;
        band("probing.force_n", probing.force_n, 0.01, 5.0, "N")?;
        band(
            "probing.proximal_tilt_deg",
            probing.proximal_tilt_deg,
            0.0,
            60.0,
            "deg",
        )?;
        within(
            "probing.mid_tilt_deg",
            probing.mid_tilt_deg,
            1.0,
            60.0,
            "deg",
        )?;
        within("probing.step_mm", probing.step_mm, 0.1, 5.0, "mm")?;
        match &self.target {
            None if self.kind == Kind::Bimanual => wrong(
                "target",
                "missing",
                "a tooth, an eye and a share, for this kind",
            ),
            None => Ok(()),
            Some(target) => {
                fdi("target.tooth", target.tooth)?;
                for x in target.eye_mm {
                    within("target.eye_mm", x, -1000.0, 1000.0, "mm")?;
                }
                within("target.visible", target.visible, 0.05, 1.0, "")
            }
        }
    }
}

impl Written for Exercise {
    const WHAT: &'static str = "exercise";

    fn check(&self) -> Result<(), WrittenError> {
        self.validate()
    }
}

fn wrong(
    field: &str,
    found: impl Into<String>,
    expected: impl Into<String>,
) -> Result<(), WrittenError> {
    Exercise::wrong(field, found, expected)
}

/// Checks a number against a range. NaN is in no range.
fn within(field: &str, x: f64, low: f64, high: f64, unit: &str) -> Result<(), WrittenError> {
    if (low..=high).contains(&x) {
        return Ok(());
    }
    let unit = if unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    };
    wrong(
        field,
        format!("{x}{unit}"),
        format!("{low} to {high}{unit}"),
    )
}

fn band(
    field: &str,
    [from, to]: [f64; 2],
    low: f64,
    high: f64,
    unit: &str,
) -> Result<(), WrittenError> {
    within(field, from, low, high, unit)?;
    within(field, to, low, high, unit)?;
    if from < to {
        Ok(())
    } else {
        wrong(
            field,
            format!("[{from}, {to}]"),
            "the lower bound before the upper",
        )
    }
}

/// Checks the FDI number of a permanent tooth: quadrant 1 to 4, then 1 to 8.
fn fdi(field: &str, tooth: u8) -> Result<(), WrittenError> {
    if (1..=4).contains(&(tooth / 10)) && (1..=8).contains(&(tooth % 10)) {
        return Ok(());
    }
    wrong(field, tooth.to_string(), "an FDI number, 11 to 48")
}
