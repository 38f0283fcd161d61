//! A periodontal probe: a straight working end with marks, a ball-ended tip of 0.5 mm, contra-angled shank, handle.
//!
//! The default is UNC-15; [`Marking`] is the pattern of marks. A WHO probe's tip is a real ball on a thinner stem.
//!
//! The tip's diameter is Carranza's (Clinical Periodontology, 12th ed.). Studies have used 0.35 to over 1.0 mm. The
//! ball of 0.5 mm is that of the WHO (Ainamo et al. 1982, Int Dent J 32:281).
//!
//! No source gives numbers for the bends, the lengths and the thickness further up. They are parameters.
//!
//! Frame of the tool: the origin is the device point, on the handle's axis, about 90 mm from the tip. z runs up the
//! handle.
//!
//! The instrument lies in the xz plane with the tip below. The working end leans towards +x.

use serde::{Deserialize, Serialize};
use sulcus_core::scene::Band;
use sulcus_core::{DisplayMesh, Vec3};

use super::marking::Marking;
use super::tube::{Piece, Station, handle, instrument, linear, rings, sweep};
use crate::mesh::TriMesh;

/// Dimensions of the probe, millimetres and degrees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Probe {
    /// Pattern of marks.
    pub marking: Marking,
    /// Diameter of the round end or ball at the tip, mm.
    pub tip_diameter_mm: f64,
    /// Diameter directly behind the tip, mm. Default: the tip's own, and 0.35 behind a WHO probe's ball.
    pub stem_diameter_mm: Option<f64>,
    /// Returns the diameter 15 mm from the tip, mm. Default: 0.95, and 0.8 for a WHO probe.
    pub neck_diameter_mm: Option<f64>,
    /// Length of the straight working end, mm.
    pub working_end_mm: f64,
    /// Angle between working end and handle, degrees.
    pub working_end_deg: f64,
    /// Angle between shank and handle, degrees.
    pub shank_deg: f64,
    /// Distance from the tip to the device point, mm.
    pub reach_mm: f64,
    /// Length of the touching part from the tip, mm. The rest is display only.
    pub touching_mm: f64,
    /// Length of the whole instrument along its axis, mm.
    pub length_mm: f64,
    /// Height of the reference point of the optimisation above the tip, mm.
    pub working_point_mm: f64,
}

impl Default for Probe {
    fn default() -> Self {
        Self {
            marking: Marking::Unc15,
            tip_diameter_mm: 0.5,
            stem_diameter_mm: None,
            neck_diameter_mm: None,
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

/// Radius of both bends, mm.
const BEND_MM: f64 = 5.0;
/// Length of the shank between its bends, mm.
const SHANK_MM: f64 = 19.0;

/// Width of an engraved line, as drawn, mm.
const LINE_MM: f64 = 0.2;
/// Length over which black becomes steel, as drawn, mm.
const FADE_MM: f64 = 0.03;
/// Distance between cross-sections of the display mesh, mm.
const DISPLAY_STEP_MM: f64 = 1.0;
/// Colour of black marks, sRGB with alpha.
const BLACK: [u8; 4] = [24, 24, 26, 255];
/// Steps of the ball's upper half.
const BALL: usize = 8;

impl Probe {
    /// Returns the diameter directly behind the tip, mm.
    pub fn stem_mm(&self) -> f64 {
        self.stem_diameter_mm.unwrap_or(match self.marking {
            Marking::Unc15 | Marking::Williams => self.tip_diameter_mm,
            Marking::Who => 0.7 * self.tip_diameter_mm,
        })
    }

    /// Diameter 15 mm from the tip, mm.
    pub fn neck_mm(&self) -> f64 {
        self.neck_diameter_mm.unwrap_or(match self.marking {
            Marking::Unc15 | Marking::Williams => 0.95,
            Marking::Who => 0.8,
        })
    }

    /// End of the bends, mm along the centre line.
    pub(super) fn bent(&self) -> f64 {
        self.working_end_mm
            + BEND_MM * (self.working_end_deg + 2.0 * self.shank_deg).to_radians()
            + SHANK_MM
    }

    /// Start and end of both bends, mm along the centre line.
    pub(super) fn bends(&self) -> [[f64; 2]; 2] {
        let end = self.bent();
        let first = BEND_MM * (self.working_end_deg + self.shank_deg).to_radians();
        let second = BEND_MM * self.shank_deg.to_radians();
        let straight = self.working_end_mm;
        [[straight, straight + first], [end - second, end]]
    }

    /// Centre line at `s` mm from the tip, in the tool's frame, mm.
    pub(super) fn line(&self) -> impl Fn(f64) -> Station {
        let (working, shank) = (
            -self.working_end_deg.to_radians(),
            self.shank_deg.to_radians(),
        );
        let piece = |length, turn| Piece { length, turn };
        let pieces = vec![
            piece(self.working_end_mm, 0.0),
            piece(BEND_MM * (shank - working), shank - working),
            piece(SHANK_MM, 0.0),
            piece(BEND_MM * shank, -shank),
            piece(self.length_mm, 0.0),
        ];
        let bent = pieces[..4].iter().map(|piece| piece.length).sum();
        instrument(pieces, working, bent, self.reach_mm)
    }

    /// Returns the radius at `s` mm from the tip, mm. Below the middle of the round end it is that of the round end.
    pub(super) fn radius(&self, s: f64) -> f64 {
        let (tip, stem) = (0.5 * self.tip_diameter_mm, 0.5 * self.stem_mm());
        let mut knots = vec![(0.0, stem), (tip, stem)];
        if self.ball_end().is_some() {
            // Behind a ball the stem is straight over the length of the ball.
            knots.push((2.0 * tip, stem));
        }
        knots.push((15.0, 0.5 * self.neck_mm()));
        knots.extend(handle(self.bent(), self.length_mm));
        let bar = linear(&knots, s);
        let over = (s - tip).max(0.0);
        match self.ball_end() {
            Some(end) if s < end => (tip * tip - over * over).sqrt(),
            _ => bar,
        }
    }

    /// Returns the place where the ball ends and the stem begins, mm from the tip; `None` if the stem is as thick as
    /// the tip.
    fn ball_end(&self) -> Option<f64> {
        let (tip, stem) = (0.5 * self.tip_diameter_mm, 0.5 * self.stem_mm());
        (stem < tip).then(|| tip + (tip * tip - stem * stem).sqrt())
    }

    /// Returns the cross-sections of the ball's upper half, mm from the tip.
    fn ball_sections(&self) -> Vec<f64> {
        let Some(end) = self.ball_end() else {
            return Vec::new();
        };
        let tip = 0.5 * self.tip_diameter_mm;
        let whole = libm::asin((end - tip) / tip);
        let at = |k: usize| tip + tip * libm::sin(whole * k as f64 / BALL as f64);
        (1..BALL).map(at).chain([end]).collect()
    }

    /// Returns the touching part: working end and shank, closed, metres, tool frame.
    pub fn touching_mesh(&self) -> TriMesh {
        self.swept(self.touching_mm, 0.25, &self.ball_sections())
    }

    /// Returns the whole instrument, closed, metres, tool frame, with cross-sections at every change of colour.
    pub fn display_mesh(&self) -> TriMesh {
        self.swept(self.length_mm, DISPLAY_STEP_MM, &self.display_sections())
    }

    /// Returns the cross-sections at every change of colour and of the ball, mm from the tip.
    fn display_sections(&self) -> Vec<f64> {
        let half = 0.5 * FADE_MM;
        let black = self.marking.black(LINE_MM);
        let borders = black.iter().flatten();
        let mut sections: Vec<f64> = borders.flat_map(|s| [s - half, s + half]).collect();
        sections.extend(self.ball_sections());
        sections.sort_by(f64::total_cmp);
        sections
    }

    /// Returns the cross-sections of the display mesh, mm from the tip, each with its radius, mm.
    pub(super) fn display_rings(&self) -> Vec<(f64, f64)> {
        let radius = |s| self.radius(s);
        let also = self.display_sections();
        rings(&radius, 0.0, self.length_mm, DISPLAY_STEP_MM, &also)
    }

    /// Returns the black stretches, mm from the tip, ascending.
    pub(super) fn black(&self) -> Vec<[f64; 2]> {
        self.marking.black(LINE_MM)
    }

    fn swept(&self, to: f64, step: f64, also: &[f64]) -> TriMesh {
        let radius = |s| self.radius(s);
        sweep(&self.line(), &radius, 0.0, to, step, also).placed(1e-3, Vec3::zeros())
    }

    /// Returns the whole instrument for display, in the given colour of steel, with its marks.
    pub fn display(&self, steel: [u8; 4]) -> DisplayMesh {
        let mesh = self.display_mesh();
        let (tip, along, black) = (self.tip(), -self.tip_axis(), self.marking.black(LINE_MM));
        let colour_at = |vertex: &Vec3| {
            // Above the marks the value is no length along the bar, but it exceeds the last mark's.
            let s = (vertex - tip).dot(&along) * 1e3;
            let is_black = black.iter().any(|[from, to]| (*from..=*to).contains(&s));
            if is_black { BLACK } else { steel }
        };
        let mut display = mesh.to_display(steel);
        display.vertex_colours = mesh.vertices.iter().map(colour_at).collect();
        display
    }

    /// Returns the foremost point of the tip, metres, tool frame.
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

    /// Returns the bands by which a depth is read, metres from the tip.
    pub fn bands(&self) -> Vec<Band> {
        self.marking.bands()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::check::check;
    use crate::mesh::distance::MeshDistance;

    fn of(marking: Marking) -> Probe {
        Probe {
            marking,
            ..Probe::default()
        }
    }

    #[test]
    fn both_meshes_are_solids_and_the_points_are_where_they_are_said_to_be() {
        for marking in Marking::ALL {
            let probe = of(marking);
            let thick = match marking {
                Marking::Who => -0.24e-3..-0.2e-3,
                _ => -0.35e-3..-0.25e-3,
            };
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
                assert!(thick.contains(&inside), "{marking:?} {name}: {inside}");
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
    }

    /// Returns the largest distance of the mesh from the working end's axis between two distances from the tip, mm.
    fn widest(probe: &Probe, mesh: &TriMesh, from: f64, to: f64) -> f64 {
        let (tip, along) = (probe.tip(), -probe.tip_axis());
        let seen = mesh.vertices.iter().map(|v| {
            let s = (v - tip).dot(&along);
            (s * 1e3, (v - tip - along * s).norm() * 1e3)
        });
        let between = seen.filter(|(s, _)| (from..=to).contains(s));
        between.fold(0.0, |wide, (_, r)| if r > wide { r } else { wide })
    }

    #[test]
    fn a_who_probe_has_a_ball_of_half_a_millimetre_on_a_thinner_stem() {
        let probe = of(Marking::Who);
        let mesh = probe.touching_mesh();
        // A ball: all its points have the same distance from its centre, and nothing is wider before the bar is.
        let centre = probe.tip() - probe.tip_axis() * 0.25e-3;
        let end = probe.ball_end().expect("a ball");
        let mut seen = 0;
        for vertex in &mesh.vertices {
            let s = (vertex - probe.tip()).dot(&-probe.tip_axis()) * 1e3;
            if s <= end - 1e-6 {
                assert!(((vertex - centre).norm() - 0.25e-3).abs() < 1e-9, "{s}");
                seen += 1;
            }
        }
        assert!(seen > 300, "{seen}");
        assert!((widest(&probe, &mesh, 0.0, 1.0) - 0.25).abs() < 1e-9);
        let stem = widest(&probe, &mesh, end - 1e-9, 0.75);
        assert!((0.17..0.19).contains(&stem), "{stem}");
        // The others are cones from the tip up.
        for marking in [Marking::Unc15, Marking::Williams] {
            let (probe, mesh) = (of(marking), of(marking).touching_mesh());
            assert!((widest(&probe, &mesh, 0.0, 0.25 + 1e-9) - 0.25).abs() < 1e-9);
            assert!(widest(&probe, &mesh, 0.0, 1.0) > 0.26);
        }
    }

    #[test]
    fn every_black_band_and_line_is_seen_where_it_is_and_as_wide() {
        let steel = [176, 182, 188, 255];
        for marking in Marking::ALL {
            let probe = of(marking);
            let (mesh, shown) = (probe.display_mesh(), probe.display(steel));
            assert_eq!(shown.vertex_colours.len(), mesh.vertices.len());
            // Black area: triangles by the share of their corners.
            let (tip, along) = (probe.tip(), -probe.tip_axis());
            let area = |from: f64, to: f64| {
                let mut black = 0.0;
                for (t, triangle) in mesh.triangles.iter().enumerate() {
                    let middle = mesh.corners(t).iter().sum::<Vec3>() / 3.0;
                    let s = (middle - tip).dot(&along) * 1e3;
                    let dark = triangle.map(|v| shown.vertex_colours[v as usize] == BLACK);
                    let share = dark.iter().filter(|dark| **dark).count() as f64 / 3.0;
                    if (from..to).contains(&s) {
                        black += share * 0.5 * mesh.area_vector(t).norm() * 1e6;
                    }
                }
                black
            };
            let mut all = 0.0;
            for [from, to] in marking.black(LINE_MM) {
                let around = std::f64::consts::TAU * probe.radius(0.5 * (from + to));
                let found = area(from - FADE_MM, to + FADE_MM) / around;
                assert!(
                    (found / (to - from) - 1.0).abs() < 0.02,
                    "{marking:?} {from} {to} {found}"
                );
                all += area(from - FADE_MM, to + FADE_MM);
            }
            // No other part is black, also not the handle.
            assert!((area(-1.0, 200.0) - all).abs() < 1e-9);
        }
    }
}
