//! Metrics of zones and called depths.

use super::{Definition, Needs};
use crate::grade::sites::SiteGrade;
use crate::grade::tolerances::{EXACT_MM, WITHIN_MM};

pub(super) const ZONES_CHARTED: Definition = Definition {
    name: "zones_charted",
    title: "zones probed and called",
    unit: "%",
    definition: "Share of the zones of the exercise that were probed and then called. \
        Probed: the tip was below the gingival margin in the zone for 0.2 s or more in total. \
        Called: a depth was called after these 0.2 s; a zone with earlier calls only does not count. \
        0 % if no zone was probed and then called.",
    source: "whole circumference, six zones a tooth: SDCEP (periodontalcare.sdcep.org.uk), Boyd",
    needs: Needs::Zones,
    missing_is_zero: true,
    advice: "Probe and call every zone of the exercise, all round the tooth.",
    value: |session| session.share(|_| true, SiteGrade::is_charted),
    critical: None,
};

pub(super) const TOUR_ORDER: Definition = Definition {
    name: "tour_order",
    title: "zones called in order",
    unit: "%",
    definition: "Of the zones of the exercise that were called: share in the longest sequence of calls that follows \
        the order of the exercise. Other calls may lie between two calls of the sequence. \
        The first call of a zone counts. Without a call the score is 0.",
    source: "a fixed tour is taught so that no zone is left out; textbooks differ in the order",
    needs: Needs::Zones,
    missing_is_zero: true,
    advice: "Keep to one fixed tour, so that no zone is left out.",
    value: |session| session.tour_order(),
    critical: None,
};

pub(super) const FLOOR_REACHED: Definition = Definition {
    name: "floor_reached",
    title: "pocket floor reached",
    unit: "%",
    definition: "Of the zones of the exercise that were probed (see zones_charted), called or not: share whose reached \
        depth is at most `reached_mm` less than the prescribed depth. Reached depth: largest depth of the tip at a \
        force on the floor within the target band `force_n`, no more than 1 mm below the prescribed floor. \
        A zone without such a force counts as not reached. Without a probed zone the score is 0.",
    source: "deepest reading of each zone: SDCEP, Boyd; interproximal readings too shallow: Feng 2013",
    needs: Needs::Zones,
    missing_is_zero: true,
    advice: "The tip did not reach the floor: move it down along the tooth until the floor yields softly at the \
        taught force.",
    value: |session| session.share(|site| site.probed, |site| site.is_reached(session.set)),
    critical: None,
};

pub(super) const MISREAD: Definition = Definition {
    name: "misread",
    title: "probe band misread",
    unit: "%",
    definition: "Of the zones of the exercise that were probed and then called (see zones_charted), and whose floor was \
        reached (see floor_reached): share whose called depth does not match the tip. \
        Too shallow: the call is more than `misread_mm` less than the reached depth. \
        Too deep: the call is greater than two limits. The first is `misread_mm` more than the largest depth of the \
        tip at any force. The second is 0.6 mm more than the mean depth that the bands showed at the deepest place \
        (see angle_mid): the bands of a tilted probe show more than the depth of its tip. \
        Without such a zone the metric does not count.",
    source: "reading of the bands, apart from the place of the tip: Haptodont, doi 10.1145/3421765; LMU epub 45788",
    needs: Needs::Zones,
    missing_is_zero: false,
    advice: "The tip was on the floor, but the band was misread: look along the gingival margin, and count the bands \
        from the tip.",
    value: |session| {
        session.share(
            |site| site.is_charted() && site.is_reached(session.set),
            |site| site.is_misread(session.set),
        )
    },
    critical: None,
};

pub(super) const CALLED_EXACT: Definition = Definition {
    name: "called_exact",
    title: "depth called exactly",
    unit: "%",
    definition: "Of the zones of the exercise that were called: share whose called depth is at most 0.5 mm from the \
        prescribed depth. The last call of a zone counts, also if the zone was not probed. \
        Without a call the score is 0.",
    source: "students 34.8 % on manikins with preset depths (LMU epub 45788), 63 % in clinic (Jansen 2025)",
    needs: Needs::Zones,
    missing_is_zero: true,
    advice: "Read the depth at the margin to the nearest millimetre, while the tip rests on the floor at the taught \
        force.",
    value: |session| session.called_within(EXACT_MM),
    critical: None,
};

pub(super) const CALLED_WITHIN_1MM: Definition = Definition {
    name: "called_within_1mm",
    title: "depth called within 1 mm",
    unit: "%",
    definition: "Of the zones of the exercise that were called: share whose called depth is at most 1 mm from the \
        prescribed depth. The last call of a zone counts, also if the zone was not probed. \
        Without a call the score is 0.",
    source: "students 79.9 % (LMU epub 45788), trained examiners 97.4 % (CMN 762)",
    needs: Needs::Zones,
    missing_is_zero: true,
    advice: "Some calls are more than 1 mm off: the finding of each zone names hand or eye as the cause.",
    value: |session| session.called_within(WITHIN_MM),
    critical: None,
};

pub(super) const CALLED_BIAS: Definition = Definition {
    name: "called_bias",
    title: "mean error of called depths",
    unit: "mm",
    definition: "Mean of called depth minus prescribed depth, over the zones of the exercise that were called. \
        Positive: calls are too deep. The last call of a zone counts. Without a call the metric does not count.",
    source: "students tend to read too deep: LMU epub 45788",
    needs: Needs::Zones,
    missing_is_zero: false,
    advice: "Calls are off in one direction: too deep with a heavy hand, too shallow if the tip stops above the floor.",
    value: |session| session.mean_error_mm(),
    critical: None,
};
