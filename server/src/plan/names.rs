//! Names of stations: usable as file names, in URLs and on the command line.

/// Longest name, bytes.
const LONGEST: usize = 64;

/// Words for the form of a name.
pub const EXPECTED: &str =
    "a station's name: 1 to 64 letters, digits, - and _, a letter or digit first, and not `any`";

/// Whether `name` can be the name of a station: 1 to 64 ASCII letters, digits, `-` and `_`, the first one a letter or a
/// digit. The word `any` stands for all stations.
pub fn is_station_name(name: &str) -> bool {
    let plain = |c: u8| c.is_ascii_alphanumeric() || c == b'-' || c == b'_';
    name.len() <= LONGEST
        && name.bytes().all(plain)
        && name
            .bytes()
            .next()
            .is_some_and(|c| c.is_ascii_alphanumeric())
        && !name.eq_ignore_ascii_case("any")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_a_file_name_and_no_option() {
        for name in ["a", "7", "room3-1", "A_b", &"x".repeat(64)] {
            assert!(is_station_name(name), "{name}");
        }
        for name in [
            "",
            "-a",
            "_a",
            "a/b",
            "..",
            "a b",
            "Süd",
            "any",
            "ANY",
            "a\n",
            &"x".repeat(65),
        ] {
            assert!(!is_station_name(name), "{name}");
        }
    }
}
