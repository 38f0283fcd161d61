//! The drawn probe.

use super::grip::handle;
use super::turned::Turned;
use super::{DrawnTool, Steel};
use crate::instruments::Probe;
use crate::instruments::tube::AROUND;
use sulcus_core::Vec3;

/// Number of ridges of each grip.
const RIDGES: usize = 26;
/// Length beside a bend and below the handle without or with cross-sections of its own, mm.
const BESIDE_MM: f64 = 1.0;

impl Probe {
    /// Returns the instrument for a display. Working end and shank are those of [`Probe::display`].
    pub fn drawn(&self) -> DrawnTool {
        let (line, black) = (self.line(), self.black());
        let shank = self.bent();
        let steel = |s: f64| {
            let is_black = black.iter().any(|[from, to]| (*from..=*to).contains(&s));
            if is_black {
                Steel::Black
            } else {
                Steel::Polished
            }
        };
        let mut turned = Turned::from_point(&line, 0.0, Steel::Polished);
        let [first, second] = self.bends();
        let is_needed = |s: f64| {
            let straight = first[1] + BESIDE_MM..second[0] - BESIDE_MM;
            // Between the bends the shank is a straight cone.
            s < shank - 0.5 * BESIDE_MM && !straight.contains(&s)
        };
        let rings = self.display_rings();
        for (s, radius) in rings.iter().filter(|(s, _)| is_needed(*s)) {
            turned.ring(*s, *radius, AROUND, steel(*s));
        }
        handle(
            &mut turned,
            shank,
            self.length_mm,
            self.radius(shank),
            RIDGES,
        );
        DrawnTool {
            mesh: turned.mesh.placed(1e-3, Vec3::zeros()),
            steel: turned.steel,
            glass_radius: None,
        }
    }
}
