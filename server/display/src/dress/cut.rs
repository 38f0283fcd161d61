//! Lines drawn into a surface along which a field has one value, so that a step of colour is crisp.

use std::collections::BTreeMap;

use sulcus_core::Vec3;

use super::sheet::Sheet;

/// Share of an edge within which a free vertex is moved onto the line, so that no thin triangle is left beside it.
const NEAR: f64 = 0.22;

/// Cuts the triangles along the zeros of a field. New and moved vertices are put `onto` the original surface.
pub fn cut(sheet: &mut Sheet, field: &dyn Fn(&Vec3) -> f64, onto: &dyn Fn(&Vec3) -> Vec3) {
    let mut values: Vec<f64> = sheet.at.iter().map(field).collect();
    let edges = sheet.edges();
    let crosses = |values: &[f64], [a, b]: [usize; 2]| values[a] * values[b] < 0.0;
    for edge in &edges {
        let [a, b] = edge.ends;
        if !crosses(&values, edge.ends) {
            continue;
        }
        let share = crossing(sheet, field, edge.ends);
        let at = onto(&on_edge(sheet, edge.ends, share));
        let near = [(a, share), (b, 1.0 - share)].into_iter();
        let mut near = near.filter(|(_, share)| *share < NEAR).map(|(v, _)| v);
        if let Some(v) = near.find(|v| sheet.may_move(*v, &at)) {
            sheet.at[v] = at;
            sheet.fixed[v] = true;
            values[v] = 0.0;
        }
    }
    let mut between: BTreeMap<[usize; 2], usize> = BTreeMap::new();
    for edge in &edges {
        if crosses(&values, edge.ends) {
            let share = crossing(sheet, field, edge.ends);
            let at = onto(&on_edge(sheet, edge.ends, share));
            between.insert(edge.ends, sheet.push_fixed(at));
        }
    }
    let mut cut = Vec::with_capacity(sheet.triangles.len() + 3 * between.len());
    for triangle in std::mem::take(&mut sheet.triangles) {
        divide(sheet, triangle, &between, &mut cut);
    }
    sheet.triangles = cut;
}

/// Adds the parts of a triangle with new vertices on none, one or two of its edges.
fn divide(
    sheet: &Sheet,
    triangle: [usize; 3],
    between: &BTreeMap<[usize; 2], usize>,
    cut: &mut Vec<[usize; 3]>,
) {
    for k in 0..3 {
        // Turned so that the first corner is alone on its side, or the edge opposite to it is the only cut one.
        let [a, b, c] = [triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3]];
        let on = |p: usize, q: usize| between.get(&[p.min(q), p.max(q)]).copied();
        match (on(a, b), on(b, c), on(c, a)) {
            (Some(ab), None, Some(ca)) => {
                let diagonal = |p: usize, q: usize| (sheet.at[p] - sheet.at[q]).norm_squared();
                cut.push([a, ab, ca]);
                if diagonal(ab, c) <= diagonal(b, ca) {
                    cut.extend([[ab, b, c], [ab, c, ca]]);
                } else {
                    cut.extend([[ab, b, ca], [b, c, ca]]);
                }
                return;
            }
            (None, Some(bc), None) => {
                cut.extend([[a, b, bc], [a, bc, c]]);
                return;
            }
            _ => {}
        }
    }
    // A field without a jump crosses two edges of a triangle at most.
    cut.push(triangle);
}

fn on_edge(sheet: &Sheet, [a, b]: [usize; 2], share: f64) -> Vec3 {
    sheet.at[a] + (sheet.at[b] - sheet.at[a]) * share
}

/// Returns the place of the zero along an edge, 0 to 1, by bisection.
fn crossing(sheet: &Sheet, field: &dyn Fn(&Vec3) -> f64, ends: [usize; 2]) -> f64 {
    let rises = field(&sheet.at[ends[1]]) > 0.0;
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        if (field(&on_edge(sheet, ends, middle)) > 0.0) == rises {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_scene::mesh::check::check;
    use sulcus_scene::mesh::shapes::icosphere;

    #[test]
    fn a_cut_ball_is_closed_and_no_edge_crosses_the_line() {
        let mut sheet = Sheet::of(&icosphere(5.0, 3));
        let onto = |p: &Vec3| p.normalize() * 5.0;
        for height in [1.0, 1.2, -0.3] {
            cut(&mut sheet, &|p| p.z - height, &onto);
            let crossing = sheet.edges().into_iter().filter(|edge| {
                let [a, b] = edge.ends.map(|v| sheet.at[v].z - height);
                a * b < 0.0 && a.abs().min(b.abs()) > 0.02
            });
            assert_eq!(crossing.count(), 0, "{height}");
        }
        let metres = sheet.to_mesh().placed(1e-3, Vec3::zeros());
        assert_eq!(check(&metres, "ball").expect("closed").genus, 0);
    }
}
