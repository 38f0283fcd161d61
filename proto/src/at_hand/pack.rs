//! Compact form of rows: for each quantity the differences from a prediction, in as many bits as the largest needs.
//!
//! A prediction is the number before, or the line through the two numbers before, whichever leaves smaller differences
//! in the batch. A quantity that meets its prediction costs two bits. Both ends keep the last two rows, so that each
//! batch must be unpacked once and in order.

use super::HandRow;
use super::bits::{BitReader, BitWriter};
use super::columns::{COLUMNS, Columns, of_row, row};
use crate::CodecError;

/// Largest number of rows of a batch.
pub const MOST_ROWS: usize = 64;

/// The last two rows, as both ends know them.
#[derive(Clone, Debug)]
struct Past {
    last: Columns,
    before: Columns,
}

impl Default for Past {
    fn default() -> Self {
        Self {
            last: [0; COLUMNS],
            before: [0; COLUMNS],
        }
    }
}

/// Prediction of the next number from the two before, for either order.
fn predict(last: u64, before: u64, by_line: bool) -> u64 {
    if by_line {
        last.wrapping_mul(2).wrapping_sub(before)
    } else {
        last
    }
}

/// Difference as a number that is small for small differences of either sign.
fn zigzag(difference: u64) -> u64 {
    let signed = difference as i64;
    (signed << 1 ^ signed >> 63) as u64
}

/// Inverse of [`zigzag`].
fn difference(zigzag: u64) -> u64 {
    zigzag >> 1 ^ (zigzag & 1).wrapping_neg()
}

/// Packing end.
#[derive(Clone, Debug, Default)]
pub struct Packer(Past);

impl Packer {
    /// Packs 1 to [`MOST_ROWS`] rows; more are left out.
    pub fn pack(&mut self, rows: &[HandRow]) -> Vec<u8> {
        let rows: Vec<Columns> = rows.iter().take(MOST_ROWS).map(of_row).collect();
        let mut head = BitWriter::default();
        let mut body = Vec::with_capacity(COLUMNS);
        head.put(rows.len() as u64, 8);
        for column in 0..COLUMNS {
            let [same, line] = [false, true].map(|by_line| self.0.column(&rows, column, by_line));
            let by_line = width(&line) < width(&same);
            let coded = if by_line { line } else { same };
            head.put(u64::from(by_line), 1);
            head.put(u64::from(width(&coded) > 0), 1);
            body.push(coded);
        }
        for coded in body {
            let width = width(&coded);
            if width > 0 {
                head.put(u64::from(width - 1), 6);
                coded.iter().for_each(|number| head.put(*number, width));
            }
        }
        for row in &rows {
            self.0.take(row);
        }
        head.into_bytes()
    }
}

/// Bits of the largest number.
fn width(coded: &[u64]) -> u32 {
    64 - coded
        .iter()
        .fold(0, |all, number| all | number)
        .leading_zeros()
}

impl Past {
    /// Differences of a column from their predictions.
    fn column(&self, rows: &[Columns], column: usize, by_line: bool) -> Vec<u64> {
        let (mut last, mut before) = (self.last[column], self.before[column]);
        let code = |row: &Columns| {
            let next = row[column];
            let coded = zigzag(next.wrapping_sub(predict(last, before, by_line)));
            (before, last) = (last, next);
            coded
        };
        rows.iter().map(code).collect()
    }

    fn take(&mut self, row: &Columns) {
        self.before = std::mem::replace(&mut self.last, *row);
    }
}

/// Unpacking end.
#[derive(Clone, Debug, Default)]
pub struct Unpacker(Past);

impl Unpacker {
    /// Unpacks a batch. After an error the unpacker is as before.
    ///
    /// # Errors
    /// The bytes are no batch: no rows, too many, a number out of its range, missing or trailing bytes.
    pub fn unpack(&mut self, bytes: &[u8]) -> Result<Vec<HandRow>, CodecError> {
        let short = CodecError::NotCanonical("a batch of inputs ends early");
        let mut reader = BitReader::new(bytes);
        let count = reader.take(8).ok_or(short.clone())? as usize;
        if count == 0 || count > MOST_ROWS {
            return Err(CodecError::NotCanonical(
                "a batch of inputs has 1 to 64 rows",
            ));
        }
        let mut kinds = [(false, false); COLUMNS];
        for kind in &mut kinds {
            let bits = reader.take(2).ok_or(short.clone())?;
            *kind = (bits & 1 == 1, bits & 2 == 2);
        }
        let mut rows = vec![[0; COLUMNS]; count];
        for (column, (by_line, differs)) in kinds.into_iter().enumerate() {
            let width = match differs {
                true => reader.take(6).ok_or(short.clone())? as u32 + 1,
                false => 0,
            };
            let (mut last, mut before) = (self.0.last[column], self.0.before[column]);
            for row in &mut rows {
                let coded = reader.take(width).ok_or(short.clone())?;
                let next = predict(last, before, by_line).wrapping_add(difference(coded));
                row[column] = next;
                (before, last) = (last, next);
            }
        }
        if !reader.is_at_end() {
            return Err(CodecError::NotCanonical(
                "a batch of inputs has trailing bytes",
            ));
        }
        let unpacked: Vec<HandRow> = rows.iter().map(row).collect::<Result<_, _>>()?;
        rows.iter().for_each(|row| self.0.take(row));
        Ok(unpacked)
    }
}

#[cfg(test)]
mod tests;
