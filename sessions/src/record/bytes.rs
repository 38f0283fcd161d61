//! Bounded little-endian reading. A read beyond the end gives `None` and never panics.

/// Rest of some bytes that are read from the front.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cut<'a>(pub &'a [u8]);

impl<'a> Cut<'a> {
    /// The next `n` bytes.
    pub fn take(&mut self, n: usize) -> Option<&'a [u8]> {
        let (head, rest) = self.0.split_at_checked(n)?;
        self.0 = rest;
        Some(head)
    }

    /// The next `N` bytes, by value.
    pub fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*head)
    }

    /// The next byte.
    pub fn u8(&mut self) -> Option<u8> {
        self.array().map(|[byte]| byte)
    }

    /// The next two bytes.
    pub fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    /// The next four bytes.
    pub fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    /// The next eight bytes.
    pub fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// A string as MCAP stores it: length in four bytes, then UTF-8.
    pub fn string(&mut self) -> Option<&'a str> {
        let length = usize::try_from(self.u32()?).ok()?;
        std::str::from_utf8(self.take(length)?).ok()
    }
}

/// Lower-case hexadecimal.
pub(crate) fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes
        .iter()
        .fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
            // Writing to a String cannot fail.
            let _ = write!(text, "{byte:02x}");
            text
        })
}

/// Inverse of [`hex`] for 32 bytes; `None` unless the text is exactly 64 hexadecimal digits.
pub(crate) fn from_hex32(text: &str) -> Option<[u8; 32]> {
    let digits = text.as_bytes();
    if digits.len() != 64 {
        return None;
    }
    let mut out = [0; 32];
    for (byte, pair) in out.iter_mut().zip(digits.chunks_exact(2)) {
        let digit = |c: u8| char::from(c).to_digit(16);
        *byte = u8::try_from(digit(pair[0])? * 16 + digit(pair[1])?).ok()?;
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hex_survives_a_round_trip_and_refuses_anything_else() {
        let bytes: [u8; 32] = std::array::from_fn(|k| (k * 37) as u8);
        assert_eq!(from_hex32(&hex(&bytes)), Some(bytes));
        assert_eq!(from_hex32("00"), None);
        assert_eq!(from_hex32(&"zz".repeat(32)), None);
        assert_eq!(from_hex32(&"é".repeat(32)), None);
    }

    #[test]
    fn reading_past_the_end_is_none() {
        let mut cut = Cut(&[1, 0, 0, 0, b'a', 255]);
        assert_eq!(cut.string(), Some("a"));
        assert_eq!(cut.u16(), None);
        assert_eq!(cut.u8(), Some(255));
        assert_eq!(cut.u8(), None);
    }
}
