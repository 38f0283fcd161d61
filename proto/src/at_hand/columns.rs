//! A row as a fixed number of integers, one for each quantity, so that consecutive rows differ by small numbers.

use super::{HandRow, HandTool};
use crate::datagram::WirePose;
use crate::{CodecError, TOOLS};

/// Number of integers of the head: skipped ticks, pause, force limit, level of detail.
const HEAD: usize = 4;
/// Number of integers of a tool.
const OF_TOOL: usize = 4 + 7 + 1 + 6;
/// Number of integers of a row.
pub(super) const COLUMNS: usize = HEAD + TOOLS * OF_TOOL;

/// Integers of a row.
pub(super) type Columns = [u64; COLUMNS];

/// Integer of a float: order-preserving, one for each bit pattern.
fn ordered(x: f32) -> u64 {
    let bits = x.to_bits();
    let negative = bits >> 31 == 1;
    u64::from(if negative { !bits } else { bits | 1 << 31 })
}

/// Inverse of [`ordered`].
fn float(ordered: u32) -> f32 {
    let positive = ordered >> 31 == 1;
    f32::from_bits(if positive {
        ordered & !(1 << 31)
    } else {
        !ordered
    })
}

/// Integers of a row.
pub(super) fn of_row(row: &HandRow) -> Columns {
    let mut columns = [0; COLUMNS];
    let (head, tools) = columns.split_at_mut(HEAD);
    head[0] = u64::from(row.skipped);
    head[1] = u64::from(row.paused);
    head[2] = u64::from(row.force_limit_n.to_bits());
    head[3] = u64::from(row.detail);
    let first_ns = row.tools[0].device_time_ns;
    for (slot, (tool, out)) in row
        .tools
        .iter()
        .zip(tools.chunks_exact_mut(OF_TOOL))
        .enumerate()
    {
        out[0] = u64::from(tool.present) | u64::from(tool.stale) << 1;
        out[1] = u64::from(tool.age_ticks);
        out[2] = u64::from(tool.buttons);
        out[3] = u64::from(tool.sequence);
        let pose = tool.pose.position.iter().chain(&tool.pose.orientation);
        for (out, x) in out[4..11].iter_mut().zip(pose) {
            *out = ordered(*x);
        }
        // The devices of two hands are mostly read together.
        let time_ns = tool.device_time_ns;
        out[11] = if slot == 0 {
            time_ns
        } else {
            time_ns.wrapping_sub(first_ns)
        };
        for (out, bits) in out[12..].iter_mut().zip(tool.changed) {
            *out = u64::from(bits);
        }
    }
    columns
}

/// Row of integers.
///
/// # Errors
/// An integer is out of the range of its quantity.
pub(super) fn row(columns: &Columns) -> Result<HandRow, CodecError> {
    let (head, tools) = columns.split_at(HEAD);
    let mut row = HandRow {
        skipped: narrow(head[0])?,
        paused: narrow::<u8>(head[1])? == 1,
        force_limit_n: f32::from_bits(narrow(head[2])?),
        detail: narrow(head[3])?,
        tools: [HandTool::default(); TOOLS],
    };
    if head[1] > 1 {
        return Err(CodecError::NotCanonical(
            "the pause of a row is neither 0 nor 1",
        ));
    }
    let mut first_ns = 0;
    for (slot, (tool, of)) in row
        .tools
        .iter_mut()
        .zip(tools.chunks_exact(OF_TOOL))
        .enumerate()
    {
        if of[0] > 3 {
            return Err(CodecError::NotCanonical(
                "a tool of a row has unknown flags",
            ));
        }
        let mut pose = [0.0; 7];
        for (x, of) in pose.iter_mut().zip(&of[4..11]) {
            *x = float(narrow(*of)?);
        }
        let [x, y, z, qw, qx, qy, qz] = pose;
        let mut changed = [0; 6];
        for (bits, of) in changed.iter_mut().zip(&of[12..]) {
            *bits = narrow(*of)?;
        }
        let time_ns = if slot == 0 {
            of[11]
        } else {
            of[11].wrapping_add(first_ns)
        };
        if slot == 0 {
            first_ns = time_ns;
        }
        *tool = HandTool {
            present: of[0] & 1 != 0,
            stale: of[0] & 2 != 0,
            age_ticks: narrow(of[1])?,
            buttons: narrow(of[2])?,
            pose: WirePose {
                position: [x, y, z],
                orientation: [qw, qx, qy, qz],
            },
            sequence: narrow(of[3])?,
            device_time_ns: time_ns,
            changed,
        };
    }
    Ok(row)
}

/// Integer in the range of its quantity.
fn narrow<T: TryFrom<u64>>(value: u64) -> Result<T, CodecError> {
    T::try_from(value).map_err(|_| CodecError::NotCanonical("a number of a row is out of range"))
}
