//! The drawn probe.

use super::grip::handle;
use super::turned::Turned;
use super::{DrawnTool, Steel};
use crate::instruments::Probe;
use crate::instruments::tube::AROUND;
use sulcus_core::Vec3;

/// Number of ridges of each grip.
const RIDGES: usize = 25;
/// Room between the last cross-section of the shank and the handle, mm.
const BESIDE_MM: f64 = 0.5;

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
        let rings = self.display_rings();
        let own = rings.iter().filter(|(s, _)| *s < shank - BESIDE_MM);
        for (s, radius) in own {
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
