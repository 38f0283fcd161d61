//! One zone of a graded session: prescribed, reached and called values.

use serde::{Serialize, Serializer};
use sulcus_core::math::fmax;
use sulcus_core::tissue::gingiva::Site;

use super::finding::Finding;
use crate::grade::settings::Settings;
use crate::grade::tolerances::TIE;

/// Tolerance of a reading of the bands, mm: half a millimetre of rounding and a tenth.
pub const READ_MM: f64 = 0.6;
/// Time of the tip on the floor from which a reading is held, seconds. Chosen: the time to look from the hand to the
/// margin.
pub const HELD_S: f64 = 0.5;
/// Time from which a force above the band is no tremor, seconds. Chosen: two periods of the fastest tremor.
pub const PRESSED_S: f64 = 0.2;

fn site_name<S: Serializer>(site: &Site, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(site.name())
}

/// One zone of a graded session, rounded: lengths to 0.01 mm, forces to 0.001 N, times to 0.001 s, angles to 0.1
/// degrees. A value of the tip is null if the tip was never in the zone.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SiteGrade {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Site of the zone.
    #[serde(serialize_with = "site_name")]
    pub site: Site,
    /// Whether the zone is one of the exercise.
    pub asked: bool,
    /// Whether the tip was below the margin for 0.2 s or more in total.
    pub probed: bool,
    /// Prescribed depth; null if the scene prescribes none.
    pub truth_mm: Option<f64>,
    /// Reached depth: largest depth of the tip at a force inside the target band; null without such a force.
    pub measured_mm: Option<f64>,
    /// Last called depth; null without a call.
    pub called_mm: Option<u8>,
    /// Largest depth of the tip at any force.
    pub deepest_mm: Option<f64>,
    /// Mean depth that the bands showed at the deepest place, which is 0.3 mm high. A tilted probe shows more than its
    /// depth.
    pub shown_mm: Option<f64>,
    /// Largest force on the floor.
    pub max_force_n: Option<f64>,
    /// Longest time with a force of the target band or more on the floor, seconds.
    pub held_s: Option<f64>,
    /// Longest time with a force more than 0.05 N above the band on the floor, seconds.
    pub pressed_s: Option<f64>,
    /// Mean tilt of the working end against the tooth's axis at the deepest place.
    pub tilt_deg: Option<f64>,
    /// Part of that tilt into the col; null in the middle of a side.
    pub into_col_deg: Option<f64>,
    /// Whether the tilt was that of the exercise for at least half of the time at the deepest place.
    pub tilt_right: Option<bool>,
    /// Prescribed recession: positive if the margin is below the cemento-enamel junction.
    pub recession_truth_mm: Option<f64>,
    /// Called recession; null without a call.
    pub recession_called_mm: Option<i8>,
    /// Whether the zone bled in the replay.
    pub bled: bool,
    /// Called bleeding; null without a call.
    pub bleeding_called: Option<bool>,
    /// Furcation grade of the patient's chart in the middle of a molar's side, Hamp 1975, 0 to 3. Null elsewhere and
    /// without a patient.
    pub furcation_truth: Option<u8>,
    /// Called furcation grade; null without a call.
    pub furcation_called: Option<u8>,
    /// Finding of the zone.
    pub finding: Finding,
}

impl SiteGrade {
    /// Whether the zone is the middle of a molar's side. In a lower jaw, furcations open there.
    pub(super) fn is_furcation(tooth: u8, site: Site) -> bool {
        !site.is_proximal() && tooth % 10 >= 6
    }

    /// Whether the zone was probed, and not only called before.
    pub fn is_probed_first(&self) -> bool {
        self.probed && self.finding != Finding::NotProbed
    }

    /// Whether the zone was probed and then called. A call before probing is a guess.
    pub fn is_charted(&self) -> bool {
        use Finding::{Missed, NotCalled, NotProbed};
        self.probed && !matches!(self.finding, Missed | NotProbed | NotCalled)
    }

    /// Called minus prescribed depth, mm.
    pub fn error_mm(&self) -> Option<f64> {
        Some(f64::from(self.called_mm?) - self.truth_mm?)
    }

    /// Whether the reached depth comes within `reached_mm` of the prescribed depth.
    pub fn is_reached(&self, set: &Settings) -> bool {
        let both = self.measured_mm.zip(self.truth_mm);
        both.is_some_and(|(measured, truth)| measured >= truth - set.reached_mm - TIE)
    }

    /// Whether the force stood above the band for longer than a tremor does.
    pub fn is_pressed(&self) -> bool {
        self.pressed_s
            .is_some_and(|pressed| pressed >= PRESSED_S - TIE)
    }

    /// Whether the tip rested on the floor long enough to read a band.
    pub fn is_held(&self) -> bool {
        self.held_s.is_some_and(|held| held >= HELD_S - TIE)
    }

    /// Whether the called depth does not match the depth of the tip.
    pub fn is_misread(&self, set: &Settings) -> bool {
        let (Some(measured), Some(called)) = (self.measured_mm, self.called_mm) else {
            return false;
        };
        let called = f64::from(called);
        // The bands of a tilted probe show more than its depth. Such a call is no misreading.
        let deepest = self.deepest_mm.unwrap_or(measured) + set.misread_mm;
        let shown = self.shown_mm.unwrap_or(measured) + READ_MM;
        called < measured - set.misread_mm - TIE || called > fmax(deepest, shown) + TIE
    }
}
