//! Zone by zone: the truth, what the tip reached, what the student called, and what that says of the hand and of the eye.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};
use sulcus_core::Scene;
use sulcus_core::math::fmax;
use sulcus_core::tissue::gingiva::{Prescribed, Site};

use super::evidence::Evidence;
use super::patient::PatientChart;
use super::rubric::Settings;
use super::stats::rounded;
use super::values::FORGIVEN;
use crate::exercise::Exercise;
use crate::exercise::events::call::Call;
use crate::exercise::events::pocket;

/// A band is read to the nearest millimetre, give or take a tenth, mm.
pub const READ_MM: f64 = 0.6;
/// Shortest that a tip rests on the floor while a band is read, seconds. Chosen: a look from the floor's feel to the margin.
pub const HELD_S: f64 = 0.5;
/// Time from which a force that is too heavy is no tremor's, seconds. Chosen: two periods of the fastest.
pub const PRESSED_S: f64 = 0.2;
/// What is left of a tie after conversion to millimetres.
const TIE: f64 = 1e-9;

/// What a zone comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// The tip reached the floor, and the depth was called as it is, within 1 mm, and not by way of a heavy or a tilted hand.
    Right,
    /// Neither probed nor called.
    Missed,
    /// Called without the tip having been there.
    NotProbed,
    /// Probed, and not called.
    NotCalled,
    /// The tip never reached the floor at a correct force.
    NeverReachedFloor,
    /// The tip reached the floor; what was called is not where it was.
    Misread,
    /// The tip reached the floor; what was called is where it was under too much force.
    ReadTooHeavy,
    /// The tip reached the floor, and what was called is what a tilted probe's bands showed: more than 1 mm off, or less and the tilt was wrong.
    ReadTilted,
    /// The tip reached the floor, and what was called is where it was; yet it is more than 1 mm off.
    Off,
}

impl Finding {
    /// In words, for people.
    pub fn words(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Missed => "missed",
            Self::NotProbed => "called, not probed first",
            Self::NotCalled => "not called",
            Self::NeverReachedFloor => "never reached the floor",
            Self::Misread => "misread the band",
            Self::ReadTooHeavy => "read under too much force",
            Self::ReadTilted => "read along a tilted probe",
            Self::Off => "more than 1 mm off",
        }
    }
}

fn site_name<S: Serializer>(site: &Site, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(site.name())
}

/// One zone. Lengths in millimetres to a hundredth, forces in newtons and times in seconds to a thousandth, angles in degrees to a tenth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SiteGrade {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Which zone.
    #[serde(serialize_with = "site_name")]
    pub site: Site,
    /// Whether the exercise asks for it.
    pub asked: bool,
    /// Whether the tip was in it, and not only passing.
    pub probed: bool,
    /// Prescribed depth; null where the scene prescribes none.
    pub truth_mm: Option<f64>,
    /// Deepest reach of the tip at a force inside the target band; null where there was none.
    pub measured_mm: Option<f64>,
    /// What was called last; null where nothing was.
    pub called_mm: Option<u8>,
    /// Deepest that the tip was at any force; null where it never was.
    pub deepest_mm: Option<f64>,
    /// Mean of what the bands showed below the margin within 0.3 mm of the deepest place: more than the depth where the probe is
    /// tilted; null where the tip never was.
    pub shown_mm: Option<f64>,
    /// Largest force on the floor; null where the tip never was.
    pub max_force_n: Option<f64>,
    /// Longest that a force of the target band or more stood on the floor, seconds; null where the tip never was.
    pub held_s: Option<f64>,
    /// Longest that one heavier than the band by more than 0.05 N did, seconds; null where the tip never was.
    pub pressed_s: Option<f64>,
    /// Mean tilt of the working end against the tooth's axis within 0.3 mm of the deepest place; null where the tip never was.
    pub tilt_deg: Option<f64>,
    /// And how far of it points into the col; null in the middle of a side.
    pub into_col_deg: Option<f64>,
    /// Whether the tilt was as the exercise asks for over at least half of that time.
    pub tilt_right: Option<bool>,
    /// Prescribed recession: positive where the margin is below the cemento-enamel junction.
    pub recession_truth_mm: Option<f64>,
    /// What was called of it.
    pub recession_called_mm: Option<i8>,
    /// Whether it bled in the replay.
    pub bled: bool,
    /// What was called of that.
    pub bleeding_called: Option<bool>,
    /// Furcation that the patient's chart says, in the middle of a molar's side (Hamp: 0 to 3); null elsewhere, and where the recording
    /// has no patient.
    pub furcation_truth: Option<u8>,
    /// What was called of it.
    pub furcation_called: Option<u8>,
    /// What it comes to.
    pub finding: Finding,
}

impl SiteGrade {
    /// Whether the middle of a molar's side: what has a furcation in a lower jaw.
    fn is_furcation(tooth: u8, site: Site) -> bool {
        !site.is_proximal() && tooth % 10 >= 6
    }

    /// Whether the tip was in it, and nothing was called of it before: a guess is no reading.
    pub fn is_probed_first(&self) -> bool {
        self.probed && self.finding != Finding::NotProbed
    }

    /// Whether it was called after the tip had been there: a call from before is hearsay.
    pub fn is_charted(&self) -> bool {
        use Finding::{Missed, NotCalled, NotProbed};
        self.probed && !matches!(self.finding, Missed | NotProbed | NotCalled)
    }

    /// Called less prescribed, mm.
    pub fn error_mm(&self) -> Option<f64> {
        Some(f64::from(self.called_mm?) - self.truth_mm?)
    }

    /// Whether the tip came so near to the prescribed depth at a correct force.
    pub fn is_reached(&self, set: &Settings) -> bool {
        let both = self.measured_mm.zip(self.truth_mm);
        both.is_some_and(|(measured, truth)| measured >= truth - set.reached_mm - TIE)
    }

    /// Whether the tip was pressed into the floor for longer than a tremor does.
    pub fn is_pressed(&self) -> bool {
        self.pressed_s
            .is_some_and(|pressed| pressed >= PRESSED_S - TIE)
    }

    /// Whether the tip rested on the floor for as long as it takes to read a band.
    pub fn is_held(&self) -> bool {
        self.held_s.is_some_and(|held| held >= HELD_S - TIE)
    }

    /// Whether what was called is nowhere near where the tip was.
    pub fn is_misread(&self, set: &Settings) -> bool {
        let (Some(measured), Some(called)) = (self.measured_mm, self.called_mm) else {
            return false;
        };
        let called = f64::from(called);
        // Who reads what a tilted probe's bands show has not misread them.
        let deepest = self.deepest_mm.unwrap_or(measured) + set.misread_mm;
        let shown = self.shown_mm.unwrap_or(measured) + READ_MM;
        called < measured - set.misread_mm - TIE || called > fmax(deepest, shown) + TIE
    }

    fn find(&self, stayed: bool, set: &Settings) -> Finding {
        let Some(called) = self.called_mm else {
            return if stayed {
                Finding::NotCalled
            } else {
                Finding::Missed
            };
        };
        if !stayed {
            return Finding::NotProbed;
        }
        let measured = match self.measured_mm {
            Some(measured) if self.is_reached(set) => measured,
            _ => return Finding::NeverReachedFloor,
        };
        if self.is_misread(set) {
            return Finding::Misread;
        }
        let near = self.error_mm().is_none_or(|error| error.abs() <= 1.0 + TIE);
        let above = |mm: f64| f64::from(called) > mm + set.misread_mm + TIE;
        if !above(measured) {
            return if near { Finding::Right } else { Finding::Off };
        }
        // What was called is not where a correct force brings the tip: a fault of the hand explains it, or it would be misread. By less
        // than a millimetre it is one only where the hand was at fault.
        let heavy = || {
            let most = set.force_n[1] + FORGIVEN;
            self.max_force_n.is_some_and(|force| force > most)
        };
        let tilted = || self.tilt_right == Some(false);
        match self.deepest_mm {
            Some(deepest) if above(deepest) => {
                // (The bands were read at a correct force: how heavy the hand was elsewhere is no matter.)
                if near && !tilted() {
                    Finding::Right
                } else {
                    Finding::ReadTilted
                }
            }
            _ if near && !heavy() => Finding::Right,
            _ => Finding::ReadTooHeavy,
        }
    }
}

/// What a scene prescribes at a site of a tooth.
pub fn prescribed(scene: &Scene, tooth: u8, site: Site) -> Option<Prescribed> {
    let pockets = pocket::all(scene);
    let pocket = pockets.iter().find(|pocket| pocket.fdi == tooth)?;
    Some(*pocket.gingiva(scene)?.prescribed(site))
}

/// What was called of a zone.
#[derive(Clone, Copy)]
struct Heard {
    call: Call,
    /// Whether some of it was called after the tip had been there.
    felt: bool,
}

/// The zones asked for that the scene has, in the order of the exercise, then what else was called, by tooth and site.
pub fn sites(
    scene: &Scene,
    exercise: &Exercise,
    evidence: &Evidence,
    calls: &[(u64, Call)],
    patient: Option<&PatientChart>,
    set: &Settings,
) -> Vec<SiteGrade> {
    let mut called: BTreeMap<(u8, Site), Heard> = BTreeMap::new();
    for (tick, call) in calls {
        let before = called.get(&(call.tooth, call.site)).copied();
        let stayed = evidence.zones.of(call.tooth, call.site);
        let stayed = stayed.and_then(|seen| seen.stayed_at);
        let felt = stayed.is_some_and(|since| *tick >= since);
        // Who calls a site again corrects what is said again, and nothing else.
        let kept = before.map_or(*call, |before| before.call);
        let merged = Call {
            recession_mm: call.recession_mm.or(kept.recession_mm),
            bleeding: call.bleeding.or(kept.bleeding),
            furcation: call.furcation.or(kept.furcation),
            ..*call
        };
        let heard = Heard {
            call: merged,
            felt: felt || before.is_some_and(|before| before.felt),
        };
        called.insert((call.tooth, call.site), heard);
    }
    let mut asked: Vec<(u8, Site)> = Vec::new();
    for zone in exercise.tour() {
        if !asked.contains(&zone) && prescribed(scene, zone.0, zone.1).is_some() {
            asked.push(zone);
        }
    }
    let more = called.keys().filter(|zone| !asked.contains(zone));
    let all: Vec<((u8, Site), bool)> = (asked.iter().map(|zone| (*zone, true)))
        .chain(more.map(|zone| (*zone, false)))
        .collect();
    let grade = |((tooth, site), asked)| {
        let call = called.get(&(tooth, site));
        let mut grade = one(scene, (tooth, site, asked), evidence, call, set);
        let said = patient.filter(|_| SiteGrade::is_furcation(tooth, site));
        grade.furcation_truth = said.map(|chart| chart.furcation(tooth, site.is_buccal()));
        grade
    };
    all.into_iter().map(grade).collect()
}

fn one(
    scene: &Scene,
    (tooth, site, asked): (u8, Site, bool),
    evidence: &Evidence,
    heard: Option<&Heard>,
    set: &Settings,
) -> SiteGrade {
    let mm = |metres: f64| rounded(metres * 1e3, 2);
    let truth = prescribed(scene, tooth, site);
    let seen = evidence.zones.of(tooth, site);
    let stood = evidence.zones.stood(tooth, site);
    let call = heard.map(|heard| &heard.call);
    let mut grade = SiteGrade {
        tooth,
        site,
        asked,
        probed: seen.is_some_and(|seen| seen.stayed_at.is_some()),
        truth_mm: truth.map(|truth| mm(truth.depth)),
        measured_mm: seen.and_then(|seen| seen.measured).map(mm),
        called_mm: call.map(|call| call.depth_mm),
        deepest_mm: seen.map(|seen| mm(seen.deepest)),
        shown_mm: stood.map(|stood| mm(stood.shown())),
        max_force_n: seen.map(|seen| rounded(seen.max_force, 3)),
        held_s: seen.map(|seen| rounded(seen.held, 3)),
        pressed_s: seen.map(|seen| rounded(seen.pressed, 3)),
        tilt_deg: stood.map(|stood| rounded(stood.tilt().to_degrees(), 1)),
        into_col_deg: stood
            .filter(|_| site.is_proximal())
            .map(|stood| rounded(stood.towards_col().to_degrees(), 1)),
        tilt_right: stood.map(|stood| stood.is_right()),
        recession_truth_mm: truth.map(|truth| mm(truth.recession)),
        recession_called_mm: call.and_then(|call| call.recession_mm),
        bled: evidence.bled.contains(&(tooth, site)),
        bleeding_called: call.and_then(|call| call.bleeding),
        furcation_truth: None,
        furcation_called: call.and_then(|call| call.furcation),
        finding: Finding::Missed,
    };
    let heard_before = heard.is_some_and(|heard| !heard.felt);
    grade.finding = grade.find(grade.probed && !heard_before, set);
    grade
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grade::test_help::{SET, zone as made};

    fn zone(measured: Option<f64>, deepest: f64, called: Option<u8>) -> SiteGrade {
        SiteGrade {
            deepest_mm: Some(deepest),
            ..made(Site::Buccal, 4.0, measured, called)
        }
    }

    #[test]
    fn the_hand_and_the_eye_are_told_apart() {
        let find = |measured, deepest, called| zone(measured, deepest, called).find(true, &SET);
        for (measured, deepest, called, finding) in [
            (Some(3.9), 4.1, Some(4), Finding::Right),
            (Some(3.5), 3.6, Some(3), Finding::Right),
            // On the floor, and the band read wrong: either way, by a millimetre or by a whole band.
            (Some(3.9), 4.1, Some(5), Finding::Misread),
            (Some(3.9), 4.1, Some(3), Finding::Misread),
            (Some(3.9), 4.1, Some(9), Finding::Misread),
            // Short of the floor, and what was called is where the tip was.
            (Some(3.4), 3.4, Some(3), Finding::NeverReachedFloor),
            (None, 1.2, Some(1), Finding::NeverReachedFloor),
            // Nor is it a misreading where the tip was not on the floor.
            (Some(2.0), 2.0, Some(4), Finding::NeverReachedFloor),
            // Pressed 1.3 mm too deep, and that was called.
            (Some(4.0), 5.3, Some(6), Finding::ReadTooHeavy),
            (Some(4.0), 4.1, None, Finding::NotCalled),
        ] {
            assert_eq!(
                find(measured, deepest, called),
                finding,
                "{measured:?} {deepest} {called:?}"
            );
        }
        // At 25 degrees 5.0 mm show 5.5, which is called 6; 8 is nowhere near.
        let tilted = |shown: f64, called| {
            let site = SiteGrade {
                truth_mm: Some(5.0),
                shown_mm: Some(shown),
                ..zone(Some(5.0), 5.1, Some(called))
            };
            site.find(true, &SET)
        };
        assert_eq!(tilted(5.5, 6), Finding::Right);
        assert_eq!(tilted(6.4, 7), Finding::ReadTilted);
        assert_eq!(tilted(6.4, 8), Finding::Misread);
        // 6.3 show 6, not 7.
        assert_eq!(tilted(6.3, 7), Finding::Misread);
        // The same where it stood wrong.
        let wrong = SiteGrade {
            truth_mm: Some(5.0),
            shown_mm: Some(5.5),
            tilt_right: Some(false),
            ..zone(Some(5.0), 5.1, Some(6))
        };
        assert_eq!(wrong.find(true, &SET), Finding::ReadTilted);
        // Another tooth's deeper floor at the border of the zone.
        assert_eq!(find(Some(5.4), 5.4, Some(6)), Finding::Off);
        assert_eq!(zone(None, 0.0, None).find(false, &SET), Finding::Missed);
        assert_eq!(
            zone(None, 0.0, Some(4)).find(false, &SET),
            Finding::NotProbed
        );
    }

    #[test]
    fn a_depth_under_too_much_force_is_not_right_because_it_is_within_a_millimetre() {
        let at = |force, called| {
            let site = SiteGrade {
                truth_mm: Some(3.0),
                max_force_n: Some(force),
                ..zone(Some(3.2), 3.9, Some(called))
            };
            site.find(true, &SET)
        };
        assert_eq!(at(0.6, 4), Finding::ReadTooHeavy);
        // Called as it is under a correct force, however heavy the hand was.
        assert_eq!(at(0.6, 3), Finding::Right);
        // What a tremor adds is forgiven.
        assert_eq!(at(0.29, 4), Finding::Right);
    }
}
