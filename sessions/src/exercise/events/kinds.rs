//! Kinds of events.

use crate::record::at_hand::OF_HAND;
use crate::record::attach::ATTACHMENTS;
use crate::record::device::DEVICES_CHANGED;
use crate::record::occurrence::FORCE_ZONE;

pub use crate::record::levels::{FORCE_LIMIT, LEVELS, PAUSED, RESUMED};

/// Kind: the tip of a probe comes into a zone.
pub(super) const SITE_REACHED: &str = "site_reached";
/// Kind: the force on the floor rises into the reading band.
pub(super) const FLOOR_FELT: &str = "floor_felt";
/// Kind: the tilt becomes wrong, or right again.
pub(super) const ANGLE: &str = "angle";
/// Kind: the tip leaves a zone.
pub(super) const LEFT_SITE: &str = "left_site";
/// Kind: the tip left the pocket between two zones of a side.
pub(super) const WITHDRAWN: &str = "withdrawn";
/// Kind: a site bleeds.
pub const BLEEDING: &str = "bleeding";
/// Kind: the target becomes visible.
pub(super) const TARGET_VISIBLE: &str = "target_visible";
/// Kind: the target becomes hidden.
pub(super) const TARGET_HIDDEN: &str = "target_hidden";

/// Kinds of events that [`super::Events`] finds, in the order of [`super::Tally::counts`].
pub const KINDS: [&str; 9] = [
    SITE_REACHED,
    FLOOR_FELT,
    ANGLE,
    LEFT_SITE,
    WITHDRAWN,
    BLEEDING,
    FORCE_ZONE,
    TARGET_VISIBLE,
    TARGET_HIDDEN,
];

/// Kinds of the events of an instructor.
pub const OF_INSTRUCTORS: [&str; 7] = [
    "instructed",
    "note",
    "flag",
    "message",
    "ended",
    "ghost_shown",
    "ghost_hidden",
];

/// Kind: a client sent more events than were recorded.
pub const LOST: &str = "client_events_lost";

/// Whether a client may send an event of this kind: one word of lower-case letters, digits and underscores, and no kind
/// that only a station writes. The log contains the kind as text; another character could make it another line.
pub fn may_a_client_say(kind: &str) -> bool {
    let word = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_';
    !kind.is_empty()
        && kind.bytes().all(word)
        && !KINDS.contains(&kind)
        && !LEVELS.contains(&kind)
        && !OF_INSTRUCTORS.contains(&kind)
        && !ATTACHMENTS.contains(&kind)
        && !OF_HAND.contains(&kind)
        && kind != LOST
        && kind != DEVICES_CHANGED
}
