//! Tissue between two places of the arch: papilla under a contact, or the way from a tooth onto a ridge.

use sulcus_core::Vec3;
use sulcus_core::math::{fclamp, fmin};

use super::cell::Cell;
use super::face::Faces;
use super::line::{Line, SIDE};
use super::ridge::Ridge;
use super::sizes;

/// Number of points from the facial to the lingual peak.
pub(super) const ACROSS: usize = 5;

/// Height of a papilla's tip over the margins beside the tip, for each mm between both. Chosen.
const POINTED: f64 = 0.55;
/// Number of the first plane from the midline whose papilla has two peaks.
const BROAD: usize = 4;

/// Plane between places `k - 1` and `k`, seen from the right to the left; 0 is in front of the right pad's ridge.
pub(super) struct Gap {
    /// Place along the line, mm.
    pub s: f64,
    /// Points from the facial to the lingual peak, world, mm.
    pub saddle: Vec<Vec3>,
}

/// Sets the rise of the papillae of all places. Neighbours share the tip's height.
pub(super) fn raise(cells: &mut [Cell<'_>]) {
    for k in 0..=cells.len() {
        let order = order(k);
        let mut ends: Vec<(usize, usize)> = Vec::new();
        if k > 0 {
            ends.push((k - 1, 1 - cells[k - 1].low_end()));
        }
        if k < cells.len() {
            ends.push((k, cells[k].low_end()));
        }
        let seen: Vec<(usize, usize, [f64; 2])> = ends
            .iter()
            .filter_map(|(c, end)| Some((*c, *end, cells[*c].papilla(*end)?)))
            .collect();
        let mut tip = f64::NEG_INFINITY;
        if let [a, b] = &seen[..] {
            // The lower contact and the larger loss bind both sides.
            let side = |(c, end, [lost, margin]): &(usize, usize, [f64; 2])| {
                let room = cells[*c].contact_low(*end) - margin;
                let share = 1.0 - fclamp(lost / sizes::BLUNT, 0.0, 1.0);
                let rise = fclamp(room, 0.0, sizes::RISE) * share;
                cells[*c].level_of_end(*end, margin + rise)
            };
            tip = fmin(side(a), side(b));
        }
        for (c, end, [_, margin]) in seen {
            let room = tip - cells[c].level_of_end(end, margin);
            let rise = fclamp(room / cells[c].tooth.frame.axis.z, 0.0, sizes::RISE);
            cells[c].set_papilla(end, rise, sizes::PEAKS[order]);
        }
    }
}

/// Number of a plane from the midline backwards, 0 to 7.
fn order(k: usize) -> usize {
    k.abs_diff(SIDE)
}

impl Gap {
    /// Plane `k` of all 15.
    pub fn new(
        line: &Line,
        cells: &[Cell<'_>],
        (ridge, faces): (&Ridge, &Faces),
        k: usize,
    ) -> Self {
        let s = line.knot(k + 1);
        let beside = [
            (k > 0).then(|| (&cells[k.wrapping_sub(1)], false)),
            cells.get(k).map(|cell| (cell, true)),
        ];
        let rim = |share: f64| -> Vec<Vec3> {
            let teeth = beside
                .iter()
                .flatten()
                .filter(|(cell, _)| cell.visible.is_some());
            teeth
                .map(|(cell, is_low)| {
                    let end = if *is_low {
                        cell.low_end()
                    } else {
                        1 - cell.low_end()
                    };
                    let turn = arc_angle(cell, end, share);
                    let z = cell.margin(turn);
                    cell.world(turn, cell.surface(turn, z), z)
                })
                .collect()
        };
        let saddle = (0..ACROSS)
            .map(|j| {
                let share = share(j);
                let rim = rim(share);
                let mean = rim.iter().sum::<Vec3>() / rim.len().max(1) as f64;
                match rim.len() {
                    2 => {
                        // The film hangs up between the teeth as far as the gap is broad, to a pointed tip.
                        let broad = (rim[0] - rim[1]).norm();
                        let peaked = if order(k) < BROAD { 1.0 } else { share * share };
                        let up = fmin(POINTED * broad, 0.7) * peaked;
                        line.at(s, line.of(&mean)[1], mean.z + up)
                    }
                    1 => {
                        // From the margin onto the ridge.
                        let cap = ridge.cap(line, faces, s, share);
                        Vec3::new(cap.x, cap.y, 0.5 * (cap.z + mean.z))
                    }
                    _ => ridge.cap(line, faces, s, share),
                }
            })
            .collect();
        Self { s, saddle }
    }
}

/// Share of the way from the middle of a saddle to its facial (1) or lingual (-1) peak at a point.
pub(super) fn share(j: usize) -> f64 {
    1.0 - 2.0 * j as f64 / (ACROSS - 1) as f64
}

/// Angle of a tooth's point at an end, a share of the way from the contact to the facial (1) or lingual (-1) peak.
pub(super) fn arc_angle(cell: &Cell<'_>, end: usize, share: f64) -> f64 {
    let lingual = share < 0.0;
    let peak = cell.ends[end].flanks[usize::from(lingual)].peak;
    cell.angle(end, if lingual { -1.0 } else { 1.0 }, share.abs() * peak)
}
