//! Values of JSON that may have another type than expected, or be absent.
//!
//! A value of another type reads as nothing. Only a text that is no JSON is an error.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{
    Deserialize, DeserializeOwned, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor,
};

/// Value, if it is of the wanted type.
#[derive(Debug)]
pub(super) struct Loose<T>(pub(super) Option<T>);

impl<T> Default for Loose<T> {
    fn default() -> Self {
        Self(None)
    }
}

/// Type that a value of JSON may have.
pub(super) trait Wanted: Sized {
    /// Value of a number.
    fn number(_: f64) -> Option<Self> {
        None
    }
    /// Value of a boolean.
    fn flag(_: bool) -> Option<Self> {
        None
    }
    /// Value of a text.
    fn text(_: &str) -> Option<Self> {
        None
    }
    /// Value of an object.
    fn object<'de, A: MapAccess<'de>>(map: A) -> Result<Option<Self>, A::Error> {
        ignore_map(map)
    }
    /// Value of an array.
    fn array<'de, A: SeqAccess<'de>>(seq: A) -> Result<Option<Self>, A::Error> {
        ignore_seq(seq)
    }
}

impl Wanted for f64 {
    fn number(value: f64) -> Option<Self> {
        value.is_finite().then_some(value)
    }
}

impl Wanted for bool {
    fn flag(value: bool) -> Option<Self> {
        Some(value)
    }
}

impl Wanted for String {
    fn text(value: &str) -> Option<Self> {
        Some(value.into())
    }
}

/// Object with named fields.
#[derive(Debug)]
pub(super) struct Fields<T>(pub(super) T);

impl<T: DeserializeOwned> Wanted for Fields<T> {
    fn object<'de, A: MapAccess<'de>>(map: A) -> Result<Option<Self>, A::Error> {
        let fields = T::deserialize(serde::de::value::MapAccessDeserializer::new(map))?;
        Ok(Some(Self(fields)))
    }
}

/// Objects of an array; other entries are left out.
impl<T: DeserializeOwned> Wanted for Vec<Fields<T>> {
    fn array<'de, A: SeqAccess<'de>>(mut seq: A) -> Result<Option<Self>, A::Error> {
        let mut all = Self::new();
        while let Some(Loose(entry)) = seq.next_element::<Loose<Fields<T>>>()? {
            all.extend(entry);
        }
        Ok(Some(all))
    }
}

fn ignore_map<'de, T, A: MapAccess<'de>>(mut map: A) -> Result<Option<T>, A::Error> {
    while map.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
    Ok(None)
}

fn ignore_seq<'de, T, A: SeqAccess<'de>>(mut seq: A) -> Result<Option<T>, A::Error> {
    while seq.next_element::<IgnoredAny>()?.is_some() {}
    Ok(None)
}

impl<'de, T: Wanted> Deserialize<'de> for Loose<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Any(PhantomData)).map(Self)
    }
}

/// Visitor of any value.
struct Any<T>(PhantomData<T>);

impl<'de, T: Wanted> Visitor<'de> for Any<T> {
    type Value = Option<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("any value")
    }
    fn visit_f64<E>(self, value: f64) -> Result<Self::Value, E> {
        Ok(T::number(value))
    }
    fn visit_i64<E>(self, value: i64) -> Result<Self::Value, E> {
        Ok(T::number(value as f64))
    }
    fn visit_u64<E>(self, value: u64) -> Result<Self::Value, E> {
        Ok(T::number(value as f64))
    }
    fn visit_bool<E>(self, value: bool) -> Result<Self::Value, E> {
        Ok(T::flag(value))
    }
    fn visit_str<E>(self, value: &str) -> Result<Self::Value, E> {
        Ok(T::text(value))
    }
    fn visit_unit<E>(self) -> Result<Self::Value, E> {
        Ok(None)
    }
    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        T::object(map)
    }
    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Self::Value, A::Error> {
        T::array(seq)
    }
}
