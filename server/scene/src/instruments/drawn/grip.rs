//! Profile of a drawn handle: taper, two knurled grips, rounded end.
//!
//! Sizes are chosen within those of the trade: handles of 10 mm need least pinch (Dong et al. 2006, JADA 137:1123);
//! rings 0.8 to 1.0 mm apart; a taper over 8 to 10 mm down to 5 mm at the shank.

use super::Steel;
use super::turned::Turned;

/// Corners of a cross-section of the handle.
const AROUND: usize = 18;
/// Radius of the handle, mm.
const RADIUS_MM: f64 = 5.0;
/// Radius at the thin end of the taper, mm.
const THIN_MM: f64 = 2.5;
/// Length of the round shoulder between shank and taper, mm.
const SHOULDER_MM: f64 = 1.6;
/// Length of the taper, mm.
const TAPER_MM: f64 = 9.0;
/// Plain part between taper and first grip, mm.
const PLAIN_MM: f64 = 1.5;
/// Distance between the ridges of a grip, mm.
pub(super) const PITCH_MM: f64 = 1.0;
/// Depth of a grip's grooves, mm.
const DEPTH_MM: f64 = 0.3;
/// Distance from the start of the first grip to the start of the second, mm.
const APART_MM: f64 = 60.0;

/// Adds a handle that begins where the shank ends, at `from` mm along the line, and ends at `to`. Each grip has
/// `ridges` ridges. `shank` is the radius at `from`, mm.
pub(super) fn handle(turned: &mut Turned<'_>, from: f64, to: f64, shank: f64, ridges: usize) {
    turned.ring(from, shank, AROUND, Steel::Polished);
    turned.crease(from, Steel::Satin);
    for k in 1..=3 {
        // A quarter ellipse.
        let angle = std::f64::consts::FRAC_PI_2 * f64::from(k) / 3.0;
        let s = from + SHOULDER_MM * (1.0 - libm::cos(angle));
        let r = shank + (THIN_MM - shank) * libm::sin(angle);
        turned.ring(s, r, AROUND, Steel::Satin);
    }
    let tapered = from + SHOULDER_MM + TAPER_MM;
    for k in 1..=3 {
        let share = f64::from(k) / 3.0;
        let r = THIN_MM + (RADIUS_MM - THIN_MM) * share;
        turned.ring(
            from + SHOULDER_MM + TAPER_MM * share,
            r,
            AROUND,
            Steel::Satin,
        );
    }
    for zone in 0..2 {
        let begin = tapered + PLAIN_MM + APART_MM * f64::from(zone);
        turned.ring(begin, RADIUS_MM, AROUND, Steel::Satin);
        turned.crease(begin, Steel::Ridge);
        for ridge in 0..ridges {
            let s = begin + PITCH_MM * ridge as f64;
            turned.ring(
                s + 0.5 * PITCH_MM,
                RADIUS_MM - DEPTH_MM,
                AROUND,
                Steel::Groove,
            );
            turned.crease(s + 0.5 * PITCH_MM, Steel::Groove);
            turned.ring(s + PITCH_MM, RADIUS_MM, AROUND, Steel::Ridge);
            let is_last = ridge + 1 == ridges;
            let next = if is_last { Steel::Satin } else { Steel::Ridge };
            turned.crease(s + PITCH_MM, next);
        }
    }
    for (back, narrower) in [(2.5, 0.0), (1.2, 0.4), (0.4, 1.1), (0.0, 2.2)] {
        turned.ring(to - back, RADIUS_MM - narrower, AROUND, Steel::Satin);
    }
    turned.close(to, Steel::Satin);
}
