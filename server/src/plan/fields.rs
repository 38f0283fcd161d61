//! Text forms and ranges of the values of a plan. A value out of range is refused while it is read, so that the message
//! has its line.

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// Whether the time limit of a session includes gaps without the student.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum ClockInGap {
    /// The clock runs: a gap costs time.
    #[default]
    Runs,
    /// The clock stops: a gap costs no time.
    Stops,
}

/// Seed of a generated patient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PatientSeed {
    /// 64 random bits of the system, new for each session; `system` in files.
    System,
    /// The given number.
    Number(u64),
}

impl fmt::Display for PatientSeed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::System => f.write_str("system"),
            Self::Number(seed) => write!(f, "{seed}"),
        }
    }
}

impl std::str::FromStr for PatientSeed {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "system" {
            return Ok(Self::System);
        }
        // `from_str` of a number also takes a sign.
        let digits = text.bytes().all(|c| c.is_ascii_digit());
        match text.parse() {
            Ok(seed) if digits => Ok(Self::Number(seed)),
            _ => Err(format!(
                "patient_seed is `{}`, expected `system` or a whole number from 0 to 2^64 - 1",
                text.escape_debug()
            )),
        }
    }
}

impl Serialize for PatientSeed {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            // TOML has no larger numbers.
            Self::Number(seed) if i64::try_from(*seed).is_ok() => to.serialize_u64(*seed),
            other => to.collect_str(other),
        }
    }
}

impl<'de> Deserialize<'de> for PatientSeed {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Seed;
        impl Visitor<'_> for Seed {
            type Value = PatientSeed;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("`system` or a whole number from 0 to 2^64 - 1")
            }

            fn visit_u64<E: Error>(self, seed: u64) -> Result<PatientSeed, E> {
                Ok(PatientSeed::Number(seed))
            }

            fn visit_i64<E: Error>(self, seed: i64) -> Result<PatientSeed, E> {
                // The sign makes the message of `from_str`.
                seed.to_string().parse().map_err(E::custom)
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<PatientSeed, E> {
                text.parse().map_err(E::custom)
            }
        }
        from.deserialize_any(Seed)
    }
}

/// Mode by its name.
pub(super) mod mode {
    use super::*;
    use sulcus_sessions::Mode;

    pub fn serialize<S: Serializer>(mode: &Mode, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(mode.name())
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Mode>, D::Error> {
        let name = String::deserialize(from)?;
        Mode::from_name(&name).map(Some).ok_or_else(|| {
            D::Error::custom(format!(
                "mode is `{}`, expected practice, self-assessment or exam",
                name.escape_debug()
            ))
        })
    }

    /// Mode of a change, for its own serialisation.
    pub fn serialize_some<S: Serializer>(mode: &Option<Mode>, to: S) -> Result<S::Ok, S::Error> {
        match mode {
            Some(mode) => serialize(mode, to),
            None => to.serialize_none(),
        }
    }
}

/// Policy about the channels for viewers, by its name.
pub(super) fn viewers<'de, D: Deserializer<'de>>(
    from: D,
) -> Result<Option<sulcus_sessions::ViewersPolicy>, D::Error> {
    let name = String::deserialize(from)?;
    let found = sulcus_sessions::ViewersPolicy::from_name(&name);
    found.map(Some).ok_or_else(|| {
        D::Error::custom(format!(
            "viewers is `{}`, expected recorded or on-demand",
            name.escape_debug()
        ))
    })
}

/// Opaque learner id.
pub(super) fn learner<'de, D: Deserializer<'de>>(from: D) -> Result<Option<String>, D::Error> {
    let id = String::deserialize(from)?;
    match sulcus_proto::learner::parse(&id) {
        Ok(id) => Ok(Some(id)),
        Err(expected) => Err(D::Error::custom(format!(
            "learner is `{}`, {expected}",
            id.escape_debug()
        ))),
    }
}

/// Text of a name or path: 1 to 512 bytes, no control characters.
pub(super) fn plain(field: &'static str, text: &str) -> Result<(), String> {
    if text.is_empty() || text.len() > 512 || text.contains(char::is_control) {
        return Err(format!(
            "{field} is `{}`, expected 1 to 512 bytes without control characters",
            text.escape_debug()
        ));
    }
    Ok(())
}

/// Path of a file.
fn path<'de, D: Deserializer<'de>>(
    field: &'static str,
    from: D,
) -> Result<Option<std::path::PathBuf>, D::Error> {
    let text = String::deserialize(from)?;
    plain(field, &text).map_err(D::Error::custom)?;
    Ok(Some(text.into()))
}

pub(super) fn scene<'de, D: Deserializer<'de>>(
    from: D,
) -> Result<Option<std::path::PathBuf>, D::Error> {
    path("scene", from)
}

pub(super) fn rubric<'de, D: Deserializer<'de>>(
    from: D,
) -> Result<Option<std::path::PathBuf>, D::Error> {
    path("rubric", from)
}

pub(super) fn exercise<'de, D: Deserializer<'de>>(from: D) -> Result<Option<String>, D::Error> {
    let text = String::deserialize(from)?;
    plain("exercise", &text).map_err(D::Error::custom)?;
    Ok(Some(text))
}

/// Ranges of the whole numbers of a plan: name, least, most, unit.
pub(super) const RANGES: [(&str, i64, i64, &str); 4] = [
    ("rate_hz", 250, 8000, "Hz"),
    ("time_limit_s", 1, 86_400, "s"),
    ("resume_within_s", 0, 3600, "s"),
    ("detail_budget_us", 10, 900, "us"),
];

/// Checks a whole number against its range.
///
/// # Errors
/// Field, value found and range.
pub(super) fn in_range(field: &str, found: i64) -> Result<(), String> {
    match RANGES.iter().find(|range| range.0 == field) {
        Some((_, least, most, unit)) if !(*least..=*most).contains(&found) => Err(format!(
            "{field} is {found}, expected {least} to {most} {unit}"
        )),
        _ => Ok(()),
    }
}

macro_rules! whole {
    ($($name:ident: $type:ty,)*) => {$(
        pub(super) fn $name<'de, D: Deserializer<'de>>(from: D) -> Result<Option<$type>, D::Error> {
            let found = i64::deserialize(from)?;
            in_range(stringify!($name), found).map_err(D::Error::custom)?;
            Ok(<$type>::try_from(found).ok())
        }
    )*};
}

whole! {
    rate_hz: u16,
    time_limit_s: u32,
    resume_within_s: u32,
    detail_budget_us: u32,
}

/// Checks a force limit.
///
/// # Errors
/// Field, value found and range.
pub(super) fn is_force(newtons: f64) -> Result<f32, String> {
    let force = newtons as f32;
    if force.is_finite() && force > 0.0 {
        Ok(force)
    } else {
        Err(format!(
            "force_limit_n is {newtons}, expected a force above 0 N"
        ))
    }
}

pub(super) fn force_limit_n<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f32>, D::Error> {
    let newtons = f64::deserialize(from)?;
    is_force(newtons).map(Some).map_err(D::Error::custom)
}
