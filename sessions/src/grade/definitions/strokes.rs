//! Metrics of the probe's tilt and of the walking stroke.

use super::{Definition, Needs};

pub(super) const ANGLE_MID: Definition = Definition {
    name: "angle_mid",
    title: "probe parallel at mid sites",
    unit: "%",
    definition: "Of the zones of the exercise in the middle of a side that were probed (see zones_charted): share in \
        which the probe's working end was within the exercise's `mid_tilt_deg` of the tooth's axis for at least half \
        of the time at the deepest place. Deepest place: within 0.3 mm of the reached depth (see floor_reached), at a \
        force within `force_n`. If there was no such force: within 0.3 mm of the largest depth, at any force. \
        Without such a zone the score is 0.",
    source: "parallel to the long axis: Boyd; rdhmag 14285040",
    needs: Needs::MidZones,
    missing_is_zero: true,
    advice: "In the middle of a side, hold the probe parallel to the long axis of the tooth.",
    value: |session| session.angle(false),
    critical: None,
};

pub(super) const ANGLE_PROXIMAL: Definition = Definition {
    name: "angle_proximal",
    title: "probe tilted into the col",
    unit: "%",
    definition: "Of the zones of the exercise beside a neighbour that were probed (see zones_charted): share in which \
        the tilt was right for at least half of the time at the deepest place (see angle_mid). Right: the probe's \
        working end is tilted into the col by an angle within the exercise's `proximal_tilt_deg`, and by at most \
        `mid_tilt_deg` in other directions. Into the col: the tip points towards the neighbour and the midline of \
        the contact. \
        Without such a zone the score is 0.",
    source: "tilt under the contact into the col: inspiredhygiene.com; rdhmag; 10 to 15 degrees are taught",
    needs: Needs::ProximalZones,
    missing_is_zero: true,
    advice: "Beside a neighbour, tilt the probe so that the tip passes under the contact into the col. An upright \
        probe, or one that is tilted outwards, reads too shallow.",
    value: |session| session.angle(true),
    critical: None,
};

pub(super) const WALKING_STEP: Definition = Definition {
    name: "walking_step",
    title: "length of a walking step",
    unit: "mm",
    definition: "Median step along the tooth, over both sides of each tooth of the exercise. Step: distance between two \
        neighbouring places of touch (see touches_too_light) on one side. The place is that of the touch's largest \
        force. Places less than 0.4 mm apart are one place. \
        The way of a touch that moves 2 mm or more along the tooth is a step, too. \
        Without a step the metric does not count.",
    source: "steps of 1 mm, 1 to 2 mm in other textbooks: Gehrig (LWW)",
    needs: Needs::Zones,
    missing_is_zero: false,
    advice: "Move on by one millimetre between two touches: the floor between wider steps stays unknown.",
    value: |session| session.median_step_mm(),
    critical: None,
};

pub(super) const WITHDRAWALS: Definition = Definition {
    name: "withdrawals",
    title: "withdrawals between zones",
    unit: "",
    definition: "Number of times that the tip left the pocket on its way between two zones of one side of a tooth, with \
        a stay of 0.2 s in each of them. The way to a zone whose floor had been felt before does not count. \
        Felt: a force on the floor at the lower bound of `force_n` or above for 0.2 s in one visit. \
        0 if the tip never left the pocket in this way.",
    source: "repeated withdrawal injures tissue: Gehrig (LWW); spot probing is an error: dimensionsofdentalhygiene.com",
    needs: Needs::Zones,
    missing_is_zero: false,
    advice: "Stay in the pocket between the zones of a side: lift the tip a little, and do not take it out.",
    value: |session| Some(session.evidence.withdrawals as f64),
    critical: None,
};
