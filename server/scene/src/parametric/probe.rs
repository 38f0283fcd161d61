//! A UNC-15 periodontal probe: working end of 15 mm with a mark at every millimetre and black bands
//! at 4-5, 9-10 and 14-15 mm, ball-ended tip of 0.5 mm, contra-angled shank, handle.
//!
//! Frame of the tool: the origin is the device point, on the handle's axis, about 90 mm from the
//! tip; z runs up the handle; the instrument lies in the xz plane with the tip below and the
//! working end leaning towards +x.

use serde::{Deserialize, Serialize};
use sulcus_core::Vec3;
use sulcus_core::scene::Band;

use super::tube::{Piece, Station, sweep, walk};
use crate::mesh::TriMesh;

/// Dimensions of the probe, millimetres and degrees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Probe {
    /// Diameter of the ball at the tip, mm.
    pub tip_diameter_mm: f64,
    /// Diameter at the 15 mm mark, mm.
    pub neck_diameter_mm: f64,
    /// Length of the straight working end, mm.
    pub working_end_mm: f64,
    /// Angle between working end and handle, degrees.
    pub working_end_deg: f64,
    /// Angle between shank and handle, degrees.
    pub shank_deg: f64,
    /// Distance from the tip to the device point, mm.
    pub reach_mm: f64,
    /// Length from the tip that can touch things, mm. The rest is only looked at.
    pub touching_mm: f64,
    /// Length of the whole instrument along its axis, mm.
    pub length_mm: f64,
    /// How far above the tip the reference point of the optimisation lies, mm.
    pub working_point_mm: f64,
}

impl Default for Probe {
    fn default() -> Self {
        Self {
            tip_diameter_mm: 0.5,
            neck_diameter_mm: 0.95,
            working_end_mm: 16.0,
            working_end_deg: 40.0,
            shank_deg: 24.0,
            reach_mm: 90.0,
            touching_mm: 30.0,
            length_mm: 172.0,
            working_point_mm: 4.0,
        }
    }
}

/// Where a bend ends and the next piece begins, mm: the radius of both bends.
const BEND_MM: f64 = 5.0;
/// Length of the shank between its bends, mm.
const SHANK_MM: f64 = 19.0;

impl Probe {
    /// Centre line at `s` mm from the tip, in the tool's frame, mm.
    fn line(&self) -> impl Fn(f64) -> Station {
        let (working, shank) = (
            -self.working_end_deg.to_radians(),
            self.shank_deg.to_radians(),
        );
        let pieces = [
            Piece {
                length: self.working_end_mm,
                turn: 0.0,
            },
            Piece {
                length: BEND_MM * (shank - working),
                turn: shank - working,
            },
            Piece {
                length: SHANK_MM,
                turn: 0.0,
            },
            Piece {
                length: BEND_MM * shank,
                turn: -shank,
            },
            Piece {
                length: self.length_mm,
                turn: 0.0,
            },
        ];
        // The tip goes where the handle's axis becomes the z axis and the reach is right.
        let bent: f64 = pieces[..4].iter().map(|piece| piece.length).sum();
        let x = -walk(&pieces, working, bent).point.x;
        let tip = Vec3::new(
            x,
            0.0,
            -(self.reach_mm * self.reach_mm - x * x).max(0.0).sqrt(),
        );
        move |s| {
            let mut station = walk(&pieces, working, s);
            station.point += tip;
            station
        }
    }

    /// Radius at `s` mm from the tip, mm.
    fn radius(&self, s: f64) -> f64 {
        let (tip, neck) = (0.5 * self.tip_diameter_mm, 0.5 * self.neck_diameter_mm);
        let bent = self.working_end_mm
            + BEND_MM * (self.working_end_deg + 2.0 * self.shank_deg).to_radians()
            + SHANK_MM;
        let knots = [
            (0.0, tip),
            (tip, tip),
            (15.0, neck),
            (bent, 1.25),
            (bent + 2.0, 1.5),
            (bent + 9.0, 3.6),
            (bent + 12.0, 4.0),
            (bent + 14.0, 3.7),
            (bent + 18.0, 4.0),
            (bent + 44.0, 4.0),
            (self.length_mm - 25.0, 3.6),
            (self.length_mm, 3.0),
        ];
        for pair in knots.windows(2) {
            let ((a, ra), (b, rb)) = (pair[0], pair[1]);
            if s <= b && b > a {
                return ra + (rb - ra) * ((s - a) / (b - a)).clamp(0.0, 1.0);
            }
        }
        knots[knots.len() - 1].1
    }

    /// What touches: working end and shank, closed, metres, tool frame.
    pub fn touching_mesh(&self) -> TriMesh {
        sweep(
            &self.line(),
            &|s| self.radius(s),
            0.0,
            self.touching_mm,
            0.25,
        )
        .placed(1e-3, Vec3::zeros())
    }

    /// The whole instrument, closed, metres, tool frame.
    pub fn display_mesh(&self) -> TriMesh {
        sweep(&self.line(), &|s| self.radius(s), 0.0, self.length_mm, 1.0)
            .placed(1e-3, Vec3::zeros())
    }

    /// The very tip, metres, tool frame.
    pub fn tip(&self) -> Vec3 {
        self.line()(0.0).point * 1e-3
    }

    /// Unit vector along the working end, out of the tip, tool frame.
    pub fn tip_axis(&self) -> Vec3 {
        -self.line()(0.0).along
    }

    /// Reference point of the optimisation, on the working end's axis, metres, tool frame.
    pub fn working_point(&self) -> Vec3 {
        self.line()(self.working_point_mm).point * 1e-3
    }

    /// The fifteen marks, metres from the tip; the black ones are dark.
    pub fn bands(&self) -> Vec<Band> {
        (0..15_u32)
            .map(|mm| Band {
                from: f64::from(mm) * 1e-3,
                to: f64::from(mm + 1) * 1e-3,
                dark: mm % 5 == 4,
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::check;
    use crate::distance::MeshDistance;

    #[test]
    fn both_meshes_are_solids_and_the_points_are_where_they_are_said_to_be() {
        let probe = Probe::default();
        for (name, mesh) in [
            ("touching", probe.touching_mesh()),
            ("display", probe.display_mesh()),
        ] {
            let report = check(&mesh, name).expect("a solid");
            assert_eq!(report.genus, 0);
            let distance = MeshDistance::new(mesh);
            assert!(distance.signed(&probe.tip()).abs() < 1e-9);
            assert!(distance.signed(&(probe.tip() + probe.tip_axis() * 1e-3)) > 0.9e-3);
            let inside = distance.signed(&probe.working_point());
            assert!((-0.35e-3..-0.25e-3).contains(&inside), "{name}: {inside}");
        }
        assert!((probe.tip().norm() - 0.09).abs() < 1e-12);
        assert!((probe.tip_axis().norm() - 1.0).abs() < 1e-12);
        assert!(((probe.tip() - probe.working_point()).norm() - 4e-3).abs() < 1e-12);
        assert!(
            probe.tip().x.abs() < 5e-3,
            "the tip is balanced under the handle: {:?}",
            probe.tip()
        );
        assert!(
            MeshDistance::new(probe.display_mesh()).signed(&Vec3::zeros()) < -3e-3,
            "the device point is in the handle"
        );
    }

    #[test]
    fn the_black_bands_are_those_of_a_unc_15() {
        let dark: Vec<_> = Probe::default()
            .bands()
            .iter()
            .filter(|b| b.dark)
            .map(|b| (b.from * 1e3).round() as u32)
            .collect();
        assert_eq!(dark, [4, 9, 14]);
    }
}
