//! Springs fitted to finite elements.
//!
//! At rest a skeleton with springs as stiff at any stretch obeys `K u = W' f`, and its skin moves by `B u`, `B` the skin over the
//! spheres over the nodes. Sought are the springs' stiffnesses for which the mean over all training loads of `|B u - t|^2 / |t|^2` is least, `t`
//! what finite elements say at the free vertices; of loads of one newton each those that move more count more, by `|t|^2`: what is least is the whole error. Each stiffness is `L L'`, `L` lower triangular with the exponentials of
//! three unknowns on its diagonal: positive definite whatever they are. The slope comes from the adjoint
//! `K a = B'(B u - t)`, the way from the limited-memory method of Broyden, Fletcher, Goldfarb and Shanno (Liu and Nocedal 1989,
//! doi:10.1007/BF01589116).

use sulcus_core::Vec3;
use sulcus_core::math::Mat3;
use sulcus_core::tissue::skeleton::SkeletonLevel;

use super::organ::Organ;

/// What may differ from spring to spring.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Freedom {
    /// Nothing: one factor on all.
    One,
    /// The stiffness along each axis.
    Axes,
    /// The whole 3x3 stiffness.
    Tensor,
}

/// A training load: forces on the vertices of the surface (newtons) and displacements there (metres).
pub(crate) struct Example {
    pub(crate) forces: Vec<Vec3>,
    pub(crate) moved: Vec<Vec3>,
}

/// Unknowns of a spring: logarithms of the diagonal of `L`, then what stands below it (yx, zx, zy), in units of its scale.
const EACH: usize = 6;
/// Price of an unknown that goes from where it began, where the mean over the loads of the error is 1: keeps in bounds what the
/// loads hardly tell, such as how stiff the stiffest springs are.
const DEAR: f64 = 3e-5;
/// Farthest that a logarithm goes from where it began, and what stands below the diagonal from 0: stiffness stays within what a
/// skeleton may have.
const FARTHEST: [f64; 2] = [4.5, 300.0];
/// Steps that the method remembers.
const REMEMBERED: usize = 30;
/// Tries of a step before the method is said to have ended.
const TRIES: usize = 30;

/// A skeleton and what it is fitted to.
pub(crate) struct Fit<'a> {
    level: &'a SkeletonLevel,
    /// Springs with an end that moves, by their place in the level and their free nodes.
    springs: Vec<(usize, Option<usize>, Option<usize>)>,
    free: usize,
    /// `B'B` between free nodes, row by row.
    squares: Vec<f64>,
    examples: Vec<Normal>,
    freedom: Freedom,
    scale: f64,
}

/// An example, seen from the nodes; of unit size.
struct Normal {
    /// How much it counts, all together 1.
    weight: f64,
    force: Vec<Vec3>,
    wanted: Vec<Vec3>,
}

impl<'a> Fit<'a> {
    /// Prepares the fit of a level to examples; those in which nothing moves teach nothing and are left out.
    pub(crate) fn new(
        organ: &Organ,
        level: &'a SkeletonLevel,
        examples: &[Example],
        freedom: Freedom,
    ) -> Self {
        let mut number = vec![None; level.nodes.len()];
        let mut free = 0;
        for (number, fixed) in number.iter_mut().zip(&level.fixed) {
            if !fixed {
                *number = Some(free);
                free += 1;
            }
        }
        // What each vertex has of each free node.
        let carried: Vec<Vec<f64>> = (0..organ.nodes.len())
            .map(|v| {
                let mut row = vec![0.0; free];
                for (sphere, w) in organ.skin.carriers(v) {
                    let skin = &level.skin[*sphere as usize];
                    for (node, of) in skin.nodes.iter().zip(skin.weights) {
                        if let Some(k) = number[usize::from(*node)] {
                            row[k] += w * of;
                        }
                    }
                }
                row
            })
            .collect();
        let mut squares = vec![0.0; free * free];
        for &v in &organ.free {
            for (i, a) in carried[v].iter().enumerate().filter(|(_, a)| **a != 0.0) {
                for (sum, b) in squares[i * free..].iter_mut().zip(&carried[v]) {
                    *sum += a * b;
                }
            }
        }
        let normal = |example: &Example| {
            let size = organ
                .free
                .iter()
                .map(|&v| example.moved[v].norm_squared())
                .sum::<f64>()
                .sqrt();
            let mut made = Normal {
                weight: size * size,
                force: vec![Vec3::zeros(); free],
                wanted: vec![Vec3::zeros(); free],
            };
            for (row, force) in carried
                .iter()
                .zip(&example.forces)
                .filter(|(_, f)| **f != Vec3::zeros())
            {
                made.force
                    .iter_mut()
                    .zip(row)
                    .for_each(|(sum, w)| *sum += force * (w / size));
            }
            for &v in &organ.free {
                let moved = example.moved[v] / size;
                made.wanted
                    .iter_mut()
                    .zip(&carried[v])
                    .for_each(|(sum, w)| *sum += moved * *w);
            }
            (size > 0.0 && size.is_finite()).then_some(made)
        };
        let mut examples: Vec<Normal> = examples.iter().filter_map(normal).collect();
        let total: f64 = examples.iter().map(|example| example.weight).sum();
        examples
            .iter_mut()
            .for_each(|example| example.weight /= total);
        let springs = level.springs.iter().enumerate().filter_map(|(k, spring)| {
            let (a, b) = (number[usize::from(spring.a)], number[usize::from(spring.b)]);
            (a.is_some() || b.is_some()).then_some((k, a, b))
        });
        let mean = |k: &[f64; 3]| (k[0] + k[1] + k[2]) / 3.0;
        let all: f64 = level.springs.iter().map(|s| mean(&s.stiffness)).sum();
        Self {
            springs: springs.collect(),
            free,
            squares,
            examples,
            freedom,
            scale: (all / level.springs.len().max(1) as f64).sqrt(),
            level,
        }
    }

    /// The unknowns that give the level's own springs.
    fn start(&self) -> Vec<f64> {
        let of = |(k, _, _): &(usize, Option<usize>, Option<usize>)| {
            let [x, y, z] = self.level.springs[*k].stiffness.map(|k| 0.5 * k.ln());
            [x, y, z, 0.0, 0.0, 0.0]
        };
        self.springs.iter().flat_map(of).collect()
    }

    fn triangle(&self, x: &[f64]) -> Mat3 {
        let s = self.scale;
        Mat3::new(
            x[0].exp(),
            0.0,
            0.0,
            s * x[3],
            x[1].exp(),
            0.0,
            s * x[4],
            s * x[5],
            x[2].exp(),
        )
    }

    /// `K^-1`, three rows a node, row by row; none where `K` is not positive definite in these digits.
    fn compliance(&self, x: &[f64]) -> Option<Vec<f64>> {
        let n = 3 * self.free;
        let mut k = vec![0.0; n * n];
        for ((_, a, b), x) in self.springs.iter().zip(x.chunks_exact(EACH)) {
            let l = self.triangle(x);
            let t = l * l.transpose();
            let mut add = |i: Option<usize>, j: Option<usize>, sign: f64| {
                if let (Some(i), Some(j)) = (i, j) {
                    for p in 0..3 {
                        for q in 0..3 {
                            k[(3 * i + p) * n + 3 * j + q] += sign * t[(p, q)];
                        }
                    }
                }
            };
            add(*a, *a, 1.0);
            add(*b, *b, 1.0);
            add(*a, *b, -1.0);
            add(*b, *a, -1.0);
        }
        inverse(k, n)
    }

    /// What is to be made least about unknowns that began at `from`, and its slope.
    fn priced(&self, x: &[f64], from: &[f64]) -> Option<(f64, Vec<f64>)> {
        let (mut value, mut slope) = self.value(x)?;
        let each = DEAR / x.len().max(1) as f64;
        for (slope, (x, from)) in slope.iter_mut().zip(x.iter().zip(from)) {
            value += each * (x - from) * (x - from);
            *slope += 2.0 * each * (x - from);
        }
        Some((value, slope))
    }

    /// The weighted mean over the examples of the square of the error over the displacement, and its slope.
    fn value(&self, x: &[f64]) -> Option<(f64, Vec<f64>)> {
        let compliance = self.compliance(x)?;
        let n = self.free;
        let mut value = 0.0;
        let mut slopes = vec![Mat3::zeros(); self.springs.len()];
        let mut moved_far = vec![Vec3::zeros(); n];
        for example in &self.examples {
            let u = product(&compliance, &example.force);
            moved_far.fill(Vec3::zeros());
            for (row, u) in self.squares.chunks_exact(n).zip(&u) {
                moved_far
                    .iter_mut()
                    .zip(row)
                    .for_each(|(sum, w)| *sum += u * *w);
            }
            let mut off = Vec::with_capacity(n);
            let mut sum = 1.0;
            for k in 0..n {
                sum += u[k].dot(&(moved_far[k] - example.wanted[k] * 2.0));
                off.push((moved_far[k] - example.wanted[k]) * (2.0 * example.weight));
            }
            value += example.weight * sum;
            let back = product(&compliance, &off);
            for (slope, (_, a, b)) in slopes.iter_mut().zip(&self.springs) {
                let change = |of: &[Vec3]| {
                    a.map_or(Vec3::zeros(), |a| of[a]) - b.map_or(Vec3::zeros(), |b| of[b])
                };
                *slope -= change(&back) * change(&u).transpose();
            }
        }
        let mut slope = Vec::with_capacity(x.len());
        for (of, x) in slopes.iter().zip(x.chunks_exact(EACH)) {
            let l = self.triangle(x);
            let by = (of + of.transpose()) * l;
            slope.extend([
                by[(0, 0)] * l[(0, 0)],
                by[(1, 1)] * l[(1, 1)],
                by[(2, 2)] * l[(2, 2)],
            ]);
            slope.extend([by[(1, 0)], by[(2, 0)], by[(2, 1)]].map(|g| g * self.scale));
        }
        self.restrict(&mut slope);
        value.is_finite().then_some((value, slope))
    }

    /// Leaves of a slope what may differ.
    fn restrict(&self, slope: &mut [f64]) {
        if self.freedom == Freedom::Tensor {
            return;
        }
        let springs = self.springs.len().max(1) as f64;
        let sum: f64 = slope.chunks_exact(EACH).map(|g| g[0] + g[1] + g[2]).sum();
        for g in slope.chunks_exact_mut(EACH) {
            g[3..].fill(0.0);
            if self.freedom == Freedom::One {
                // The nearest slope that is the same for all.
                g[..3].fill(sum / (3.0 * springs));
            }
        }
    }

    /// Fits in at most so many steps. Gives the level with its new springs, the root mean square over the examples of the error over the
    /// displacement, and the steps taken; `progress` gets both on the way.
    pub(crate) fn run(
        &self,
        steps: usize,
        progress: &dyn Fn(usize, f64),
    ) -> Option<(SkeletonLevel, f64, usize)> {
        let mut x = self.start();
        // One factor on all, by tries: where the method begins hardly matters then.
        let shifted = |by: f64| -> Vec<f64> {
            let each = |(k, x): (usize, &f64)| if k % EACH < 3 { x + by } else { *x };
            x.iter().enumerate().map(each).collect()
        };
        let tries = (-40..=40).map(|k| shifted(0.15 * f64::from(k)));
        let valued = tries.filter_map(|x| Some((self.value(&x)?.0, x)));
        x = valued.min_by(|a, b| a.0.total_cmp(&b.0))?.1;
        let from = x.clone();
        let (mut value, mut slope) = self.priced(&x, &from)?;
        let mut memory: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
        let mut taken = 0;
        while taken < steps {
            let mut way = towards(&slope, &memory);
            let mut fall = dot(&way, &slope);
            if fall >= 0.0 || !fall.is_finite() {
                memory.clear();
                way = slope.iter().map(|g| -g).collect();
                fall = dot(&way, &slope);
            }
            if fall == 0.0 {
                break;
            }
            // No unknown goes farther than by one at once: that is a factor of e^2.
            let farthest = way.iter().fold(0.0_f64, |most, w| most.max(w.abs()));
            let mut length = (1.0 / farthest).min(1.0);
            let mut next = None;
            for _ in 0..TRIES {
                let there: Vec<f64> = (0..x.len())
                    .map(|k| {
                        let most = FARTHEST[usize::from(k % EACH >= 3)];
                        (x[k] + length * way[k]).clamp(from[k] - most, from[k] + most)
                    })
                    .collect();
                if let Some((v, g)) = self.priced(&there, &from)
                    && v <= value + 1e-4 * length * fall
                {
                    next = Some((there, v, g));
                    break;
                }
                length *= 0.5;
            }
            let Some((there, v, g)) = next else { break };
            let moved: Vec<f64> = there.iter().zip(&x).map(|(a, b)| a - b).collect();
            let turned: Vec<f64> = g.iter().zip(&slope).map(|(a, b)| a - b).collect();
            if dot(&moved, &turned)
                > 1e-10 * dot(&turned, &turned).sqrt() * dot(&moved, &moved).sqrt()
            {
                memory.push((moved, turned));
                if memory.len() > REMEMBERED {
                    memory.remove(0);
                }
            }
            let gained = value - v;
            (x, value, slope) = (there, v, g);
            taken += 1;
            progress(taken, value.max(0.0).sqrt());
            if gained < 1e-9 * value {
                break;
            }
        }
        let error = self.value(&x)?.0.max(0.0).sqrt();
        Some((self.level_with(&x), error, taken))
    }

    fn level_with(&self, x: &[f64]) -> SkeletonLevel {
        let mut level = self.level.clone();
        for ((k, _, _), x) in self.springs.iter().zip(x.chunks_exact(EACH)) {
            let l = self.triangle(x);
            let t = l * l.transpose();
            let spring = &mut level.springs[*k];
            spring.stiffness = [t[(0, 0)], t[(1, 1)], t[(2, 2)]];
            spring.coupling = [t[(1, 2)], t[(0, 2)], t[(0, 1)]];
        }
        level
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The way down from a slope by what steps and changes of the slope taught, oldest first.
fn towards(slope: &[f64], memory: &[(Vec<f64>, Vec<f64>)]) -> Vec<f64> {
    let mut way: Vec<f64> = slope.iter().map(|g| -g).collect();
    let mut parts = Vec::with_capacity(memory.len());
    for (moved, turned) in memory.iter().rev() {
        let part = dot(moved, &way) / dot(moved, turned);
        way.iter_mut().zip(turned).for_each(|(w, y)| *w -= part * y);
        parts.push(part);
    }
    if let Some((moved, turned)) = memory.last() {
        let scale = dot(moved, turned) / dot(turned, turned);
        way.iter_mut().for_each(|w| *w *= scale);
    }
    for ((moved, turned), part) in memory.iter().zip(parts.into_iter().rev()) {
        let more = part - dot(turned, &way) / dot(moved, turned);
        way.iter_mut().zip(moved).for_each(|(w, s)| *w += more * s);
    }
    way
}

/// A symmetric matrix times a vector, three numbers a node.
fn product(matrix: &[f64], x: &[Vec3]) -> Vec<Vec3> {
    let n = 3 * x.len();
    let mut y = vec![0.0; n];
    for (row, x) in matrix.chunks_exact(n).zip(x.iter().flat_map(|x| x.iter())) {
        y.iter_mut().zip(row).for_each(|(y, m)| *y += m * x);
    }
    y.chunks_exact(3)
        .map(|y| Vec3::new(y[0], y[1], y[2]))
        .collect()
}

/// Inverse of a symmetric positive definite matrix, row by row, by Cholesky's factor; none where it is not positive definite.
fn inverse(mut a: Vec<f64>, n: usize) -> Option<Vec<f64>> {
    for i in 0..n {
        let (above, rest) = a.split_at_mut(i * n);
        let row = &mut rest[..n];
        for j in 0..i {
            let other = &above[j * n..j * n + j + 1];
            let sum = row[j] - dot(&row[..j], &other[..j]);
            row[j] = sum / other[j];
        }
        let pivot = row[i] - dot(&row[..i], &row[..i]);
        if pivot.is_nan() || pivot <= 1e-12 * row[i].abs() {
            return None;
        }
        row[i] = pivot.sqrt();
    }
    // L^-1, row by row, then its transpose times itself.
    let mut back = vec![0.0; n * n];
    for i in 0..n {
        let (above, rest) = back.split_at_mut(i * n);
        let row = &mut rest[..n];
        for j in 0..i {
            let l = a[i * n + j];
            row[..=j]
                .iter_mut()
                .zip(&above[j * n..])
                .for_each(|(sum, b)| *sum -= l * b);
        }
        row[i] = 1.0;
        let scale = 1.0 / a[i * n + i];
        row[..=i].iter_mut().for_each(|b| *b *= scale);
    }
    let mut all = vec![0.0; n * n];
    for row in back.chunks_exact(n) {
        for (i, b) in row.iter().enumerate().filter(|(_, b)| **b != 0.0) {
            all[i * n..(i + 1) * n]
                .iter_mut()
                .zip(row)
                .for_each(|(sum, c)| *sum += b * c);
        }
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_is_one_and_what_is_not_definite_has_none() {
        let n = 7;
        let a: Vec<f64> = (0..n * n)
            .map(|k| {
                let (i, j) = (k / n, k % n);
                if i == j {
                    3.0 + i as f64
                } else {
                    1.0 / (1.0 + (i as f64 - j as f64).abs())
                }
            })
            .collect();
        let b = inverse(a.clone(), n).expect("positive definite");
        for i in 0..n {
            for j in 0..n {
                let sum: f64 = (0..n).map(|k| a[i * n + k] * b[k * n + j]).sum();
                assert!((sum - f64::from(u8::from(i == j))).abs() < 1e-13);
            }
        }
        assert_eq!(inverse(vec![1.0, 2.0, 2.0, 1.0], 2), None);
    }
}
