//! Sessions in several recordings: a station's program that stopped continues the session in another file.
//!
//! The signed header of each further recording names the file before it, with the hash of all its bytes. The signature
//! thus covers the former file to its last byte. A former file needs no end of its own. Its tail of at most 200 ms was
//! lost with the program. Everything else about it is checked as for any recording. A continuation without the file
//! that it names gets no grade, because nobody can tell what the missing part would have cost.

use serde::Serialize;

use crate::record::bytes::hex;
use crate::record::read::{Ending, Recording};

/// Recording of a session in several recordings.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct PartFacts {
    /// BLAKE3 of the file, hexadecimal.
    pub blake3: String,
    /// Number of rows.
    pub ticks: u64,
    /// Ending of the file, in words.
    pub ending: String,
}

impl PartFacts {
    /// Facts of the recordings of a session; none for a session in one recording.
    pub fn of(parts: &[&Recording]) -> Vec<Self> {
        let facts = |part: &&Recording| Self {
            blake3: hex(&part.blake3()),
            ticks: part.facts().rows,
            ending: part.ending().to_string(),
        };
        if parts.len() < 2 {
            return Vec::new();
        }
        parts.iter().map(facts).collect()
    }
}

/// Groups of the items that are recordings of one session, each in the order of the session. An item is given with its
/// own hash, and the hash that it names as its predecessor. Groups stand in the order of their last items.
pub fn sessions(items: &[([u8; 32], Option<[u8; 32]>)]) -> Vec<Vec<usize>> {
    let named = |hash: &[u8; 32]| items.iter().position(|(own, _)| own == hash);
    let before: Vec<Option<usize>> = items
        .iter()
        .enumerate()
        .map(|(k, (_, of))| of.as_ref().and_then(named).filter(|other| *other != k))
        .collect();
    let mut taken = vec![false; items.len()];
    let mut groups = Vec::new();
    for k in 0..items.len() {
        let is_last = !before.contains(&Some(k));
        if !is_last {
            continue;
        }
        let (mut group, mut next) = (Vec::new(), Some(k));
        // Of two recordings that continue the same one, the first gets it.
        while let Some(at) = next.filter(|at| !taken[*at]) {
            taken[at] = true;
            group.push(at);
            next = before[at];
        }
        group.reverse();
        groups.push(group);
    }
    groups
}

/// Reason why the recordings are no session in this order, in words; `None` if they are.
pub fn unlinked(parts: &[&Recording]) -> Option<String> {
    let first = parts.first()?;
    if let Some(missing) = &first.header().predecessor {
        return Some(format!(
            "the recording continues {missing}, which is missing: grade both together"
        ));
    }
    parts.windows(2).find_map(|two| {
        let (before, after) = (two[0], two[1]);
        let (a, b) = (before.header(), after.header());
        let named = b.predecessor.as_ref();
        if named.is_none_or(|named| named.blake3 != before.blake3()) {
            let named = named.map_or("none".to_owned(), ToString::to_string);
            return Some(format!(
                "predecessor is {named}, expected the recording before it with blake3 {}",
                hex(&before.blake3())
            ));
        }
        let same = [
            ("scene", a.scene == b.scene),
            (
                "exercise",
                a.exercise == b.exercise && a.exercise_name == b.exercise_name,
            ),
            ("patient", a.patient == b.patient),
            ("rubric", a.rubric == b.rubric),
            ("learner", a.learner_id == b.learner_id),
            ("mode", a.mode == b.mode),
            ("seed", a.seed == b.seed),
            ("signer", before.signer() == after.signer()),
        ];
        let differs = same.into_iter().find(|(_, same)| !same);
        if let Some((what, _)) = differs {
            return Some(format!(
                "{what} differs between the recordings of the session, expected the same one"
            ));
        }
        match before.ending() {
            Ending::Finished | Ending::CutOff { .. } => None,
            other => Some(format!("the first recording is {other}")),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn recordings_are_put_together_in_any_order() {
        let hash = |k: u8| [k; 32];
        // 3 continues 2, and 2 continues 1; 4 stands alone, and 5 continues one that is not there.
        let items = [
            (3, Some(2)),
            (4, None),
            (1, None),
            (5, Some(9)),
            (2, Some(1)),
        ];
        let items = items.map(|(own, of)| (hash(own), of.map(hash)));
        assert_eq!(sessions(&items), [vec![2, 4, 0], vec![1], vec![3]]);
        // Two continuations of one recording: the second lacks its beginning.
        let items =
            [(1, None), (2, Some(1)), (3, Some(1))].map(|(own, of)| (hash(own), of.map(hash)));
        assert_eq!(sessions(&items), [vec![0, 1], vec![2]]);
        // A copy continues the first of its copies, and a recording cannot continue itself.
        let items = [(1, None), (1, None), (2, Some(2))].map(|(own, of)| (hash(own), of.map(hash)));
        assert_eq!(sessions(&items), [vec![0], vec![1], vec![2]]);
    }

    proptest! {
        #[test]
        fn every_recording_is_in_one_session_at_most(items in proptest::collection::vec((0u8..6, proptest::option::of(0u8..6)), 0..8)) {
            let items: Vec<_> = items.into_iter().map(|(own, of)| ([own; 32], of.map(|of| [of; 32]))).collect();
            let mut found: Vec<usize> = sessions(&items).concat();
            let all = found.len();
            found.sort_unstable();
            found.dedup();
            prop_assert_eq!(found.len(), all);
        }
    }
}
