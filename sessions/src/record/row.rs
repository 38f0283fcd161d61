//! Exact row: input and output of one tick in a fixed number of bytes.

use sulcus_core::{MAX_TOOLS, TickInput, TickOutput};

use crate::record::bytes::Cut;
use crate::record::sample::DeviceSamples;

/// One recorded tick: enough to run the tick again and to notice any difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Number of the tick on the clock's grid.
    pub tick: u64,
    /// Session clock, nanoseconds since the Unix epoch.
    pub time_unix_ns: u64,
    /// Complete input of the tick.
    pub input: TickInput,
    /// Chained state hash after the tick.
    pub hash: u64,
    /// Per tool, the wrench sent to the hand: force (N), torque (N m), world axes, about the
    /// device point. f32 as on the wire.
    pub wrench: [[f32; 6]; MAX_TOOLS],
    /// Per tool, bits of [`sulcus_core::output::status`].
    pub status: [u16; MAX_TOOLS],
    /// Per tool, the device's sample of the pose that this tick was the first to use. No part of [`Row::to_bytes`].
    pub device: DeviceSamples,
}

/// Length of a tool's part: six f32 and a u16.
const TOOL_BYTES: usize = 26;

impl Row {
    /// Length of [`Row::to_bytes`].
    pub const BYTES: usize = 8 + 8 + TickInput::BYTES + MAX_TOOLS * TOOL_BYTES + 8;

    /// Row of a tick that has just run.
    pub fn new(time_unix_ns: u64, input: &TickInput, output: &TickOutput) -> Self {
        let wrench = output.tools.map(|tool| {
            let (f, t) = (tool.wrench.force, tool.wrench.torque);
            [f.x, f.y, f.z, t.x, t.y, t.z].map(|x| x as f32)
        });
        Self {
            tick: output.tick,
            time_unix_ns,
            input: *input,
            hash: output.hash,
            wrench,
            status: output.tools.map(|tool| tool.status),
            device: [None; MAX_TOOLS],
        }
    }

    /// The same row with the device's samples of the poses that the tick used.
    pub fn with_device(self, device: DeviceSamples) -> Self {
        Self { device, ..self }
    }

    /// Writes the bytes that chain and signatures cover into `out`, whose former content is dropped: those of the row,
    /// then those of each sample.
    pub(crate) fn chained(&self, out: &mut Vec<u8>) {
        out.clear();
        out.extend_from_slice(&self.to_bytes());
        for (tool, sample) in (0..).zip(&self.device) {
            let bytes = sample.map(|sample| sample.to_bytes(tool));
            out.extend(bytes.into_iter().flatten());
        }
    }

    /// Bytes in the layout of `proto/sulcus/v1/exact_row.proto`, bit-exact for every float, NaN included.
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        let mut rest = &mut bytes[..];
        let mut put = |part: &[u8]| {
            let (head, tail) = std::mem::take(&mut rest).split_at_mut(part.len());
            head.copy_from_slice(part);
            rest = tail;
        };
        put(&self.tick.to_le_bytes());
        put(&self.time_unix_ns.to_le_bytes());
        put(&self.input.to_bytes());
        for (wrench, status) in self.wrench.iter().zip(self.status) {
            wrench.iter().for_each(|x| put(&x.to_bits().to_le_bytes()));
            put(&status.to_le_bytes());
        }
        put(&self.hash.to_le_bytes());
        bytes
    }

    /// Inverse of [`Row::to_bytes`]; `None` for another length or an unknown flag.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let mut cut = Cut(bytes);
        let mut row = Self {
            tick: cut.u64()?,
            time_unix_ns: cut.u64()?,
            input: TickInput::from_bytes(&cut.array()?)?,
            hash: 0,
            wrench: [[0.0; 6]; MAX_TOOLS],
            status: [0; MAX_TOOLS],
            device: [None; MAX_TOOLS],
        };
        for (wrench, status) in row.wrench.iter_mut().zip(&mut row.status) {
            for x in wrench {
                *x = f32::from_bits(cut.u32()?);
            }
            *status = cut.u16()?;
        }
        row.hash = cut.u64()?;
        cut.0.is_empty().then_some(row)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_schema_adds_up_to_the_length() {
        assert_eq!(
            Row::BYTES,
            8 + 8 + 1 + 2 + 4 + 1 + 2 * (1 + 2 + 2 + 12 + 16) + 2 * 26 + 8
        );
    }

    proptest! {
        #[test]
        fn bytes_survive_a_round_trip(raw in proptest::collection::vec(any::<u8>(), Row::BYTES)) {
            let mut raw = raw;
            raw[16] &= 1; // paused
            raw[23] &= TickInput::MAX_DETAIL; // level of detail
            raw[24] &= 3; // flags of the first tool
            raw[57] &= 3; // and of the second
            let row = Row::from_bytes(&raw).expect("valid flags");
            prop_assert_eq!(&row.to_bytes()[..], &raw[..]);
        }

        #[test]
        fn any_bytes_give_a_row_or_none(raw in proptest::collection::vec(any::<u8>(), 0..200)) {
            if let Some(row) = Row::from_bytes(&raw) {
                prop_assert_eq!(&row.to_bytes()[..], &raw[..]);
            }
        }
    }
}
