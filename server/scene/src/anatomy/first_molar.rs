//! A lower left first molar (FDI 36): five cusps, central fossa and grooves, constricted neck, root
//! trunk, and a mesial and a distal root.
//!
//! Frame: x mesial (anterior), y buccal (the patient's left), z occlusal (up). The origin lies on the tooth's axis at
//! the height of the buccal cemento-enamel junction (CEJ).
//!
//! The crown is a barrel cut by an occlusal height field. The barrel is a superellipse whose four walls follow the
//! contours of the tooth. The height field has cones for cusps and bars for the marginal ridges.
//!
//! The roots are flattened tapering tubes. Smooth minima and maxima join all parts.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmax};

use crate::file::Molar;
use crate::mesh::TriMesh;
use crate::mesh::implicit::{bell, ramp, smooth_max, smooth_min, through};
use crate::mesh::polygonise::polygonise;

// The shape below is drawn for these dimensions and stretched to the requested ones.
const DRAWN_MESIODISTAL: f64 = 11.0;
const DRAWN_BUCCOLINGUAL: f64 = 10.3;
const DRAWN_CROWN: f64 = 7.5;
const DRAWN_ROOT: f64 = 13.5;

/// Heights of the wall contours.
const LEVELS: [f64; 9] = [-5.0, -3.0, -1.2, 0.0, 1.0, 2.5, 4.5, 6.2, 8.5];
const BUCCAL: [f64; 9] = [3.4, 3.9, 4.2, 4.35, 4.95, 5.15, 4.7, 3.95, 2.7];
const LINGUAL: [f64; 9] = [-3.4, -3.8, -4.1, -4.25, -4.6, -4.95, -5.15, -4.75, -3.7];
const MESIAL: [f64; 9] = [4.0, 4.2, 4.35, 4.45, 4.75, 5.15, 5.55, 5.35, 4.6];
const DISTAL: [f64; 9] = [-3.9, -4.1, -4.25, -4.35, -4.65, -5.0, -5.4, -5.0, -4.2];

/// Tip (x, y, z), steepness and radius of the tip of a cusp.
struct Cusp {
    tip: [f64; 3],
    slope: f64,
    blunt: f64,
}

/// Mesiobuccal, distobuccal, distal, mesiolingual, distolingual. The buccal ones are blunter.
const CUSPS: [Cusp; 5] = [
    Cusp {
        tip: [2.95, 2.75, 7.15],
        slope: 0.86,
        blunt: 0.75,
    },
    Cusp {
        tip: [-0.75, 2.95, 7.05],
        slope: 0.86,
        blunt: 0.75,
    },
    Cusp {
        tip: [-3.75, 1.55, 6.5],
        slope: 0.80,
        blunt: 0.7,
    },
    Cusp {
        tip: [2.75, -2.95, 7.65],
        slope: 0.98,
        blunt: 0.55,
    },
    Cusp {
        tip: [-2.05, -3.0, 7.5],
        slope: 0.96,
        blunt: 0.55,
    },
];

/// Knots of a root's centre line (x, z), its mesiodistal half width and its buccolingual stretch.
struct Root {
    x: [f64; 4],
    z: [f64; 4],
    half: [f64; 4],
    stretch: [f64; 4],
    /// Depth of the groove that runs down its mesial and distal faces.
    groove: f64,
}

/// Broad and flat; its apex is swept distally.
const MESIAL_ROOT: Root = Root {
    x: [2.1, 2.75, 2.75, 1.75],
    z: [-0.8, -5.0, -9.4, -12.6],
    half: [2.15, 1.85, 1.45, 0.9],
    stretch: [1.65, 2.0, 1.9, 1.5],
    groove: 0.34,
};

/// Rounder and straighter.
const DISTAL_ROOT: Root = Root {
    x: [-2.0, -2.75, -3.2, -3.4],
    z: [-0.8, -5.0, -9.0, -11.9],
    half: [2.15, 1.85, 1.4, 0.9],
    stretch: [1.6, 1.75, 1.55, 1.3],
    groove: 0.14,
};

impl Molar {
    /// The closed surface, metres, in the frame of this module.
    pub fn mesh(&self) -> TriMesh {
        let stretch = self.stretch_up();
        let drawn = |p: &Vec3| {
            let z = p.z
                / if p.z > 0.0 {
                    stretch.z
                } else {
                    self.root_length_mm / DRAWN_ROOT
                };
            self.drawn(&Vec3::new(p.x / stretch.x, p.y / stretch.y, z))
        };
        let low = Vec3::new(
            -6.5 * stretch.x,
            -6.2 * stretch.y,
            -(self.root_length_mm + 1.2),
        );
        let high = Vec3::new(6.6 * stretch.x, 6.2 * stretch.y, self.crown_height_mm + 1.5);
        // In a groove narrower than the grid, two walls may share an edge on one grid and not on the next. The first
        // grid that gives a manifold is taken.
        let on_grid = |k: u32| {
            let shift = Vec3::new(0.37, 0.61, 0.83) * (self.grid_mm * 0.25 * f64::from(k));
            polygonise(&drawn, low - shift, high, self.grid_mm).placed(1e-3, Vec3::zeros())
        };
        let mut mesh = on_grid(0);
        for k in 1..8 {
            if crate::mesh::check::check(&mesh, "molar").is_ok() {
                break;
            }
            mesh = on_grid(k);
        }
        mesh
    }

    fn stretch_up(&self) -> Vec3 {
        Vec3::new(
            self.mesiodistal_mm / DRAWN_MESIODISTAL,
            self.buccolingual_mm / DRAWN_BUCCOLINGUAL,
            self.crown_height_mm / DRAWN_CROWN,
        )
    }

    /// Returns about the signed distance at a drawn point, mm.
    fn drawn(&self, p: &Vec3) -> f64 {
        let top = (p.z - self.occlusal(p.x, p.y)) * 0.8;
        let crown = smooth_max(barrel(p), top, 0.9);
        // The furcation's roof ends the trunk; the roots continue.
        let trunk = smooth_max(crown, -3.6 - p.z - 0.35 * ramp(p.y.abs(), 0.5, 3.5), 1.2);
        let roots = smooth_min(root(&MESIAL_ROOT, p), root(&DISTAL_ROOT, p), 0.5);
        smooth_min(trunk, roots, 0.7)
    }

    /// Height of the chewing surface over a point of the plane, mm.
    fn occlusal(&self, x: f64, y: f64) -> f64 {
        let mut height = 2.0;
        for (k, cusp) in CUSPS.iter().enumerate() {
            let [tx, ty, tz] = cusp.tip;
            // The triangular ridge runs from the tip towards the central groove: gentler along it
            // than across it.
            let (ax, ay) = (0.45 * tx - 0.15 - tx, -ty);
            let length = (ax * ax + ay * ay).sqrt();
            let (ax, ay) = (ax / length, ay / length);
            let (dx, dy) = (x - tx, y - ty);
            let (along, across) = (dx * ax + dy * ay, 1.24 * (dx * ay - dy * ax));
            let away =
                (along * along + across * across + cusp.blunt * cusp.blunt).sqrt() - cusp.blunt;
            let cone = tz - cusp.slope * self.relief * away;
            height = if k == 0 {
                cone
            } else {
                smooth_max(height, cone, 0.45)
            };
        }
        let mesial = bar([4.35, 2.6], [4.3, -2.7], 6.25, x, y);
        let distal = bar([-4.4, 1.3], [-3.9, -2.5], 5.85, x, y);
        height = smooth_max(smooth_max(height, mesial, 0.5), distal, 0.5);
        // Central, mesial and distal fossa with their pits.
        height
            - 0.3 * bell(pit(x, y, -0.35, -0.05), 0.75)
            - 0.2 * bell(pit(x, y, 3.0, -0.1), 0.6)
            - 0.15 * bell(pit(x, y, -3.2, -0.55), 0.6)
    }
}

fn pit(x: f64, y: f64, px: f64, py: f64) -> f64 {
    ((x - px) * (x - px) + (y - py) * (y - py)).sqrt()
}

/// A marginal ridge: a rounded bar from `a` to `b` at one height.
fn bar(a: [f64; 2], b: [f64; 2], height: f64, x: f64, y: f64) -> f64 {
    let (bx, by) = (b[0] - a[0], b[1] - a[1]);
    let t = fclamp(
        ((x - a[0]) * bx + (y - a[1]) * by) / (bx * bx + by * by),
        0.0,
        1.0,
    );
    let d = pit(x, y, a[0] + t * bx, a[1] + t * by);
    height - 0.95 * ((d * d + 0.16).sqrt() - 0.4)
}

/// The walls of crown and root trunk.
fn barrel(p: &Vec3) -> f64 {
    // The CEJ rises towards the neighbours, by about a millimetre on the mesial side.
    let rise = 0.9 * (p.x / 4.5) * (p.x / 4.5) * (1.0 - ramp(p.z.abs(), 0.5, 3.5));
    let z = p.z - rise;
    let (buccal, lingual) = (through(&LEVELS, &BUCCAL, z), through(&LEVELS, &LINGUAL, z));
    let (mesial, distal) = (through(&LEVELS, &MESIAL, z), through(&LEVELS, &DISTAL, z));
    let (half_x, half_y) = (0.5 * (mesial - distal), 0.5 * (buccal - lingual));
    let mut u = (p.x - 0.5 * (mesial + distal)) / half_x;
    let mut v = (p.y - 0.5 * (buccal + lingual)) / half_y;
    // Seen from above a crown tapers lingually and distally.
    let crown = ramp(z, 0.0, 3.0);
    u /= 1.0 + 0.055 * crown * fclamp(v, -1.2, 1.2);
    v /= 1.0 + 0.04 * crown * fclamp(u, -1.2, 1.2);
    let n = 2.35 + 0.35 * crown;
    let ring = libm::pow(libm::pow(u.abs(), n) + libm::pow(v.abs(), n), 1.0 / n);
    let walls = (ring - 1.0) * if half_x < half_y { half_x } else { half_y };
    let (to_buccal, to_lingual) = (ramp(v, 0.2, 0.8), ramp(-v, 0.2, 0.8));
    // Buccal, distobuccal and lingual grooves run over the edge and fade down the walls.
    let grooves = 0.42 * bell(p.x - 1.05, 0.55) * ramp(z, 2.4, 5.6) * to_buccal
        + 0.36 * bell(p.x + 2.55, 0.5) * ramp(z, 3.2, 5.8) * to_buccal
        + 0.34 * bell(p.x - 0.3, 0.5) * ramp(z, 4.0, 6.2) * to_lingual;
    // Enamel ends in a small step; the trunk is fluted towards the furcation, deeper buccally.
    let enamel = 0.13 * ramp(z, -0.05, 0.45);
    let flute = (0.75 * to_buccal + 0.6 * to_lingual) * bell(p.x, 1.1) * ramp(-z, 0.3, 3.2);
    walls + grooves - enamel + 0.13 + flute - 0.1
}

/// Roughly the signed distance to a root: an ellipse that follows the centre line, round ends.
fn root(root: &Root, p: &Vec3) -> f64 {
    let depths: [f64; 4] = root.z.map(|z| -z);
    let depth = fclamp(-p.z, depths[0], depths[3]);
    let half = through(&depths, &root.half, depth);
    // The buccolingual stretch makes a round tube flat.
    let y = p.y / through(&depths, &root.stretch, depth);
    let (dx, dz) = (p.x - through(&depths, &root.x, depth), p.z + depth);
    let groove =
        root.groove * bell(p.y, 1.0) * ramp(depth, 1.5, 4.5) * (1.0 - ramp(depth, 9.0, 12.0));
    (dx * dx + y * y + dz * dz).sqrt() - half + groove * fmax(0.0, 1.0 - 0.5 * (y / half).abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::check::check;

    #[test]
    fn is_a_solid_of_the_size_of_a_lower_first_molar() {
        let report = check(&Molar::default().mesh(), "molar").expect("a solid");
        assert_eq!(report.genus, 0, "{report:?}");
        let [md, bl, height] = report.size_mm;
        assert!(
            (10.5..11.5).contains(&md) && (9.8..10.8).contains(&bl),
            "{report:?}"
        );
        assert!((20.0..22.0).contains(&height), "{report:?}");
        assert!((600.0..1400.0).contains(&report.volume_mm3), "{report:?}");
    }

    #[test]
    fn has_five_cusps_around_a_fossa_and_two_roots() {
        let molar = Molar::default();
        for cusp in &CUSPS {
            let [x, y, z] = cusp.tip;
            assert!(
                molar.drawn(&Vec3::new(x, y, z - 0.9)) < 0.0,
                "no dentine under {:?}",
                cusp.tip
            );
            assert!(molar.drawn(&Vec3::new(x, y, z + 0.2)) > 0.0);
        }
        assert!(
            molar.drawn(&Vec3::new(-0.35, -0.05, 5.5)) > 0.0,
            "the fossa is open"
        );
        assert!(
            molar.drawn(&Vec3::new(0.0, 0.0, -6.0)) > 0.0,
            "the furcation is open"
        );
        assert!(
            molar.drawn(&Vec3::new(2.7, 0.0, -9.0)) < 0.0
                && molar.drawn(&Vec3::new(-3.1, 0.0, -9.0)) < 0.0
        );
    }

    #[test]
    fn dimensions_stretch_it() {
        let small = Molar {
            mesiodistal_mm: 9.9,
            root_length_mm: 11.0,
            grid_mm: 0.4,
            ..Molar::default()
        };
        let report = check(&small.mesh(), "molar").expect("a solid");
        assert!((9.4..10.4).contains(&report.size_mm[0]), "{report:?}");
        assert!((17.5..19.5).contains(&report.size_mm[2]), "{report:?}");
    }
}
