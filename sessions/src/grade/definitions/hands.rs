//! Metrics of sight, of both hands together, and of the force on a tool.

use super::{CHOSEN, Definition, Needs};

pub(super) const TARGET_VISIBLE: Definition = Definition {
    name: "target_visible",
    title: "target visible past the tongue",
    unit: "%",
    definition: "Share of the working time in which the target was visible past the tongue: rays from the operator's \
        eye reach the share `visible` of the target that the exercise sets. Working time with zones: from the first to the last moment of the probe in a pocket. \
        Working time without zones: time in which a hand holds a tool; 5 s or a quarter of the exercise is needed, \
        whichever is less. Without this time the score is 0.",
    source: "retraction and sight with the mirror are taught; share chosen for this simulator",
    needs: Needs::Target,
    missing_is_zero: true,
    advice: "Hold the tongue aside for as long as the probe works.",
    value: |session| session.visible_percent(),
    critical: None,
};

pub(super) const COORDINATION: Definition = Definition {
    name: "coordination",
    title: "mirror and probe coordination",
    unit: "%",
    definition: "Of the time with the probe in a pocket: share in which the target was visible and the mirror held the \
        tongue. Held: the force of the mirror on the tongue was 0.02 N or more, and the mirror was at most \
        `steady_mm` from its place half a second before. Without time in a pocket the score is 0.",
    source: CHOSEN,
    needs: Needs::BothHands,
    missing_is_zero: true,
    advice: "Hold the tongue with the mirror, and keep the mirror still, for as long as the probe works.",
    value: |session| session.evidence.hands.together_percent(),
    critical: None,
};

pub(super) const MIRROR_FORCE: Definition = Definition {
    name: "mirror_force",
    title: "force on the mirror",
    unit: "N",
    definition: "95th percentile of the force on the mirror, rounded up to 0.01 N, over the ticks in contact: 0.02 N or \
        more on any object. \
        Contact of 5 s or of a quarter of the exercise is needed, whichever is less; otherwise the score is 0. \
        A critical error needs 1 s of contact.",
    source: "a relaxed tongue yields at 1 to 3 N: Haptodont; limit chosen for this simulator",
    needs: Needs::Mirror,
    missing_is_zero: true,
    advice: "Hold the tongue aside gently: more force hurts, and shows no more.",
    value: |session| session.usual_force(&session.evidence.mirror),
    critical: Some(|session| session.critical_force(&session.evidence.mirror)),
};

pub(super) const MIRROR_PEAK: Definition = Definition {
    name: "mirror_peak",
    title: "peak force on the mirror",
    unit: "N",
    definition: "Largest mean of the force on the mirror over 50 ms, on any object. \
        Without a contact of 0.02 N or more the metric does not count.",
    source: CHOSEN,
    needs: Needs::Mirror,
    missing_is_zero: false,
    advice: "Approach the tongue slowly: a short hard push hurts as much as a heavy hand.",
    value: |session| session.evidence.mirror.peak(),
    critical: None,
};

pub(super) const PROBE_PEAK: Definition = Definition {
    name: "probe_peak",
    title: "peak force on the probe",
    unit: "N",
    definition: "Largest mean of the force on the probe over 50 ms, on any object: floor, tooth, gingiva or tongue. \
        Without a contact of 0.02 N or more the metric does not count.",
    source: "200 g is more than any clinician pressed: Freed 1983; here on every object that the probe touches",
    needs: Needs::Probe,
    missing_is_zero: false,
    advice: "Feel where the probe is before you press. Press tooth, gingiva and tongue as lightly as the floor.",
    value: |session| session.evidence.probe.peak(),
    critical: None,
};
