//! Fuller triangles on the same vertices, by flips of edges.

use std::collections::BTreeSet;

use sulcus_core::Vec3;
use sulcus_core::math::fmin;

use super::sheet::{Sheet, fullness};

/// Least gain in fullness of the thinner of two triangles.
const GAIN: f64 = 0.03;
/// Least cosine of the angle between the new triangles, relative to the cosine between the old ones.
const TURNED: f64 = -0.03;
/// Number of passes over all edges. The second finds most of what the first made possible.
const PASSES: usize = 3;

/// Flips edges of a closed surface where triangles become fuller. `is_near` tells whether the middle of a new edge is
/// near enough to the original surface.
pub fn flip(sheet: &mut Sheet, is_near: &dyn Fn(&Vec3) -> bool) {
    for _ in 0..PASSES {
        let edges = sheet.edges();
        let mut known: BTreeSet<[usize; 2]> = edges.iter().map(|edge| edge.ends).collect();
        let mut touched = vec![false; sheet.triangles.len()];
        for edge in &edges {
            let [s, t] = edge.triangles[..] else { continue };
            if touched[s] || touched[t] {
                continue;
            }
            let Some((new, ends)) = flipped(sheet, edge.ends, [s, t]) else {
                continue;
            };
            let middle = (sheet.at[ends[0]] + sheet.at[ends[1]]) * 0.5;
            if known.contains(&ends) || !is_near(&middle) {
                continue;
            }
            known.remove(&edge.ends);
            known.insert(ends);
            [sheet.triangles[s], sheet.triangles[t]] = new;
            (touched[s], touched[t]) = (true, true);
        }
    }
}

/// Returns both triangles and the new edge after a flip that makes them fuller.
fn flipped(
    sheet: &Sheet,
    ends: [usize; 2],
    triangles: [usize; 2],
) -> Option<([[usize; 3]; 2], [usize; 2])> {
    let [first, second] = triangles.map(|t| sheet.triangles[t]);
    let opposite = |triangle: [usize; 3]| triangle.into_iter().find(|v| !ends.contains(v));
    let (c, d) = (opposite(first)?, opposite(second)?);
    // Directed so that the first triangle is a, b, c.
    let k = first.iter().position(|v| *v == c)?;
    let (a, b) = (first[(k + 1) % 3], first[(k + 2) % 3]);
    let new = [[a, d, c], [d, b, c]];
    let least = |both: [[usize; 3]; 2]| {
        let [s, t] = both.map(|t| fullness(t.map(|v| sheet.at[v])));
        fmin(s, t)
    };
    let between = |both: [[usize; 3]; 2]| {
        let [s, t] = both.map(|t| sheet.area_vector(t));
        s.dot(&t) / (s.norm() * t.norm()).max(f64::MIN_POSITIVE)
    };
    let old = [first, second];
    let is_better = least(new) > least(old) + GAIN && between(new) > between(old) + TURNED;
    is_better.then_some((new, [c.min(d), c.max(d)]))
}
