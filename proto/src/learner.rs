//! What a recording may call a learner: an opaque id, never a name. The key table lives apart.

/// Longest id, bytes.
pub const LONGEST: usize = 32;

/// Whether `id` is opaque enough: empty (nobody is named), or at most [`LONGEST`] letters, digits, `-` and `_` of ASCII with
/// at least one digit, which names have none of.
pub fn is_opaque(id: &str) -> bool {
    let plain = |c: u8| c.is_ascii_alphanumeric() || c == b'-' || c == b'_';
    id.is_empty()
        || id.len() <= LONGEST && id.bytes().all(plain) && id.bytes().any(|c| c.is_ascii_digit())
}

/// The id in an argument.
///
/// # Errors
/// When it is none ([`is_opaque`]): says what is expected.
pub fn parse(id: &str) -> Result<String, String> {
    if is_opaque(id) {
        Ok(id.into())
    } else {
        Err(format!(
            "expected an opaque id, never a name: at most {LONGEST} letters, digits, - and _, one digit at least, such as a7f3"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_no_id() {
        for id in ["", "a7f3", "2026-014", "S_7", &"7".repeat(LONGEST)] {
            assert_eq!(parse(id), Ok(id.to_owned()));
        }
        for name in [
            "Jane Doe",
            "jane",
            "jane-doe",
            "j.doe7",
            "Zoë7",
            "7\n",
            &"7".repeat(LONGEST + 1),
        ] {
            assert!(parse(name).is_err(), "{name}");
        }
    }
}
