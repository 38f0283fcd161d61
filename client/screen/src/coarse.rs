//! Coarser meshes: vertices of one cell of a grid become one.

use std::collections::BTreeMap;

/// Merges the vertices of each cell into its first vertex, and drops triangles without area. `cell_um` is the edge of a
/// cell, micrometres; 0 keeps the mesh. Places are in mm.
///
/// Returns the numbers of the kept vertices, and the triangles by place in this list.
pub(crate) fn merged(
    places: &[[f32; 3]],
    triangles: Vec<[u32; 3]>,
    cell_um: u32,
) -> (Vec<u32>, Vec<[u32; 3]>) {
    if cell_um == 0 {
        return ((0..places.len() as u32).collect(), triangles);
    }
    let edge = cell_um as f32 * 1e-3;
    let mut cells: BTreeMap<[i32; 3], u32> = BTreeMap::new();
    let (mut kept, mut number) = (Vec::new(), Vec::with_capacity(places.len()));
    for (v, place) in (0..).zip(places) {
        let cell = place.map(|x| (x / edge).floor() as i32);
        let next = kept.len() as u32;
        let found = *cells.entry(cell).or_insert(next);
        if found == next {
            kept.push(v);
        }
        number.push(found);
    }
    let renumbered = triangles.into_iter().map(|t| t.map(|v| number[v as usize]));
    let is_whole = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    (kept, renumbered.filter(is_whole).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fine_sheet_becomes_a_coarse_sheet_of_the_same_area() {
        let n = 41u32;
        let at = |k: u32| k as f32 * 0.25;
        let places: Vec<[f32; 3]> = (0..n * n).map(|v| [at(v % n), at(v / n), 0.0]).collect();
        let squares = (0..n * n).filter(|v| v % n + 1 < n && v / n + 1 < n);
        let triangles: Vec<[u32; 3]> = squares
            .flat_map(|v| [[v, v + 1, v + n], [v + 1, v + n + 1, v + n]])
            .collect();
        let area = |kept: &[u32], triangles: &[[u32; 3]]| -> f32 {
            let place = |v: u32| places[kept[v as usize] as usize];
            let of = |[a, b, c]: &[u32; 3]| {
                let (a, b, c) = (place(*a), place(*b), place(*c));
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
            };
            triangles.iter().map(of).sum()
        };
        let (kept, same) = merged(&places, triangles.clone(), 0);
        assert_eq!((kept.len(), &same), (places.len(), &triangles));
        let (few, coarse) = merged(&places, triangles, 1_000);
        assert_eq!(few.len(), 11 * 11);
        assert_eq!(coarse.len(), 2 * 10 * 10);
        assert!((area(&few, &coarse) - area(&kept, &same)).abs() < 1e-4);
    }
}
