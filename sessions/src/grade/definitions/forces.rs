//! Metrics of the force on the floor of a pocket.

use sulcus_core::math::fmax;

use super::{Definition, Needs};
use crate::grade::sites::SiteGrade;
use crate::grade::tolerances::TREMOR_N;

pub(super) const TOUCHES_TOO_LIGHT: Definition = Definition {
    name: "touches_too_light",
    title: "touches too light",
    unit: "%",
    definition: "Share of the touches of the floor whose largest force is below the target band `force_n`. \
        Only touches on the teeth of the exercise count. A touch begins at 0.02 N on the floor. \
        The touch ends when the force stays below half of its largest force for 50 ms, or when the tip leaves the \
        pocket. In the same pocket, the next touch begins at 0.02 N or more, and at twice the least force since. \
        Without a touch the score is 0.",
    source: "10 to 25 g are recommended: Gehrig, Boyd, Polson 1980, Lang 1991",
    needs: Needs::Zones,
    missing_is_zero: true,
    advice: "Press until the floor is clearly felt: a lighter touch reads too shallow.",
    value: |session| session.share_of_touches(|touch| touch.peak < session.set.force_n[0]),
    critical: None,
};

pub(super) const TOUCHES_TOO_HEAVY: Definition = Definition {
    name: "touches_too_heavy",
    title: "touches too heavy",
    unit: "%",
    definition: "Share of the touches of the floor (see touches_too_light) whose largest force is more than 0.05 N above \
        the target band `force_n`. The 0.05 N are a tolerance for tremor. Without a touch the metric does not count.",
    source: "\"a strong possibility of traumatising healthy tissue above 0.25 N\": Karayiannis 1992",
    needs: Needs::Zones,
    missing_is_zero: false,
    advice: "Press less: more than the taught force reads too deep, and makes healthy tissue bleed.",
    value: |session| {
        session.share_of_touches(|touch| touch.peak > session.set.force_n[1] + TREMOR_N)
    },
    critical: None,
};

pub(super) const READINGS_HELD: Definition = Definition {
    name: "readings_held",
    title: "tip held on the floor",
    unit: "%",
    definition: "Of the zones of the exercise that were probed and then called (see zones_charted): share in which the \
        force on the floor stayed at the lower bound of `force_n` or above for 0.5 s or more. \
        Lower forces for 50 ms or less do not interrupt this time. \
        Without such a zone the score is 0.",
    source: "the floor must yield softly before a depth is read: Boyd, LWW; duration chosen for this simulator",
    needs: Needs::Zones,
    missing_is_zero: true,
    advice: "Rest the tip on the floor for half a second at the taught force, and read the depth meanwhile.",
    value: |session| session.share(SiteGrade::is_charted, SiteGrade::is_held),
    critical: None,
};

pub(super) const READINGS_TOO_HEAVY: Definition = Definition {
    name: "readings_too_heavy",
    title: "readings under too much force",
    unit: "%",
    definition: "Of the zones of the exercise that were probed and then called (see zones_charted): share in which the \
        force on the floor stayed more than 0.05 N above the target band `force_n` for 0.2 s or more. \
        Lower forces for 50 ms or less do not interrupt this time. \
        Lighter touches of the same zone do not offset it. Without such a zone the metric does not count.",
    source: "force as in touches_too_heavy; duration chosen for this simulator",
    needs: Needs::Zones,
    missing_is_zero: false,
    advice: "Keep to the taught force while you read the depth: more force pushes the tip too deep.",
    value: |session| session.share(SiteGrade::is_charted, SiteGrade::is_pressed),
    critical: None,
};

pub(super) const FORCE_IN_BAND: Definition = Definition {
    name: "force_in_band",
    title: "floor time in the force band",
    unit: "%",
    definition: "Of the time with 0.02 N or more on the floor of any pocket: share with a force within the target band \
        `force_n`. Time in the scene's zones of trauma and damage is outside the band. \
        Without such time the metric does not count.",
    source: "force as in touches_too_light; strokes pass through lower forces, so 100 % is no aim",
    needs: Needs::Zones,
    missing_is_zero: false,
    advice: "Hold the taught force while you read the depth.",
    value: |session| session.evidence.floor.in_band_percent(),
    critical: None,
};

pub(super) const TRAUMA_EVENTS: Definition = Definition {
    name: "trauma_events",
    title: "entries into the trauma zone",
    unit: "",
    definition: "Number of times that the force on the floor of any pocket entered the scene's zone of trauma: from \
        0.5 N by default, below the zone of damage. The value is at least the number of full seconds in this zone. \
        0 if the force was never there.",
    source: "bleeding of healthy gingiva increases with force: Lang 1991",
    needs: Needs::Zones,
    missing_is_zero: false,
    advice: "Press less: at this force healthy tissue bleeds, and bleeding on probing has no meaning.",
    // A force that stays in the zone enters it once.
    value: |session| {
        Some(fmax(
            session.evidence.trauma as f64,
            session.evidence.floor.trauma_s.floor(),
        ))
    },
    critical: None,
};

pub(super) const DAMAGE_EVENTS: Definition = Definition {
    name: "damage_events",
    title: "entries into the damage zone",
    unit: "",
    definition: "Number of times that the force on the floor of any pocket entered the scene's zone of damage: from \
        1.96 N by default. 0 if the force was never there.",
    source: "200 g is more than any clinician pressed: Freed 1983",
    needs: Needs::Zones,
    missing_is_zero: false,
    advice: "This force injures tissue: lift the probe at the first resistance, and begin again.",
    value: |session| Some(session.evidence.damage as f64),
    critical: None,
};
