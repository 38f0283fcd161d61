//! The one reader of TOML on the side of the devices: every list must have the length of its field.

use serde::de::DeserializeOwned;

/// Reads a value from a text, by [`sulcus_core::exactly()`].
///
/// # Errors
/// The text is no TOML, or no such value: the message has the place and the values expected.
pub fn read<T: DeserializeOwned>(text: &str) -> Result<T, String> {
    let read = toml::Deserializer::parse(text).and_then(sulcus_core::exactly);
    read.map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, Deserialize)]
    struct Place {
        at: [f64; 3],
    }

    #[test]
    fn a_list_that_is_too_long_is_refused() {
        let place: Place = read("at = [1.0, 2.0, 3.0]").expect("three");
        assert_eq!(place.at, [1.0, 2.0, 3.0]);
        let told = read::<Place>("at = [0,1, 2, 3]").expect_err("four");
        assert!(told.contains("at"), "{told}");
    }
}
