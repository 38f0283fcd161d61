//! Metrics of findings that are called besides the depth: recession, bleeding, furcation.

use super::{Definition, Needs};
use crate::grade::tolerances::WITHIN_MM;

pub(super) const RECESSION_WITHIN_1MM: Definition = Definition {
    name: "recession_within_1mm",
    title: "recession called within 1 mm",
    unit: "%",
    definition: "Of the zones of the exercise that were probed (see zones_charted), without zones that were called before \
        probing only: share whose called recession is at most 1 mm from the prescribed one. Recession is positive if \
        the margin lies below the cemento-enamel junction. A zone without a call of recession counts as wrong. \
        Without any call of recession the metric does not count, unless the rubric sets `ask_recession`.",
    source: "students 94.4 %: LMU epub 45788",
    needs: Needs::Zones,
    missing_is_zero: false,
    advice: "Measure the margin from the cemento-enamel junction. Recession is positive if the margin lies below it.",
    value: |session| {
        session.share_once_called(
            session.set.ask_recession,
            |_| true,
            |site| site.recession_called_mm.is_some(),
            |site| {
                let both = site.recession_called_mm.zip(site.recession_truth_mm);
                both.is_some_and(|(said, is)| (f64::from(said) - is).abs() <= WITHIN_MM)
            },
        )
    },
    critical: None,
};

pub(super) const BLEEDING_AGREEMENT: Definition = Definition {
    name: "bleeding_agreement",
    title: "bleeding called correctly",
    unit: "%",
    definition: "Of the zones of the exercise that were probed (see zones_charted), without zones that were called before \
        probing only: share whose called bleeding is that of the replay, from any cause. \
        A zone without a call of bleeding counts as wrong. \
        Without any call of bleeding the metric does not count, unless the rubric sets `ask_bleeding`.",
    source: "students agree with staff in 86 %: synapsesocial 69e07e",
    needs: Needs::Zones,
    missing_is_zero: false,
    advice: "Look back at each zone after the probe has left it: bleeding appears late.",
    value: |session| {
        session.share_once_called(
            session.set.ask_bleeding,
            |_| true,
            |site| site.bleeding_called.is_some(),
            |site| site.bleeding_called == Some(site.bled),
        )
    },
    critical: None,
};

pub(super) const FURCATION_AGREEMENT: Definition = Definition {
    name: "furcation_agreement",
    title: "furcation called correctly",
    unit: "%",
    definition: "Of the zones of the exercise in the middle of a molar's side that were probed (see zones_charted), \
        without zones that were called before probing only: share whose called furcation grade is that of the \
        patient's chart (Hamp 1975: 0 to 3). A zone without a call of furcation counts as wrong. \
        Without any call of furcation the metric does not count, unless the rubric sets `ask_furcation`. \
        Without a patient in the recording the metric does not count.",
    source: "students' calls of furcation were not acceptable: LMU epub 45788; grades: Hamp 1975",
    needs: Needs::MidZones,
    missing_is_zero: false,
    advice: "Feel for the entrance between the roots in the middle of a molar's side, buccally and lingually.",
    value: |session| {
        session.share_once_called(
            session.set.ask_furcation,
            |site| site.furcation_truth.is_some(),
            |site| site.furcation_called.is_some(),
            |site| site.furcation_called == site.furcation_truth,
        )
    },
    critical: None,
};
