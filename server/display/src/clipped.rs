//! A gingiva that is a mesh of a scene file, without the wall and the floor of its pocket.

use std::f64::consts::TAU;

use sulcus_core::tissue::gingiva::ToothFrame;
use sulcus_core::{DisplayMesh, Vec3};

/// Height below the margin down to which the pocket's wall is kept, metres. Chosen.
const SEEN_M: f64 = 5e-4;
/// Distance outside the crest up to which a face towards the tooth belongs to the pocket, metres. Chosen.
const BULGE_M: f64 = 1.5e-3;
/// Number of sectors round the tooth in which the crest is searched.
const SECTORS: usize = 36;
/// Largest height of a vertex over or under the margin for the crest, metres.
const CREST_M: f64 = 5e-4;

/// Surroundings of one pocket.
pub struct Pocket<'a> {
    /// Frame of the tooth.
    pub tooth: ToothFrame,
    /// Height of the margin over the tooth's origin at an angle (radians from mesial over buccal), metres.
    pub margin: &'a dyn Fn(f64) -> f64,
}

impl Pocket<'_> {
    /// Distance of the crest from the tooth's axis in each sector, metres. A sector without a vertex at the margin has
    /// the larger distance of the nearest sectors on both sides. Without any vertex at the margin the distance is
    /// `f64::INFINITY`, so that nothing below the margin is shown.
    pub fn crest(&self, vertices: &[Vec3]) -> [f64; SECTORS] {
        let mut crest = [f64::INFINITY; SECTORS];
        for v in vertices {
            let (around, height) = self.tooth.cylindrical(v);
            if (height - (self.margin)(around)).abs() < CREST_M {
                let crest = &mut crest[sector(around)];
                let r = self.tooth.from_axis(v);
                if r < *crest {
                    *crest = r;
                }
            }
        }
        std::array::from_fn(|k| {
            if crest[k].is_finite() {
                return crest[k];
            }
            let at = |step: usize| crest[(k + step) % SECTORS];
            let before = (1..SECTORS).rev().map(at).find(|r| r.is_finite());
            let after = (1..SECTORS).map(at).find(|r| r.is_finite());
            before.zip(after).map_or(f64::INFINITY, |(a, b)| a.max(b))
        })
    }

    /// Point of the crest at an angle, world axes, metres.
    pub fn at_margin(&self, crest: &[f64; SECTORS], around: f64) -> Vec3 {
        let r = crest[sector(around)];
        // A sector without a crest has its place at the axis.
        let r = if r.is_finite() { r } else { 0.0 };
        let tooth = &self.tooth;
        let out = tooth.mesial * around.cos() + tooth.buccal * around.sin();
        tooth.origin + out * r + tooth.axis * (self.margin)(around)
    }

    /// Whether a triangle belongs to the pocket's wall or floor, or lies in the tooth.
    fn is_hidden(&self, crest: &[f64; SECTORS], corners: &[Vec3; 3]) -> bool {
        let [a, b, c] = corners;
        let middle = (a + b + c) / 3.0;
        let (around, height) = self.tooth.cylindrical(&middle);
        if (self.margin)(around) - height < SEEN_M {
            return false;
        }
        let from = middle - self.tooth.origin;
        let away = from - self.tooth.axis * from.dot(&self.tooth.axis);
        let (r, crest) = (away.norm(), crest[sector(around)]);
        let faces_tooth = (b - a).cross(&(c - a)).dot(&away) < 0.0;
        r < crest || (faces_tooth && r < crest + BULGE_M)
    }

    /// Returns the mesh without hidden triangles, and without vertices that no triangle needs.
    pub fn clip(&self, mesh: &DisplayMesh) -> DisplayMesh {
        let place = |v: &[f32; 3]| Vec3::from(v.map(f64::from));
        let vertices: Vec<Vec3> = mesh.vertices.iter().map(place).collect();
        let crest = self.crest(&vertices);
        let is_seen = |triangle: &&[u32; 3]| {
            let corners = triangle.map(|v| vertices[v as usize]);
            !self.is_hidden(&crest, &corners)
        };
        let mut kept: Vec<[u32; 3]> = mesh.triangles.iter().filter(is_seen).copied().collect();
        let mut number = vec![u32::MAX; vertices.len()];
        let mut clipped = DisplayMesh {
            colour: mesh.colour,
            ..DisplayMesh::default()
        };
        for v in kept.iter_mut().flatten() {
            let old = *v as usize;
            if number[old] == u32::MAX {
                number[old] = clipped.vertices.len() as u32;
                clipped.vertices.push(mesh.vertices[old]);
                clipped.vertex_colours.extend(mesh.vertex_colours.get(old));
            }
            *v = number[old];
        }
        clipped.triangles = kept;
        clipped
    }
}

fn sector(around: f64) -> usize {
    let turns = around / TAU;
    ((turns - turns.floor()) * SECTORS as f64) as usize % SECTORS
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Collar of 64 columns: outer face, crest, wall and floor of a pocket of `depth`, open below.
    fn collar(depth: f64) -> DisplayMesh {
        let rows = [
            (6.0, -9.0),
            (6.0, 0.0),
            (5.0, 0.0),
            (5.2, -depth),
            (4.0, -depth),
        ];
        let mut mesh = DisplayMesh::default();
        for k in 0..64 {
            let (s, c) = (TAU * f64::from(k) / 64.0).sin_cos();
            for (r, z) in rows {
                mesh.vertices
                    .push([r * c, r * s, z].map(|x| (x * 1e-3) as f32));
            }
        }
        for k in 0..64u32 {
            for row in 0..4u32 {
                let (a, b) = (5 * k + row, 5 * ((k + 1) % 64) + row);
                mesh.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
            }
        }
        mesh
    }

    fn tooth() -> ToothFrame {
        ToothFrame {
            origin: Vec3::zeros(),
            axis: Vec3::z(),
            mesial: Vec3::x(),
            buccal: Vec3::y(),
        }
    }

    #[test]
    fn wall_and_floor_are_cut_and_no_depth_is_left() {
        let pocket = Pocket {
            tooth: tooth(),
            margin: &|_| 0.0,
        };
        let of = |depth| pocket.clip(&collar(depth));
        let shallow = of(2.0);
        assert_eq!(shallow.triangles.len(), 2 * 2 * 64, "outer face and crest");
        assert_eq!(shallow.vertices.len(), 3 * 64);
        for depth in [2.5, 4.0, 7.0] {
            assert_eq!(of(depth), shallow, "{depth} mm");
        }
    }

    #[test]
    fn without_a_crest_everything_below_the_margin_is_cut() {
        let pocket = Pocket {
            tooth: tooth(),
            margin: &|_| 3e-3,
        };
        assert!(pocket.clip(&collar(2.0)).triangles.is_empty());
    }
}
