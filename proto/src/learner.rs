//! Opaque learner ids for recordings.
//!
//! A recording never holds a learner's name. The table of ids and names is kept elsewhere.

/// Largest length of an id, bytes.
pub const LONGEST: usize = 32;

/// Whether `id` is empty or a valid opaque id.
///
/// An empty id stands for an anonymous learner. Any other id consists of at most [`LONGEST`] ASCII letters, digits, `-`
/// and `_`. At least one digit is required, because names have none.
pub fn is_opaque(id: &str) -> bool {
    let plain = |c: u8| c.is_ascii_alphanumeric() || c == b'-' || c == b'_';
    id.is_empty()
        || id.len() <= LONGEST && id.bytes().all(plain) && id.bytes().any(|c| c.is_ascii_digit())
}

/// Parses a learner id, for example from a command-line argument.
///
/// # Errors
/// The id is invalid by [`is_opaque`]; the message states the expected form.
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
