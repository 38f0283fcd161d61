//! Gloss, stippling and translucence of the soft tissues.
//!
//! A film of saliva covers all tissues; its thickness sets the roughness (chosen within the ranges that films of 10 to
//! 70 um suggest). Stippling lies on attached gingiva alone, between papillae more than over roots (chosen by studies
//! of stippling patterns).

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmax};
use sulcus_proto::display::Finish;
use sulcus_scene::anatomy::mouth::{Mark, Part};

use super::noise::noise;

const ATTACHED: f64 = 0.35;
const MARGIN: f64 = 0.22;
const MUCOSA: f64 = 0.19;
// The cheek is nearly flat. A sharp highlight on it would have the outlines of its triangles.
const LIP: f64 = 0.40;
const PAD: f64 = 0.28;
/// Change of the roughness at the grades 0 to 3 of Loe and Silness: glazed from grade 2.
const GLAZED: [f64; 4] = [0.0, 0.0, -0.10, -0.12];
/// Stippling left in the rim and in the rest at these grades.
const RIM: [f64; 4] = [1.0, 0.8, 0.0, 0.0];
const BAND: [f64; 4] = [1.0, 0.9, 0.6, 0.2];
/// Share of the stippling over roots, between roots and between papillae (23, 75 and 84 % of 250 people).
const ROOTS: [f64; 3] = [0.23, 0.75, 0.84];
/// Breadth of the free gingiva without pits, mm, and length of the change, mm.
const FREE: f64 = 1.2;
const CHANGE: f64 = 0.5;

/// Finish of a vertex at `at` (mm).
pub(crate) fn finish(at: &Vec3, mark: &Mark) -> Finish {
    let (roughness, stipple, thin) = match mark.part {
        Part::Gingiva if mark.is_ridge => (PAD, 0.25 * fclamp(mark.below, 0.0, 1.0), 0.0),
        Part::Gingiva => gingiva(at, mark),
        Part::Mucosa => (MUCOSA, 0.0, 0.1),
        Part::Lip => (
            LIP + 0.3 * fclamp(2.0 * mark.share - 1.0, 0.0, 1.0),
            0.0,
            0.0,
        ),
        Part::Floor => (MUCOSA, 0.0, 0.0),
    };
    let byte = |x: f64| (255.0 * fclamp(x, 0.0, 1.0)).round() as u8;
    Finish {
        // Skin and the dark behind the mouth are dry.
        roughness: byte(roughness + 0.4 * mark.dark + 0.03 * noise(at, 3.0, 4)),
        stipple: byte(stipple),
        thin: byte(thin),
    }
}

/// Roughness, stippling and translucence of a gingiva.
fn gingiva(at: &Vec3, mark: &Mark) -> (f64, f64, f64) {
    let grade = |values: &[f64; 4]| {
        let at = fclamp(3.0 * mark.inflammation, 0.0, 3.0);
        let k = (at as usize).min(2);
        values[k] + (values[k + 1] - values[k]) * (at - k as f64)
    };
    let free = 1.0 - fclamp((mark.below - FREE) / CHANGE, 0.0, 1.0);
    let dry = ATTACHED + (MARGIN - ATTACHED) * free;
    // The wet mucosa begins at the line.
    let end = fclamp((mark.share - 0.9) / 0.1, 0.0, 1.0);
    let dry = dry + 0.5 * (MUCOSA - dry) * end;
    let roughness = fmax(dry + grade(&GLAZED) * (0.4 + 0.6 * free), 0.08);
    let [over, between, papillae] = ROOTS;
    let high = fclamp(1.0 - mark.share * 2.0, 0.0, 1.0);
    let most = between + (papillae - between) * high;
    let place = over + (most - over) * mark.papilla;
    let left =
        grade(&RIM) + (grade(&BAND) - grade(&RIM)) * fclamp((mark.below - 1.5) / 2.0, 0.0, 1.0);
    let side = if mark.lingual { 0.4 } else { 1.0 };
    let patch = 0.85 + 0.3 * noise(at, 5.0, 5);
    let stipple = place * left * side * patch * (1.0 - free) * (1.0 - end);
    // Light passes the first millimetre and the tip of a papilla.
    let thin = fmax(1.0 - mark.below / (1.0 + 0.8 * mark.papilla), 0.0);
    (roughness, stipple, 0.8 * thin)
}
