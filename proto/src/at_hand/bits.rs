//! Numbers of any width from 0 to 64 bits in bytes, least bit first.

/// Writer of bits.
#[derive(Debug, Default)]
pub(super) struct BitWriter {
    bytes: Vec<u8>,
    /// Number of bits used of the last byte, 0 to 7; 0: the last byte is full.
    used: u32,
}

impl BitWriter {
    /// Appends the lowest `width` bits of `value`.
    pub fn put(&mut self, mut value: u64, mut width: u32) {
        while width > 0 {
            if self.used == 0 {
                self.bytes.push(0);
            }
            let take = width.min(8 - self.used);
            let part = value & ((1 << take) - 1);
            if let Some(last) = self.bytes.last_mut() {
                *last |= (part as u8) << self.used;
            }
            self.used = (self.used + take) % 8;
            value = value.checked_shr(take).unwrap_or(0);
            width -= take;
        }
    }

    /// Bytes, with zeros after the last bit.
    pub fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}

/// Reader of bits.
#[derive(Debug)]
pub(super) struct BitReader<'a> {
    bytes: &'a [u8],
    /// Number of bits read.
    at: usize,
}

impl<'a> BitReader<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// Next `width` bits; `None` beyond the end.
    pub fn take(&mut self, width: u32) -> Option<u64> {
        let (mut value, mut done) = (0, 0);
        while done < width {
            let byte = u64::from(*self.bytes.get(self.at / 8)?);
            let used = (self.at % 8) as u32;
            let take = (width - done).min(8 - used);
            value |= (byte >> used & ((1 << take) - 1)) << done;
            self.at += take as usize;
            done += take;
        }
        Some(value)
    }

    /// Whether all bytes are read and the rest of the last one is zero.
    pub fn is_at_end(&self) -> bool {
        let left = 8 * self.bytes.len() - self.at;
        let is_zero = || {
            self.bytes
                .last()
                .is_some_and(|last| last >> (8 - left) == 0)
        };
        left == 0 || left < 8 && is_zero()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn numbers_are_read_as_they_were_written(
            numbers in proptest::collection::vec((any::<u64>(), 0u32..=64), 0..50),
        ) {
            let low = |value: u64, width: u32| if width == 64 { value } else { value & ((1u64 << width) - 1) };
            let mut writer = BitWriter::default();
            for (value, width) in &numbers {
                writer.put(*value, *width);
            }
            let bytes = writer.into_bytes();
            let bits: u32 = numbers.iter().map(|(_, width)| width).sum();
            prop_assert_eq!(bytes.len() as u32, bits.div_ceil(8));
            let mut reader = BitReader::new(&bytes);
            for (value, width) in &numbers {
                prop_assert_eq!(reader.take(*width), Some(low(*value, *width)));
            }
            prop_assert!(reader.is_at_end());
            prop_assert_eq!(reader.take(8), None);
        }
    }

    #[test]
    fn a_bit_after_the_end_is_noticed() {
        for (byte, at_end) in [
            (0b0000_0101, true),
            (0b0000_1101, false),
            (0b1000_0101, false),
        ] {
            let bytes = [byte];
            let mut reader = BitReader::new(&bytes);
            assert_eq!(reader.take(3), Some(5));
            assert_eq!(reader.is_at_end(), at_end, "{byte:#b}");
        }
        let mut reader = BitReader::new(&[5, 0]);
        assert_eq!(reader.take(3), Some(5));
        assert!(!reader.is_at_end(), "a whole byte is left");
    }
}
