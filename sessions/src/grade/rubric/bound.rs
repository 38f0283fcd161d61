//! Bounds of a metric's scale: a number, or a band with a lower and an upper number.

use std::fmt;

use serde::Serialize;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};

/// Bound of a metric's scale: the value of a full score, or of no score.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Bound {
    /// Number. The other bound tells which side is better.
    One(f64),
    /// Lower and upper number of a band. Values on both sides of the band lose points.
    Band([f64; 2]),
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::One(x) => write!(f, "{x}"),
            Self::Band([a, b]) => write!(f, "{a} to {b}"),
        }
    }
}

/// Deserialisation by hand: an untagged enum would not report the length of a wrong list.
impl<'de> Deserialize<'de> for Bound {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Written)
    }
}

struct Written;

impl<'de> Visitor<'de> for Written {
    type Value = Bound;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, or a list of two numbers")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Bound, E> {
        Ok(Bound::One(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Bound, E> {
        Ok(Bound::One(value as f64))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Bound, E> {
        Ok(Bound::One(value as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Bound, A::Error> {
        let band = Deserialize::deserialize(SeqAccessDeserializer::new(list))?;
        Ok(Bound::Band(band))
    }
}
