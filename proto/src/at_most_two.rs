//! List with one entry for each tool slot: at most [`TOOLS`] entries are written and read.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Error as _, SeqAccess, Visitor};
use serde::ser::{Error as _, Serialize, Serializer};

use crate::TOOLS;

/// Writes the list.
pub(crate) fn serialize<T: Serialize, S: Serializer>(list: &[T], to: S) -> Result<S::Ok, S::Error> {
    if list.len() > TOOLS {
        let found = list.len();
        return Err(S::Error::custom(format!(
            "list has {found} entries, at most {TOOLS} are allowed"
        )));
    }
    list.serialize(to)
}

/// Reads the list. A longer list is refused before its further entries are read.
pub(crate) fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    from: D,
) -> Result<Vec<T>, D::Error> {
    from.deserialize_seq(Few(PhantomData))
}

struct Few<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for Few<T> {
    type Value = Vec<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a list of at most {TOOLS} entries")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Vec<T>, A::Error> {
        if let Some(found) = entries.size_hint().filter(|found| *found > TOOLS) {
            return Err(A::Error::invalid_length(found, &self));
        }
        let mut list = Vec::with_capacity(TOOLS);
        while let Some(entry) = entries.next_element()? {
            if list.len() == TOOLS {
                return Err(A::Error::invalid_length(TOOLS + 1, &self));
            }
            list.push(entry);
        }
        Ok(list)
    }
}
