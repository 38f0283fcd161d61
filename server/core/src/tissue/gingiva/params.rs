//! How soft gingiva is, how quickly it follows, and when a hand is too heavy on it.

use serde::{Deserialize, Serialize};

use crate::scene::params::within;
use crate::tissue::TissueError;

/// Parameters of a gingiva, SI units.
///
/// Sources: *note* marks what follows from measurements, *chosen* what no measurement was found for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GingivaParams {
    /// Stiffness `k_d` of a pocket's wall pushed away from the tooth at one place, N/m. Default 500, range 10 to
    /// 1e6. Larger: a tighter pocket. Source: 0.3 to 1 N/mm gave no buzz and small jumps in closed loop; chosen.
    pub wall_stiffness: f64,
    /// Stiffness `k_t` of the same place dragged along the tooth, N/m. Default 1500, range 10 to 1e6. The tissue is
    /// bound to the tooth below the pocket, so it gives way less to a pull along the tooth than to one away from it; chosen.
    pub shear_stiffness: f64,
    /// Length `l` over which a press is felt by its neighbourhood, m: compliance falls as `exp(-distance / l)`. Default
    /// 8.3e-4, range 1e-5 to 1e-2. Source: the paper's 0.3 per millimetre (Eq. 14), doi:10.1109/TOH.2014.2304734.
    pub reach: f64,
    /// Time constant of a Kelvin-Voigt solid, s: let go, the tissue comes back as `exp(-t / relaxation)`. Default 0.02,
    /// range 0 to 1. Larger: slower and calmer; 0 is purely elastic. Chosen: short against a probing stroke.
    pub relaxation: f64,
    /// Stiffness of the floor along the tooth's axis under [`GingivaParams::reading_tip`], N/m. Default 500, range 10 to 1e6. Larger: the
    /// depth read depends less on the force. Source: 50 N/cm2 reaches the base of the sulcus, 200 N/cm2 the base of the
    /// junctional epithelium about a millimetre below (Garnick 2000, PMID 10695944): 0.3 N/mm; a little stiffer, because
    /// tissue hardens as it is pressed and this model does not.
    pub floor_stiffness: f64,
    /// Height over the floor in which the wall's compliance along the axis becomes the floor's, m. Default 5e-4, range 0
    /// to 5e-3; chosen.
    pub floor_taper: f64,
    /// Force at which the prescribed depth is read with a tip of 0.5 mm, N; at rest the floor lies higher by how far
    /// this force presses healthy tissue. Default 0.225, range 0 to 1. Source: 0.20 to 0.25 N of clinical studies.
    pub reading_force: f64,
    /// Diameter of the tip with which depths are read, m. Default 5e-4, range 1e-4 to 2e-3. A tip spreads its load, and
    /// presses less deep than the same load on a point: each place of the floor is softer by that much.
    pub reading_tip: f64,
    /// How inflamed the tissue is, 0 (healthy, default) to 1. Softens walls and floor, so that more is read at the
    /// same force. Source for the direction: inflamed tissue lets a probe deeper at light force.
    pub inflammation: f64,
    /// Share of every stiffness that full inflammation takes away. Default 0.5, range 0 to 0.95; chosen.
    pub softening: f64,
    /// Force on the floor above which a hand is too heavy, N. Default 0.25. Source: Karayiannis 1992, Lang 1991.
    pub too_heavy: f64,
    /// Force on the floor at which healthy tissue bleeds, N. Default 0.5. Source: Lang 1991.
    pub trauma: f64,
    /// Force on the floor that damages, N. Default 1.96. Source: the paper's 200 g.
    pub damage: f64,
    /// Share of a zone's threshold under which the zone is left, so that it can be entered again. Default 0.8, range
    /// 0.1 to 1; chosen.
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
    /// Names the first field out of range, with the value found and the range expected.
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
        // The floor's compliance is that of a tip that is small against the reach: see `floor_compliance`.
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

    /// What inflammation leaves of every stiffness, 0 to 1.
    pub fn firmness(&self) -> f64 {
        1.0 - self.softening * self.inflammation
    }

    /// How far the floor of healthy tissue gives way to [`GingivaParams::reading_force`], metres: so much higher than
    /// the prescribed depth it lies at rest.
    pub fn sink(&self) -> f64 {
        self.reading_force / self.floor_stiffness
    }

    /// Compliance of one place of the floor, m/N. The floor is a line round the tooth, which the tip covers from wall to
    /// wall: a load spread evenly over a disc moves it by the mean of `exp(-distance / l)` over all pairs of its points,
    /// with their distance along that line, which is nearly that at the mean distance, 256 / (45 pi^2) radii.
    pub fn floor_compliance(&self) -> f64 {
        let distance =
            256.0 / (45.0 * std::f64::consts::PI * std::f64::consts::PI) * 0.5 * self.reading_tip;
        libm::exp(distance / self.reach) / (self.firmness() * self.floor_stiffness)
    }

    /// Thresholds of the zones above light, N.
    pub(super) fn thresholds(&self) -> [f64; 3] {
        [self.too_heavy, self.trauma, self.damage]
    }
}
