//! Colours of the soft tissues by zone and inflammation.
//!
//! Zones are measured on upper front gingiva (Gomez Polo 2019, Ito 2015); the default of the attached gingiva lies
//! between both. All other numbers are chosen by the direction that studies report: alveolar mucosa is darker and
//! redder than attached gingiva, inflamed tissue redder, then darker.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmax};
use sulcus_scene::anatomy::mouth::{Mark, Part};

use super::lab::{Lab, mix, srgb};
use super::noise::noise;

const ATTACHED: Lab = [56.0, 25.0, 16.0];
const FREE: Lab = [55.0, 26.0, 15.0];
const MUCOSA: Lab = [48.0, 31.0, 17.0];
const FLOOR: Lab = [45.0, 33.0, 17.0];
const LIP: Lab = [50.0, 29.0, 17.0];
const PAD: Lab = [52.0, 28.0, 17.0];
/// Margin and papilla at the grades 0 to 3 of Loe and Silness.
const RIM: [Lab; 4] = [
    FREE,
    [53.0, 28.0, 15.0],
    [49.0, 32.0, 14.0],
    [43.0, 34.0, 10.0],
];
/// Depth of the inflamed rim below the margin, mm, by grade, and of the way down to the attached gingiva's share.
const DEEP: [f64; 4] = [1.0, 1.0, 2.0, 3.0];
const FADES: f64 = 1.5;
/// Share of the rim's change in the rest of the attached gingiva.
const BAND: f64 = 0.5;
/// Place along the arch at which the retromolar pads begin, mm.
const PAD_FROM: f64 = 51.0;
/// Length of the colour step at the mucogingival line, mm.
const STEP: f64 = 0.4;
/// Colour of the veins under the floor and the tongue, and of the dark behind the mouth.
const VEIN: Lab = [42.0, 18.0, 4.0];
const DARK: Lab = [7.0, 6.0, 3.0];
/// Size of the noise, mm, and its amplitude in L and a.
const PATCHES: f64 = 4.5;
const AMPLITUDE: [f64; 2] = [2.0, 1.5];

/// Colour of a vertex at `at` (mm).
pub(crate) fn colour(at: &Vec3, mark: &Mark) -> [u8; 4] {
    let mut lab = zone(at, mark);
    lab[0] += AMPLITUDE[0] * noise(at, PATCHES, 1);
    lab[1] += AMPLITUDE[1] * noise(at, PATCHES, 2);
    srgb(mix(lab, DARK, mark.dark))
}

fn zone(at: &Vec3, mark: &Mark) -> Lab {
    match mark.part {
        Part::Gingiva if mark.is_ridge => {
            // A pad is firm and pink in front, softer and redder behind.
            let behind = fclamp((mark.s.abs() - PAD_FROM) / 8.0, 0.0, 1.0);
            mix(mix(ATTACHED, PAD, 0.3 + 0.7 * behind), MUCOSA, beyond(mark))
        }
        Part::Gingiva => gingiva(mark),
        Part::Mucosa => {
            // Vessels along the mucosa: thin ridges of a noise.
            let vessel = fmax(1.0 - 9.0 * noise(at, 2.2, 3).abs(), 0.0);
            let lip = fclamp(mark.share - 1.2, 0.0, 0.8) / 0.8;
            let lab = mix(MUCOSA, LIP, lip);
            mix(lab, [lab[0] - 5.0, lab[1] + 5.0, lab[2]], 0.25 * vessel)
        }
        Part::Lip => LIP,
        Part::Floor => {
            let middle = fclamp((mark.share - 0.55) / 0.2, 0.0, 1.0);
            let vein = fmax(1.0 - (at.y.abs() - 5.0).abs() / 1.6, 0.0);
            mix(FLOOR, VEIN, 0.5 * middle * vein)
        }
    }
}

/// Free and attached gingiva. The last row of the gingiva is the mucogingival line.
fn gingiva(mark: &Mark) -> Lab {
    let grade = 3.0 * mark.inflammation;
    // Papillae are inflamed before the margin.
    let early = grade + 0.6 * mark.papilla * fclamp(grade, 0.0, 1.0);
    let rim = graded(&RIM, early);
    let change: Lab = std::array::from_fn(|k| rim[k] - FREE[k]);
    let healthy = mix(FREE, ATTACHED, fclamp((mark.below - 0.8) / 1.2, 0.0, 1.0));
    let deep = DEEP[(grade as usize).min(3)] + mark.papilla;
    let share = 1.0 - (1.0 - BAND) * fclamp((mark.below - deep) / FADES, 0.0, 1.0);
    let lab: Lab = std::array::from_fn(|k| healthy[k] + share * change[k]);
    mix(lab, MUCOSA, beyond(mark))
}

/// Share of the mucosa's colour above the mucogingival line. The step lies half above and half below the line.
fn beyond(mark: &Mark) -> f64 {
    if mark.share < 0.5 {
        return 0.0;
    }
    let whole = mark.below / mark.share;
    fclamp(0.5 + (mark.below - whole) / STEP, 0.0, 0.5)
}

/// Colour of a grade, 0 to 3.
fn graded(colours: &[Lab; 4], grade: f64) -> Lab {
    let at = fclamp(grade, 0.0, 3.0);
    let k = (at as usize).min(2);
    mix(colours[k], colours[k + 1], at - k as f64)
}
