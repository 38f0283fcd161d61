//! Parameters of a gingiva: stiffness, relaxation, reading of the probing depth, and force thresholds.

use serde::{Deserialize, Serialize};

use crate::scene::params::within;
use crate::tissue::TissueError;

/// Parameters of a gingiva, SI units.
///
/// The text of a field gives the source of its value; *chosen* marks a value for which no measurement was found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GingivaParams {
    /// Stiffness `k_d` of one place of a pocket's wall pushed away from the tooth, N/m. Default 500, range 10 to 1e6.
    /// Larger values give a tighter pocket. Chosen: 0.3 to 1 N/mm gave no buzz and small jumps in closed loop.
    pub wall_stiffness: f64,
    /// Stiffness `k_t` of one place of the wall dragged along the tooth's surface, N/m. Default 1500, range 10 to 1e6.
    /// Chosen: the tissue is bound to the tooth below the pocket, so it yields less along the tooth than away from it.
    pub shear_stiffness: f64,
    /// Length `l` of the compliance's falloff `exp(-distance / l)`, m. Default 8.3e-4, range 1e-5 to 1e-2, at least
    /// half of `reading_tip`. Source: the paper's factor of 0.3 per millimetre (Eq. 14), doi:10.1109/TOH.2014.2304734.
    pub reach: f64,
    /// Time constant of the Kelvin-Voigt solid, s: after release the displacement decays as `exp(-t / relaxation)`.
    /// Default 0.02, range 0 to 1. Larger values are slower and calmer; 0 is purely elastic. Chosen: short against a
    /// probing stroke.
    pub relaxation: f64,
    /// Stiffness of the floor along the tooth's axis under a tip of diameter [`GingivaParams::reading_tip`], N/m.
    /// Default 500, range 10 to 1e6. With larger values the probing depth depends less on the force.
    ///
    /// Source: a pressure of 50 N/cm2 reaches the base of the sulcus. A pressure of 200 N/cm2 reaches the base of the
    /// junctional epithelium, about a millimetre below (Garnick 2000, PMID 10695944). The result is 0.3 N/mm. The
    /// default is a little stiffer, because tissue hardens under load and this model does not.
    pub floor_stiffness: f64,
    /// Height over the floor in which the wall's compliance along the axis changes to the floor's, m. Default 5e-4,
    /// range 0 to 5e-3. Chosen.
    pub floor_taper: f64,
    /// Force at which a tip of 0.5 mm (`reading_tip`) reads the prescribed depth, N. Default 0.225, range 0 to 1. At
    /// rest the floor lies higher by [`GingivaParams::sink`], the displacement of healthy tissue under this force.
    /// Source: 0.20 to 0.25 N of clinical studies.
    pub reading_force: f64,
    /// Diameter of the tip for which `floor_stiffness` and `reading_force` hold, m. Default 5e-4, range 1e-4 to 2e-3,
    /// at most twice `reach`. A tip spreads its load, so each place of the pocket's floor is softer to compensate.
    pub reading_tip: f64,
    /// Degree of inflammation, 0 (healthy, default) to 1. Inflammation softens walls and floor, so that the probing
    /// depth at the same force is larger. Source of the direction: a probe at light force goes deeper into inflamed
    /// tissue.
    pub inflammation: f64,
    /// Fraction by which full inflammation reduces every stiffness. Default 0.5, range 0 to 0.95. Chosen.
    pub softening: f64,
    /// Floor force above which the hand is too heavy, N. Default 0.25, range 0.001 to 10. Source: Karayiannis 1992,
    /// Lang 1991.
    pub too_heavy: f64,
    /// Floor force at which healthy tissue bleeds, N. Default 0.5, range `too_heavy` to 10. Source: Lang 1991.
    pub trauma: f64,
    /// Floor force that damages tissue, N. Default 1.96, range `trauma` to 10. Source: the paper's 200 g.
    pub damage: f64,
    /// Fraction of a zone's threshold below which the zone is left, so that it can be entered again. Default 0.8, range
    /// 0.1 to 1. Chosen.
    pub rearm: f64,
}

impl Default for GingivaParams {
    fn default() -> Self {
        Self {
            wall_stiffness: 500.0,
            shear_stiffness: 1500.0,
            reach: 8.3e-4,
            relaxation: 0.02,
            floor_stiffness: 500.0,
            floor_taper: 5e-4,
            reading_force: 0.225,
            reading_tip: 5e-4,
            inflammation: 0.0,
            softening: 0.5,
            too_heavy: 0.25,
            trauma: 0.5,
            damage: 1.96,
            rearm: 0.8,
        }
    }
}

impl GingivaParams {
    /// Checks every field against its range.
    ///
    /// # Errors
    /// A field is out of range: the error names the field, the value found and the range expected.
    pub fn validate(&self) -> Result<(), TissueError> {
        const STIFFNESS: &str = "10 to 1e6 N/m";
        let checks = [
            ("wall_stiffness", self.wall_stiffness, 10.0, 1e6, STIFFNESS),
            (
                "shear_stiffness",
                self.shear_stiffness,
                10.0,
                1e6,
                STIFFNESS,
            ),
            ("reach", self.reach, 1e-5, 1e-2, "1e-5 to 1e-2 m"),
            ("relaxation", self.relaxation, 0.0, 1.0, "0 to 1 s"),
            (
                "floor_stiffness",
                self.floor_stiffness,
                10.0,
                1e6,
                STIFFNESS,
            ),
            ("floor_taper", self.floor_taper, 0.0, 5e-3, "0 to 5e-3 m"),
            ("reading_force", self.reading_force, 0.0, 1.0, "0 to 1 N"),
            (
                "reading_tip",
                self.reading_tip,
                1e-4,
                2e-3,
                "1e-4 to 2e-3 m",
            ),
            ("inflammation", self.inflammation, 0.0, 1.0, "0 to 1"),
            ("softening", self.softening, 0.0, 0.95, "0 to 0.95"),
            ("too_heavy", self.too_heavy, 1e-3, 10.0, "0.001 to 10 N"),
            (
                "trauma",
                self.trauma,
                self.too_heavy,
                10.0,
                "too_heavy to 10 N",
            ),
            ("damage", self.damage, self.trauma, 10.0, "trauma to 10 N"),
            ("rearm", self.rearm, 0.1, 1.0, "0.1 to 1"),
        ];
        // `floor_compliance` assumes a tip that is small against `reach`.
        if self.reach < 0.5 * self.reading_tip {
            return Err(TissueError {
                field: "reach",
                found: format!(
                    "{} m with a reading_tip of {} m",
                    self.reach, self.reading_tip
                ),
                expected: "at least half of reading_tip".into(),
            });
        }
        match checks
            .iter()
            .find(|(_, found, low, high, _)| !within(*found, *low, *high))
        {
            Some((field, found, _, _, expected)) => Err(TissueError {
                field,
                found: found.to_string(),
                expected: (*expected).into(),
            }),
            None => Ok(()),
        }
    }

    /// Returns the factor of inflammation on every stiffness, 0.05 to 1; 1 for healthy tissue.
    pub fn firmness(&self) -> f64 {
        1.0 - self.softening * self.inflammation
    }

    /// Returns the displacement of the healthy floor under [`GingivaParams::reading_force`], metres. At rest the floor
    /// lies higher than the prescribed depth by this length.
    pub fn sink(&self) -> f64 {
        self.reading_force / self.floor_stiffness
    }

    /// Returns the compliance of one place of the floor along the tooth's axis, m/N, with the effect of inflammation.
    ///
    /// The floor is a line round the tooth, which the tip covers from wall to wall. A load spread evenly over a disc
    /// moves the disc by the mean of `exp(-distance / l)` over all pairs of its points. The distance is measured along
    /// that line. The mean is nearly the value at the mean distance, 256 / (45 pi^2) radii.
    pub fn floor_compliance(&self) -> f64 {
        let distance =
            256.0 / (45.0 * std::f64::consts::PI * std::f64::consts::PI) * 0.5 * self.reading_tip;
        libm::exp(distance / self.reach) / (self.firmness() * self.floor_stiffness)
    }

    /// Returns the floor forces from which the zones too heavy, trauma and damage begin, N.
    pub(super) fn thresholds(&self) -> [f64; 3] {
        [self.too_heavy, self.trauma, self.damage]
    }
}
