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
/// Sagitta in blend lengths up to which two spheres are on one smooth surface.
const ONE_SURFACE: f64 = 4.5;
/// Sagitta in blend lengths from which they have nothing to do with one another.
const TWO_SURFACES: f64 = 12.5;
/// A seed is left out where the rows before it hold all but this share of its sum: it could bind at most
/// this share of the blend length before them.
const IMPLIED: f64 = 1e-3;
/// Most rows of one tool sphere against one object: the walls of a pocket, its floor, and some.
pub const MAX_SEEDS: usize = 8;

/// How far two spheres of an object, seen from the tool's sphere in directions of that `cosine`
/// and from `distance` (the smaller of the two centres' distances, metres), belong to one surface: 1 yes, 0
/// no, smooth between. Measured by the sagitta, `(1 - cosine) distance`, in blend lengths: how far a sphere
/// drops away over that angle, which on a smooth surface grows with the gap itself, at any level.
#[inline]
pub fn compatibility(cosine: f64, distance: f64, blend: f64) -> f64 {
    let sagitta = (1.0 - cosine) * distance;
    if sagitta <= ONE_SURFACE * blend {
        return 1.0;
    }
    if sagitta >= TWO_SURFACES * blend {
        return 0.0;
    }
    let t = (TWO_SURFACES - sagitta / blend) / (TWO_SURFACES - ONE_SURFACE);
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
            self.now.clear();
            let mut sum = 0.0;
            for pair in &self.pairs {
                let a = compatibility(
                    seed.normal.dot(&pair.normal),
                    fmin(seed.distance, pair.distance),
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
