//! Metrics of motion through the air, and of time.

use super::{Definition, Needs};

pub(super) const SMOOTHNESS: Definition = Definition {
    name: "smoothness",
    title: "smoothness of moves (SPARC)",
    unit: "",
    definition: "Median spectral arc length (SPARC) of the leading tool's free moves; less negative is smoother. \
        Leading tool: the first probe, in a retraction the mirror. Free: the force on the tool is below 0.02 N, and \
        the tip is in no pocket. A move begins at a speed of 10 mm/s, and ends after 0.1 s below 4 mm/s or at a \
        contact; it takes 0.2 s and 5 mm or more. Tip low-passed at 20 Hz, spectrum up to 20 Hz, amplitude threshold \
        0.05, zero padding 2^4. Without a move the metric does not count.",
    source: "Balasubramanian 2015, J NeuroEng Rehabil 12:112; reference code siva82kb/SPARC",
    needs: Needs::Nothing,
    missing_is_zero: false,
    advice: "Move from place to place in one smooth movement, with the hand supported.",
    value: |session| session.smoothness,
    critical: None,
};

pub(super) const PATH_LENGTH: Definition = Definition {
    name: "path_length",
    title: "tip path through the air",
    unit: "mm",
    definition: "Length of the path of the leading tool's tip while the tool is free (see smoothness), low-passed at \
        20 Hz. 0 without free motion.",
    source: "economy of movement; no norm is known",
    needs: Needs::Nothing,
    missing_is_zero: false,
    advice: "Take the shortest path between two teeth.",
    value: |session| Some(session.free_path_mm()),
    critical: None,
};

pub(super) const TIME: Definition = Definition {
    name: "time",
    title: "working time",
    unit: "s",
    definition: "Time from the first to the last moment of the probe in a pocket. In an exercise without zones: time in \
        which a hand holds a tool. Pauses are left out. Without such time the metric does not count.",
    source: "time limit of the exercise",
    needs: Needs::Nothing,
    missing_is_zero: false,
    advice: "A fixed tour saves time. Never leave out a zone to be faster.",
    value: |session| session.evidence.hands.span_s(),
    critical: None,
};
