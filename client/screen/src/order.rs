//! Order of triangles: neighbours in space are neighbours in the list.
//!
//! An adapter reuses the vertices that it has shaded a moment ago. A software adapter pays for each vertex again
//! otherwise. Mesa finds a shaded vertex by the low bits of its number, so that numbers follow the order of use.

/// Bits of a coordinate in the order.
const BITS: u32 = 10;

/// Sorts triangles along a curve through space (Morton 1966). Places are those of the vertices.
pub(crate) fn sort(places: &[[f32; 3]], triangles: &mut [[u32; 3]]) {
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for place in places {
        for k in 0..3 {
            low[k] = low[k].min(place[k]);
            high[k] = high[k].max(place[k]);
        }
    }
    let size = (0..3).fold(1e-6f32, |size, k| size.max(high[k] - low[k]));
    let cells = (1u32 << BITS) as f32 - 1.0;
    let code = |triangle: &[u32; 3]| {
        let middle = |k: usize| triangle.iter().map(|v| places[*v as usize][k]).sum::<f32>() / 3.0;
        let cell = |k: usize| ((middle(k) - low[k]) / size * cells) as u32;
        spread(cell(0)) | spread(cell(1)) << 1 | spread(cell(2)) << 2
    };
    triangles.sort_by_cached_key(code);
}

/// Numbers the vertices anew, by their first use. Returns the former numbers of the used vertices.
pub(crate) fn by_use(count: usize, triangles: &mut [[u32; 3]]) -> Vec<u32> {
    let (mut kept, mut number) = (Vec::new(), vec![u32::MAX; count]);
    for v in triangles.iter_mut().flatten() {
        let new = &mut number[*v as usize];
        if *new == u32::MAX {
            *new = kept.len() as u32;
            kept.push(*v);
        }
        *v = *new;
    }
    kept
}

/// Bits of a number, two places apart.
fn spread(number: u32) -> u32 {
    (0..BITS).fold(0, |code, bit| code | (number >> bit & 1) << (3 * bit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shuffled_sheet_reuses_its_vertices_again() {
        let n = 60u32;
        let places: Vec<[f32; 3]> = (0..n * n)
            .map(|v| [(v % n) as f32, (v / n) as f32, 0.0])
            .collect();
        let squares = (0..n * n).filter(|v| v % n + 1 < n && v / n + 1 < n);
        let mut triangles: Vec<[u32; 3]> = squares
            .flat_map(|v| [[v, v + 1, v + n], [v + 1, v + n + 1, v + n]])
            .collect();
        let count = triangles.len();
        for k in 0..count {
            triangles.swap(k, k * 7919 % count);
        }
        // Vertices that are not among the last 32.
        let shaded = |triangles: &[[u32; 3]]| {
            let mut last: Vec<u32> = Vec::new();
            let mut shaded = 0;
            for v in triangles.iter().flatten() {
                if !last.contains(v) {
                    shaded += 1;
                    last.push(*v);
                    if last.len() > 32 {
                        last.remove(0);
                    }
                }
            }
            shaded as f64 / triangles.len() as f64
        };
        let before = shaded(&triangles);
        let mut sorted = triangles.clone();
        sort(&places, &mut sorted);
        assert!(
            before > 2.5 && shaded(&sorted) < 1.0,
            "{before} {}",
            shaded(&sorted)
        );
        let mut renumbered = sorted.clone();
        let kept = by_use(places.len(), &mut renumbered);
        assert_eq!(renumbered[0], [0, 1, 2]);
        let back = renumbered.iter().map(|t| t.map(|v| kept[v as usize]));
        assert!(back.eq(sorted.iter().copied()));
        sorted.sort_unstable();
        triangles.sort_unstable();
        assert_eq!(sorted, triangles, "no triangle is lost");
    }
}
