//! Sizes of the soft tissues by tooth, mm, from the midline backwards (31 to 37).

/// Width of the gingiva from the margin to the mucogingival line on the facial side of a healthy tooth: attached
/// gingiva (Shirmohammadi 2008) and a sulcus of 1.4.
pub const FACIAL: [f64; 7] = [5.0, 5.1, 4.5, 3.8, 4.0, 4.4, 4.3];
/// The same on the lingual side: means of two studies (Shirmohammadi 2008, Voigt 1978) and a sulcus of 1.4.
pub const LINGUAL: [f64; 7] = [4.1, 4.1, 4.4, 4.6, 5.1, 6.5, 6.5];
/// Least width of the gingiva where the margin has receded. Chosen.
pub const LEAST: f64 = 1.2;
/// Distance from the facial margin of a healthy tooth to the bottom of the vestibule. Front: the mean of a study of the
/// vestibule is 6.5 at rest, and 7.6 is chosen for a lip drawn away. Back: chosen.
pub const VESTIBULE: [f64; 7] = [7.6, 7.6, 9.2, 9.0, 9.0, 9.6, 8.4];
/// Depth of the furrows beside a root on the facial side. A first molar stands out by its breadth alone, and tissue
/// fills the furrows beside it: a negative depth. Chosen, as all numbers below.
pub const RELIEF: [f64; 7] = [0.4, 0.4, 0.9, 0.4, 0.4, -0.3, 0.25];
/// Distances below the margin between which the relief fades.
pub const FADES: [f64; 2] = [3.0, 7.5];
/// Height of the healthy facial margin over the cemento-enamel junction.
pub const HEALTHY: f64 = 2.0;
/// Recession of a healthy proximal site.
pub const HEALTHY_PROXIMAL: f64 = -2.5;
/// Thickness of the gingiva over a root at the height of the junction, as simulated (`wall_mm` of a mouth).
pub const WALL: f64 = 1.3;
/// Growth of that thickness for each mm downwards, as simulated.
pub const THICKENING: f64 = 0.1;
/// Half the distance between the facial and the lingual peak of a papilla, by the teeth on its mesial side, the midline
/// first: one tip in front, a broad saddle behind.
pub const PEAKS: [f64; 8] = [0.6, 0.6, 0.65, 0.9, 1.2, 1.5, 1.75, 2.2];
/// Largest height of a papilla's tip over the margin beside it.
pub const RISE: f64 = 1.2;
/// Loss of a papilla at which its tip no longer rises over the margin beside it.
pub const BLUNT: f64 = 2.0;
/// Radius of a healthy margin.
pub const RIM: f64 = 0.14;
/// Depth of the first row of vertices inside the tooth: no light passes between tooth and gingiva.
pub const SUNK: f64 = 0.1;

/// Rounding of the margin and its swelling outwards by inflammation, 0 to 1. Grades 0 to 3 of Loe and Silness lie at 0,
/// 1/3, 2/3 and 1. Chosen; the direction is that of the grades' definitions.
pub fn swollen(inflammation: f64) -> [f64; 2] {
    [
        graded(&[RIM, 0.25, 0.5, 0.8], inflammation),
        graded(&[0.0, 0.1, 0.4, 1.0], inflammation),
    ]
}

/// Value between those of the grades 0 to 3 for an inflammation of 0 to 1.
pub fn graded(values: &[f64; 4], inflammation: f64) -> f64 {
    let at = sulcus_core::math::fclamp(3.0 * inflammation, 0.0, 3.0);
    let k = (at as usize).min(2);
    values[k] + (values[k + 1] - values[k]) * (at - k as f64)
}
