//! Six charted sites of a tooth, and the prescription of each site.
//!
//! Borders of the zones are angles about the tooth's axis from mesial (0) over buccal (+90 degrees). The midlines lie
//! at 0 and 180 degrees. The line angles lie at `proximal` and at 180 degrees less `proximal`, on either side.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::Gingiva;
use crate::scene::params::within;
use crate::tissue::{TissueError, wrong};

/// Smallest and largest half width of a proximal zone, degrees.
const PROXIMAL_DEG: (f64, f64) = (20.0, 80.0);

/// Site of a tooth for charting a depth, in the order round the tooth from mesial over buccal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Site {
    /// From the mesial midline to the line angle, on the cheek's side.
    MesioBuccal,
    /// Between the line angles, on the cheek's side.
    Buccal,
    /// From the line angle to the distal midline, on the cheek's side.
    DistoBuccal,
    /// From the distal midline to the line angle, on the tongue's side.
    DistoLingual,
    /// Between the line angles, on the tongue's side.
    Lingual,
    /// From the line angle to the mesial midline, on the tongue's side.
    MesioLingual,
}

impl Site {
    /// All six sites, in the order round the tooth.
    pub const ALL: [Site; 6] = [
        Site::MesioBuccal,
        Site::Buccal,
        Site::DistoBuccal,
        Site::DistoLingual,
        Site::Lingual,
        Site::MesioLingual,
    ];

    /// Returns the name of the site in files, one word.
    pub const fn name(self) -> &'static str {
        match self {
            Site::MesioBuccal => "mesiobuccal",
            Site::Buccal => "buccal",
            Site::DistoBuccal => "distobuccal",
            Site::DistoLingual => "distolingual",
            Site::Lingual => "lingual",
            Site::MesioLingual => "mesiolingual",
        }
    }

    /// Returns the site with the name `name`, if there is one.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|site| site.name() == name)
    }

    /// Whether the site lies beside a neighbouring tooth.
    pub const fn is_proximal(self) -> bool {
        !matches!(self, Site::Buccal | Site::Lingual)
    }

    /// Whether the site lies on the mesial half; `None` in the middle of a side.
    pub const fn is_mesial(self) -> Option<bool> {
        match self {
            Site::MesioBuccal | Site::MesioLingual => Some(true),
            Site::DistoBuccal | Site::DistoLingual => Some(false),
            Site::Buccal | Site::Lingual => None,
        }
    }

    /// Whether the site lies on the cheek's side.
    pub const fn is_buccal(self) -> bool {
        matches!(self, Site::MesioBuccal | Site::Buccal | Site::DistoBuccal)
    }

    /// Returns the zone of an angle (radians from mesial over buccal, any number of turns). The proximal zones reach
    /// `proximal` radians from the midlines. An angle that is not finite counts as the mesial midline.
    pub fn at(around: f64, proximal: f64) -> Self {
        let turn = around / (2.0 * PI);
        // Fraction of a turn, -0.5 to 0.5.
        let part = turn - libm::floor(turn + 0.5);
        let (buccal, from_mesial) = if part < 0.0 {
            (false, -part * 2.0 * PI)
        } else {
            (true, part * 2.0 * PI)
        };
        if from_mesial > PI - proximal {
            if buccal {
                Site::DistoBuccal
            } else {
                Site::DistoLingual
            }
        } else if from_mesial >= proximal {
            if buccal { Site::Buccal } else { Site::Lingual }
        } else if buccal {
            Site::MesioBuccal
        } else {
            // A NaN never reaches this branch: `part < 0.0` is false for a NaN.
            Site::MesioLingual
        }
    }
}

/// Prescription of one site in a patient's chart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Prescribed {
    /// Probing depth, metres, 0 to 0.02: from the margin to the deepest place of the zone's floor, read at
    /// [`super::GingivaParams::reading_force`] with [`super::GingivaParams::reading_tip`].
    pub depth: f64,
    /// Distance of the margin below the cemento-enamel junction, along the tooth's axis, metres, -0.01 to 0.02;
    /// negative above the junction.
    pub recession: f64,
    /// Whether the site bleeds after light probing.
    pub bleeds: bool,
}

impl Gingiva {
    /// Returns the zone of an angle, radians from mesial over buccal.
    pub fn site_at(&self, around: f64) -> Site {
        Site::at(around, self.proximal)
    }

    /// Returns the prescription of a site.
    pub fn prescribed(&self, site: Site) -> &Prescribed {
        &self.sites[site as usize]
    }

    /// Checks zones and prescriptions.
    ///
    /// # Errors
    /// A field is out of range: the error names the field, the value found and the range expected.
    pub(super) fn validate_sites(&self) -> Result<(), TissueError> {
        let (narrow, wide) = (PROXIMAL_DEG.0.to_radians(), PROXIMAL_DEG.1.to_radians());
        if !within(self.proximal, narrow, wide) {
            return wrong(
                "proximal",
                format!("{} deg", self.proximal.to_degrees()),
                "20 to 80 deg",
            );
        }
        for (site, says) in Site::ALL.into_iter().zip(&self.sites) {
            let mm = |metres: f64| format!("{} mm at {}", metres * 1e3, site.name());
            if !within(says.depth, 0.0, 20e-3) {
                return wrong("depth", mm(says.depth), "0 to 20 mm");
            }
            if !within(says.recession, -10e-3, 20e-3) {
                return wrong("recession", mm(says.recession), "-10 to 20 mm");
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(degrees: f64, proximal: f64) -> &'static str {
        Site::at(degrees.to_radians(), proximal.to_radians()).name()
    }

    #[test]
    fn bearings_fall_into_six_zones() {
        // Angles from mesial over buccal: -90 degrees is the middle of the lingual side.
        let names = [10.0, 90.0, 170.0, -170.0, -90.0, -10.0].map(|degrees| name(degrees, 50.0));
        assert_eq!(names, Site::ALL.map(Site::name));
        for (degrees, is) in [
            (49.9, "mesiobuccal"),
            (50.1, "buccal"),
            (129.9, "buccal"),
            (130.1, "distobuccal"),
            (-49.9, "mesiolingual"),
            (-50.1, "lingual"),
            (-129.9, "lingual"),
            (-130.1, "distolingual"),
            (0.0, "mesiobuccal"),
            (-0.1, "mesiolingual"),
            (180.1, "distolingual"),
        ] {
            assert_eq!(name(degrees, 50.0), is, "{degrees}");
            assert_eq!(name(degrees + 720.0, 50.0), is, "{degrees} and two turns");
        }
        assert_eq!(name(67.0, 67.5), "mesiobuccal");
        assert_eq!(name(68.0, 67.5), "buccal");
        assert_eq!(name(113.0, 67.5), "distobuccal");
    }

    #[test]
    fn sides_and_names_agree() {
        for site in Site::ALL {
            assert_eq!(Site::from_name(site.name()), Some(site));
            let is = |part: &str| site.name().contains(part);
            assert_eq!(site.is_buccal(), is("buccal"));
            assert_eq!(site.is_proximal(), is("mesio") || is("disto"));
            assert_eq!(site.is_mesial(), site.is_proximal().then(|| is("mesio")));
        }
        assert_eq!(Site::from_name("Buccal"), None);
    }

    #[test]
    fn what_is_no_number_has_a_zone_too() {
        for around in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            assert!(Site::ALL.contains(&Site::at(around, 0.9)), "{around}");
        }
        assert_eq!(Site::at(f64::NAN, 0.9), Site::MesioBuccal);
    }
}
