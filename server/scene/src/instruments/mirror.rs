//! A mouth mirror: a flat round disc with a rounded edge, tilted to the handle, with a neck.
//!
//! The neck leaves the disc's edge in the disc's plane and bends into the handle. The default is a No. 4 mirror.
//!
//! Sizes are those of the trade: No. 4 is 22 mm, No. 5 is 24 mm, each size 2 mm more than the one before. ISO 9873
//! counts in the same way; instruments longer than 173 mm do not fit its cassettes.
//!
//! No source gives numbers for thickness, edge, neck and angle. They are parameters.
//!
//! Frame of the tool, as for the probe: the origin is the device point, on the handle's axis, 90 mm from the disc's
//! centre. z runs up the handle.
//!
//! The instrument lies in the xz plane with the disc below, its far edge towards +x. The reflecting face points along
//! +x and up: a look down the handle is reflected to the side.

use serde::{Deserialize, Serialize};
use sulcus_core::Vec3;

use super::tube::{Piece, Station, handle, instrument, linear};
use crate::mesh::TriMesh;
use crate::mesh::implicit::ramp;
use crate::mesh::repair::drop_unused;

/// Dimensions of the mirror, millimetres and degrees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Mirror {
    /// Size, as written on the handle: 4 or 5.
    pub number: u8,
    /// Diameter of the disc, mm. Default: that of its size, 22 for No. 4, 24 for No. 5.
    pub disc_diameter_mm: Option<f64>,
    /// Thickness of the disc, glass and frame together, mm.
    pub disc_thickness_mm: f64,
    /// Radius of the round between the disc's faces and its side, mm.
    pub edge_radius_mm: f64,
    /// Angle between the disc's plane and the handle, degrees.
    pub disc_deg: f64,
    /// Diameter of the neck, mm.
    pub neck_diameter_mm: f64,
    /// Length of the straight neck between the disc's edge and the bend, mm.
    pub neck_mm: f64,
    /// Distance from the disc's centre to the device point, mm.
    pub reach_mm: f64,
    /// Length of the touching part from the disc's far edge, along the instrument, mm. The rest is display only.
    pub touching_mm: f64,
    /// Length of the whole instrument along its axis, mm.
    pub length_mm: f64,
}

impl Default for Mirror {
    fn default() -> Self {
        Self {
            number: 4,
            disc_diameter_mm: None,
            disc_thickness_mm: 2.0,
            edge_radius_mm: 0.4,
            disc_deg: 45.0,
            neck_diameter_mm: 1.8,
            neck_mm: 4.0,
            reach_mm: 90.0,
            touching_mm: 40.0,
            length_mm: 172.0,
        }
    }
}

/// Radius of the bend between neck and handle, mm.
pub(super) const BEND_MM: f64 = 8.0;
/// Length over which the neck's foot on the edge of the disc becomes round, mm.
pub(super) const FOOT_MM: f64 = 2.0;
/// Corners of the disc's circumference; the neck's foot is in the middle of a side.
pub(super) const AROUND: usize = 144;
/// Steps of a quarter circle.
const QUARTER: usize = 6;

impl Mirror {
    /// Diameter of the disc, mm.
    pub fn diameter_mm(&self) -> f64 {
        let of_number = 14.0 + 2.0 * f64::from(self.number);
        self.disc_diameter_mm.unwrap_or(of_number)
    }

    /// Returns its size, as written on the handle.
    pub fn name(&self) -> String {
        match self.disc_diameter_mm {
            None => format!("No. {}", self.number),
            Some(diameter) => format!("{diameter} mm"),
        }
    }

    pub(super) fn radius(&self) -> f64 {
        0.5 * self.diameter_mm()
    }

    /// End of the bend, mm along the centre line.
    pub(super) fn bent(&self) -> f64 {
        self.radius() + self.neck_mm + BEND_MM * self.disc_deg.to_radians()
    }

    /// Centre line at `s` mm from the disc's centre, in the tool's frame, mm.
    pub(super) fn line(&self) -> impl Fn(f64) -> Station {
        let turn = self.disc_deg.to_radians();
        let piece = |length, turn| Piece { length, turn };
        let pieces = vec![
            piece(self.radius() + self.neck_mm, 0.0),
            piece(BEND_MM * turn, turn),
            piece(self.length_mm, 0.0),
        ];
        instrument(pieces, -turn, self.bent(), self.reach_mm)
    }

    /// Radius of neck and handle at `s` mm from the disc's centre, mm.
    pub(super) fn thickness(&self, s: f64) -> f64 {
        let bent = self.bent();
        let mut knots = vec![(bent, 0.5 * self.neck_diameter_mm)];
        knots.extend(handle(bent + 12.0, self.length_mm - self.radius()));
        linear(&knots, s)
    }

    /// Returns the touching part: disc, neck and the beginning of the shank, closed, metres, tool frame.
    pub fn touching_mesh(&self) -> TriMesh {
        self.mesh(self.touching_mm - self.radius(), 0.4)
    }

    /// The whole instrument, closed, metres, tool frame.
    pub fn display_mesh(&self) -> TriMesh {
        self.mesh(self.length_mm - self.radius(), 1.0)
    }

    /// The point of the disc's edge farthest from the handle, metres, tool frame.
    pub fn tip(&self) -> Vec3 {
        let centre = self.line()(0.0);
        (centre.point - centre.along * self.radius()) * 1e-3
    }

    /// Unit vector in the disc's plane, out of the tip, tool frame.
    pub fn tip_axis(&self) -> Vec3 {
        -self.line()(0.0).along
    }

    /// Unit normal of the reflecting face, tool frame.
    pub fn face_normal(&self) -> Vec3 {
        self.line()(0.0).side()
    }

    /// Reference point of the optimisation: the disc's centre, metres, tool frame.
    pub fn working_point(&self) -> Vec3 {
        self.line()(0.0).point * 1e-3
    }

    /// Returns the disc's outline from one face to the other: distance from the axis and height, mm. Also returns the
    /// part that is the round edge.
    pub(super) fn outline(&self) -> (Vec<[f64; 2]>, std::ops::RangeInclusive<usize>) {
        let (radius, half) = (self.radius(), 0.5 * self.disc_thickness_mm);
        let round = self.edge_radius_mm;
        let flat = radius - round;
        let rings = (flat / 0.8).ceil() as usize;
        let mut outline: Vec<[f64; 2]> = (1..rings)
            .map(|k| [flat * k as f64 / rings as f64, half])
            .collect();
        let first = outline.len();
        let quarter = |k: usize| std::f64::consts::FRAC_PI_2 * k as f64 / QUARTER as f64;
        for k in 0..=QUARTER {
            let (sin, cos) = (libm::sin(quarter(k)), libm::cos(quarter(k)));
            outline.push([flat + round * sin, half - round * (1.0 - cos)]);
        }
        // The straight part of the side, if any.
        let straight = 2.0 * (half - round);
        let steps = (straight / 0.3).ceil() as usize;
        for k in 1..steps {
            outline.push([radius, half - round - straight * k as f64 / steps as f64]);
        }
        for k in (0..=QUARTER).rev() {
            if k == QUARTER && steps == 0 {
                continue;
            }
            let (sin, cos) = (libm::sin(quarter(k)), libm::cos(quarter(k)));
            outline.push([flat + round * sin, round * (1.0 - cos) - half]);
        }
        let last = outline.len() - 1;
        for k in (1..rings).rev() {
            outline.push([flat * k as f64 / rings as f64, -half]);
        }
        (outline, first..=last)
    }

    /// Disc, and neck and handle up to `end` mm from the disc's centre in steps of `step` mm.
    fn mesh(&self, end: f64, step: f64) -> TriMesh {
        let (outline, edge) = self.outline();
        let (mut mesh, ring) = self.disc(&outline, &edge);
        self.neck(&mut mesh, ring, &self.line(), end, step);
        // Corners of the edge that the neck covers.
        drop_unused(&mut mesh);
        mesh.placed(1e-3, Vec3::zeros())
    }

    /// Returns the disc, mm, open where the neck stands, and the rim of this opening.
    ///
    /// Vertices are the middle of the reflecting face, a ring of [`AROUND`] for each row of the outline, and the
    /// middle of the back.
    pub(super) fn disc(
        &self,
        outline: &[[f64; 2]],
        edge: &std::ops::RangeInclusive<usize>,
    ) -> (TriMesh, Vec<u32>) {
        let line = self.line();
        let centre = line(0.0);
        let (up, across, normal) = (centre.along, Vec3::y(), centre.side());
        let rows = outline.len();
        // Half the foot's width in sides of the circumference.
        let side_mm = std::f64::consts::TAU * self.radius() / AROUND as f64;
        let foot = ((0.5 * self.neck_diameter_mm / side_mm).round() as usize).max(1);
        let half = 0.5 * self.disc_thickness_mm;

        let mut mesh = TriMesh::default();
        mesh.vertices.push(centre.point + normal * half);
        // Corners are counted from the one that begins the foot.
        for &[from_axis, height] in outline {
            for corner in 0..AROUND {
                let turned = (corner as f64 - foot as f64) / AROUND as f64;
                let angle = std::f64::consts::TAU * turned;
                mesh.vertices.push(
                    centre.point
                        + up * (from_axis * libm::cos(angle))
                        + across * (from_axis * libm::sin(angle))
                        + normal * height,
                );
            }
        }
        let bottom = mesh.vertices.len() as u32;
        mesh.vertices.push(centre.point - normal * half);
        let at = |row: usize, corner: usize| (1 + row * AROUND + corner % AROUND) as u32;
        for corner in 0..AROUND {
            mesh.triangles.push([0, at(0, corner + 1), at(0, corner)]);
            mesh.triangles
                .push([bottom, at(rows - 1, corner), at(rows - 1, corner + 1)]);
            for row in 1..rows {
                if corner < 2 * foot && row > *edge.start() && row <= *edge.end() {
                    // The neck stands here.
                    continue;
                }
                let (a, b) = (at(row - 1, corner), at(row - 1, corner + 1));
                let (c, d) = (at(row, corner), at(row, corner + 1));
                mesh.triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
        // The rim of the opening, once around, in the direction that the disc's triangles leave open.
        let (top, low) = (*edge.start(), *edge.end());
        let mut ring: Vec<u32> = (0..2 * foot).map(|corner| at(top, corner)).collect();
        ring.extend((top..low).map(|row| at(row, 2 * foot)));
        ring.extend((1..=2 * foot).rev().map(|corner| at(low, corner)));
        ring.extend((top + 1..=low).rev().map(|row| at(row, 0)));
        (mesh, ring)
    }

    /// Returns the places of the foot's corners in its cross-section, along its side and along y, mm.
    pub(super) fn offsets(&self, mesh: &TriMesh, ring: &[u32]) -> Vec<[f64; 2]> {
        let foot = self.line()(self.radius());
        let of = |v: &u32| {
            let off = mesh.vertices[*v as usize] - foot.point;
            [off.dot(&foot.side()), off.y]
        };
        ring.iter().map(of).collect()
    }

    /// Returns the cross-sections of neck and handle before the round end, mm from the disc's centre, with radii, mm.
    pub(super) fn neck_rings(&self, end: f64, step: f64) -> Vec<(f64, f64)> {
        let begin = self.radius() + 0.25;
        let straight = end - self.thickness(end) - begin;
        let steps = (straight / step).ceil() as usize;
        (0..=steps)
            .map(|k| begin + straight * k as f64 / steps as f64)
            .map(|s| (s, self.thickness(s)))
            .collect()
    }

    /// Returns the corners of a cross-section of the neck, mm. The foot's outline becomes round.
    pub(super) fn neck_ring(&self, offsets: &[[f64; 2]], s: f64, radius: f64) -> Vec<Vec3> {
        let station = self.line()(s);
        let round = ramp(s - self.radius(), 0.0, FOOT_MM);
        let of = |[height, width]: &[f64; 2]| {
            let length = (height * height + width * width).sqrt();
            let mix = |x: f64| x * (1.0 - round) + x / length * radius * round;
            station.point + station.side() * mix(*height) + Vec3::y() * mix(*width)
        };
        offsets.iter().map(of).collect()
    }

    /// Continues the rim of an opening (`ring`) into the neck and closes it with a round end.
    fn neck(
        &self,
        mesh: &mut TriMesh,
        mut ring: Vec<u32>,
        line: &dyn Fn(f64) -> Station,
        end: f64,
        step: f64,
    ) {
        let offsets = self.offsets(mesh, &ring);
        let last = self.thickness(end);
        let mut rings = self.neck_rings(end, step);
        const CAP: usize = 8;
        for k in (1..CAP).rev() {
            let angle = std::f64::consts::FRAC_PI_2 * k as f64 / CAP as f64;
            rings.push((
                end - last * (1.0 - libm::cos(angle)),
                last * libm::sin(angle),
            ));
        }
        let join = |mesh: &mut TriMesh, lower: &[u32], upper: &[u32]| {
            for k in 0..lower.len() {
                let next = (k + 1) % lower.len();
                mesh.triangles.extend([
                    [lower[k], lower[next], upper[next]],
                    [lower[k], upper[next], upper[k]],
                ]);
            }
        };
        for (s, radius) in rings {
            let first = mesh.vertices.len() as u32;
            mesh.vertices.extend(self.neck_ring(&offsets, s, radius));
            let upper: Vec<u32> = (first..mesh.vertices.len() as u32).collect();
            join(mesh, &ring, &upper);
            ring = upper;
        }
        let apex = mesh.vertices.len() as u32;
        mesh.vertices.push(line(end).point);
        for k in 0..ring.len() {
            mesh.triangles
                .push([ring[k], ring[(k + 1) % ring.len()], apex]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::check::check;
    use crate::mesh::distance::MeshDistance;
    use crate::mesh::repair::repair;

    #[test]
    fn both_meshes_are_solids_and_the_points_are_where_they_are_said_to_be() {
        let mirror = Mirror::default();
        for (name, mesh) in [
            ("touching", mirror.touching_mesh()),
            ("display", mirror.display_mesh()),
        ] {
            let report = check(&mesh, name).expect("a solid");
            assert_eq!(report.genus, 0);
            assert!(repair(mesh.clone()).1.is_empty());
            let distance = MeshDistance::new(mesh);
            assert!(distance.signed(&mirror.tip()).abs() < 1e-6);
            let out = mirror.tip() + mirror.tip_axis() * 1e-3;
            assert!((distance.signed(&out) - 1e-3).abs() < 1e-6);
            // The faces are flat and a millimetre from the centre.
            for (face, sign) in [(mirror.face_normal(), 1.0), (-mirror.face_normal(), -1.0)] {
                for across in [-7.0, 0.0, 6.0] {
                    let point = mirror.working_point()
                        + Vec3::y() * (across * 1e-3)
                        + mirror.tip_axis() * (0.4e-3 * across * sign);
                    assert!((distance.signed(&(point + face * 3e-3)) - 2e-3).abs() < 1e-9);
                }
            }
            let inside = distance.signed(&mirror.working_point());
            assert!((inside + 1e-3).abs() < 1e-9, "{name}: {inside}");
        }
        assert!((mirror.working_point().norm() - 0.09).abs() < 1e-12);
        assert!((mirror.tip() - mirror.working_point()).norm() - 11e-3 < 1e-12);
        // 45 degrees between disc and handle, the reflecting face up.
        assert!((mirror.tip_axis().z + 0.5_f64.sqrt()).abs() < 1e-12);
        assert!((mirror.face_normal().z - 0.5_f64.sqrt()).abs() < 1e-12);
        assert!(
            MeshDistance::new(mirror.display_mesh()).signed(&Vec3::zeros()) < -3e-3,
            "the device point is in the handle"
        );
    }

    #[test]
    fn the_disc_has_the_volume_of_a_disc_and_a_round_edge() {
        let mirror = Mirror::default();
        let mesh = mirror.touching_mesh();
        let neck = std::f64::consts::PI * 0.9 * 0.9 * 18.0;
        let disc = std::f64::consts::PI * 11.0 * 11.0 * 2.0;
        let volume = mesh.signed_volume() * 1e9;
        assert!((volume - disc - neck).abs() < 0.02 * disc, "{volume}");
        // On the edge, 45 degrees out of the disc's plane, the round is inside the corner by
        // (sqrt 2 - 1) of its radius.
        let corner = mirror.tip() + mirror.face_normal() * 1e-3;
        let off = MeshDistance::new(mesh).signed(&corner) * 1e3;
        assert!((off - 0.4 * (2.0_f64.sqrt() - 1.0)).abs() < 0.01, "{off}");
    }

    #[test]
    fn numbers_4_and_5_are_22_and_24_mm_wide() {
        for (number, name, wide) in [(4, "No. 4", 22e-3), (5, "No. 5", 24e-3)] {
            let mirror = Mirror {
                number,
                ..Mirror::default()
            };
            assert_eq!(mirror.name(), name);
            let (low, high) = mirror.touching_mesh().bounds();
            assert!((high.y - low.y - wide).abs() < 1e-9);
        }
        assert_eq!(Mirror::default().name(), "No. 4");
    }

    #[test]
    fn only_disc_and_neck_touch() {
        let mirror = Mirror::default();
        let (low, high) = mirror.touching_mesh().bounds();
        assert!((high.y - 11e-3).abs() < 1e-9 && (low.y + 11e-3).abs() < 1e-9);
        let disc = mirror.working_point();
        assert!(high.z - disc.z < 30e-3, "{high}");
        assert!(mirror.display_mesh().bounds().1.z > 60e-3);
    }

    #[test]
    fn every_mirror_that_a_scene_may_ask_for_is_a_solid() {
        let ends = [
            (16.0, 1.0, 0.1, 0.8),
            (16.0, 1.0, 0.5, 1.0),
            (30.0, 4.0, 2.0, 4.0),
            (30.0, 4.0, 0.1, 0.8),
            (22.0, 2.0, 1.0, 2.0),
        ];
        for (disc, thick, round, neck) in ends {
            for disc_deg in [0.0, 45.0, 80.0] {
                for neck_mm in [3.0, 10.0] {
                    for touching_mm in [disc + neck_mm + 5.0, 55.0] {
                        let mirror = Mirror {
                            disc_diameter_mm: Some(disc),
                            disc_thickness_mm: thick,
                            edge_radius_mm: round,
                            neck_diameter_mm: neck,
                            disc_deg,
                            neck_mm,
                            touching_mm,
                            ..Mirror::default()
                        };
                        for mesh in [mirror.touching_mesh(), mirror.display_mesh()] {
                            let report = check(&mesh, "mirror").expect("a solid");
                            assert_eq!(report.genus, 0, "{mirror:?}");
                            assert!(repair(mesh).1.is_empty(), "{mirror:?}");
                        }
                    }
                }
            }
        }
    }
}
