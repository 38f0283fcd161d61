//! Colour and finish of a tooth, by place.
//!
//! Enamel lies over dentine. Its share of the colour is `1 - exp(-t / 0.8 mm)` at a thickness `t`. This form and all
//! thicknesses are chosen; they make the colours below at their places.
//!
//! # Sources of the colours, L*a*b* under D65
//! - Body of the incisors near VITA A1, of canines and molars near B3: Pop-Ciutrila et al. 2015 (PMC4689248), upper
//!   teeth.
//! - The cervical third has most red and yellow: the same order as in a measurement of tooth regions (KU 43500378).
//! - Translucent edge, halo, root and fissure: chosen from textbooks of dental anatomy.
//! - Dentine: chosen.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmax, fmin};
use sulcus_proto::display::Finish;
use sulcus_scene::anatomy::tooth::{Fissure, Tooth};

use super::colour::Lab;

/// Dentine under enamel.
const DENTINE: Lab = Lab([74.0, 4.0, 24.0]);
/// Exposed root: cementum and dentine.
const ROOT: Lab = Lab([68.0, 4.0, 24.0]);
/// Enamel of an edge without dentine behind.
const EDGE: Lab = Lab([70.0, -1.0, 6.0]);
/// Rim of the edge, in which the light collects.
const HALO: Lab = Lab([78.0, 0.0, 16.0]);
/// Share of both colours at the cusp of a canine, which is thicker. Chosen.
const CANINE: f64 = 0.55;
/// Stain of a fissure.
const STAIN: Lab = Lab([45.0, 8.0, 18.0]);
/// Difference of the cervical enamel from what its thickness gives, at the CEJ.
const CERVICAL: [f64; 3] = [-3.4, 0.5, 1.6];
/// Height over which the cervical difference vanishes, mm.
const CERVICAL_MM: f64 = 3.2;
/// Thickness of enamel that hides `1 - 1/e` of the dentine, mm.
const HIDES_MM: f64 = 0.8;
/// Thickness of the enamel at which the body's colour is measured, mm.
const BODY_MM: f64 = 1.0;

/// Width of the step of colour below the CEJ, mm: 0.1 to 0.2.
pub const STEP_MM: f64 = 0.14;
/// Width of the halo under the edge of a front tooth, mm, and where its fade ends.
pub const HALO_MM: [f64; 2] = [0.22, 0.4];
/// End of the translucent part under the edge, mm.
const TRANSLUCENT_MM: f64 = 1.5;
/// Half the width of a fissure at its foot, mm. The stain fades linearly, so that half of it is 0.14 mm wide.
pub const FISSURE_MM: f64 = 0.14;
/// Length over which a developmental fissure fades at its end on the crown's edge, mm.
const BEGINS_MM: f64 = 0.8;
/// Greatest distance of the surface under the undisturbed chewing surface that has fissures, mm.
const UNDER_MM: f64 = 0.45;

/// Perceptual roughness: enamel wet by saliva, the same of a root, a fissure with plaque.
const ROUGHNESS: [f64; 3] = [0.10, 0.30, 0.45];

/// Look of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Colour.
    pub colour: Lab,
    /// Finish.
    pub finish: Finish,
}

/// Colours of the teeth of one number on both sides.
pub struct Enamel<'a> {
    shape: &'a Tooth,
    fissures: Vec<Fissure>,
    /// Enamel so thick that no dentine shows.
    thick: Lab,
}

impl<'a> Enamel<'a> {
    /// Colours of a shape, in its average shade.
    pub fn new(shape: &'a Tooth) -> Self {
        let body = match shape.fdi() % 10 {
            1 | 2 => Lab([77.0, 0.0, 15.0]),
            4 | 5 => Lab([75.0, 1.0, 17.5]),
            _ => Lab([73.0, 2.0, 20.0]),
        };
        // The mixture at the body's thickness has the body's colour.
        let share = cover(BODY_MM);
        let thick = std::array::from_fn(|k| DENTINE.0[k] + (body.0[k] - DENTINE.0[k]) / share);
        Self {
            shape,
            fissures: shape.fissures(),
            thick: Lab(thick),
        }
    }

    /// Fissures.
    pub fn fissures(&self) -> &[Fissure] {
        &self.fissures
    }

    /// Whether the tooth has an edge or one cusp instead of a table.
    pub fn is_front(&self) -> bool {
        self.shape.fdi() % 10 <= 3
    }

    /// Height over the CEJ, mm.
    pub fn above_cej(&self, p: &Vec3) -> f64 {
        p.z - self.shape.cej(libm::atan2(p.y, p.x))
    }

    /// Depth under the edge or under the undisturbed chewing surface, mm.
    pub fn under_edge(&self, p: &Vec3) -> f64 {
        self.shape.chewing(p.x, p.y) - p.z
    }

    /// Whether a place belongs to the chewing table, on which fissures lie.
    pub fn is_table(&self, p: &Vec3) -> bool {
        p.z > 0.35 * self.shape.crown_height_mm() && self.under_edge(p).abs() < UNDER_MM
    }

    /// Returns the distance from the middle of the nearest fissure, mm, and that fissure's strength there, 0 to 1.
    pub fn fissure(&self, p: &Vec3) -> (f64, f64) {
        let mut nearest = (f64::INFINITY, 0.0);
        if self.fissures.is_empty() || !self.is_table(p) {
            return nearest;
        }
        for fissure in &self.fissures {
            let (distance, strength) = beside(fissure, p);
            // The stronger of two fissures is seen at their meeting.
            let same = (distance - nearest.0).abs() < 1e-6;
            if distance < nearest.0 - 1e-6 || (same && strength > nearest.1) {
                nearest = (distance, strength);
            }
        }
        nearest
    }

    /// Returns the look of a place on the surface.
    pub fn look(&self, p: &Vec3) -> Look {
        let above = self.above_cej(p);
        let root = fclamp(-above / STEP_MM, 0.0, 1.0);
        let mut colour = DENTINE.mix(self.thick, cover(self.thickness(p, above)));
        let neck = fclamp(1.0 - above / CERVICAL_MM, 0.0, 1.0);
        colour = colour.moved(CERVICAL.map(|x| x * neck));
        let mut thin = 0.0;
        if self.is_front() {
            let under = fmax(self.under_edge(p), 0.0);
            let clear = fclamp(1.0 - under / TRANSLUCENT_MM, 0.0, 1.0);
            thin = fmin(1.0, 1.4 * clear);
            let [rim, ends] = HALO_MM;
            let halo = fclamp((ends - under) / (ends - rim), 0.0, 1.0);
            // No dentine lies behind the upper half of the clear part.
            let share = if self.shape.fdi() % 10 == 3 {
                CANINE
            } else {
                1.0
            };
            colour = colour
                .mix(EDGE, share * fmin(1.3 * clear, 1.0))
                .mix(HALO, share * halo);
        }
        let (away, strength) = self.fissure(p);
        let stain = strength * fclamp(1.0 - away / FISSURE_MM, 0.0, 1.0);
        colour = colour.mix(ROOT, root).mix(STAIN, stain);
        let [enamel, bare, rough] = ROUGHNESS;
        let roughness = enamel + (bare - enamel) * root + (rough - enamel) * stain;
        Look {
            colour,
            finish: Finish {
                roughness: share_255(roughness),
                stipple: 0,
                thin: share_255(thin * (1.0 - root)),
            },
        }
    }

    /// Returns the thickness of the enamel, mm, chosen from textbooks: none at the CEJ, 1.0 in the middle third, more
    /// over cusps.
    fn thickness(&self, p: &Vec3, above: f64) -> f64 {
        let crown = self.shape.crown_height_mm();
        let top = if self.is_front() { 1.1 } else { 2.3 };
        let height = fclamp(above / fmax(crown - (p.z - above), 1.0), 0.0, 1.0);
        let knots = [
            (0.0, 0.0),
            (0.12, 0.35),
            (0.33, 0.6),
            (0.5, 1.0),
            (0.75, 1.05),
            (1.0, top),
        ];
        let next = knots.iter().position(|knot| height <= knot.0);
        let next = next.unwrap_or(knots.len() - 1).max(1);
        let ((x, a), (y, b)) = (knots[next - 1], knots[next]);
        a + (b - a) * (height - x) / (y - x)
    }
}

/// Finish of enamel whose tooth has no known form.
pub fn plain() -> Finish {
    Finish {
        roughness: share_255(ROUGHNESS[0]),
        stipple: 0,
        thin: 0,
    }
}

/// Returns the difference of a tooth's shade from the average, from its FDI number alone: at most 1.5 in L*, 1 in b*.
pub fn variation(fdi: u8) -> [f64; 3] {
    let share = |salt: u64| {
        // SplitMix64 (Steele et al. 2014), one step.
        let mut z = (u64::from(fdi) << 8 | salt).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z >> 40) as f64 / (1u64 << 23) as f64 - 1.0
    };
    [1.5 * share(1), 0.0, share(2)]
}

/// Returns the share of the dentine that enamel of this thickness hides, mm.
fn cover(thickness: f64) -> f64 {
    1.0 - libm::exp(-thickness / HIDES_MM)
}

/// A share as 255ths.
pub fn share_255(share: f64) -> u8 {
    libm::round(255.0 * fclamp(share, 0.0, 1.0)) as u8
}

/// Returns the distance from a fissure, seen from above, mm, and its strength at the nearest place.
fn beside(fissure: &Fissure, p: &Vec3) -> (f64, f64) {
    let mut nearest = (f64::INFINITY, 0.0);
    let mut passed = 0.0;
    for pair in fissure.points.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = fmax((dx * dx + dy * dy).sqrt(), 1e-9);
        let along = ((p.x - a[0]) * dx + (p.y - a[1]) * dy) / (length * length);
        let along = fclamp(along, 0.0, 1.0);
        let (x, y) = (p.x - a[0] - dx * along, p.y - a[1] - dy * along);
        let distance = (x * x + y * y).sqrt();
        if distance < nearest.0 {
            nearest = (distance, passed + along * length);
        }
        passed += length;
    }
    let (distance, at) = nearest;
    let strength = if fissure.fades {
        0.6 * fclamp(1.0 - at / passed, 0.0, 1.0)
    } else {
        0.85 * fclamp((passed - at) / BEGINS_MM, 0.0, 1.0)
    };
    (distance, strength)
}
