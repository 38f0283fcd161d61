//! Gaps of a salvaged recording after the pass over its file.

use crate::record::gap;
use crate::record::gap::Gap;
use crate::record::read::{ReadError, Recording};
use crate::record::verify::Verifier;

/// Gaps of a recording that was recovered before and is damaged again: the found gaps, and those former gaps that the
/// ticks do not show.
pub(super) fn with_former(mut found: Vec<Gap>, former: Vec<Gap>, messages: u64) -> Vec<Gap> {
    for old in former {
        if old.from_tick.is_none() && found.len() < gap::MOST {
            // The byte position belongs to another file.
            found.push(Gap {
                messages: old.messages.min(messages),
                bytes: 0,
                at_byte: 0,
                ..old
            });
        }
    }
    found.sort_by_key(|gap| gap.messages);
    found
}

/// Removes the gaps at which nothing exact is missing: the chain continues across them to a signed statement.
pub(super) fn forget_bridged(recording: &mut Recording) -> Result<(), ReadError> {
    let bridged = {
        let mut verifier = Verifier::new(recording);
        for message in recording.messages() {
            verifier.message(&message?);
        }
        verifier.bridged_gaps().to_vec()
    };
    let mut k = 0;
    recording.gaps.retain(|_| {
        k += 1;
        !bridged.contains(&(k - 1))
    });
    Ok(())
}
