//! Places of the arch, each with a tooth or with a ridge, and the visible margin of a tooth.

use std::f64::consts::{FRAC_PI_2, PI};

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmax, fmin};
use sulcus_core::tissue::gingiva::Site;

use super::super::{Standing, UNDER_CONTACT};
use super::sizes;
use crate::anatomy::arch::to_world;
use crate::anatomy::collar::{SulcusProfile, USUAL_MM};
use crate::mesh::implicit::ramp;

/// Distance beside a broad papilla's peak in which its rise fades out, mm.
const FLANK: f64 = 0.8;
/// Distance from a charted site at which the margin is the simulated one, mm.
const CLEAR: f64 = 0.05;
/// Least distance of a peak beyond a charted site, mm. A nearer peak is moved between site and contact.
const BEYOND: f64 = 0.3;
/// Half width of a narrow tip, as a share of the distance between contact and site.
const NARROW: f64 = 0.4;
/// Range of the search for a tooth's surface beside its convex section, mm.
const NEAR: f64 = 0.9;

/// Visible values of a tooth's gingiva. No other value of a chart reaches the sheet.
pub(super) struct Visible {
    /// Margins; its depths are [`USUAL_MM`].
    pub sulcus: SulcusProfile,
    /// Recession at the six sites, mm.
    pub recession: [f64; 6],
    /// Inflammation, 0 to 1.
    pub inflammation: f64,
}

/// A place of the arch.
pub(super) struct Cell<'a> {
    /// Tooth of this place, also if the mouth lacks this tooth.
    pub tooth: &'a Standing,
    /// Gingiva of the tooth; `None` for a ridge.
    pub visible: Option<Visible>,
    /// Papillae at the ends of the tooth.
    pub ends: [End; 2],
}

/// Papilla at an end of a tooth, mm.
#[derive(Clone, Copy, Default)]
pub(super) struct End {
    /// Rise of the margin over the simulated one at the peaks.
    pub rise: f64,
    /// Distances from the contact, facially and lingually.
    pub flanks: [Flank; 2],
}

/// Half of a papilla: the margin rises from `from` up to `peak`, and falls from `level` down to `to`.
#[derive(Clone, Copy, Default)]
pub(super) struct Flank {
    from: f64,
    /// Distance of the peak from the contact, mm.
    pub peak: f64,
    level: f64,
    to: f64,
}

impl<'a> Cell<'a> {
    /// Place with a gingiva of this recession (mm, by site) and inflammation (0 to 1), or with a ridge.
    pub fn new(tooth: &'a Standing, seen: Option<([f64; 6], f64)>) -> Self {
        Self {
            tooth,
            visible: seen.map(|(recession, inflammation)| visible(tooth, recession, inflammation)),
            ends: [End::default(); 2],
        }
    }

    /// Position from the midline backwards, 0 to 6.
    pub fn kind(&self) -> usize {
        usize::from(self.tooth.fdi % 10 - 1)
    }

    /// End (0 mesial, 1 distal) towards smaller `s`.
    pub fn low_end(&self) -> usize {
        usize::from(self.tooth.fdi / 10 == 4)
    }

    /// Inflammation, 0 to 1.
    pub fn inflammation(&self) -> f64 {
        self.visible.as_ref().map_or(0.0, |seen| seen.inflammation)
    }

    /// Point of the world, mm, at an angle, a distance from the axis and a height in the tooth's frame.
    pub fn world(&self, around: f64, r: f64, z: f64) -> Vec3 {
        to_world(
            &self.tooth.frame_mm(),
            &Vec3::new(r * libm::cos(around), r * libm::sin(around), z),
        )
    }

    /// Height in the world, mm, of a height over the tooth's origin on its facial (`way` 1) or lingual (-1) side.
    pub fn level(&self, way: f64, z: f64) -> f64 {
        self.level_at(way * FRAC_PI_2, z)
    }

    /// Height in the world, mm, of the tooth's surface at an angle and a height over the tooth's origin.
    pub fn level_at(&self, around: f64, z: f64) -> f64 {
        self.world(around, self.tooth.sections.radius(around, z), z)
            .z
    }

    /// Height in the world, mm, under or over the contact at an end, of a height over the tooth's origin.
    pub fn level_of_end(&self, end: usize, z: f64) -> f64 {
        let contact = self.tooth.contacts[end];
        to_world(&self.tooth.frame_mm(), &Vec3::new(contact.x, contact.y, z)).z
    }

    /// Height over the tooth's origin, mm, at which the tooth's surface at an angle has a height in the world.
    /// `radius` is the distance of that surface from the axis by height.
    pub fn height_at(&self, around: f64, level: f64, radius: impl Fn(f64) -> f64) -> f64 {
        let frame = &self.tooth.frame;
        let out = libm::cos(around) * frame.mesial.z + libm::sin(around) * frame.buccal.z;
        let mut z = level - frame.origin.z * 1e3;
        // The surface is nearly parallel to the axis: each step leaves a tenth of the error or less.
        for _ in 0..5 {
            z = (level - frame.origin.z * 1e3 - radius(z) * out) / frame.axis.z;
        }
        z
    }

    /// Distance of the tooth's true surface from its axis, mm. Sections bridge grooves; the surface does not.
    pub fn surface(&self, around: f64, z: f64) -> f64 {
        let hull = self.tooth.sections.radius(around, z);
        let (c, s) = (libm::cos(around), libm::sin(around));
        let outside = |r: f64| self.tooth.shape.distance(&Vec3::new(r * c, r * s, z)) > 0.0;
        let (mut low, mut high) = (fmax(hull - NEAR, 0.1), hull + 0.3);
        if outside(low) || !outside(high) {
            return hull;
        }
        for _ in 0..24 {
            let r = 0.5 * (low + high);
            if outside(r) {
                high = r;
            } else {
                low = r;
            }
        }
        0.5 * (low + high)
    }

    /// Margin as simulated in a pocket of the usual depth, mm over the tooth's origin.
    pub fn simulated(&self, around: f64) -> f64 {
        self.visible
            .as_ref()
            .map_or(0.0, |seen| seen.sulcus.margin(around))
    }

    /// Drawn margin, mm over the tooth's origin. Beside the contact the margin rises to the papilla's tip; elsewhere
    /// the margin is the simulated one.
    pub fn margin(&self, around: f64) -> f64 {
        let margin = self.simulated(around);
        let end = usize::from(libm::cos(around) < 0.0);
        let End { rise, flanks } = &self.ends[end];
        let contact = self.tooth.contacts[end];
        let r = self.tooth.sections.radius(around, margin);
        let y = r * libm::sin(around) - contact.y;
        let flank = &flanks[usize::from(y < 0.0)];
        let y = y.abs();
        if y > flank.to || libm::cos(around).abs() < 0.3 {
            return margin;
        }
        let inner = if flank.from < flank.peak {
            ramp(y, flank.from, flank.peak)
        } else {
            1.0
        };
        margin + rise * inner * (1.0 - ramp(y, flank.level, flank.to))
    }

    /// Sets the papilla at an end of the tooth. `peak` is the distance of a broad papilla's peaks from the contact, mm.
    ///
    /// The margin at a charted site is the simulated one: a student reads depths against it. A broad papilla's peak
    /// lies beyond the site, the tip of a narrow one between both sites.
    pub fn set_papilla(&mut self, end: usize, rise: f64, peak: f64) {
        let Some(seen) = &self.visible else { return };
        let sites = seen.sulcus.sites();
        let contact = self.tooth.contacts[end].y;
        let flanks = [0, 1].map(|side| {
            let around = sites[[[0, 5], [2, 3]][end][side]];
            let r = self
                .tooth
                .sections
                .radius(around, seen.sulcus.margin(around));
            let site = fmax([1.0, -1.0][side] * (r * libm::sin(around) - contact), 0.3);
            if peak > site + BEYOND {
                Flank {
                    from: site + CLEAR,
                    peak,
                    level: peak,
                    to: peak + FLANK,
                }
            } else {
                Flank {
                    from: f64::INFINITY,
                    peak: NARROW * (site - CLEAR),
                    level: NARROW * (site - CLEAR),
                    to: site - CLEAR,
                }
            }
        });
        self.ends[end] = End { rise, flanks };
    }

    /// Angle at which the surface stands `y` mm from the contact towards the lip (`side` 1) or the tongue (-1), at an
    /// end.
    pub fn angle(&self, end: usize, side: f64, y: f64) -> f64 {
        let contact = self.tooth.contacts[end];
        let z = self.simulated(around(end, side, 0.3));
        let (mut low, mut high) = (-0.9, 1.25);
        for _ in 0..40 {
            let off = 0.5 * (low + high);
            let turn = around(end, side, off);
            let r = self.tooth.sections.radius(turn, z);
            if side * (r * libm::sin(turn) - contact.y) < y {
                low = off;
            } else {
                high = off;
            }
        }
        around(end, side, 0.5 * (low + high))
    }

    /// Height of the contact's lower end at an end of the tooth, mm over the tooth's origin: the gap to a neighbour of
    /// the same shape is 0.3 mm there.
    pub fn contact_low(&self, end: usize) -> f64 {
        let contact = self.tooth.contacts[end];
        let reach = contact.x.abs();
        let turn = libm::atan2(contact.y, contact.x);
        let mut z = contact.z;
        while z > 0.0 {
            let x = self.tooth.sections.radius(turn, z) * libm::cos(turn).abs();
            if reach - x > 0.15 {
                break;
            }
            z -= 0.05;
        }
        z
    }

    /// Loss of the papilla at an end against a healthy one, mm, and the margin there, mm over the tooth's origin.
    pub fn papilla(&self, end: usize) -> Option<[f64; 2]> {
        let seen = self.visible.as_ref()?;
        let sites = [[0, 5], [2, 3]][end];
        let worst = fmax(seen.recession[sites[0]], seen.recession[sites[1]]);
        let height = fmin(seen.sulcus.margins[sites[0]], seen.sulcus.margins[sites[1]]);
        Some([fmax(worst - sizes::HEALTHY_PROXIMAL, 0.0), height])
    }
}

/// Angle from mesial over buccal, radians, `off` from the middle of an end towards a side (1 facial, -1 lingual).
pub(super) fn around(end: usize, side: f64, off: f64) -> f64 {
    side * if end == 0 { off } else { PI - off }
}

/// Margin of a tooth from its recession alone, in the way of a simulated pocket of the usual depth.
fn visible(tooth: &Standing, recession: [f64; 6], inflammation: f64) -> Visible {
    let usual = [USUAL_MM; 6];
    let nearly = recession.map(|recession| -recession);
    let angles = SulcusProfile::new(&tooth.sections, usual, nearly).sites();
    let margins = Site::ALL.map(|site| {
        let k = site as usize;
        let margin = tooth.shape.cej(angles[k]) - recession[k];
        // A papilla has room under the contact point only.
        let contact = site.is_mesial().map(|mesial| usize::from(!mesial));
        contact.map_or(margin, |end| {
            fmin(margin, tooth.contacts[end].z - UNDER_CONTACT)
        })
    });
    Visible {
        sulcus: SulcusProfile::new(&tooth.sections, usual, margins),
        recession,
        inflammation: fclamp(inflammation, 0.0, 1.0),
    }
}
