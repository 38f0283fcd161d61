//! Chains of points drawn into a surface as chains of edges, seen from above.

use sulcus_core::Vec3;

use super::sheet::Sheet;

/// Distance within which a vertex stands for a point of a chain, mm. Chosen as half a fissure's width.
const SAME_MM: f64 = 0.06;
/// Distance within which a vertex that must not move stands for a point of a chain, mm.
const THERE_MM: f64 = 0.03;
/// Share of an edge within which a chain goes through its end.
const NEAR: f64 = 0.15;
/// Largest number of triangles between two points of a chain.
const STEPS: usize = 64;
/// Largest number of triangles that cross an edge: two in a surface.
const BESIDE: usize = 2;

/// Draws a chain into the triangles that `is_table` accepts. New and moved vertices are put `onto` the surface.
pub fn trace(
    sheet: &mut Sheet,
    chain: &[[f64; 2]],
    is_table: &dyn Fn(&Vec3) -> bool,
    onto: &dyn Fn(&Vec3) -> Vec3,
) {
    let mut pen = Pen { sheet, onto };
    let Some((first, rest)) = chain.split_first() else {
        return;
    };
    let Some(start) = pen.triangle_under(first, is_table) else {
        return;
    };
    let mut v = pen.insert(start, first);
    for point in rest {
        match pen.walk(v, point) {
            Some(next) => v = next,
            None => return,
        }
    }
}

struct Pen<'a> {
    sheet: &'a mut Sheet,
    onto: &'a dyn Fn(&Vec3) -> Vec3,
}

impl Pen<'_> {
    fn flat(&self, v: usize) -> [f64; 2] {
        [self.sheet.at[v].x, self.sheet.at[v].y]
    }

    /// Returns the triangle of the table that faces up and has the point inside, seen from above.
    fn triangle_under(&self, p: &[f64; 2], is_table: &dyn Fn(&Vec3) -> bool) -> Option<usize> {
        (0..self.sheet.triangles.len()).find(|t| {
            let corners = self.sheet.triangles[*t];
            let is_up = self.sheet.area_vector(corners).z > 0.0;
            let shares = self.shares(corners, p);
            is_up
                && shares.iter().all(|share| *share >= -1e-9)
                && corners.iter().all(|v| is_table(&self.sheet.at[*v]))
        })
    }

    /// Returns the shares of the corners in a point, seen from above.
    fn shares(&self, corners: [usize; 3], p: &[f64; 2]) -> [f64; 3] {
        let [a, b, c] = corners.map(|v| self.flat(v));
        let whole = turn(&a, &b, &c);
        [turn(&b, &c, p), turn(&c, &a, p), turn(&a, &b, p)].map(|part| part / whole)
    }

    /// Tries to take a vertex for a place nearby, moved there if it may move.
    fn takes(&mut self, v: usize, at: Vec3) -> bool {
        let at = (self.onto)(&at);
        let moves = self.sheet.may_move(v, &at);
        if moves {
            self.sheet.at[v] = at;
        }
        let is_there = (self.sheet.at[v] - at).norm() < THERE_MM;
        self.sheet.fixed[v] |= is_there;
        is_there
    }

    /// Puts a vertex at a point of a triangle, or takes a vertex that is there. Returns the vertex.
    fn insert(&mut self, t: usize, p: &[f64; 2]) -> usize {
        let corners = self.sheet.triangles[t];
        let shares = self.shares(corners, p);
        let mut at = Vec3::zeros();
        for (v, share) in corners.iter().zip(shares) {
            at += self.sheet.at[*v] * share;
        }
        let away = |v: &usize| (self.sheet.at[*v] - at).norm();
        let nearest = corners
            .into_iter()
            .min_by(|a, b| away(a).total_cmp(&away(b)));
        if let Some(v) = nearest
            && away(&v) < SAME_MM
            && self.takes(v, at)
        {
            return v;
        }
        for k in 0..3 {
            let (b, c) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
            let height = self.sheet.area_vector(corners).norm()
                / (self.sheet.at[b] - self.sheet.at[c]).norm();
            if shares[k] * height < 0.5 * SAME_MM {
                return self.split([b, c], at);
            }
        }
        let new = self.sheet.push_fixed((self.onto)(&at));
        let [a, b, c] = corners;
        self.sheet.triangles[t] = [a, b, new];
        self.sheet.triangles.extend([[b, c, new], [c, a, new]]);
        new
    }

    /// Splits an edge at a place. Returns the new vertex.
    fn split(&mut self, ends: [usize; 2], at: Vec3) -> usize {
        let new = self.sheet.push_fixed((self.onto)(&at));
        let is_beside = |t: &[usize; 3]| ends.iter().all(|v| t.contains(v));
        let triangles = self.sheet.triangles.iter().enumerate();
        let beside: Vec<usize> = triangles
            .filter(|(_, triangle)| is_beside(triangle))
            .map(|(t, _)| t)
            .take(BESIDE)
            .collect();
        for t in beside {
            let old = self.sheet.triangles[t];
            let with = |gone: usize| old.map(|v| if v == gone { new } else { v });
            self.sheet.triangles[t] = with(ends[0]);
            self.sheet.triangles.push(with(ends[1]));
        }
        new
    }

    /// Draws edges from a vertex to a point. Returns the point's vertex; `None` where the surface does not face up.
    fn walk(&mut self, from: usize, to: &[f64; 2]) -> Option<usize> {
        let mut v = from;
        for _ in 0..STEPS {
            let here = self.flat(v);
            if distance(&here, to) < SAME_MM {
                return Some(v);
            }
            let triangles = self.sheet.triangles.iter().enumerate();
            let (t, p, q) = triangles
                .filter_map(|(t, corners)| {
                    let k = corners.iter().position(|w| *w == v)?;
                    Some((t, corners[(k + 1) % 3], corners[(k + 2) % 3]))
                })
                .find(|(_, p, q)| {
                    let (p, q) = (self.flat(*p), self.flat(*q));
                    turn(&here, &p, &q) > 0.0
                        && turn(&here, &p, to) >= 0.0
                        && turn(&here, to, &q) > 0.0
                })?;
            let (flat_p, flat_q) = (self.flat(p), self.flat(q));
            if turn(&flat_p, &flat_q, to) >= 0.0 {
                return Some(self.insert(t, to));
            }
            let (left, right) = (turn(&here, to, &flat_p), turn(&here, to, &flat_q));
            let share = left / (left - right);
            let at = self.sheet.at[p] + (self.sheet.at[q] - self.sheet.at[p]) * share;
            let near = [(p, share), (q, 1.0 - share)].into_iter();
            let mut near = near.filter(|(_, share)| *share < NEAR).map(|(w, _)| w);
            v = match near.find(|w| self.takes(*w, at)) {
                Some(w) => w,
                None => self.split([p, q], at),
            };
        }
        None
    }
}

/// Twice the area of a triangle, positive if it is counter-clockwise.
fn turn(a: &[f64; 2], b: &[f64; 2], c: &[f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn distance(a: &[f64; 2], b: &[f64; 2]) -> f64 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    (dx * dx + dy * dy).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sulcus_scene::mesh::check::check;
    use sulcus_scene::mesh::shapes::icosphere;

    #[test]
    fn a_chain_becomes_edges_of_a_closed_surface() {
        let mut sheet = Sheet::of(&icosphere(5.0, 3));
        let onto = |p: &Vec3| p.normalize() * 5.0;
        let chain = [[-2.0, -0.4], [-0.7, 0.3], [0.4, 0.1], [1.9, 1.3]];
        trace(&mut sheet, &chain, &|p| p.z > 1.0, &onto);
        let metres = sheet.to_mesh().placed(1e-3, Vec3::zeros());
        assert_eq!(check(&metres, "ball").expect("closed").genus, 0);
        // Every stretch of 0.2 mm of the chain has a fixed vertex, or an edge between two, near it.
        let edges = sheet.edges().into_iter();
        let drawn: Vec<[Vec3; 2]> = edges
            .filter(|edge| edge.ends.iter().all(|v| sheet.fixed[*v]))
            .map(|edge| edge.ends.map(|v| sheet.at[v]))
            .collect();
        for pair in chain.windows(2) {
            for k in 0..=10 {
                let share = f64::from(k) / 10.0;
                let at = [0, 1].map(|i| pair[0][i] + (pair[1][i] - pair[0][i]) * share);
                let off = drawn.iter().map(|[a, b]| {
                    let (a, b) = ([a.x, a.y], [b.x, b.y]);
                    let length = distance(&a, &b);
                    let along = ((at[0] - a[0]) * (b[0] - a[0]) + (at[1] - a[1]) * (b[1] - a[1]))
                        / (length * length);
                    let along = along.clamp(0.0, 1.0);
                    let near = [0, 1].map(|i| a[i] + (b[i] - a[i]) * along);
                    distance(&near, &at)
                });
                let off = off.fold(f64::INFINITY, f64::min);
                assert!(off < 0.06, "{at:?} is {off} from an edge");
            }
        }
    }
}
