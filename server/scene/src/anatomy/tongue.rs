//! A tongue at rest: broad rounded root, arched back with a slight groove along its middle, thin rounded tip above
//! the floor of the mouth.
//!
//! Frame: x anterior (root to tip), y to the patient's left, z up. The origin lies in the middle of the length and of
//! the width, at the height of the underside.
//!
//! The shape is a superellipsoid. Its width, back and underside follow curves along its length.

use sulcus_core::Vec3;
use sulcus_core::math::fclamp;

use crate::file::Tongue;
use crate::mesh::TriMesh;
use crate::mesh::implicit::{bell, ramp, through};
use crate::mesh::polygonise::polygonise;

/// Places along the length, root -1 to tip 1, with width, back and underside there in units of the whole.
const ALONG: [f64; 6] = [-1.0, -0.6, -0.15, 0.3, 0.7, 1.0];
const WIDTH: [f64; 6] = [0.9, 1.0, 1.0, 0.94, 0.76, 0.58];
const BACK: [f64; 6] = [0.8, 0.94, 1.0, 0.92, 0.72, 0.6];
const UNDERSIDE: [f64; 6] = [0.0, 0.0, 0.0, 0.02, 0.14, 0.24];
/// Exponents of the section across and of the outline along.
const ACROSS: f64 = 2.4;
const OUTLINE: f64 = 3.2;
/// Half width of the groove, in units of the width.
const GROOVE: f64 = 0.07;

impl Tongue {
    /// The closed surface, metres, in the frame of this module.
    pub fn mesh(&self) -> TriMesh {
        let margin = 2.0 * self.grid_mm + 1.0;
        let half = Vec3::new(0.5 * self.length_mm, 0.5 * self.width_mm, 0.0);
        let low = -half - Vec3::repeat(margin);
        let high = half + Vec3::new(margin, margin, self.height_mm + margin);
        polygonise(&|p| self.drawn(p), low, high, self.grid_mm).placed(1e-3, Vec3::zeros())
    }

    /// Returns about the distance to the surface near it, mm; negative inside.
    fn drawn(&self, p: &Vec3) -> f64 {
        let along = p.x / (0.5 * self.length_mm);
        let near = fclamp(along, -1.0, 1.0);
        let width = 0.5 * self.width_mm * through(&ALONG, &WIDTH, near);
        let back = self.height_mm * through(&ALONG, &BACK, near);
        let under = self.height_mm * through(&ALONG, &UNDERSIDE, near);
        let (middle, half) = (0.5 * (back + under), 0.5 * (back - under));
        let v = (p.z - middle) / half;
        let across = libm::pow((p.y / width).abs(), ACROSS) + libm::pow(v.abs(), ACROSS);
        let whole = libm::pow(across, OUTLINE / ACROSS) + libm::pow(along.abs(), OUTLINE);
        let groove = self.groove_mm
            * bell(p.y, GROOVE * self.width_mm)
            * ramp(v, 0.2, 0.8)
            * ramp(1.0 - along.abs(), 0.05, 0.5);
        (libm::pow(whole, 1.0 / OUTLINE) - 1.0) * half + groove
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::check::check;

    #[test]
    fn is_a_solid_of_the_size_asked_for() {
        for tongue in [
            Tongue::default(),
            Tongue {
                length_mm: 64.0,
                width_mm: 42.0,
                height_mm: 24.0,
                groove_mm: 0.0,
                grid_mm: 1.5,
            },
        ] {
            let report = check(&tongue.mesh(), "tongue").expect("a solid");
            assert_eq!(report.genus, 0, "{report:?}");
            let wanted = [tongue.length_mm, tongue.width_mm, tongue.height_mm];
            for (found, wanted) in report.size_mm.iter().zip(wanted) {
                assert!((found / wanted - 1.0).abs() < 0.06, "{report:?}");
            }
            let share = report.volume_mm3 / wanted.iter().product::<f64>();
            assert!((0.45..0.8).contains(&share), "{report:?}");
        }
    }

    #[test]
    fn has_a_groove_a_thin_tip_and_a_thick_root() {
        let tongue = Tongue::default();
        let top = |x: f64, y: f64| {
            let mut z = 40.0;
            while z > 0.0 && tongue.drawn(&Vec3::new(x, y, z)) > 0.0 {
                z -= 0.01;
            }
            z
        };
        let flat = Tongue {
            groove_mm: 0.0,
            ..tongue.clone()
        };
        let inside = Vec3::new(0.0, 0.0, top(0.0, 0.0) + 0.5);
        assert!(tongue.drawn(&inside) > 0.0 && flat.drawn(&inside) < 0.0);
        // Symmetric, and thinner at the tip than at the root.
        for p in [Vec3::new(3.0, 9.0, 20.0), Vec3::new(30.0, 5.0, 8.0)] {
            let mirrored = Vec3::new(p.x, -p.y, p.z);
            assert_eq!(
                tongue.drawn(&p).to_bits(),
                tongue.drawn(&mirrored).to_bits()
            );
        }
        let thick = |x: f64| {
            let steps = (0..400).map(|k| Vec3::new(x, 0.0, 0.1 * f64::from(k)));
            steps.filter(|p| tongue.drawn(p) < 0.0).count() as f64 * 0.1
        };
        assert!(
            thick(36.0) < 0.7 * thick(-36.0),
            "{} {}",
            thick(36.0),
            thick(-36.0)
        );
    }
}
