//! Strict reading of hand-written values: a list that is longer or shorter than its field is refused.
//!
//! serde fills a field of fixed length from the start of a list, and TOML readers silently drop the rest. A decimal
//! comma in `[5,5, 4, 4]` therefore becomes `[5, 5, 4]`. [`exactly`] wraps a deserialiser of any format. Every list
//! must be used up by its field, and a table must be written as a table, not as a list of its values. A new field needs
//! no annotation. Binary formats do not pass through this module, so their bytes are unaffected.

use std::cell::Cell;
use std::fmt;

use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error, Expected, IgnoredAny, IntoDeserializer,
    MapAccess, SeqAccess, VariantAccess, Visitor,
};

/// Deserialises the value of `from`; every list must be used up.
///
/// # Errors
/// The format reports an error, or a list has the wrong length. The message then has the name of the list, the length
/// found and the length expected (`depth_mm.buccal: 4 numbers found, 3 expected`).
pub fn exactly<'de, D, T>(from: D) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: serde::Deserialize<'de>,
{
    T::deserialize(Watched::new(from, &Place::root()))
}

/// Whether a value is an integer, a decimal number or neither, for the message about a list of wrong length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Neither, or not read yet.
    Other,
    /// Integer.
    Whole,
    /// Floating-point number.
    Decimal,
}

/// Step from a value to a value inside: from the file to its root value, by a key, or by an index from 0.
enum Step {
    Root,
    Key(String),
    Index(usize),
}

/// Position of a value in its file.
struct Place<'p> {
    parent: Option<&'p Place<'p>>,
    step: Step,
    /// Kind of the value; [`Kind::Other`] until the value is read.
    kind: Cell<Kind>,
}

impl<'p> Place<'p> {
    fn root() -> Self {
        Self {
            parent: None,
            step: Step::Root,
            kind: Cell::new(Kind::Other),
        }
    }

    fn below(parent: &'p Place<'p>, step: Step) -> Self {
        Self {
            parent: Some(parent),
            step,
            kind: Cell::new(Kind::Other),
        }
    }
}

/// Writes the path of keys and indices to a value, such as `depth_mm.buccal` or `points[2]`. The path starts at the
/// nearest table of a list of tables. A message names the line anyway.
impl fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let above = self.parent;
        match &self.step {
            Step::Root => f.write_str("the file"),
            Step::Index(k) => match above {
                Some(list) => write!(f, "{list}[{k}]"),
                None => write!(f, "[{k}]"),
            },
            Step::Key(key) => {
                if let Some(table) = above.filter(|table| matches!(table.step, Step::Key(_))) {
                    write!(f, "{table}.")?;
                }
                f.write_str(key)
            }
        }
    }
}

/// Expected form of a list for a field.
#[derive(Clone, Copy)]
enum Shape {
    /// Any list that the visitor accepts.
    Any,
    /// Exactly this number of elements.
    Length(usize),
    /// Keys of a table; a list is refused.
    Table,
}

/// Wrapper of a deserialiser, seed, visitor or accessor, with the position of its value.
struct Watched<'p, T> {
    inner: T,
    place: &'p Place<'p>,
    shape: Shape,
}

impl<'p, T> Watched<'p, T> {
    fn new(inner: T, place: &'p Place<'p>) -> Self {
        Self {
            inner,
            place,
            shape: Shape::Any,
        }
    }

    fn shaped(inner: T, place: &'p Place<'p>, shape: Shape) -> Self {
        Self {
            inner,
            place,
            shape,
        }
    }
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Watched<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<S::Value, D::Error> {
        self.inner.deserialize(Watched::new(from, self.place))
    }
}

macro_rules! forward_deserialize {
    ($($method:ident)*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
            self.inner.$method(Watched::new(visitor, self.place))
        }
    )*};
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Watched<'_, D> {
    type Error = D::Error;

    forward_deserialize! {
        deserialize_any deserialize_bool deserialize_i8 deserialize_i16 deserialize_i32 deserialize_i64 deserialize_i128
        deserialize_u8 deserialize_u16 deserialize_u32 deserialize_u64 deserialize_u128 deserialize_f32 deserialize_f64
        deserialize_char deserialize_str deserialize_string deserialize_bytes deserialize_byte_buf deserialize_option
        deserialize_unit deserialize_seq deserialize_map deserialize_identifier deserialize_ignored_any
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let visitor = Watched::new(visitor, self.place);
        self.inner.deserialize_unit_struct(name, visitor)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let visitor = Watched::new(visitor, self.place);
        self.inner.deserialize_newtype_struct(name, visitor)
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        len: usize,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let visitor = Watched::shaped(visitor, self.place, Shape::Length(len));
        self.inner.deserialize_tuple(len, visitor)
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        len: usize,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let visitor = Watched::shaped(visitor, self.place, Shape::Length(len));
        self.inner.deserialize_tuple_struct(name, len, visitor)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let visitor = Watched::shaped(visitor, self.place, Shape::Table);
        self.inner.deserialize_struct(name, fields, visitor)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let visitor = Watched::new(visitor, self.place);
        self.inner.deserialize_enum(name, variants, visitor)
    }

    fn is_human_readable(&self) -> bool {
        self.inner.is_human_readable()
    }
}

macro_rules! forward_visit {
    ($($method:ident: $type:ty => $kind:ident,)*) => {$(
        fn $method<E: Error>(self, value: $type) -> Result<V::Value, E> {
            self.place.kind.set(Kind::$kind);
            self.inner.$method(value)
        }
    )*};
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Watched<'_, V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.inner.expecting(f)
    }

    forward_visit! {
        visit_bool: bool => Other,
        visit_i8: i8 => Whole,
        visit_i16: i16 => Whole,
        visit_i32: i32 => Whole,
        visit_i64: i64 => Whole,
        visit_i128: i128 => Whole,
        visit_u8: u8 => Whole,
        visit_u16: u16 => Whole,
        visit_u32: u32 => Whole,
        visit_u64: u64 => Whole,
        visit_u128: u128 => Whole,
        visit_f32: f32 => Decimal,
        visit_f64: f64 => Decimal,
        visit_char: char => Other,
        visit_str: &str => Other,
        visit_borrowed_str: &'de str => Other,
        visit_string: String => Other,
        visit_bytes: &[u8] => Other,
        visit_borrowed_bytes: &'de [u8] => Other,
        visit_byte_buf: Vec<u8> => Other,
    }

    fn visit_none<E: Error>(self) -> Result<V::Value, E> {
        self.inner.visit_none()
    }

    fn visit_unit<E: Error>(self) -> Result<V::Value, E> {
        self.inner.visit_unit()
    }

    fn visit_some<D: Deserializer<'de>>(self, from: D) -> Result<V::Value, D::Error> {
        self.inner.visit_some(Watched::new(from, self.place))
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, from: D) -> Result<V::Value, D::Error> {
        self.inner
            .visit_newtype_struct(Watched::new(from, self.place))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, access: A) -> Result<V::Value, A::Error> {
        let place = self.place;
        if matches!(self.shape, Shape::Table) {
            let expected = Wanted(&self.inner);
            let found = format!("{place}: a list found, {expected} expected with its keys");
            return Err(A::Error::custom(found));
        }
        let mut list = List {
            access,
            place,
            taken: 0,
            ended: false,
            kinds: Vec::new(),
        };
        let value = self.inner.visit_seq(&mut list);
        let taken = list.taken;
        match (value, self.shape) {
            (Ok(value), _) => {
                while list.next_element::<IgnoredAny>()?.is_some() {}
                if list.taken == taken {
                    Ok(value)
                } else {
                    Err(list.wrong_length(taken))
                }
            }
            (Err(_), Shape::Length(expected)) if list.ended && taken < expected => {
                Err(list.wrong_length(expected))
            }
            (Err(error), _) => Err(error),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, access: A) -> Result<V::Value, A::Error> {
        self.inner.visit_map(Table {
            access,
            place: self.place,
            key: String::new(),
        })
    }

    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> Result<V::Value, A::Error> {
        self.inner.visit_enum(Watched::new(access, self.place))
    }
}

/// Displays the description of the value that a visitor expects.
struct Wanted<'a, V>(&'a V);

impl<'de, V: Visitor<'de>> fmt::Display for Wanted<'_, V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Expected::fmt(self.0, f)
    }
}

/// Accessor of a list that counts the elements read and keeps their kinds.
struct List<'p, A> {
    access: A,
    place: &'p Place<'p>,
    /// Number of elements read.
    taken: usize,
    /// Whether the end of the list was reached.
    ended: bool,
    /// Kinds of the elements read, in order.
    kinds: Vec<Kind>,
}

impl<A> List<'_, A> {
    fn wrong_length<E: Error>(&self, expected: usize) -> E {
        let (place, found) = (self.place, self.taken);
        let are = |kind| {
            self.kinds
                .iter()
                .all(|one| *one == kind || *one == Kind::Whole)
        };
        let name = match (are(Kind::Decimal), found) {
            (true, 1) => "number",
            (true, _) => "numbers",
            (false, 1) => "value",
            (false, _) => "values",
        };
        let hint = if found > expected && are(Kind::Whole) {
            "; a decimal is written with a point, such as 5.5"
        } else {
            ""
        };
        E::custom(format!(
            "{place}: {found} {name} found, {expected} expected{hint}"
        ))
    }
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for List<'_, A> {
    type Error = A::Error;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, A::Error> {
        let place = Place::below(self.place, Step::Index(self.taken));
        let element = self.access.next_element_seed(Watched::new(seed, &place))?;
        if element.is_some() {
            self.taken += 1;
            self.kinds.push(place.kind.get());
        } else {
            self.ended = true;
        }
        Ok(element)
    }

    fn size_hint(&self) -> Option<usize> {
        self.access.size_hint()
    }
}

/// Accessor of a table that keeps the last key for the position of its value.
struct Table<'p, A> {
    access: A,
    place: &'p Place<'p>,
    key: String,
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for Table<'_, A> {
    type Error = A::Error;

    fn next_key_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, A::Error> {
        let key = &mut self.key;
        self.access.next_key_seed(Key { seed, key })
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, A::Error> {
        let place = Place::below(self.place, Step::Key(std::mem::take(&mut self.key)));
        self.access.next_value_seed(Watched::new(seed, &place))
    }

    fn size_hint(&self) -> Option<usize> {
        self.access.size_hint()
    }
}

/// Seed of a key, which also stores the key's text.
struct Key<'k, S> {
    seed: S,
    key: &'k mut String,
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Key<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<S::Value, D::Error> {
        let key: String = serde::Deserialize::deserialize(from)?;
        self.key.clone_from(&key);
        // Deserialised inside the format's own call, so that an error about the key gets the key's line.
        self.seed.deserialize(key.into_deserializer())
    }
}

impl<'de, 'p, A: EnumAccess<'de>> EnumAccess<'de> for Watched<'p, A> {
    type Error = A::Error;
    type Variant = Watched<'p, A::Variant>;

    fn variant_seed<S: DeserializeSeed<'de>>(
        self,
        seed: S,
    ) -> Result<(S::Value, Self::Variant), A::Error> {
        let (value, variant) = self.inner.variant_seed(seed)?;
        Ok((value, Watched::new(variant, self.place)))
    }
}

impl<'de, A: VariantAccess<'de>> VariantAccess<'de> for Watched<'_, A> {
    type Error = A::Error;

    fn unit_variant(self) -> Result<(), A::Error> {
        self.inner.unit_variant()
    }

    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value, A::Error> {
        let seed = Watched::new(seed, self.place);
        self.inner.newtype_variant_seed(seed)
    }

    fn tuple_variant<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, A::Error> {
        let visitor = Watched::shaped(visitor, self.place, Shape::Length(len));
        self.inner.tuple_variant(len, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        let visitor = Watched::shaped(visitor, self.place, Shape::Table);
        self.inner.struct_variant(fields, visitor)
    }
}
