//! Bounded little-endian reading. A read beyond the end gives `None` and never panics.

pub(crate) use sulcus_proto::hex::{from_hex32, hex};

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reading_past_the_end_is_none() {
        let mut cut = Cut(&[1, 0, 0, 0, b'a', 255]);
        assert_eq!(cut.string(), Some("a"));
        assert_eq!(cut.u16(), None);
        assert_eq!(cut.u8(), Some(255));
        assert_eq!(cut.u8(), None);
    }
}
