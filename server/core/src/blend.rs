//! Spheres blended into one smooth surface: rows that do not feel the single spheres.
//!
//! A union of spheres is bumpy by its nature; a hand that presses a probe's tip 1 mm deep feels the bumps
//! as ripple of the force. Here a tool's sphere `t` meets the *blended* surface of all spheres of
//! the object. With the core gap `g_k = |p_t - c_k| - (r_k - b_k) - rho_t` (`b_k` the inset of sphere
//! `k`) and the blend length `kappa` of the level, the row of the pair `(t, j)` has the gap
//!
//! `s_j = -kappa ln sum_k a_jk exp(-g_k / kappa)`, and the Jacobian `sum_k w_k J_k`,
//! `w_k = a_jk exp(-g_k / kappa) / sum`,
//!
//! where `a_jk` is 1 for neighbours on one smooth surface and falls to 0 for spheres that are touched
//! from quite another side ([`compatibility`]). As `a_jj` is 1, `s_j <= g_j`: rows that hold keep the
//! tool out of every core. The insets are calibrated offline so that the surface `s = 0` lies on
//! the mesh; the union of hard spheres lies on it too, so without insets the blended surface would
//! stand off by about `kappa` times the logarithm of the number of spheres in the sum.
//!
//! The soft minimum is that of the exponential blend of implicit surfaces (Blinn 1982,
//! doi:10.1145/357306.357310). One row per *seed* `j`, not one per tool sphere: in a groove the walls
//! keep separate rows, so that the problem is convex there. One row of their mean turns with the tool's
//! way instead, by `-depth / fillet radius` of it in each pass, and buzzes where the press is deeper than
//! the fillet. On a smooth surface all seeds give nearly the same row; those that another one implies
//! are left out.

use crate::contact::Contact;
use crate::math::{Vec3, fmin};

/// Spheres whose core gap exceeds the smallest by this many blend lengths count for nothing
/// (`exp(-8)` is 0.03 %).
pub const REACH: f64 = 8.0;
/// Excess of the sagitta in blend lengths up to which two spheres are on one smooth surface. Over the pit between four
/// spheres of a lattice that is blended as it should be, two that face each other have 4 to 6.
const ONE_SURFACE: f64 = 5.0;
/// Excess from which they have nothing to do with one another.
const TWO_SURFACES: f64 = 12.0;
/// A seed is left out where the rows before it hold all but this share of its sum: it could bind at most
/// this share of the blend length before them.
const IMPLIED: f64 = 1e-3;
/// Most rows of one tool sphere against one object: the walls of a pocket, its floor, and some.
pub const MAX_SEEDS: usize = 8;

/// How far a sphere belongs to the surface of the seed: 1 wholly, 0 not at all, smooth between. Seen from the
/// tool's sphere the two lie in directions of that `cosine`, the nearer of the two centres at `distance`
/// (metres), and the sphere's core gap exceeds the seed's by `rise` (metres).
///
/// Over that angle a sphere drops away by the sagitta `(1 - cosine) distance`. On a surface that is
/// flat or convex the other sphere's gap is larger by about as much; where it is as near in spite of the
/// angle, it is another wall, and the excess in blend lengths, which means the same at any level, tells them
/// apart.
#[inline]
pub fn compatibility(cosine: f64, distance: f64, rise: f64, blend: f64) -> f64 {
    let excess = (1.0 - cosine) * distance - rise;
    if excess <= ONE_SURFACE * blend {
        return 1.0;
    }
    if excess >= TWO_SURFACES * blend {
        return 0.0;
    }
    let t = (TWO_SURFACES - excess / blend) / (TWO_SURFACES - ONE_SURFACE);
    t * t * (3.0 - 2.0 * t)
}

/// A tool sphere and a sphere of a blended object.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// Index in the contact list.
    pub contact: u32,
    /// Core gap, metres.
    pub gap: f64,
    /// Unit vector from the object's sphere to the tool's.
    pub normal: Vec3,
    /// Between the centres, metres.
    pub distance: f64,
    /// `exp(-(gap - smallest) / kappa)`.
    weight: f64,
}

impl Pair {
    pub fn new(contact: u32, gap: f64, normal: Vec3, distance: f64) -> Self {
        Self {
            contact,
            gap,
            normal,
            distance,
            weight: 0.0,
        }
    }
}

/// Share of a contact in a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Member {
    /// Index in the contact list.
    pub contact: u32,
    /// Share of the row's multiplier, 0 to 1; they add up to 1.
    pub weight: f64,
}

/// One row of the problem.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// The contact that it is about, in a blended row its seed: tells tool, object and arm.
    pub contact: u32,
    /// Gap, metres.
    pub gap: f64,
    /// Derivative of the gap by the tool sphere's place: a unit normal, in a blended row the mean of those of
    /// its members.
    pub normal: Vec3,
    /// Its members begin here in the list of all; none where the row is a contact of its own.
    pub first: u32,
    /// And so many there are.
    pub members: u32,
}

impl Line {
    /// The row of a hard contact.
    pub fn hard(index: usize, contact: &Contact) -> Self {
        Self {
            contact: index as u32,
            gap: contact.gap,
            normal: contact.normal,
            first: 0,
            members: 0,
        }
    }
}

/// Scratch: nothing in it outlives a call.
#[derive(Debug)]
pub(crate) struct Blender {
    /// Pairs of one tool sphere and one object.
    pairs: Vec<Pair>,
    /// Contacts of one object, tool sphere by tool sphere.
    pub order: Vec<u32>,
    /// Compatibility of each pair with each seed that was kept, seed by seed.
    kept: Vec<f64>,
    /// Compatibility of each pair with the seed in question.
    now: Vec<f64>,
}

impl Blender {
    /// Scratch for lists of at most `contacts`.
    pub fn with_capacity(contacts: usize) -> Self {
        Self {
            pairs: Vec::with_capacity(contacts),
            order: Vec::with_capacity(contacts),
            kept: Vec::with_capacity(contacts * MAX_SEEDS),
            now: Vec::with_capacity(contacts),
        }
    }

    /// Begins with the pairs of another tool sphere and object.
    pub fn begin(&mut self) {
        self.pairs.clear();
    }

    /// Adds a pair.
    pub fn push(&mut self, pair: Pair) {
        self.pairs.push(pair);
    }

    /// Gives every row of the pairs with a gap under `limit` to `row`: gap, mean normal, seed, and the
    /// members. Pairs are sorted first, by gap, then by contact.
    pub fn rows(
        &mut self,
        blend: f64,
        limit: f64,
        mut row: impl FnMut(Line, &mut dyn Iterator<Item = Member>),
    ) {
        let n = self.pairs.len();
        let Some(smallest) = self.pairs.iter().map(|pair| pair.gap).reduce(fmin) else {
            return;
        };
        // The sum has at most n terms of at most 1.
        if smallest - blend * libm::log(n as f64) >= limit {
            return;
        }
        for pair in &mut self.pairs {
            pair.weight = libm::exp((smallest - pair.gap) / blend);
        }
        self.pairs
            .sort_unstable_by(|a, b| a.gap.total_cmp(&b.gap).then(a.contact.cmp(&b.contact)));
        self.kept.clear();
        let mut seeds = 0;
        let mut left_out = f64::INFINITY;
        for j in 0..n {
            if seeds == MAX_SEEDS {
                return;
            }
            let seed = self.pairs[j];
            // So far up that its own core is out of reach whatever else is near: where the surface
            // is within reach, nearer spheres make it, and have their rows.
            if seed.gap - blend * libm::log(n as f64) >= limit {
                return;
            }
            // What the first row leaves out may be too little to make another one.
            if seeds > 0 && left_out <= IMPLIED * seed.weight {
                continue;
            }
            self.now.clear();
            let mut sum = 0.0;
            for pair in &self.pairs {
                let a = compatibility(
                    seed.normal.dot(&pair.normal),
                    fmin(seed.distance, pair.distance),
                    pair.gap - seed.gap,
                    blend,
                );
                self.now.push(a);
                sum += a * pair.weight;
            }
            let implied = (0..seeds).any(|kept| {
                let mut beyond = 0.0;
                for ((pair, now), before) in self
                    .pairs
                    .iter()
                    .zip(&self.now)
                    .zip(&self.kept[kept * n..(kept + 1) * n])
                {
                    if now > before {
                        beyond += (now - before) * pair.weight;
                    }
                }
                beyond <= IMPLIED * sum
            });
            let gap = smallest - blend * libm::log(sum);
            if implied || gap >= limit {
                continue;
            }
            if seeds == 0 {
                left_out = self
                    .pairs
                    .iter()
                    .zip(&self.now)
                    .fold(0.0, |left, (pair, a)| left + (1.0 - a) * pair.weight);
            }
            seeds += 1;
            self.kept.extend_from_slice(&self.now);
            let share = |k: usize| self.now[k] * self.pairs[k].weight / sum;
            let mut normal = Vec3::zeros();
            for k in 0..n {
                normal += self.pairs[k].normal * share(k);
            }
            let line = Line {
                contact: seed.contact,
                gap,
                normal,
                first: 0,
                members: 0,
            };
            let mut members = (0..n).map(|k| Member {
                contact: self.pairs[k].contact,
                weight: share(k),
            });
            row(
                line,
                &mut members.by_ref().filter(|member| member.weight > 0.0),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Mat3, norm};
    use proptest::prelude::*;

    const TIP: f64 = 2.5e-4;

    fn pairs(at: &Vec3, spheres: &[(Vec3, f64)]) -> Blender {
        let mut blender = Blender::with_capacity(spheres.len());
        blender.begin();
        for (k, (centre, radius)) in spheres.iter().enumerate() {
            let distance = norm(&(at - centre));
            let normal = (at - centre) / distance;
            blender.push(Pair::new(
                k as u32,
                distance - radius - TIP,
                normal,
                distance,
            ));
        }
        blender
    }

    fn rows(
        at: &Vec3,
        spheres: &[(Vec3, f64)],
        blend: f64,
        limit: f64,
    ) -> Vec<(Line, Vec<Member>)> {
        let mut found = Vec::new();
        pairs(at, spheres).rows(blend, limit, |line, members| {
            found.push((line, members.collect()));
        });
        found
    }

    /// Smallest blended gap over all seeds, straight from the definition.
    fn smallest(at: &Vec3, spheres: &[(Vec3, f64)], blend: f64) -> f64 {
        let seen: Vec<_> = spheres
            .iter()
            .map(|(centre, radius)| {
                let distance = norm(&(at - centre));
                (distance - radius - TIP, distance, (at - centre) / distance)
            })
            .collect();
        seen.iter().fold(f64::INFINITY, |least, seed| {
            let sum: f64 = seen
                .iter()
                .map(|other| {
                    let shared = compatibility(
                        seed.2.dot(&other.2),
                        fmin(seed.1, other.1),
                        other.0 - seed.0,
                        blend,
                    );
                    shared * libm::exp(-(other.0 - seed.0) / blend)
                })
                .sum();
            fmin(least, seed.0 - blend * libm::log(sum))
        })
    }

    /// A plate of spheres about the origin in the plane with that normal.
    fn plate(turn: &Mat3, radius: f64, spacing: f64) -> impl Iterator<Item = (Vec3, f64)> {
        let turn = *turn;
        (-8..=8).flat_map(move |i| {
            (-8..=8).map(move |j| {
                let flat = Vec3::new(f64::from(i) * spacing, f64::from(j) * spacing, -radius);
                (turn * flat, radius)
            })
        })
    }

    fn turned(angle: f64) -> Mat3 {
        crate::math::exp_rotation(&(Vec3::y() * angle))
            .to_rotation_matrix()
            .into_inner()
    }

    #[test]
    fn on_a_smooth_surface_one_row_is_all_and_it_is_flat() {
        let spheres: Vec<_> = plate(&Mat3::identity(), 1e-3, 2.5e-4).collect();
        // Bumps of the hard plate: 16 um over the pits of the lattice.
        let mut gaps = Vec::new();
        for k in 0..40 {
            let at = Vec3::new(1.3e-5 * f64::from(k), 0.7e-5 * f64::from(k), 4e-4);
            let rows = rows(&at, &spheres, 3e-5, 1.0);
            assert_eq!(rows.len(), 1, "at {at:?}");
            let (line, members) = &rows[0];
            assert!(line.normal.z > 0.95, "{:?}", line.normal);
            let sum: f64 = members.iter().map(|m| m.weight).sum();
            assert!((sum - 1.0).abs() < 1e-12);
            gaps.push(line.gap);
        }
        let low = gaps.iter().copied().fold(f64::INFINITY, fmin);
        let high = gaps
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, crate::math::fmax);
        assert!(high - low < 2e-7, "ripple {:e} m", high - low);
    }

    #[test]
    fn a_row_is_the_derivative_of_its_gap() {
        let spheres: Vec<_> = plate(&turned(0.2), 1e-3, 2.5e-4).collect();
        let at = Vec3::new(1.1e-4, -0.7e-4, 4e-4);
        let (line, _) = rows(&at, &spheres, 3e-5, 1.0).remove(0);
        let step = 1e-8;
        for axis in 0..3 {
            let gap = |side: f64| {
                let mut there = at;
                there[axis] += side * step;
                rows(&there, &spheres, 3e-5, 1.0)[0].0.gap
            };
            let slope = (gap(1.0) - gap(-1.0)) / (2.0 * step);
            assert!(
                (slope - line.normal[axis]).abs() < 1e-6,
                "axis {axis}: {slope} against {}",
                line.normal[axis]
            );
        }
    }

    #[test]
    fn the_walls_of_a_groove_keep_rows_of_their_own() {
        let mut spheres: Vec<_> = plate(&turned(0.7), 1e-3, 2.5e-4).collect();
        spheres.extend(plate(&turned(-0.7), 1e-3, 2.5e-4));
        let at = Vec3::new(0.0, 0.0, 4e-4);
        let rows = rows(&at, &spheres, 3e-5, 1e-3);
        let tilt = |line: &Line| line.normal.x / norm(&line.normal);
        for side in [1.0, -1.0] {
            assert!(
                rows.iter()
                    .any(|(line, _)| (tilt(line) * side - 0.644).abs() < 0.05),
                "no row of the wall on side {side}: {:?}",
                rows.iter().map(|(line, _)| line.normal).collect::<Vec<_>>()
            );
        }
    }

    #[test]
    fn nothing_within_the_limit_is_no_row() {
        let spheres: Vec<_> = plate(&Mat3::identity(), 1e-3, 2.5e-4).collect();
        let at = Vec3::new(0.0, 0.0, 2e-3);
        assert!(rows(&at, &spheres, 3e-5, 1e-3).is_empty());
        assert!(rows(&at, &[], 3e-5, 1.0).is_empty());
    }

    proptest! {
        #[test]
        fn rows_hold_the_surface_and_every_core_off(
            at in (-1e-3..1e-3, -1e-3..1e-3, 2e-4..1e-3_f64),
            places in proptest::collection::vec((-1e-3..1e-3_f64, -1e-3..1e-3_f64, -1e-3..0.0_f64, 1e-4..1e-3_f64), 1..40),
            blend in 1e-6..2e-4_f64) {
            let at = Vec3::new(at.0, at.1, at.2);
            let spheres: Vec<_> = places.iter().map(|p| (Vec3::new(p.0, p.1, p.2), p.3)).collect();
            let rows = rows(&at, &spheres, blend, 1.0);
            let least = rows.iter().map(|(line, _)| line.gap).fold(f64::INFINITY, fmin);
            // What was left out binds at most this much earlier.
            prop_assert!((least - smallest(&at, &spheres, blend)).abs() <= 1.001 * IMPLIED * blend + 1e-15);
            for (line, members) in &rows {
                let sum: f64 = members.iter().map(|member| member.weight).sum();
                prop_assert!((sum - 1.0).abs() < 1e-9);
                prop_assert!(members.iter().all(|member| member.weight >= 0.0));
                prop_assert!(norm(&line.normal) <= 1.0 + 1e-12);
            }
            let core = spheres.iter().map(|(c, r)| norm(&(at - c)) - r - TIP).fold(f64::INFINITY, fmin);
            prop_assert!(least <= core + 1e-15);
        }
    }
}
