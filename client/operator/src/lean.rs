//! How a probe has to lean, all round a tooth and at all depths, so that its shaft passes its own tooth's crown and the
//! neighbours: the smallest tilt from the tooth's axis that does, found by trying them in order, then smoothed so that
//! the hand that follows it never jumps.

use sulcus_core::Vec3;

/// Columns from the mesial to the distal midline of one side.
const COLUMNS: usize = 46;
const COLUMN_STEP: f64 = std::f64::consts::PI / (COLUMNS - 1) as f64;
/// Depths below the margin, metres.
const ROWS: usize = 19;
const SHALLOWEST: f64 = -3e-3;
const ROW_STEP: f64 = 0.75e-3;
/// Tilts tried: tangent of the angle, step and largest (42 degrees).
const TILT_STEP: f64 = 0.04;
const MOST_TILT: f64 = 0.9;
/// Largest lean to the other side's side, as a tangent.
const ACROSS: f64 = 0.05;
/// Row (1.5 mm) above which the tilt stays as it is: a bob does not turn the probe.
const SAME: usize = 6;
/// Room that smoothing may take away, metres.
const SMOOTHING: f64 = 0.12e-3;
/// Rows (2.25 to 4.5 mm) that must be open for a column to be.
const OPEN: std::ops::RangeInclusive<usize> = 7..=10;

/// Which tilts an operator knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manner {
    /// Away from the crown and under the contact: any tilt to its own side.
    Taught,
    /// Only away from the crown's bulge, never to pass under a contact.
    Upright,
}

/// Tilts of one side (buccal or lingual).
#[derive(Clone, Debug)]
pub(crate) struct Leans {
    /// Tangents of the tilt mesially and buccally, by column and row.
    tilt: Vec<[[f64; 2]; ROWS]>,
    /// Shallowest depth at which the tip has room, by column; none where it has none.
    ceiling: Vec<Option<f64>>,
}

impl Leans {
    /// Upright everywhere, with room nowhere.
    pub fn none() -> Self {
        Self {
            tilt: vec![[[0.0; 2]; ROWS]; COLUMNS],
            ceiling: vec![None; COLUMNS],
        }
    }

    /// `sign` is 1 for the buccal side and -1 for the lingual one; `passes` says whether the shaft clears everything at
    /// an angle (radians from mesial), a depth (metres), tilted mesially and buccally: the first tilt that does, with less
    /// room than is wanted (metres).
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
        // What the hand really does counts.
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

    /// Tangents of the tilt mesially and buccally, at an angle from the mesial midline (0 to pi) and a depth.
    pub fn at(&self, from_mesial: f64, depth: f64) -> [f64; 2] {
        let (c, f) = share(from_mesial / COLUMN_STEP, COLUMNS);
        let (r, g) = share((depth - SHALLOWEST) / ROW_STEP, ROWS);
        let row = |c: usize, k: usize| self.tilt[c][r][k] * (1.0 - g) + self.tilt[c][r + 1][k] * g;
        [0, 1].map(|k| row(c, k) * (1.0 - f) + row(c + 1, k) * f)
    }

    /// Shallowest depth at which the tip has room at an angle from the mesial midline; none where it has none.
    pub fn ceiling_at(&self, from_mesial: f64) -> Option<f64> {
        let (c, f) = share(from_mesial / COLUMN_STEP, COLUMNS);
        // On a column its own word counts.
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

/// Tilts to try, the nearest to the tooth's axis first.
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
    // (The sort is stable: equals stay in a fixed order.)
    tilts.sort_by(|a, b| {
        let size = |t: &[f64; 2]| t[0] * t[0] + t[1] * t[1];
        size(a).total_cmp(&size(b))
    });
    tilts
}

/// Where nothing passes the hand keeps the tilt of the next deeper place, else that of the nearest column.
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

/// Mean with the neighbours, weights 1 2 1, over columns and rows.
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

/// Index below and share of the way to the next.
fn share(at: f64, n: usize) -> (usize, f64) {
    let at = at.clamp(0.0, (n - 1) as f64);
    let k = (at.floor() as usize).min(n - 2);
    (k, at - k as f64)
}

/// Unit vector up along a working end that is tilted.
pub(crate) fn up(axis: &Vec3, mesial: &Vec3, buccal: &Vec3, tilt: [f64; 2]) -> Vec3 {
    (axis + mesial * tilt[0] + buccal * tilt[1]).normalize()
}
