//! Tissue between a molar's roots, for a pocket whose floor lies below the entrance.
//!
//! Hamp, Nyman and Lindhe (Journal of Clinical Periodontology 2:126, 1975) grade a furcation by the horizontal reach
//! of a probe. Degree I is up to 3 mm, II is farther but not through, III is through.
//!
//! Behind the reach of the degree stands attached tissue as high as the roof. Before it lies a bed as high as the
//! pocket's floor.
//!
//! A probe cannot meet this tissue if the floor is above the entrance. Then no spheres are made.

use sulcus_core::{Sphere, Vec3};

use super::{Collar, Entrance, Packed};
use crate::anatomy::tooth::Furcation;

/// Reach of a probe at each degree, mm, from the outline that bridges the entrance. Degree 0 is flush.
const ENTERED: [f64; 4] = [0.15, 2.0, 4.0, f64::INFINITY];
/// Least tissue between two entrances that are not through, mm.
const LEAST_BETWEEN: f64 = 0.9;
/// Radius of the spheres, and distance between them, mm. No tip passes between four of them.
const RADIUS: f64 = 0.42;
const APART: f64 = 0.6;
/// Largest depth of a sphere's centre inside a root, mm. A deeper sphere has no effect.
const INTO_ROOT: f64 = 0.25;
/// Largest distance from the entrance's middle towards mesial and distal that is between the roots, mm.
const ASIDE: f64 = 2.2;

/// Returns the spheres between the roots.
pub(super) fn between_roots(collar: &Collar) -> Vec<Packed> {
    let mut packed = Vec::new();
    let open: Vec<Open> = collar
        .entrances
        .iter()
        .map(|entrance| Open::new(collar, entrance))
        .collect();
    let is_met = |open: &&Open| open.floor < open.roof;
    if collar.entrances.iter().any(|entrance| entrance.degree >= 3) {
        for open in open.iter().filter(is_met) {
            // Each side's bed reaches to the middle.
            open.bed(collar, open.outline, &mut packed);
        }
        return packed;
    }
    let sum = |of: fn(&Open) -> f64| open.iter().map(of).sum::<f64>();
    let (width, wanted) = (sum(|open| open.outline), sum(|open| open.entered));
    let share = ((width - LEAST_BETWEEN) / wanted).min(1.0);
    for open in open.iter().filter(is_met) {
        let entered = open.entered * share;
        open.bed(collar, entered, &mut packed);
        open.plug(collar, entered, width - share * wanted, &mut packed);
    }
    packed
}

/// An entrance in the tooth's frame, mm.
struct Open {
    /// 1 buccal, -1 lingual.
    side: f64,
    /// Middle, positive towards mesial.
    middle: f64,
    /// Distance of the outline from the axis plane.
    outline: f64,
    roof: f64,
    floor: f64,
    /// Reach of a probe.
    entered: f64,
}

impl Open {
    fn new(collar: &Collar, entrance: &Entrance) -> Self {
        let Furcation { around, height_mm } = entrance.furcation;
        let floor = collar.floor(around);
        let r = collar.sections.radius(around, height_mm.min(floor));
        Self {
            side: libm::sin(around).signum(),
            middle: r * libm::cos(around),
            outline: r * libm::sin(around).abs(),
            roof: height_mm,
            floor,
            entered: ENTERED[usize::from(entrance.degree.min(3))],
        }
    }

    /// Tissue as high as the floor, `entered` from the outline.
    fn bed(&self, collar: &Collar, entered: f64, packed: &mut Vec<Packed>) {
        let mut inwards = RADIUS;
        while inwards < entered + RADIUS {
            // The second layer is shifted by half a step: a tip pressed down between four spheres meets one of it.
            for (below, set_off) in [(0.0, 0.0), (APART, 0.5 * APART)] {
                let z = self.floor - RADIUS - below;
                self.row(collar, inwards + set_off, z, -1.0, packed);
            }
            inwards += APART;
        }
    }

    /// Tissue from the floor up to the roof, `entered` from the outline and as thick as `between`.
    fn plug(&self, collar: &Collar, entered: f64, between: f64, packed: &mut Vec<Packed>) {
        // The second layer must not come out on the other side.
        let layers = [RADIUS, (RADIUS + APART).min(between - RADIUS)];
        let mut z = self.floor - RADIUS;
        while z < self.roof + RADIUS {
            for layer in layers {
                self.row(collar, entered + layer, z, 1.0, packed);
            }
            z += APART;
        }
    }

    /// Adds a row of spheres from root to root. `facing` 1: its surface is towards the outline, -1: upwards.
    fn row(&self, collar: &Collar, inwards: f64, z: f64, facing: f64, packed: &mut Vec<Packed>) {
        let steps = (ASIDE / APART).floor() as i32;
        for k in -steps..=steps {
            let x = self.middle + APART * f64::from(k);
            let centre = Vec3::new(x, self.side * (self.outline - inwards), z);
            let outline = collar.sections.radius(libm::atan2(centre.y, centre.x), z);
            if collar.tooth.distance(&centre) < -INTO_ROOT
                || centre.xy().norm() > outline - 0.5 * RADIUS
            {
                continue;
            }
            let to_surface = if facing > 0.0 {
                Vec3::y() * self.side
            } else {
                Vec3::z()
            };
            packed.push(Packed {
                sphere: Sphere {
                    centre: centre * 1e-3,
                    radius: RADIUS * 1e-3,
                },
                away: Vec3::y() * self.side,
                on_surface: (centre + to_surface * RADIUS) * 1e-3,
                height: (z - self.floor) * 1e-3,
                floor: true,
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use sulcus_core::tissue::gingiva::GingivaParams;

    use super::*;
    use crate::anatomy::collar::pack;
    use crate::anatomy::mouth::{Standing, collar, standing};
    use crate::anatomy::patient::{Furcations, LOWER, Sides, ToothChart};
    use crate::file::MouthEntry;

    const TIP: f64 = 0.25;

    /// Collars of a tooth with an attachment loss of 6 mm all round, by degree, 0 to 3.
    fn collars(all: &[Standing], fdi: u8) -> Vec<Collar> {
        let k = LOWER
            .iter()
            .position(|other| *other == fdi)
            .expect("a tooth");
        let six = Sides {
            buccal: [6.0; 3],
            lingual: [6.0; 3],
        };
        let none = Sides {
            buccal: [0.0; 3],
            lingual: [0.0; 3],
        };
        let made = (0..=3).map(|degree| {
            let chart = ToothChart {
                depth_mm: six,
                recession_mm: none,
                furcation: Furcations {
                    buccal: degree,
                    lingual: degree,
                },
                ..ToothChart::healthy(fdi)
            };
            let (entry, params) = (MouthEntry::default(), GingivaParams::default());
            collar(all, k, &chart, &entry, &params).expect("room")
        });
        made.collect()
    }

    /// Returns the free way of a tip from `from` along `way` up to tissue, mm, at most `most`.
    fn free(packed: &[Packed], from: Vec3, way: Vec3, most: f64) -> f64 {
        let met = |at: Vec3| {
            let gap = |p: &Packed| (p.sphere.centre * 1e3 - at).norm() - p.sphere.radius * 1e3;
            packed.iter().any(|p| gap(p) < TIP)
        };
        let mut gone = 0.0;
        while gone < most && !met(from + way * gone) {
            gone += 0.02;
        }
        gone
    }

    #[test]
    fn a_probe_goes_in_between_the_roots_as_far_as_the_degree_says() {
        let all = standing();
        for fdi in [36, 37, 46] {
            for (degree, collar) in collars(all, fdi).iter().enumerate() {
                let packed = pack(collar);
                for entrance in &collar.entrances {
                    let open = Open::new(collar, entrance);
                    assert!(open.roof - open.floor > 1.0, "{fdi}: it is open");
                    let z = 0.5 * (open.floor + open.roof);
                    // A place in the pocket, close to its wall.
                    let outside = 0.1;
                    let from = Vec3::new(open.middle, open.side * (open.outline + outside), z);
                    let through = 2.0 * open.outline;
                    let gone = free(&packed, from, -Vec3::y() * open.side, through);
                    let entered = gone + TIP - outside;
                    if degree == 3 {
                        assert!(gone >= through, "{fdi} degree 3: {gone}");
                    } else {
                        let most = open.outline - 0.5 * LEAST_BETWEEN;
                        let off = entered - ENTERED[degree].min(most);
                        assert!(off.abs() < 0.25, "{fdi} degree {degree}: {entered}");
                        // The tip stands there on a bed as high as the pocket's floor.
                        let half_way = from - Vec3::y() * (open.side * (0.5 * gone + TIP));
                        let down = free(&packed, half_way, -Vec3::z(), 5.0);
                        let bed = z - down - TIP - open.floor;
                        assert!(
                            degree == 0 || bed.abs() < 0.25,
                            "{fdi} degree {degree}: {bed}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn where_the_entrance_is_covered_nothing_is_laid_out() {
        let mut collar = collars(standing(), 36).swap_remove(2);
        collar.sulcus.depths = [2.0; 6];
        assert!(between_roots(&collar).is_empty());
    }
}
