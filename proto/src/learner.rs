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

/// Beginning of a claim by code.
const CODE: &str = "code-";

/// Claim of a client whose learner has typed a code: it stands in the place of a learner id in the hello, and the
/// server puts the id of the code's learner there. No recording has it.
pub fn claim(code: &str) -> String {
    let digits = code.chars().filter(|c| !c.is_whitespace() && *c != '-');
    digits.fold(CODE.to_owned(), |mut claim, digit| {
        claim.push(digit);
        claim
    })
}

/// Code of a claim; `None` for an id.
pub fn code_of(id: &str) -> Option<&str> {
    let code = id.strip_prefix(CODE)?;
    (code.len() == 6 && code.bytes().all(|c| c.is_ascii_digit())).then_some(code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_claim_is_told_from_an_id() {
        assert_eq!(code_of(&claim("123 456")), Some("123456"));
        assert!(is_opaque(&claim("123456")));
        for id in [
            "",
            "s-17",
            "code-12345",
            "code-1234567",
            "code-12345a",
            "123456",
        ] {
            assert_eq!(code_of(id), None, "{id}");
        }
    }

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
