//! Triangles of the sheet, in pieces: a tooth's gingiva, a healed ridge, and the rest.

use std::collections::BTreeMap;

use sulcus_core::Vec3;

use super::gap::{ACROSS, arc_angle, share};
use super::path::{GINGIVA, POINTS, margin_point};
use super::strip::{Start, Strip};
use super::{Mark, Mouth, Piece};

/// Row at which a gingiva ends and the rest begins: just below the mucogingival line.
const CUT: usize = GINGIVA + 1;

/// A piece in the making. A vertex is shared by its place.
#[derive(Default)]
struct Making {
    piece: Piece,
    known: BTreeMap<[u64; 3], u32>,
}

impl Making {
    fn vertex(&mut self, (at, mark): &(Vec3, Mark)) -> u32 {
        let at = at * 1e-3;
        let key = [at.x, at.y, at.z].map(|x| (x + 0.0).to_bits());
        *self.known.entry(key).or_insert_with(|| {
            self.piece.mesh.vertices.push(at);
            self.piece.marks.push(*mark);
            (self.piece.marks.len() - 1) as u32
        })
    }

    /// Two triangles of `a`, `b` and the points across, `c` beside `a` and `d` beside `b`. The normal is
    /// `(b - a) x (c - a)`. The cut is the shorter diagonal.
    fn quad(&mut self, a: &(Vec3, Mark), b: &(Vec3, Mark), c: &(Vec3, Mark), d: &(Vec3, Mark)) {
        self.cut(a, b, c, d, (a.0 - d.0).norm() < (b.0 - c.0).norm());
    }

    /// The same, cut from `a` to `d` or from `b` to `c`.
    fn cut(
        &mut self,
        a: &(Vec3, Mark),
        b: &(Vec3, Mark),
        c: &(Vec3, Mark),
        d: &(Vec3, Mark),
        from_a: bool,
    ) {
        let [a, b, c, d] = [a, b, c, d].map(|v| self.vertex(v));
        let halves = if from_a {
            [[a, b, d], [a, d, c]]
        } else {
            [[a, b, c], [b, d, c]]
        };
        let is_whole = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        self.piece
            .mesh
            .triangles
            .extend(halves.into_iter().filter(is_whole));
    }
}

/// Columns of a side with their points.
pub(super) struct Woven {
    pub strip: Strip,
    pub points: Vec<Vec<(Vec3, Mark)>>,
}

/// Pieces by place of the arch, and the rest.
pub(super) fn weave(mouth: &Mouth<'_>, sides: &[Woven; 2], own: &[bool]) -> (Vec<Piece>, Piece) {
    let mut rest = Making::default();
    let mut cells: Vec<Making> = mouth.cells.iter().map(|_| Making::default()).collect();
    for (side, woven) in sides.iter().enumerate() {
        let columns = woven.points.len();
        let gaps = &woven.strip.gaps;
        for c in 0..columns - 1 {
            let cell = (0..mouth.cells.len()).find(|k| (gaps[*k]..gaps[*k + 1]).contains(&c));
            for row in 0..POINTS[side] - 1 {
                let into = match cell {
                    Some(k) if own[k] && row < CUT => &mut cells[k],
                    _ => &mut rest,
                };
                let at = |c: usize, row: usize| &woven.points[c][row];
                let (a, below) = (at(c, row), at(c, row + 1));
                let (beside, across) = (at(c + 1, row), at(c + 1, row + 1));
                if side == 0 {
                    into.quad(a, below, beside, across);
                } else if row + 2 == POINTS[side] {
                    // Both halves of the floor meet here: the cut starts at the place nearer to the midline.
                    into.cut(a, beside, below, across, 2 * c + 1 < columns);
                } else {
                    into.quad(a, beside, below, across);
                }
            }
        }
    }
    let columns = sides[0].strip.columns.len();
    for c in 0..columns - 1 {
        let cell = (0..mouth.cells.len()).find(|k| {
            let gaps = &sides[0].strip.gaps;
            (gaps[*k]..gaps[*k + 1]).contains(&c)
        });
        let [low, high] = match (
            across(mouth, sides, c, true),
            across(mouth, sides, c + 1, false),
        ) {
            (Some(low), Some(high)) => [low, high],
            // Both columns stand at the margin of one tooth.
            _ => continue,
        };
        let into = match cell {
            Some(k) if own[k] => &mut cells[k],
            _ => &mut rest,
        };
        for j in 0..ACROSS - 1 {
            into.quad(&low[j], &high[j], &low[j + 1], &high[j + 1]);
        }
    }
    (
        cells.into_iter().map(|making| making.piece).collect(),
        rest.piece,
    )
}

/// Points from the facial to the lingual column `c`: a saddle, the cap of a ridge, or the margin under a contact.
///
/// `is_low` tells whether the neighbouring column has larger `s`. `None`: the column stands at the middle of a margin.
fn across(
    mouth: &Mouth<'_>,
    sides: &[Woven; 2],
    c: usize,
    is_low: bool,
) -> Option<Vec<(Vec3, Mark)>> {
    let mark = sides[0].points[c][0].1;
    let strip = &sides[0].strip;
    if let Some(k) = strip.gaps.iter().position(|gap| *gap == c) {
        return Some(mouth.gaps[k].saddle.iter().map(|at| (*at, mark)).collect());
    }
    let column = &strip.columns[c];
    match column.start {
        Start::Margin { cell, .. } => {
            let tooth = &mouth.cells[cell];
            let beside = if is_low { c + 1 } else { c - 1 };
            if !strip.gaps.contains(&beside) {
                return None;
            }
            let end = if is_low {
                1 - tooth.low_end()
            } else {
                tooth.low_end()
            };
            let point = |j: usize| {
                let around = arc_angle(tooth, end, share(j));
                margin_point(mouth, cell, around, tooth.margin(around))
            };
            Some((0..ACROSS).map(|j| (point(j), mark)).collect())
        }
        Start::Papilla(_) | Start::Crest(_) => {
            let cap = |j: usize| {
                mouth
                    .ridge
                    .cap(&mouth.line, &mouth.faces, column.low, share(j))
            };
            Some((0..ACROSS).map(|j| (cap(j), mark)).collect())
        }
    }
}
