//! Cause of a wrong call: the finding of a zone, from its measured and called values.

use super::finding::Finding;
use super::site_grade::SiteGrade;
use crate::grade::settings::Settings;
use crate::grade::tolerances::{TIE, TREMOR_N, WITHIN_MM};

impl SiteGrade {
    /// Finding of the zone. `stayed`: the zone was probed, and a call came after that, or no call at all.
    pub(super) fn find(&self, stayed: bool, set: &Settings) -> Finding {
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
        let near = self.error_mm().is_none_or(|error| error.abs() <= WITHIN_MM);
        let above = |mm: f64| f64::from(called) > mm + set.misread_mm + TIE;
        if !above(measured) {
            return if near { Finding::Right } else { Finding::Off };
        }
        // The call is deeper than a correct force brings the tip. A fault of the hand explains this; else it is a
        // misreading. Within a millimetre it counts as wrong only if the hand was at fault.
        let heavy = || {
            let most = set.force_n[1] + TREMOR_N;
            self.max_force_n.is_some_and(|force| force > most)
        };
        let tilted = || self.tilt_right == Some(false);
        match self.deepest_mm {
            Some(deepest) if above(deepest) => {
                // The bands were read at a correct force. The force at other times has no effect.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grade::test_help::{SET, zone as made};
    use sulcus_core::tissue::gingiva::Site;

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
            // The tip was on the floor, and the call is wrong by a millimetre or by a whole band.
            (Some(3.9), 4.1, Some(5), Finding::Misread),
            (Some(3.9), 4.1, Some(3), Finding::Misread),
            (Some(3.9), 4.1, Some(9), Finding::Misread),
            // The tip was short of the floor, and the call is its depth.
            (Some(3.4), 3.4, Some(3), Finding::NeverReachedFloor),
            (None, 1.2, Some(1), Finding::NeverReachedFloor),
            // Off the floor, a wrong call is no misreading.
            (Some(2.0), 2.0, Some(4), Finding::NeverReachedFloor),
            // The tip was pressed 1.3 mm too deep, and the call is that depth.
            (Some(4.0), 5.3, Some(6), Finding::ReadTooHeavy),
            (Some(4.0), 4.1, None, Finding::NotCalled),
        ] {
            assert_eq!(
                find(measured, deepest, called),
                finding,
                "{measured:?} {deepest} {called:?}"
            );
        }
        // At 25 degrees, the bands show 5.5 mm at a depth of 5.0 mm. A call of 6 is right, and 8 is a misreading.
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
        // A reading of 6.3 mm is called 6, not 7.
        assert_eq!(tilted(6.3, 7), Finding::Misread);
        // The same reading with a wrong tilt.
        let wrong = SiteGrade {
            truth_mm: Some(5.0),
            shown_mm: Some(5.5),
            tilt_right: Some(false),
            ..zone(Some(5.0), 5.1, Some(6))
        };
        assert_eq!(wrong.find(true, &SET), Finding::ReadTilted);
        // A deeper floor of another tooth at the border of the zone.
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
        // The call is the depth at a correct force.
        assert_eq!(at(0.6, 3), Finding::Right);
        // 0.05 N above the band are a tolerance for tremor.
        assert_eq!(at(0.29, 4), Finding::Right);
    }
}
