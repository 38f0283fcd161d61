//! Ranges of the numbers and texts in a header.

/// Longest text of a field, bytes.
const MOST_TEXT: usize = 4096;

/// Checks that a number is finite and above zero.
pub(crate) fn above_zero(field: &str, x: f64) -> Result<(), String> {
    if x.is_finite() && x > 0.0 {
        return Ok(());
    }
    Err(format!("{field} is {x}, expected a finite number above 0"))
}

/// Checks that a number is finite and zero or more.
pub(crate) fn no_less_than_zero(field: &str, x: f64) -> Result<(), String> {
    if x.is_finite() && x >= 0.0 {
        return Ok(());
    }
    Err(format!(
        "{field} is {x}, expected a finite number from 0 on"
    ))
}

/// Checks the length of a text.
pub(crate) fn text_of(field: &str, text: &str) -> Result<(), String> {
    if text.len() <= MOST_TEXT {
        return Ok(());
    }
    Err(format!(
        "{field} is {} bytes long, expected at most {MOST_TEXT}",
        text.len()
    ))
}
