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
//! keep separate rows, so that the problem is convex there. On a smooth surface all seeds give nearly the
//! same row; those that another one implies are left out. What is blended may still be hollow: passes that
//! know only the slope there turn with the tool's way, by `-depth / radius` of it each time, and
//! buzz where the press is deeper than the hollow's radius. The pass therefore also knows the bend
//! (`hollowness`, and the module `metric`).
//!
//! Measured (probe tip, 1 mm deep, ellipsoid of 40, 25, 15 mm; rms of the force / median error of direction):
//! hard spheres 2.0 % / 3.0 degrees at level 3, 0.34 % / 1.3 at level 4, 0.12 % / 0.6 at level 5; blended 0.56 % / 0.7
//! and 0.15 % / 0.3 at levels 3 and 4. Other shapes, blend lengths and costs: the bench `ripple` of sulcus-cases.

mod groups;
mod hollowness;

use crate::Scene;
use crate::contact::{Contact, SHORTER, SMALLEST_PREDICTION};
use crate::math::{Vec3, exp_of_loss, fclamp, fmax, fmin};

pub(crate) use groups::{Group, Groups};
pub(crate) use hollowness::hollowness;

/// A sphere that would move the surface by less than this is left out, metres.
const UNFELT: f64 = 2e-8;
/// Excess of the sagitta in blend lengths up to which two spheres are on one smooth surface. Over the pit between four
/// spheres of a lattice that is blended as it should be, two that face each other have 4 to 6.
const ONE_SURFACE: f64 = 7.0;
/// Excess from which they have nothing to do with one another.
const TWO_SURFACES: f64 = 12.0;
/// A seed is left out where the rows before it hold all but this share of its sum: it could bind at most
/// this share of the blend length before them.
const IMPLIED: f64 = 1e-3;
/// Far above the rounding of a blended gap, far below anything that is felt, metres.
const ROUNDING: f64 = 1e-12;
/// By how many blend lengths another seed's surface may be closer than that of the nearest core: where the
/// one stands alone, hardly inset, and the other deep among many.
pub(crate) const OTHER_SEEDS: f64 = 3.0;
/// Most rows of one tool sphere against one object: the walls of a pocket, its floor, and some. Seeds come by their own
/// core's gap, not by that of the surface, so what has no room here may be what is touched: then only nearer ones are asked for.
pub const MAX_SEEDS: usize = 12;

/// How many blend lengths above the smallest core gap a sphere still counts: there its share,
/// `exp(-reach)` of the blend length, comes to 20 nm; there may be dozens.
#[inline]
pub fn reach(blend: f64) -> f64 {
    fclamp(libm::log(blend / UNFELT), 4.0, 10.0)
}

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
    /// Between the centres, metres.
    pub distance: f64,
    /// Share of the row's multiplier, 0 to 1; they add up to 1.
    pub weight: f64,
}

/// One row of the problem.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactRow {
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

impl ContactRow {
    /// The row of a hard contact.
    #[inline]
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

/// Where rows are written.
pub(crate) struct Written<'a> {
    /// The rows.
    pub contact_rows: &'a mut Vec<ContactRow>,
    /// The members of all of them.
    pub members: &'a mut Vec<Member>,
}

/// A node's core at its object's level in contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Core {
    /// Its radius, metres.
    pub radius: f64,
    /// And by how much that is less than the contact sphere's.
    pub inset: f64,
}

/// Cores of an object's nodes; none where it is not blended.
pub(crate) fn cores(scene: &Scene, k: usize) -> Vec<Core> {
    if scene.blend_of(k) == 0.0 {
        return Vec::new();
    }
    let object = &scene.objects[k];
    let nodes = object.tree.nodes().iter().enumerate();
    let core = nodes.map(|(id, node)| {
        let radius = object.tree.core_radius(id as u32, object.level);
        Core {
            radius,
            inset: node.contact_radius - radius,
        }
    });
    core.collect()
}

/// A pair that is not wholly in a kept row's sum.
#[derive(Clone, Copy, Debug)]
struct LeftOut {
    pair: u32,
    /// Its share there.
    share: f64,
    /// The most that this pair and those of the same row after it could add to another row's sum.
    rest: f64,
}

/// Scratch: nothing in it outlives a call.
#[derive(Debug)]
pub(crate) struct Blender {
    /// Pairs of one tool sphere and one object.
    pairs: Vec<Pair>,
    /// Pairs that kept rows leave out in part or wholly, row by row.
    left_out: Vec<LeftOut>,
    /// Share of each pair in the row in question.
    shares: Vec<f64>,
    /// Natural logarithm of each number of pairs; of none, 0.
    logs: Vec<f64>,
    /// A blend length and its [`reach`].
    reach: (f64, f64),
    /// Largest weight beyond that.
    unfelt: f64,
}

impl Blender {
    /// Scratch for lists of at most `contacts`.
    pub fn with_capacity(contacts: usize) -> Self {
        Self {
            pairs: Vec::with_capacity(contacts),
            left_out: Vec::with_capacity(contacts * MAX_SEEDS),
            shares: Vec::with_capacity(contacts),
            logs: (0..=contacts)
                .map(|n| libm::log(fmax(1.0, n as f64)))
                .collect(),
            reach: (f64::NAN, 0.0),
            unfelt: 1.0,
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

    /// Puts the nearest pair first, weighs the others against it and drops those that are both out of its
    /// reach and farther than `kept`. Gives the smallest gap; nothing where there is no pair.
    fn weigh(&mut self, blend: f64, kept: f64) -> Option<f64> {
        let nearest = (0..self.pairs.len()).reduce(|best, k| {
            let (a, b) = (&self.pairs[k], &self.pairs[best]);
            if a.gap < b.gap { k } else { best }
        })?;
        self.pairs.swap(0, nearest);
        let smallest = self.pairs[0].gap;
        if self.reach.0 != blend {
            self.reach = (blend, reach(blend));
            self.unfelt = libm::exp(-self.reach.1);
        }
        let farthest = fmax(smallest + self.reach.1 * blend, kept);
        self.pairs.retain(|pair| pair.gap <= farthest);
        for pair in &mut self.pairs {
            // Never nothing: a seed on another wall, however far above the nearest, has its own row.
            pair.weight = exp_of_loss((smallest - pair.gap) / blend);
        }
        Some(smallest)
    }

    /// How far pair `k` belongs to the surface of `seed`.
    #[inline]
    fn shared(&self, seed: &Pair, k: usize, blend: f64) -> f64 {
        let pair = &self.pairs[k];
        compatibility(
            seed.normal.dot(&pair.normal),
            fmin(seed.distance, pair.distance),
            pair.gap - seed.gap,
            blend,
        )
    }

    /// Blended gap of `seed`, metres.
    fn gap_of(&self, seed: &Pair, smallest: f64, blend: f64) -> f64 {
        let sum = (0..self.pairs.len()).fold(0.0, |sum, k| {
            sum + self.shared(seed, k, blend) * self.pairs[k].weight
        });
        smallest - blend * libm::log(sum)
    }

    /// The smaller of `limit` and the smallest blended gap over all seeds, metres.
    pub fn least(&mut self, blend: f64, limit: f64) -> f64 {
        let Some(smallest) = self.weigh(blend, f64::NEG_INFINITY) else {
            return limit;
        };
        let nearest = self.pairs[0];
        self.left_out.clear();
        let mut sum = 0.0;
        for (k, pair) in self.pairs.iter().enumerate() {
            let share = self.shared(&nearest, k, blend);
            sum += share * pair.weight;
            if share < 1.0 {
                self.left_out.push(LeftOut {
                    pair: k as u32,
                    share,
                    rest: 0.0,
                });
            }
        }
        let mut least = fmin(limit, smallest - blend * libm::log(sum));
        if self.left_out.is_empty() {
            return least;
        }
        for seed in &self.pairs[1..] {
            // No more is in this seed's sum than in the nearest one's and what that leaves out.
            let more = self.left_out.iter().fold(sum, |more, left_out| {
                let k = left_out.pair as usize;
                let now = self.shared(seed, k, blend);
                more + fmax(0.0, now - left_out.share) * self.pairs[k].weight
            });
            if smallest - blend * libm::log(more) < least {
                least = fmin(least, self.gap_of(seed, smallest, blend));
            }
        }
        least
    }

    /// Writes the rows of the pairs with a gap under `limit`, with their members. Where there are more of them than
    /// [`MAX_SEEDS`] the limit is lowered until there is room. Returns the limit under which all rows are written (metres; 0 where
    /// none was small enough), and what none of the gaps of these pairs is under.
    pub fn rows(&mut self, blend: f64, limit: f64, written: &mut Written<'_>) -> (f64, f64) {
        let count = self.pairs.len();
        // Within the limit the tool may come in this pass to any wall, not only to the nearest.
        let kept = limit + blend * self.logs[count];
        let Some(smallest) = self.weigh(blend, kept) else {
            return (limit, f64::INFINITY);
        };
        // All on one surface, those that were dropped as near as they could be.
        let dropped = (count - self.pairs.len()) as f64 * self.unfelt;
        let sum = self
            .pairs
            .iter()
            .fold(dropped, |sum, pair| sum + pair.weight);
        let least = smallest - blend * libm::log(sum) - ROUNDING;
        // Not even the surface of the nearest?
        if least >= limit
            || self.gap_of(&self.pairs[0], smallest, blend) >= limit + OTHER_SEEDS * blend
        {
            return (limit, least);
        }
        // By gap, then by contact: which rows imply which depends on nothing else.
        self.pairs
            .sort_unstable_by(|a, b| a.gap.total_cmp(&b.gap).then(a.contact.cmp(&b.contact)));
        let (contact_rows, members) = (written.contact_rows.len(), written.members.len());
        let mut room = limit;
        while !self.seeds(smallest, blend, room, written) {
            if room <= SMALLEST_PREDICTION {
                return (0.0, least);
            }
            // At least the farthest of those that took up the room must go.
            let farthest = written.contact_rows[contact_rows..]
                .iter()
                .fold(0.0, |most, line| fmax(most, line.gap));
            written.contact_rows.truncate(contact_rows);
            written.members.truncate(members);
            room = fmax(fmin(SHORTER * room, farthest), SMALLEST_PREDICTION);
        }
        (room, least)
    }

    fn seeds(&mut self, smallest: f64, blend: f64, limit: f64, written: &mut Written<'_>) -> bool {
        let n = self.pairs.len();
        let most = blend * self.logs[n];
        let all = self.pairs.iter().fold(0.0, |sum, pair| sum + pair.weight);
        self.left_out.clear();
        let mut begins = [0; MAX_SEEDS + 1];
        let mut seeds = 0;
        for j in 0..n {
            let seed = self.pairs[j];
            // A seed so far up has its own core out of reach whatever else is near: where the surface is
            // within reach, nearer spheres make it, and have their rows.
            if seed.gap - most >= limit {
                return true;
            }
            // What this row would hold beyond a row before it, as far as it matters.
            let mut beyond = f64::INFINITY;
            let (little, much) = (IMPLIED * seed.weight, IMPLIED * all);
            for kept in 0..seeds {
                let left_out = &self.left_out[begins[kept]..begins[kept + 1]];
                let mut more = 0.0;
                for left_out in left_out {
                    if more > much || more + left_out.rest <= little {
                        break;
                    }
                    let k = left_out.pair as usize;
                    let now = self.shared(&seed, k, blend);
                    more += fmax(0.0, now - left_out.share) * self.pairs[k].weight;
                }
                beyond = fmin(beyond, more);
                if beyond <= little {
                    break;
                }
            }
            if beyond <= little {
                continue;
            }
            self.shares.clear();
            let mut sum = 0.0;
            for k in 0..n {
                let share = self.shared(&seed, k, blend);
                sum += share * self.pairs[k].weight;
                self.shares.push(share);
            }
            let gap = smallest - blend * libm::log(sum);
            if beyond <= IMPLIED * sum || gap >= limit {
                continue;
            }
            if seeds == MAX_SEEDS {
                return false;
            }
            for (k, share) in self.shares.iter_mut().enumerate() {
                let weight = self.pairs[k].weight;
                if *share < 1.0 {
                    self.left_out.push(LeftOut {
                        pair: k as u32,
                        share: *share,
                        rest: (1.0 - *share) * weight,
                    });
                }
                *share *= weight / sum;
            }
            let mut rest = 0.0;
            for left_out in self.left_out[begins[seeds]..].iter_mut().rev() {
                rest += left_out.rest;
                left_out.rest = rest;
            }
            seeds += 1;
            begins[seeds] = self.left_out.len();
            let mut normal = Vec3::zeros();
            for (pair, share) in self.pairs.iter().zip(&self.shares) {
                normal += pair.normal * *share;
            }
            let first = written.members.len();
            let members = self
                .pairs
                .iter()
                .zip(&self.shares)
                .filter(|(_, share)| **share > 0.0)
                .map(|(pair, share)| Member {
                    contact: pair.contact,
                    distance: pair.distance,
                    weight: *share,
                });
            written.members.extend(members);
            written.contact_rows.push(ContactRow {
                contact: seed.contact,
                gap,
                normal,
                first: first as u32,
                members: (written.members.len() - first) as u32,
            });
        }
        true
    }
}

#[cfg(test)]
mod tests;
