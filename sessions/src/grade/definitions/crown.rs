//! Metrics of the exercise on a crown.

use super::{Definition, Needs};
use crate::grade::crown::Crown;

pub(super) const CROWN_COVERED: Definition = Definition {
    name: "crown_covered",
    title: "crown circumference touched",
    unit: "%",
    definition: "Share of twelve sectors of 30 degrees about the crown's middle in which the probe's tip touched: a force \
        of 0.02 N or more for 20 ms or more in total. Seen from above, the tip must be 3 mm or more from the middle. \
        The tip must be in the box around the crown, the highest 7 mm of the tooth, or at most 2 mm outside. \
        0 % without a touch.",
    source: "the exercise asks for the whole crown; sectors chosen for this simulator",
    needs: Needs::Crown,
    missing_is_zero: true,
    advice: "Follow the whole crown, not only the parts that are easy to reach.",
    value: |session| session.evidence.crown.as_ref().map(Crown::covered_percent),
    critical: None,
};

pub(super) const CONTACT_FORCE: Definition = Definition {
    name: "contact_force",
    title: "probe force at the crown",
    unit: "N",
    definition: "95th percentile of the force on the probe, rounded up to 0.01 N, over the ticks in contact: 0.02 N or \
        more on any object. \
        Contact of 5 s or of a quarter of the exercise is needed, whichever is less; otherwise the score is 0. \
        A critical error needs 1 s of contact.",
    source: "a light touch is taught; limit chosen for this simulator",
    needs: Needs::Crown,
    missing_is_zero: true,
    advice: "Let the tip glide along the crown: a light touch feels more.",
    value: |session| session.usual_force(&session.evidence.probe),
    critical: Some(|session| session.critical_force(&session.evidence.probe)),
};
