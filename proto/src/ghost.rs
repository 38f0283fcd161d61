//! Ghost of a recorded hand, which an instructor shows on a student's screen.
//!
//! A ghost is seen and never felt. The server sends its path in parts, because a control frame is small.

use serde::{Deserialize, Serialize};

use crate::TOOLS;
use crate::datagram::WirePose;

/// Largest number of moments of a path: ten minutes at [`PERIOD_NS`].
pub const MOST_MOMENTS: usize = 30_000;
/// Largest number of moments of a part.
pub const PART_MOMENTS: usize = 500;
/// Period between two moments of a path, nanoseconds.
pub const PERIOD_NS: u64 = 20_000_000;

/// Poses of both tools at one moment of a path, `world_from_tool` at the device point; `None` for a tool without a
/// hand.
pub type Moment = [Option<WirePose>; TOOLS];

/// Part of the path of a ghost, at most [`PART_MOMENTS`] moments. A path without moments ends the ghost.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GhostPart {
    /// Number of moments of the whole path, at most [`MOST_MOMENTS`].
    pub count: u32,
    /// Number of the first moment of this part. The part with number 0 begins a path.
    pub first: u32,
    /// Tips in the frames of the tools, metres.
    pub tips: [[f32; 3]; TOOLS],
    /// Moments, [`PERIOD_NS`] apart.
    pub moments: Vec<Moment>,
}

/// Path of a ghost, as its parts arrive.
#[derive(Debug, Default)]
pub struct Gathering {
    path: Vec<Moment>,
    /// Number of moments of the whole path; 0 before the first part.
    count: usize,
}

/// State of a path after a part.
#[derive(Clone, Debug, PartialEq)]
pub enum Gathered {
    /// Further parts are missing.
    Begun,
    /// The path is whole. A path without moments ends the ghost.
    Whole(Vec<Moment>),
}

impl Gathering {
    /// Takes the next part.
    ///
    /// # Errors
    /// The part is too long, or does not follow the part before: one sentence.
    pub fn take(&mut self, part: &GhostPart) -> Result<Gathered, &'static str> {
        let (first, count) = (part.first as usize, part.count as usize);
        if first == 0 {
            self.path.clear();
            self.count = count;
        }
        let after = first + part.moments.len();
        let is_next = first == self.path.len() && count == self.count;
        let fits = count <= MOST_MOMENTS && part.moments.len() <= PART_MOMENTS && after <= count;
        let moves = count == 0 || !part.moments.is_empty();
        if !(is_next && fits && moves) {
            *self = Self::default();
            return Err("a part of a ghost that does not follow the part before");
        }
        self.path.extend(&part.moments);
        if after < count {
            return Ok(Gathered::Begun);
        }
        self.count = 0;
        Ok(Gathered::Whole(std::mem::take(&mut self.path)))
    }
}

/// Parts of a path. A path beyond [`MOST_MOMENTS`] ends there.
pub fn parts(path: &[Moment], tips: [[f32; 3]; TOOLS]) -> Vec<GhostPart> {
    let path = &path[..path.len().min(MOST_MOMENTS)];
    let count = path.len() as u32;
    if path.is_empty() {
        return vec![GhostPart::default()];
    }
    let part = |(k, moments): (usize, &[Moment])| GhostPart {
        count,
        first: (k * PART_MOMENTS) as u32,
        tips,
        moments: moments.to_vec(),
    };
    path.chunks(PART_MOMENTS).enumerate().map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::CONTROL_BYTES;
    use crate::{ServerMessage, frame};
    use proptest::prelude::*;

    fn path(count: usize) -> Vec<Moment> {
        let at = |k: usize| WirePose {
            position: [k as f32; 3],
            ..WirePose::IDENTITY
        };
        (0..count).map(|k| [Some(at(k)), Some(at(k))]).collect()
    }

    #[test]
    fn a_full_part_fits_a_control_frame() {
        let part = parts(&path(PART_MOMENTS), [[0.0; 3]; TOOLS]).remove(0);
        let bytes = frame::encode(&ServerMessage::Ghost(part)).expect("encodes");
        assert!(bytes.len() < CONTROL_BYTES, "{}", bytes.len());
    }

    #[test]
    fn a_missing_part_and_a_part_beyond_the_end_are_refused() {
        let mut parts = parts(&path(3 * PART_MOMENTS), [[0.0; 3]; TOOLS]);
        let mut gathering = Gathering::default();
        assert_eq!(gathering.take(&parts[0]), Ok(Gathered::Begun));
        assert!(gathering.take(&parts[2]).is_err());
        // The refusal forgets the path.
        assert!(gathering.take(&parts[1]).is_err());
        parts[0].count = 1;
        assert!(gathering.take(&parts[0]).is_err());
        parts[0].count = MOST_MOMENTS as u32 + 1;
        assert!(gathering.take(&parts[0]).is_err());
    }

    proptest! {
        #[test]
        fn the_parts_of_a_path_are_the_path(count in 0usize..1600, before in 0usize..600) {
            let whole = path(count);
            let mut gathering = Gathering::default();
            // A path that was begun before leaves no trace.
            let _ = gathering.take(&parts(&path(before), [[0.0; 3]; TOOLS])[0]);
            let mut last = Ok(Gathered::Begun);
            for part in parts(&whole, [[0.0; 3]; TOOLS]) {
                prop_assert_eq!(&last, &Ok(Gathered::Begun));
                last = gathering.take(&part);
            }
            prop_assert_eq!(last, Ok(Gathered::Whole(whole)));
        }
    }
}
