//! The one reader of TOML in this crate: every list must have the length of its field.

use serde::de::DeserializeOwned;

/// Error of the reader: message and place in the text.
pub(crate) type TomlError = toml::de::Error;

/// Reads a value from a text, by [`sulcus_core::exactly`].
///
/// # Errors
/// The text is no TOML, or no such value.
pub(crate) fn read<T: DeserializeOwned>(text: &str) -> Result<T, TomlError> {
    toml::Deserializer::parse(text).and_then(sulcus_core::exactly)
}

/// Reads places in a text that [`read`] has accepted. The exact reader knows no places.
///
/// # Errors
/// The text is no such value.
pub(crate) fn outline<T: DeserializeOwned>(text: &str) -> Result<T, TomlError> {
    toml::from_str(text)
}
