//! Tilt of a probe at every angle and depth of a pocket, so that its shaft clears the tooth's crown and the neighbours.
//!
//! The search takes the smallest tilt from the tooth's axis that clears everything. The table of tilts is then
//! smoothed, so that a hand moves along it without jumps.

use sulcus_core::Vec3;

/// Number of columns from the mesial to the distal midline of one side.
const COLUMNS: usize = 46;
/// Angle between two columns, radians.
const COLUMN_STEP: f64 = std::f64::consts::PI / (COLUMNS - 1) as f64;
/// Number of rows, one for each depth below the margin.
const ROWS: usize = 19;
/// Depth of the first row, metres.
const SHALLOWEST: f64 = -3e-3;
/// Depth between two rows, metres.
const ROW_STEP: f64 = 0.75e-3;
/// Step of the tilts, tangent of the angle.
const TILT_STEP: f64 = 0.04;
/// Largest tilt, tangent of the angle: 42 degrees.
const MOST_TILT: f64 = 0.9;
/// Largest tilt towards the opposite side, tangent of the angle.
const ACROSS: f64 = 0.05;
/// Row of 1.5 mm. Above it the tilt is constant, so a bob does not turn the probe.
const SAME: usize = 6;
/// Room that smoothing may take, metres.
const SMOOTHING: f64 = 0.12e-3;
/// Rows of 2.25 to 4.5 mm. All of them must be clear in an open column.
const OPEN: std::ops::RangeInclusive<usize> = 7..=10;

/// Tilts that an operator uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manner {
    /// Any tilt to the probed side: away from the crown, and under the contact with a neighbour.
    Taught,
    /// Only tilts away from the crown's bulge, none under a contact.
    Upright,
}

/// Tilts of one side, buccal or lingual.
#[derive(Clone, Debug)]
pub(crate) struct Leans {
    /// Tangents of the tilt in the mesial and the buccal direction, by column and row.
    tilt: Vec<[[f64; 2]; ROWS]>,
    /// Shallowest depth with room for the tip, metres, by column; `None` for a column without room.
    ceiling: Vec<Option<f64>>,
}

impl Leans {
    /// Upright tilts, and no room in any column.
    pub fn none() -> Self {
        Self {
            tilt: vec![[[0.0; 2]; ROWS]; COLUMNS],
            ceiling: vec![None; COLUMNS],
        }
    }

    /// Searches the tilts of one side. `sign` is 1 for the buccal side and -1 for the lingual side.
    ///
    /// `passes(around, depth, tilts, less)` returns the first of `tilts` with which the shaft clears everything.
    /// `around` is in radians from mesial, `depth` in metres below the margin. `less` reduces the room that is
    /// required, metres.
    pub fn search(
        sign: f64,
        manner: Manner,
        mut passes: impl FnMut(f64, f64, &[[f64; 2]], f64) -> Option<[f64; 2]>,
    ) -> Self {
        let place = |c: usize, r: usize| {
            (
                sign * c as f64 * COLUMN_STEP,
                SHALLOWEST + r as f64 * ROW_STEP,
            )
        };
        let mut found = vec![[None; ROWS]; COLUMNS];
        for (c, column) in found.iter_mut().enumerate() {
            let tilts = candidates(place(c, 0).0, sign, manner);
            for (r, node) in column.iter_mut().enumerate().skip(SAME) {
                let (around, depth) = place(c, r);
                *node = passes(around, depth, &tilts, 0.0);
            }
        }
        let mut tilt = filled(&found);
        for _ in 0..2 {
            tilt = smoothed(&tilt);
        }
        for column in &mut tilt {
            let deeper = column[SAME];
            column[..SAME].fill(deeper);
        }
        // The room is that of the smoothed tilts, which the hand uses.
        let ceiling = (0..COLUMNS).map(|c| {
            let mut open = |r: usize| {
                let (around, depth) = place(c, r);
                passes(around, depth, &[tilt[c][r]], SMOOTHING).is_some()
            };
            if !OPEN.clone().all(&mut open) {
                return None;
            }
            let highest = (0..*OPEN.start()).rev().take_while(|r| open(*r)).last();
            Some(place(c, highest.unwrap_or(*OPEN.start())).1)
        });
        Self {
            ceiling: ceiling.collect(),
            tilt,
        }
    }

    /// Tangents of the tilt in the mesial and the buccal direction, at an angle from the mesial midline, 0 to pi, and a
    /// depth below the margin, metres.
    pub fn at(&self, from_mesial: f64, depth: f64) -> [f64; 2] {
        let (c, f) = share(from_mesial / COLUMN_STEP, COLUMNS);
        let (r, g) = share((depth - SHALLOWEST) / ROW_STEP, ROWS);
        let row = |c: usize, k: usize| self.tilt[c][r][k] * (1.0 - g) + self.tilt[c][r + 1][k] * g;
        [0, 1].map(|k| row(c, k) * (1.0 - f) + row(c + 1, k) * f)
    }

    /// Shallowest depth with room for the tip, metres, at an angle from the mesial midline, 0 to pi; `None` without
    /// room.
    pub fn ceiling_at(&self, from_mesial: f64) -> Option<f64> {
        let (c, f) = share(from_mesial / COLUMN_STEP, COLUMNS);
        // At a column only its own value counts.
        let (before, after) = (self.ceiling[c], self.ceiling[c + 1]);
        if f < 1e-6 {
            before
        } else if f > 1.0 - 1e-6 {
            after
        } else {
            Some(before?.max(after?))
        }
    }
}

/// Tilts of a manner, ascending from the tooth's axis.
fn candidates(around: f64, sign: f64, manner: Manner) -> Vec<[f64; 2]> {
    let steps = (MOST_TILT / TILT_STEP) as i32;
    let tilts = match manner {
        Manner::Taught => (-steps..=steps)
            .flat_map(|u| (-steps..=steps).map(move |v| [u, v].map(|k| f64::from(k) * TILT_STEP)))
            .filter(|[u, v]| v * sign >= -ACROSS && u * u + v * v <= MOST_TILT * MOST_TILT)
            .collect(),
        Manner::Upright => {
            let out = [libm::cos(around), libm::sin(around)];
            let lean = |k: i32| out.map(|x| x * f64::from(k) * TILT_STEP);
            (0..=steps).map(lean).collect()
        }
    };
    let mut tilts: Vec<[f64; 2]> = tilts;
    // The sort is stable: equal tilts stay in a fixed order.
    tilts.sort_by(|a, b| {
        let size = |t: &[f64; 2]| t[0] * t[0] + t[1] * t[1];
        size(a).total_cmp(&size(b))
    });
    tilts
}

/// Fills places without a tilt: with the tilt of the next deeper row, else with the nearest column.
fn filled(found: &[[Option<[f64; 2]>; ROWS]]) -> Vec<[[f64; 2]; ROWS]> {
    let mut columns: Vec<Option<[[f64; 2]; ROWS]>> = found
        .iter()
        .map(|column| {
            let deepest = column.iter().rev().flatten().next()?;
            let mut last = *deepest;
            let mut full = [last; ROWS];
            for r in (0..ROWS).rev() {
                last = column[r].unwrap_or(last);
                full[r] = last;
            }
            Some(full)
        })
        .collect();
    let known: Vec<usize> = (0..columns.len())
        .filter(|c| columns[*c].is_some())
        .collect();
    for c in 0..columns.len() {
        if columns[c].is_none() {
            let nearest = known.iter().min_by_key(|k| k.abs_diff(c));
            columns[c] = Some(nearest.and_then(|k| columns[*k]).unwrap_or_default());
        }
    }
    columns.into_iter().flatten().collect()
}

/// Mean over columns, then over rows, with weights 1, 2, 1.
fn smoothed(tilt: &[[[f64; 2]; ROWS]]) -> Vec<[[f64; 2]; ROWS]> {
    let mix = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
        [0, 1].map(|k| 0.25 * a[k] + 0.5 * b[k] + 0.25 * c[k])
    };
    let last = tilt.len() - 1;
    let along: Vec<[[f64; 2]; ROWS]> = (0..tilt.len())
        .map(|c| {
            let (a, b) = (&tilt[c.saturating_sub(1)], &tilt[(c + 1).min(last)]);
            std::array::from_fn(|r| mix(a[r], tilt[c][r], b[r]))
        })
        .collect();
    along
        .iter()
        .map(|column| {
            std::array::from_fn(|r| {
                mix(
                    column[r.saturating_sub(1)],
                    column[r],
                    column[(r + 1).min(ROWS - 1)],
                )
            })
        })
        .collect()
}

/// Index below `at`, and the share of the distance to the next index, for a table of `n` entries.
fn share(at: f64, n: usize) -> (usize, f64) {
    let at = at.clamp(0.0, (n - 1) as f64);
    let k = (at.floor() as usize).min(n - 2);
    (k, at - k as f64)
}

/// Unit vector up along a working end with the tangents `tilt` in the mesial and the buccal direction.
pub(crate) fn up(axis: &Vec3, mesial: &Vec3, buccal: &Vec3, tilt: [f64; 2]) -> Vec3 {
    (axis + mesial * tilt[0] + buccal * tilt[1]).normalize()
}
