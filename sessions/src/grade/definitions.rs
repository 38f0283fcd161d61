//! What is measured: one table with every metric's name, unit, definition, source, what it needs, and what to say to someone
//! who is weak there. A rubric weighs these, and carries the definitions with it into the recording.

use super::sites::SiteGrade;
use crate::exercise::{Exercise, Kind};

/// What an exercise must have for a metric to mean anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Zones to probe.
    Zones,
    /// Zones beside a neighbour.
    ProximalZones,
    /// Zones in the middle of a side.
    MidZones,
    /// A target to see past the tongue.
    Target,
    /// Both: two hands.
    BothHands,
    /// A tool that is no probe.
    Mirror,
    /// A crown to be followed.
    Crown,
    /// A probe.
    Probe,
    /// Nothing.
    Nothing,
}

impl Needs {
    /// Whether the exercise has it.
    pub fn are_met(self, exercise: &Exercise) -> bool {
        let zones = !exercise.zones.is_empty();
        let any = |proximal: bool| {
            exercise
                .tour()
                .any(|(_, site)| site.is_proximal() == proximal)
        };
        match self {
            Self::Zones => zones,
            Self::ProximalZones => any(true),
            Self::MidZones => any(false),
            Self::Target => exercise.target.is_some(),
            Self::BothHands => zones && exercise.target.is_some(),
            Self::Mirror => matches!(exercise.kind, Kind::Retraction | Kind::Bimanual),
            Self::Crown => exercise.kind == Kind::Crown,
            Self::Probe => zones || exercise.kind == Kind::Crown,
            Self::Nothing => true,
        }
    }

    /// Whether the scene has what of it the exercise asks for: a tooth that is missing there has no middle of a side.
    pub fn are_there(self, sites: &[SiteGrade]) -> bool {
        let any = |proximal: bool| {
            let mut asked = sites.iter().filter(|site| site.asked);
            asked.any(|site| site.site.is_proximal() == proximal)
        };
        match self {
            Self::ProximalZones => any(true),
            Self::MidZones => any(false),
            _ => true,
        }
    }

    /// Whether who grades by a metric with this need could expect the exercise to have it. (Of zones some kind is enough: who
    /// asks for the middle of a side only is not graded on what is beside a neighbour.)
    pub fn may_be_weighed(self, exercise: &Exercise) -> bool {
        match self {
            Self::ProximalZones | Self::MidZones => Self::Zones.are_met(exercise),
            other => other.are_met(exercise),
        }
    }

    /// What is missing where it is not met, for people.
    pub fn what(self) -> &'static str {
        match self {
            Self::Zones => "zones to probe",
            Self::ProximalZones => "zones beside a neighbour",
            Self::MidZones => "zones in the middle of a side",
            Self::Target => "a target to see past the tongue",
            Self::BothHands => "work for both hands",
            Self::Mirror => "work for a mirror",
            Self::Crown => "a crown to follow",
            Self::Probe => "work for a probe",
            Self::Nothing => "nothing",
        }
    }
}

/// A metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Definition {
    /// In rubrics and JSON.
    pub name: &'static str,
    /// For people.
    pub title: &'static str,
    /// Unit; empty for a pure number.
    pub unit: &'static str,
    /// What exactly is measured.
    pub definition: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// When it applies.
    pub needs: Needs,
    /// Whether it scores nothing where there is nothing to measure, because what it measures was asked for; else it is left out.
    pub missing_is_zero: bool,
    /// What to practise.
    pub advice: &'static str,
}

const CHOSEN: &str = "chosen for this simulator";

/// All metrics, in the order of pages.
pub const METRICS: [Definition; 31] = [
    Definition {
        name: "zones_charted",
        title: "zones probed and called",
        unit: "%",
        definition: "Share of the zones asked for in which the tip was below the margin for 0.2 s or more and of which a depth was called then (a call from before is hearsay).",
        source: "whole circumference, six zones a tooth: SDCEP periodontalcare.sdcep.org.uk; Boyd",
        needs: Needs::Zones,
        missing_is_zero: true,
        advice: "Probe and call every zone asked for, the whole way round the tooth.",
    },
    Definition {
        name: "tour_order",
        title: "order of the tour",
        unit: "%",
        definition: "Of the zones asked for that were called: the share that lies in the longest run called in the order of the exercise.",
        source: "a fixed tour is taught so that no zone is left out; texts differ, the order is the exercise's",
        needs: Needs::Zones,
        missing_is_zero: true,
        advice: "Keep to one fixed tour: it is how no zone is forgotten.",
    },
    Definition {
        name: "floor_reached",
        title: "floor reached",
        unit: "%",
        definition: "Of the zones asked for that were probed (see zones_charted), called or not: the share in which the tip's deepest place, at a force on the floor inside the target band and no more than 1 mm below the prescribed one, came within `reached_mm` of the prescribed depth.",
        source: "deepest reading of each zone: SDCEP, Boyd; interproximal under-reading: Feng 2013",
        needs: Needs::Zones,
        missing_is_zero: true,
        advice: "Go on along the tooth until the floor yields softly at the taught force: the tip did not get there.",
    },
    Definition {
        name: "misread",
        title: "band misread",
        unit: "%",
        definition: "Of the zones whose floor was reached and whose depth was called after the tip had been there: the share whose called depth is more than `misread_mm` less than the depth that the tip reached at a correct force, or more than both that beyond the deepest that it was at any, and 0.6 mm beyond what the bands showed at the deepest place (see angle_mid) in the mean: a tilted probe shows more.",
        source: "reading the bands at the margin, apart from where the tip was: Haptodont doi 10.1145/3421765; LMU epub 45788",
        needs: Needs::Zones,
        missing_is_zero: false,
        advice: "The tip was on the floor, the mark was read wrong: look along the margin, count the bands from the tip.",
    },
    Definition {
        name: "called_exact",
        title: "depth called exactly",
        unit: "%",
        definition: "Of the zones asked for that were called: the share whose called depth is the whole millimetre nearest to the prescribed one (at a tie either).",
        source: "students 34.8 % on manikins with preset truth (LMU epub 45788), 63 % in clinic (Jansen 2025)",
        needs: Needs::Zones,
        missing_is_zero: true,
        advice: "Read to the nearest millimetre, at the margin, with the tip on the floor under the taught force.",
    },
    Definition {
        name: "called_within_1mm",
        title: "depth called within 1 mm",
        unit: "%",
        definition: "Of the zones asked for that were called: the share whose called depth is within 1 mm of the prescribed one.",
        source: "students 79.9 % (LMU epub 45788), trained examiners 97.4 % (CMN 762)",
        needs: Needs::Zones,
        missing_is_zero: true,
        advice: "Called depths are more than 1 mm off: see for each zone whether hand or eye was at fault.",
    },
    Definition {
        name: "called_bias",
        title: "mean error of calls",
        unit: "mm",
        definition: "Mean of called less prescribed depth over the zones asked for that were called: positive reads too deep.",
        source: "students tend to over-read: LMU epub 45788",
        needs: Needs::Zones,
        missing_is_zero: false,
        advice: "Calls are off in one direction: too deep with a heavy hand, too shallow short of the floor.",
    },
    Definition {
        name: "touches_too_light",
        title: "touches too light",
        unit: "%",
        definition: "Share of the touches of the floor whose largest force stays under the target band. A touch begins at 0.02 N on the floor and ends when the force has been under half of the touch's largest for 50 ms, or the tip leaves the tooth; the next begins at twice the least force since.",
        source: "recommended 10 to 25 g: Gehrig, Boyd, Polson 1980, Lang 1991",
        needs: Needs::Zones,
        missing_is_zero: true,
        advice: "Press until the floor is felt clearly; a touch that is too light reads too shallow.",
    },
    Definition {
        name: "touches_too_heavy",
        title: "touches too heavy",
        unit: "%",
        definition: "Share of the touches of the floor (see touches_too_light) whose largest force is more than 0.05 N above the target band: what a hand's tremor adds is forgiven.",
        source: "\"a strong possibility of traumatising healthy tissue above 0.25 N\": Karayiannis 1992",
        needs: Needs::Zones,
        missing_is_zero: false,
        advice: "Lighten the hand: the taught force is enough, more reads too deep and makes healthy tissue bleed.",
    },
    Definition {
        name: "readings_held",
        title: "floor held while read",
        unit: "%",
        definition: "Of the zones asked for that were probed and then called (see zones_charted): the share in which a force of the target band or more stood on the floor for 0.5 s or more, forces under it for 50 ms or less forgiven.",
        source: "the base must yield softly before a depth is read: Boyd, LWW; how long is chosen for this simulator",
        needs: Needs::Zones,
        missing_is_zero: true,
        advice: "Let the tip rest on the floor for half a second at the taught force, and read the band meanwhile.",
    },
    Definition {
        name: "readings_too_heavy",
        title: "read under too much force",
        unit: "%",
        definition: "Of the zones asked for that were probed and then called (see zones_charted): the share in which a force more than 0.05 N above the target band stood on the floor for 0.2 s or more, lighter ones for 50 ms or less forgiven: how light the strokes between were is no matter.",
        source: "as touches_too_heavy; how long is chosen for this simulator",
        needs: Needs::Zones,
        missing_is_zero: false,
        advice: "Let the hand rest while the depth is read: more than the taught force presses the tip in, and shows too much.",
    },
    Definition {
        name: "force_in_band",
        title: "time on the floor in the band",
        unit: "%",
        definition: "Of the time with 0.02 N or more on the floor: the share with a force inside the target band.",
        source: "as touches_too_light; strokes pass through lighter forces, so that 100 % is no aim",
        needs: Needs::Zones,
        missing_is_zero: false,
        advice: "Hold the taught force while the band is read.",
    },
    Definition {
        name: "trauma_events",
        title: "trauma, times",
        unit: "",
        definition: "Entries of the force on a floor into the scene's zone of trauma (0.5 N by default), but at least one for every second that it is there in all.",
        source: "bleeding of healthy gingiva grows with force: Lang 1991",
        needs: Needs::Zones,
        missing_is_zero: false,
        advice: "At this force healthy tissue bleeds, and bleeding on probing says nothing any more.",
    },
    Definition {
        name: "damage_events",
        title: "damage, times",
        unit: "",
        definition: "Entries of the force on a floor into the scene's zone of damage (1.96 N by default).",
        source: "200 g is above all that clinicians press: Freed 1983",
        needs: Needs::Zones,
        missing_is_zero: false,
        advice: "This force damages: lift the hand at the first resistance and begin again.",
    },
    Definition {
        name: "angle_mid",
        title: "parallel at mid sites",
        unit: "%",
        definition: "Of the mid zones asked for that were probed: the share where the working end was within the exercise's `mid_tilt_deg` of the tooth's axis for at least half of the time that the tip was within 0.3 mm of its deepest place at a correct force (at any where there was none).",
        source: "parallel to the long axis: Boyd; rdhmag 14285040",
        needs: Needs::MidZones,
        missing_is_zero: true,
        advice: "In the middle of a side hold the probe parallel to the tooth's long axis.",
    },
    Definition {
        name: "angle_proximal",
        title: "tilted into the col",
        unit: "%",
        definition: "Of the proximal zones asked for that were probed: the share where the working end was tilted towards the neighbour and the midline by the exercise's `proximal_tilt_deg`, and by no more than `mid_tilt_deg` any other way, for at least half of the time at the deepest place (see angle_mid).",
        source: "tilt under the contact into the col: inspiredhygiene.com; rdhmag; 10 to 15 degrees are taught",
        needs: Needs::ProximalZones,
        missing_is_zero: true,
        advice: "At the contact tilt the probe so that the tip passes under it into the col, and no other way: upright it reads too shallow, tilted outwards too.",
    },
    Definition {
        name: "walking_step",
        title: "walking step",
        unit: "mm",
        definition: "Median distance along the tooth between neighbouring places where the floor was touched, side by side of each tooth asked for; places nearer than 0.4 mm are one; the way of a touch that goes 2 mm along the tooth or farther without being lifted is a step as well.",
        source: "steps of 1 mm, 1 to 2 mm in other texts: Gehrig (LWW)",
        needs: Needs::Zones,
        missing_is_zero: false,
        advice: "Walk on by a millimetre between two touches; what lies between is not known.",
    },
    Definition {
        name: "withdrawals",
        title: "withdrawals between zones",
        unit: "",
        definition: "Times that the tip came out of the pocket between two zones of one side of a tooth in which it stayed for 0.2 s, on its way to a zone on whose floor a force of the target band or more had not stood so long in one visit: to look again at one is no withdrawal.",
        source: "repeated withdrawal traumatises: Gehrig (LWW); spot probing as an error: dimensionsofdentalhygiene.com",
        needs: Needs::Zones,
        missing_is_zero: false,
        advice: "Stay in the pocket between the zones of a side: bob, do not pull out.",
    },
    Definition {
        name: "recession_within_1mm",
        title: "recession called within 1 mm",
        unit: "%",
        definition: "Where recession was called at all, or the rubric's `ask_recession` is set: of the zones asked for that were probed before anything was called of them, the share in which it was called within 1 mm of the prescribed one (positive: margin below the cemento-enamel junction).",
        source: "students 94.4 %: LMU epub 45788",
        needs: Needs::Zones,
        missing_is_zero: false,
        advice: "Measure the margin from the cemento-enamel junction, and mind the sign: recession is positive.",
    },
    Definition {
        name: "bleeding_agreement",
        title: "bleeding called as it was",
        unit: "%",
        definition: "Where bleeding was called at all, or the rubric's `ask_bleeding` is set: of the zones asked for that were probed before anything was called of them, the share in which it was called as it was in the replay; where nothing was said of it, it was not.",
        source: "students agree with staff on 86 %: synapsesocial 69e07e",
        needs: Needs::Zones,
        missing_is_zero: false,
        advice: "Look back at each zone after the probe has passed: blood comes late.",
    },
    Definition {
        name: "furcation_agreement",
        title: "furcation called as it is",
        unit: "%",
        definition: "Where furcation was called at all, or the rubric's `ask_furcation` is set: of the middles of molars' sides asked for that were probed before anything was called of them, the share in which it was called as the patient's chart has it (Hamp 1975: 0 to 3); nothing where the recording has no patient.",
        source: "students' furcation calls were not acceptable: LMU epub 45788; classes: Hamp 1975",
        needs: Needs::MidZones,
        missing_is_zero: false,
        advice: "Feel for the entrance between the roots in the middle of a molar's side, from the cheek and from the tongue.",
    },
    Definition {
        name: "target_visible",
        title: "target seen past the tongue",
        unit: "%",
        definition: "Share of the time in which the target was visible past the tongue, by rays from the eye: between the first and the last moment of the probe in a pocket; without zones, while a hand holds a tool, which it must for 5 s or a quarter of the exercise's length.",
        source: "retraction and sight with the mirror are taught; share chosen for this simulator",
        needs: Needs::Target,
        missing_is_zero: true,
        advice: "Hold the tongue aside for as long as the probe is at work.",
    },
    Definition {
        name: "coordination",
        title: "both hands at once",
        unit: "%",
        definition: "Share of the time of the probe in a pocket in which the target was visible and the mirror held the tongue: it bore on it with 0.02 N or more and was no farther than `steady_mm` from where it was half a second before.",
        source: CHOSEN,
        needs: Needs::BothHands,
        missing_is_zero: true,
        advice: "Hold the tongue with the mirror, and keep that hand still, for as long as the probe's hand works.",
    },
    Definition {
        name: "mirror_force",
        title: "force of the mirror",
        unit: "N",
        definition: "95th percentile of the force on the mirror while it touches something (0.02 N or more); nothing where that is less than 5 s and less than a quarter of the exercise's length (but a critical error is looked for in it from 1 s on).",
        source: "a relaxed tongue gives way at 1 to 3 N: Haptodont; limit chosen for this simulator",
        needs: Needs::Mirror,
        missing_is_zero: true,
        advice: "Hold the tongue aside gently: more force hurts and shows no more.",
    },
    Definition {
        name: "mirror_peak",
        title: "largest push of the mirror",
        unit: "N",
        definition: "Largest mean of the force on the mirror over 50 ms.",
        source: CHOSEN,
        needs: Needs::Mirror,
        missing_is_zero: false,
        advice: "A single stab hurts as much as a heavy hand: come to the tongue slowly.",
    },
    Definition {
        name: "probe_peak",
        title: "largest push of the probe",
        unit: "N",
        definition: "Largest mean of the force on the probe over 50 ms, on whatever it is: floor, tooth, gum or tongue.",
        source: "200 g is above all that clinicians press: Freed 1983; here over all that the probe touches",
        needs: Needs::Probe,
        missing_is_zero: false,
        advice: "Feel where the probe is before you push: tooth, gum and tongue are pressed as lightly as the floor.",
    },
    Definition {
        name: "crown_covered",
        title: "way round the crown",
        unit: "%",
        definition: "Share of twelve sectors of 30 degrees about the crown's middle in which the probe's tip, 3 mm or more from it and no more than 2 mm outside of the crown's box, bore on something with 0.02 N or more for 20 ms or more.",
        source: "all of the crown is asked for; sectors chosen for this simulator",
        needs: Needs::Crown,
        missing_is_zero: true,
        advice: "Go the whole way round the crown, not only where it is easy.",
    },
    Definition {
        name: "contact_force",
        title: "force along the crown",
        unit: "N",
        definition: "95th percentile of the force on the probe while it touches something (0.02 N or more); nothing where that is less than 5 s and less than a quarter of the exercise's length (but a critical error is looked for in it from 1 s on).",
        source: "light touch is taught; limit chosen for this simulator",
        needs: Needs::Crown,
        missing_is_zero: true,
        advice: "Let the tip glide: a light touch tells more.",
    },
    Definition {
        name: "smoothness",
        title: "smoothness (SPARC)",
        unit: "",
        definition: "Median spectral arc length of the leading tool's free-space moves: speed of the tip low-passed at 20 Hz, spectrum up to 20 Hz, amplitude threshold 0.05, padding 2^4. Less negative is smoother.",
        source: "Balasubramanian 2015, J NeuroEng Rehabil 12:112; reference code siva82kb/SPARC",
        needs: Needs::Nothing,
        missing_is_zero: false,
        advice: "Move from place to place in one flowing movement, with the hand rested.",
    },
    Definition {
        name: "path_length",
        title: "path through the air",
        unit: "mm",
        definition: "Way of the leading tool's tip, low-passed at 20 Hz, while it touches nothing.",
        source: "economy of movement; no norm is known",
        needs: Needs::Nothing,
        missing_is_zero: false,
        advice: "Take the shortest way between two teeth.",
    },
    Definition {
        name: "time",
        title: "time",
        unit: "s",
        definition: "From the first to the last moment of the probe in a pocket; without zones, the time that a hand held a tool. (A pause takes no time, and what the hands do in it counts for nothing; what is called then is called.)",
        source: "limit of the exercise",
        needs: Needs::Nothing,
        missing_is_zero: false,
        advice: "Speed comes with a fixed tour; never at the cost of a zone.",
    },
];

/// The metric of that name.
pub fn find(name: &str) -> Option<&'static Definition> {
    METRICS.iter().find(|metric| metric.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_metric_has_a_name_of_its_own_and_words() {
        for (k, metric) in METRICS.iter().enumerate() {
            assert_eq!(METRICS.iter().position(|m| m.name == metric.name), Some(k));
            for words in [
                metric.title,
                metric.definition,
                metric.source,
                metric.advice,
            ] {
                assert!(words.len() > 3, "{}: `{words}`", metric.name);
            }
            assert_eq!(find(metric.name), Some(metric));
        }
        assert_eq!(find("charm"), None);
    }

    #[test]
    fn numbers_in_definitions_are_those_that_are_measured_by() {
        use crate::grade::{crown, hands, sites, touches, values, zones};
        let says = |name: &str, what: String| {
            let text = find(name).map_or("", |metric| metric.definition);
            assert!(text.contains(&what), "{name}: `{what}` in `{text}`");
        };
        let mm = |metres: f64| format!("{} mm", (metres * 1e5).round() / 1e2);
        says("zones_charted", format!("for {} s", zones::STAYED));
        says(
            "floor_reached",
            format!("no more than {} below", mm(zones::BEYOND)),
        );
        says("withdrawals", format!("for {} s", zones::STAYED));
        says("misread", format!("{} mm beyond what", sites::READ_MM));
        says(
            "angle_mid",
            format!("within {} of its deepest", mm(zones::AT_FLOOR)),
        );
        says("touches_too_light", format!("at {} N", touches::BEGINS));
        says(
            "touches_too_light",
            format!("largest for {} ms", touches::FOR * 1e3),
        );
        says(
            "walking_step",
            format!("goes {} along", mm(touches::DRAGGED)),
        );
        says("readings_held", format!("for {} s", sites::HELD_S));
        says("readings_held", format!("for {} ms", zones::LAPSE * 1e3));
        says("readings_too_heavy", format!("for {} s", sites::PRESSED_S));
        says(
            "readings_too_heavy",
            format!("{} N above", values::FORGIVEN),
        );
        says("touches_too_heavy", format!("{} N above", values::FORGIVEN));
        says("mirror_peak", format!("over {} ms", hands::PEAK_S * 1e3));
        says("probe_peak", format!("over {} ms", hands::PEAK_S * 1e3));
        says("contact_force", format!("less than {} s", values::LEAST_S));
        says("mirror_force", format!("from {} s on", values::CRITICAL_S));
        says(
            "crown_covered",
            format!("{} or more from it", mm(crown::OFF_AXIS)),
        );
        says(
            "crown_covered",
            format!("{} ms or more", crown::LEAST_S * 1e3),
        );
    }

    #[test]
    fn metrics_apply_where_the_exercise_has_what_they_need() {
        let names = |exercise: &str| -> Vec<&str> {
            let all = Exercise::built_in();
            let exercise = all.iter().find(|one| one.name == exercise);
            let exercise = exercise.unwrap_or_else(|| panic!("built in"));
            let apply = METRICS.iter().filter(|m| m.needs.are_met(exercise));
            apply.map(|m| m.name).collect()
        };
        assert_eq!(
            names("retraction"),
            [
                "target_visible",
                "mirror_force",
                "mirror_peak",
                "smoothness",
                "path_length",
                "time"
            ]
        );
        assert_eq!(
            names("crown"),
            [
                "probe_peak",
                "crown_covered",
                "contact_force",
                "smoothness",
                "path_length",
                "time"
            ]
        );
        assert!(!names("probing").contains(&"coordination"));
        assert_eq!(names("bimanual").len(), METRICS.len() - 2);
    }

    /// Titles, definitions, sources and advice by their version. Whoever mends a sentence appends a row with the next version.
    const WORDS: &[(u32, &str)] = &[(1, "2d16dc6fa59a7ff2")];

    #[test]
    fn the_words_of_all_metrics_are_those_of_the_last_version() {
        let mut hasher = blake3::Hasher::new();
        for metric in METRICS {
            for words in [
                metric.title,
                metric.definition,
                metric.source,
                metric.advice,
            ] {
                hasher.update(&(words.len() as u64).to_le_bytes());
                hasher.update(words.as_bytes());
            }
        }
        let (version, known) = WORDS[WORDS.len() - 1];
        let found = &hasher.finalize().to_hex()[..16];
        assert_eq!(
            found,
            known,
            "the words changed: append the row ({}, \"{found}\") to `WORDS`",
            version + 1
        );
        let versions = WORDS.iter().map(|(version, _)| *version);
        assert!(versions.eq(1..=WORDS.len() as u32));
    }
}
