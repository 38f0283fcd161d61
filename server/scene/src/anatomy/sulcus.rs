//! The sulcus between a tooth's mesh and its gingiva's mesh: its width, and by angle the heights of floor and margin.
//!
//! All three are found by sounding both meshes.
//!
//! Sounding imitates a clinician's probe. At an angle, points `open` millimetres beside the tooth's surface are
//! tested from above.
//!
//! The floor is the first of them in the tissue: the lowest open height that is connected to the mouth. The margin is
//! the highest tissue near the tooth.

use std::f64::consts::PI;

use sulcus_core::Vec3;
use sulcus_core::math::{fmax, fmin};
use sulcus_core::tissue::gingiva::{Prescribed, Site, ToothFrame};

use crate::file::SulcusEntry;
use crate::mesh::distance::MeshDistance;
use crate::parallel;

/// Number of angles.
const ANGLES: usize = 128;
/// Step downwards, metres.
const STEP: f64 = 1e-4;
/// Tolerance of a found surface, metres.
const EXACT: f64 = 1e-7;
/// Largest distance from the tooth of tissue that makes its margin, metres.
const MARGIN_REACH: f64 = 1.5e-3;
/// Number of distances from the tooth in the search for the margin.
const MARGIN_PLACES: usize = 8;
/// Height of a healthy margin over the cemento-enamel junction in the middle of a side, metres (Wang 2022, Appl. Sci.
/// 12:7015).
///
/// The height is used if the place of the junction is not given.
const MARGIN_OVER_CEJ: f64 = 2e-3;
/// Width of a pocket that is nowhere open enough to be measured, metres.
const USUAL_WIDTH: f64 = 4e-4;

/// Reason why meshes have no sulcus between them.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SulcusError {
    /// The axis leaves the tooth, or there is no tooth.
    #[error(
        "at {degrees:.0} degrees from mesial over buccal the tooth is not beside its gingiva; give `sulcus.axis` and `sulcus.origin_mm`"
    )]
    NoTooth {
        /// Angle from mesial over buccal, degrees.
        degrees: f64,
    },
    /// The sulcus has no floor.
    #[error(
        "the sulcus has no floor at {degrees:.0} degrees from mesial over buccal; give `sulcus.floor_mm`"
    )]
    NoFloor {
        /// Angle from mesial over buccal, degrees.
        degrees: f64,
    },
    /// No tissue beside the tooth.
    #[error("no tissue within 1.5 mm of the tooth at {degrees:.0} degrees from mesial over buccal")]
    NoMargin {
        /// Angle from mesial over buccal, degrees.
        degrees: f64,
    },
}

/// A sounded sulcus, world axes, metres. Heights are along the frame's axis over its origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Sounded {
    /// The tooth's frame.
    pub frame: ToothFrame,
    /// Height of the margin at equal angles from mesial over buccal.
    pub margin: Vec<f64>,
    /// Height of the floor at rest at the same angles.
    pub floor: Vec<f64>,
    /// Width at rest.
    pub width: f64,
    /// Points of the floor.
    pub on_floor: Vec<Vec3>,
}

impl Sounded {
    /// Sounds the sulcus of the tooth with FDI number `fdi`; 0 means a lower left molar. Both meshes are in the world
    /// frame.
    ///
    /// # Errors
    /// [`SulcusError`] if there is no tooth, no margin or no floor.
    pub fn new(
        tooth: &MeshDistance,
        gingiva: &MeshDistance,
        fdi: u8,
        given: &SulcusEntry,
    ) -> Result<Self, SulcusError> {
        let mut sounding = Sounding {
            tooth,
            gingiva,
            frame: frame(tooth, fdi, given),
            open: given.open_mm * 1e-3,
        };
        let mut margin = sounding.margins()?;
        if given.origin_mm.is_none() {
            // The origin moves to the middle of the tooth at its margin, in two passes.
            let mean = margin.iter().sum::<f64>() / margin.len() as f64;
            let across = sounding.middle(mean);
            sounding.frame.origin += across;
            margin = sounding.margins()?;
            let buccal = margin[ANGLES / 4] - MARGIN_OVER_CEJ;
            sounding.frame.origin += sounding.frame.axis * buccal;
            margin.iter_mut().for_each(|height| *height -= buccal);
        }
        let floor = match given.floor_mm {
            Some(height) => vec![height * 1e-3; ANGLES],
            None => sounding.floors(&margin)?,
        };
        let width = match given.width_mm {
            Some(width) => width * 1e-3,
            None => sounding.width(&margin, &floor),
        };
        let of_angle = |k: usize| {
            let across =
                [0.2, 0.4, 0.6, 0.8].map(|share| sounding.beside(k, floor[k], share * width));
            across.into_iter().flatten().collect::<Vec<Vec3>>()
        };
        let on_floor = parallel::map(ANGLES, of_angle).concat();
        Ok(Self {
            frame: sounding.frame,
            margin,
            floor,
            width,
            on_floor,
        })
    }

    /// Returns the height of the floor at rest at an angle, radians from mesial over buccal.
    pub fn floor_at(&self, around: f64) -> f64 {
        let turn = around / (2.0 * PI);
        let at = (turn - libm::floor(turn)) * ANGLES as f64;
        let k = (at as usize).min(ANGLES - 1);
        let share = at - k as f64;
        self.floor[k] + share * (self.floor[(k + 1) % ANGLES] - self.floor[k])
    }

    /// Returns the reading of each site: the deepest place of its zone, with the floor pressed down by `sink` metres.
    pub fn charted(&self, proximal: f64, sink: f64, bleeds: bool) -> [Prescribed; 6] {
        Site::ALL.map(|site| {
            let zone = (0..ANGLES).filter(|k| Site::at(angle(*k), proximal) == site);
            let deepest = zone.max_by(|a, b| self.depth(*a).total_cmp(&self.depth(*b)));
            deepest.map_or_else(Prescribed::default, |k| Prescribed {
                depth: self.depth(k) + sink,
                recession: -self.margin[k],
                bleeds,
            })
        })
    }

    fn depth(&self, k: usize) -> f64 {
        self.margin[k] - self.floor[k]
    }
}

/// Returns angle number `k`, radians from mesial over buccal.
fn angle(k: usize) -> f64 {
    2.0 * PI * k as f64 / ANGLES as f64
}

fn degrees(k: usize) -> f64 {
    angle(k).to_degrees()
}

/// Returns the tooth's frame from its FDI number and the given directions.
///
/// Mesial, buccal and axis are right-handed on the lower left and the upper right, left-handed on the other sides.
fn frame(tooth: &MeshDistance, fdi: u8, given: &SulcusEntry) -> ToothFrame {
    let (quadrant, number) = (fdi / 10, fdi % 10);
    let upper = matches!(quadrant, 1 | 2);
    let to_the_right = if matches!(quadrant, 1 | 4) { 1.0 } else { -1.0 };
    let usual_axis = Vec3::new(0.0, 0.0, if upper { -1.0 } else { 1.0 });
    let usual_mesial = match number {
        1..=3 => Vec3::new(0.0, to_the_right, 0.0),
        _ => Vec3::x(),
    };
    let axis = given.axis.map_or(usual_axis, Vec3::from).normalize();
    let across = |v: Vec3| v - axis * v.dot(&axis);
    // A mesial direction along the axis is replaced by any direction across it.
    let mesial = [
        across(given.mesial.map_or(usual_mesial, Vec3::from)),
        across(Vec3::x()),
        across(Vec3::y()),
    ];
    let mesial = mesial.into_iter().find(|v| v.norm() > 1e-6);
    let mesial = across(mesial.unwrap_or(Vec3::x()).normalize()).normalize();
    let left_handed = matches!(quadrant, 2 | 4);
    let buccal = axis.cross(&mesial) * if left_handed { -1.0 } else { 1.0 };
    let origin = match given.origin_mm {
        Some(point) => Vec3::from(point) * 1e-3,
        None => {
            let (low, high) = tooth.mesh().bounds();
            (low + high) * 0.5
        }
    };
    ToothFrame {
        origin,
        axis,
        mesial,
        buccal: buccal.normalize(),
    }
}

struct Sounding<'a> {
    tooth: &'a MeshDistance,
    gingiva: &'a MeshDistance,
    frame: ToothFrame,
    open: f64,
}

impl Sounding<'_> {
    fn out(&self, k: usize) -> Vec3 {
        self.frame.mesial * libm::cos(angle(k)) + self.frame.buccal * libm::sin(angle(k))
    }

    /// Returns the outermost point at an angle and a height at the distance `off` from the tooth, by sphere tracing
    /// inwards.
    fn beside(&self, k: usize, height: f64, off: f64) -> Option<Vec3> {
        let (low, high) = self.tooth.mesh().bounds();
        let mut along = (high - low).norm() + off;
        let (out, axis) = (self.out(k), self.frame.origin + self.frame.axis * height);
        for _ in 0..1000 {
            let point = axis + out * along;
            let left = self.tooth.signed(&point) - off;
            if left < EXACT {
                return Some(point);
            }
            along -= left;
            if along < 0.0 {
                return None;
            }
        }
        None
    }

    /// Returns whether the point `off` beside the tooth is in the tissue; `None` if there is no tooth.
    fn in_tissue(&self, k: usize, height: f64, off: f64) -> Option<bool> {
        let beside = self.beside(k, height, off);
        beside.map(|point| self.gingiva.signed(&point) < 0.0)
    }

    /// Returns the lowest and highest height of the tissue.
    fn heights(&self) -> (f64, f64) {
        let of = |v: &Vec3| (v - self.frame.origin).dot(&self.frame.axis);
        let heights = self.gingiva.mesh().vertices.iter().map(of);
        heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| {
            (fmin(low, h), fmax(high, h))
        })
    }

    /// Returns the first height from `top` downwards at which the point `off` beside the tooth is in the tissue.
    fn first(&self, k: usize, off: f64, top: f64, bottom: f64) -> Option<f64> {
        let steps = ((top - bottom) / STEP).ceil() as usize;
        let at = |step: usize| top - STEP * step as f64;
        let hit = (0..steps).find(|step| self.in_tissue(k, at(*step), off) == Some(true))?;
        let (mut inside, mut above) = (at(hit), at(hit) + STEP);
        while above - inside > EXACT {
            let middle = 0.5 * (inside + above);
            if self.in_tissue(k, middle, off) == Some(true) {
                inside = middle;
            } else {
                above = middle;
            }
        }
        Some(inside)
    }

    fn margins(&self) -> Result<Vec<f64>, SulcusError> {
        let (bottom, top) = self.heights();
        let found = parallel::map(ANGLES, |k| {
            let mut highest: Option<f64> = None;
            for place in 0..MARGIN_PLACES {
                let share = place as f64 / (MARGIN_PLACES - 1) as f64;
                let off = self.open + (MARGIN_REACH - self.open) * share;
                // Lower tissue than found so far is no margin.
                let from = highest.unwrap_or(bottom);
                if let Some(height) = self.first(k, off, top + STEP, from) {
                    highest = Some(height);
                }
            }
            highest
        });
        let missing = |(k, height): (usize, &Option<f64>)| {
            height.ok_or(SulcusError::NoMargin {
                degrees: degrees(k),
            })
        };
        found.iter().enumerate().map(missing).collect()
    }

    fn floors(&self, margin: &[f64]) -> Result<Vec<f64>, SulcusError> {
        let (bottom, _) = self.heights();
        let found = parallel::map(ANGLES, |k| {
            if self.beside(k, margin[k], self.open).is_none() {
                return Err(SulcusError::NoTooth {
                    degrees: degrees(k),
                });
            }
            let floor = self.first(k, self.open, margin[k] + STEP, bottom);
            floor.ok_or(SulcusError::NoFloor {
                degrees: degrees(k),
            })
        });
        let pairs = found.into_iter().zip(margin);
        pairs
            .map(|(floor, margin)| floor.map(|floor| fmin(floor, *margin)))
            .collect()
    }

    /// Returns the median distance from the tooth's surface to the tissue.
    ///
    /// Only heights count that are farther from margin and floor than from the wall.
    fn width(&self, margin: &[f64], floor: &[f64]) -> f64 {
        let of_angle = |k: usize| {
            let mut clear = Vec::new();
            let mut height = floor[k] + 2.0 * STEP;
            while height < margin[k] {
                let surface = self.beside(k, height, 0.0);
                let width = surface.map(|point| self.gingiva.signed(&point));
                let room = fmin(height - floor[k], margin[k] - height);
                clear.extend(width.filter(|w| *w > 0.0 && *w < room));
                height += 2.0 * STEP;
            }
            clear
        };
        let mut clear = parallel::map(ANGLES, of_angle).concat();
        clear.sort_by(f64::total_cmp);
        clear.get(clear.len() / 2).copied().unwrap_or(USUAL_WIDTH)
    }

    /// Returns the vector from the origin to the middle of the tooth at a height, across the axis.
    fn middle(&self, height: f64) -> Vec3 {
        let outline: Vec<Vec3> = (0..ANGLES)
            .filter_map(|k| self.beside(k, height, 0.0))
            .collect();
        let mean = outline.iter().sum::<Vec3>() / outline.len().max(1) as f64;
        let off = mean - self.frame.origin;
        let across = off - self.frame.axis * off.dot(&self.frame.axis);
        if outline.is_empty() {
            Vec3::zeros()
        } else {
            across
        }
    }
}
