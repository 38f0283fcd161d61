//! Hexadecimal text of bytes, in certificates, tickets, tokens and hashes.

/// Formats bytes as lower-case hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes
        .iter()
        .fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
            // Writing to a String cannot fail.
            let _ = write!(text, "{byte:02x}");
            text
        })
}

/// Inverse of [`hex`], for digits of either case. `None` for any other text.
pub fn from_hex(text: &str) -> Option<Vec<u8>> {
    let (pairs, []) = text.as_bytes().as_chunks::<2>() else {
        return None;
    };
    let digit = |c: u8| char::from(c).to_digit(16);
    let byte = |&[high, low]: &[u8; 2]| u8::try_from(digit(high)? * 16 + digit(low)?).ok();
    pairs.iter().map(byte).collect()
}

/// Inverse of [`hex`] for 32 bytes. `None` unless the text is exactly 64 hexadecimal digits.
pub fn from_hex32(text: &str) -> Option<[u8; 32]> {
    from_hex(text)?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn digits_are_read_as_they_are_written(bytes in proptest::collection::vec(any::<u8>(), 0..40)) {
            prop_assert_eq!(from_hex(&hex(&bytes)), Some(bytes.clone()));
            prop_assert_eq!(from_hex(&hex(&bytes).to_uppercase()), Some(bytes));
        }

        #[test]
        fn other_text_is_none(text in "[0-9a-f]{0,8}[^0-9a-fA-F][0-9a-f]{0,8}") {
            prop_assert_eq!(from_hex(&text), None);
        }
    }

    #[test]
    fn hex_survives_a_round_trip_and_refuses_anything_else() {
        let bytes: [u8; 32] = std::array::from_fn(|k| (k * 37) as u8);
        assert_eq!(from_hex32(&hex(&bytes)), Some(bytes));
        assert_eq!(from_hex32("00"), None);
        assert_eq!(from_hex("012"), None);
        // An integer's reader accepts a sign.
        assert_eq!(from_hex("+1"), None);
        assert_eq!(from_hex32(&"zz".repeat(32)), None);
        assert_eq!(from_hex32(&"é".repeat(32)), None);
    }
}
