//! Blended rows: contact rows on one smooth surface over the spheres of a rigid object.
//!
//! A union of spheres is bumpy. A hand that presses a probe's tip 1 mm deep feels the bumps as ripple of the force. A
//! tool sphere `t` therefore meets the *blended* surface of all spheres of the object.
//!
//! The core gap of sphere `k` is `g_k = |p_t - c_k| - (r_k - b_k) - rho_t`. Here `r_k` and `b_k` are the radius and the
//! inset of the sphere, and `rho_t` is the radius of the tool sphere. With the blend length `kappa` of the level, the
//! row of the pair `(t, j)` has the gap
//!
//! `s_j = -kappa ln sum_k a_jk exp(-g_k / kappa)`, and the Jacobian `sum_k w_k J_k`,
//! `w_k = a_jk exp(-g_k / kappa) / sum`.
//!
//! The compatibility `a_jk` is 1 for neighbours on one smooth surface. The value falls to 0 for spheres that are
//! touched from a different side ([`compatibility`]). Because `a_jj` is 1, `s_j <= g_j`: valid rows keep the tool out
//! of every core.
//!
//! The insets are calibrated offline so that the surface `s = 0` lies on the mesh. The union of hard spheres lies on
//! the mesh too. Without insets the blended surface would stand off by about `kappa` times the logarithm of the number
//! of spheres in the sum.
//!
//! The soft minimum is that of the exponential blend of implicit surfaces (Blinn 1982, doi:10.1145/357306.357310).
//! There is a row per *seed* `j`, not per tool sphere. In a groove the walls thus keep separate rows, and the problem
//! is convex there. On a smooth surface all seeds give nearly the same row. Seeds implied by another row are left out.
//!
//! A blended surface can still be hollow. Substeps that know only the slope of a hollow oscillate: each lateral step is
//! `-depth / radius` times the previous step. The oscillation grows where the press is deeper than the radius of the
//! hollow. The metric of a substep therefore includes the curvature (`hollowness`, and the module `metric`).
//!
//! Measured with a probe tip, 1 mm deep, on an ellipsoid of 40, 25, 15 mm: rms of the force / median error of
//! direction.
//!
//! | spheres | level 3 | level 4 | level 5 |
//! |---|---|---|---|
//! | hard | 2.0 % / 3.0 degrees | 0.34 % / 1.3 degrees | 0.12 % / 0.6 degrees |
//! | blended | 0.56 % / 0.7 degrees | 0.15 % / 0.3 degrees | |
//!
//! Other shapes, blend lengths and costs: the bench `ripple` of sulcus-cases.

mod groups;
mod hollowness;

use crate::Scene;
use crate::contact::{Contact, SHORTER, SMALLEST_PREDICTION};
use crate::math::{Vec3, exp_of_loss, fclamp, fmax, fmin};

pub(crate) use groups::{Group, Groups};
pub(crate) use hollowness::hollowness;

/// Contribution of a sphere to a blended gap under which the sphere is ignored, metres.
const UNFELT: f64 = 2e-8;
/// Excess in [`compatibility`] up to which two spheres are on one smooth surface, in blend lengths. Opposite spheres
/// over the pit between four spheres of a properly blended lattice have an excess of 4 to 6.
const ONE_SURFACE: f64 = 7.0;
/// Excess in [`compatibility`] from which two spheres are on separate surfaces, in blend lengths.
const TWO_SURFACES: f64 = 12.0;
/// Share of its own sum up to which a seed may exceed the sum of an earlier row and still get no row. Such a seed could
/// bind earlier by at most this share of the blend length.
const IMPLIED: f64 = 1e-3;
/// Margin subtracted for rounding from the lower bound of the blended gaps, metres: far above the rounding, far below
/// any perceptible distance.
const ROUNDING: f64 = 1e-12;
/// Margin by which the blended gap of another seed may be under that of the seed with the nearest core, in blend
/// lengths. The case occurs where the nearest core stands alone with a small inset and the other core lies deep among
/// many.
pub(crate) const OTHER_SEEDS: f64 = 3.0;
/// Maximum number of rows of one tool sphere against one object: the walls of a pocket, its floor, and a reserve. Seeds
/// are ordered by their core gap, not by the blended gap, so a seed beyond the capacity may be touched. On overflow
/// only seeds with a blended gap under a smaller limit get rows.
pub const MAX_SEEDS: usize = 12;

/// Returns the reach of spheres in a blended gap, 4 to 10 blend lengths: farther core gaps, counted from the smallest
/// core gap, are ignored. `blend` is the blend length, metres. Unless the reach is clamped, a sphere at the reach
/// changes the gap by 20 nm. Dozens of spheres can lie there.
#[inline]
pub fn reach(blend: f64) -> f64 {
    fclamp(libm::log(blend / UNFELT), 4.0, 10.0)
}

/// Returns the compatibility of a sphere with a seed: 1 on one smooth surface, 0 on separate surfaces, smooth between.
///
/// - `cosine`: cosine of the angle between the directions from the tool sphere to the two spheres.
/// - `distance`: distance from the tool sphere to the nearer of the two centres, metres.
/// - `rise`: core gap of the sphere minus the core gap of the seed, metres.
/// - `blend`: blend length, metres.
///
/// Over that angle a sphere drops away by the sagitta `(1 - cosine) distance`. On a flat or convex surface the gap of
/// the other sphere is larger by about the sagitta. A sphere with a much smaller `rise` belongs to another wall. The
/// excess of the sagitta over `rise` separates the two cases. In blend lengths the excess has the same meaning at every
/// level.
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

/// Pair of a tool sphere and a sphere of a blended object, at the pose of the evaluation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// Index in the contact list.
    pub contact: u32,
    /// Core gap, metres.
    pub gap: f64,
    /// Unit vector from the object's sphere to the tool's, world axes.
    pub normal: Vec3,
    /// Distance between the centres, metres.
    pub distance: f64,
    /// Weight before compatibility, 0 to 1: `exp(-(gap - smallest) / kappa)`, with the smallest core gap of the pairs;
    /// 0 until [`Blender::weigh`].
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

/// Member of a blended row: a contact with its share of the row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Member {
    /// Index in the contact list.
    pub contact: u32,
    /// Distance between the centres of the pair of spheres, metres.
    pub distance: f64,
    /// Share of the row's multiplier, 0 to 1. The shares of a row add up to 1.
    pub weight: f64,
}

/// Contact row: a hard contact, or a seed on a blended object with its members.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactRow {
    /// Index in the contact list of the contact, or of the seed of a blended row. Determines tool, object and arm.
    pub contact: u32,
    /// Gap of the spheres for a hard contact, blended gap for a seed, metres. Negative is penetration.
    pub gap: f64,
    /// Derivative of the gap by the position of the tool sphere, world axes: a unit normal, or the weighted mean of the
    /// members' normals. The mean has a length of at most 1.
    pub normal: Vec3,
    /// Start of the members in the list of all members; 0 for a hard contact.
    pub first: u32,
    /// Number of members; 0 for a hard contact.
    pub members: u32,
}

impl ContactRow {
    /// Returns the row of a hard contact.
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

/// Lists to which [`Blender::rows`] appends the rows and their members.
pub(crate) struct Written<'a> {
    /// Contact rows, in the order of their writing.
    pub contact_rows: &'a mut Vec<ContactRow>,
    /// Members of all rows, row by row.
    pub members: &'a mut Vec<Member>,
}

/// Core of a node at the contact level of its object: the contact sphere reduced by the inset.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Core {
    /// Radius of the core, metres.
    pub radius: f64,
    /// Inset: contact radius minus radius of the core, metres.
    pub inset: f64,
}

/// Returns the cores of the nodes of object `k` of the scene, in the order of the nodes; empty for an object without
/// blending.
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

/// Pair whose compatibility with the seed of an earlier row is under 1.
#[derive(Clone, Copy, Debug)]
struct LeftOut {
    /// Index in `Blender::pairs`.
    pair: u32,
    /// Compatibility of the pair with that seed, 0 to 1.
    share: f64,
    /// Upper bound of the weight that this and the later left-out pairs of the same row can add to another row's sum.
    /// In [`Blender::least`] the value is 0 and unused.
    rest: f64,
}

/// Scratch for the rows of one tool sphere against one object. Results depend only on the pairs since
/// [`Blender::begin`].
#[derive(Debug)]
pub(crate) struct Blender {
    /// Pairs of one tool sphere and one object.
    pairs: Vec<Pair>,
    /// Left-out pairs of the rows written so far, row by row; in [`Blender::least`] those of the nearest seed.
    left_out: Vec<LeftOut>,
    /// Scratch: share of each pair in the row that is being written, 0 to 1.
    shares: Vec<f64>,
    /// Natural logarithm of each number of pairs, indexed by the number; 0 at index 0.
    logs: Vec<f64>,
    /// Last blend length, metres, and its [`reach`] in blend lengths; NaN and 0 before the first use.
    reach: (f64, f64),
    /// Largest weight of a pair beyond that reach, `exp(-reach)`; 1 before the first use.
    unfelt: f64,
    /// Counts since the last [`Blender::take_effort`].
    effort: Effort,
}

/// Counts of evaluations of blended gaps, the same on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Effort {
    /// Pairs that were weighed.
    pub weighed: u64,
    /// Compatibilities that were evaluated.
    pub shared: u64,
}

/// Soft minimum of core gaps, metres: `smallest - blend ln(sum)`. `sum` adds up the compatibilities times
/// `exp((smallest - gap) / blend)` over all pairs; `smallest` and `blend` are in metres.
#[inline]
fn soft_minimum(smallest: f64, blend: f64, sum: f64) -> f64 {
    smallest - blend * libm::log(sum)
}

impl Blender {
    /// Returns scratch for lists of at most `contacts` contacts.
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
            effort: Effort::default(),
        }
    }

    /// Returns the counts since the last call.
    pub fn take_effort(&mut self) -> Effort {
        std::mem::take(&mut self.effort)
    }

    /// Removes all pairs, for the next tool sphere and object.
    pub fn begin(&mut self) {
        self.pairs.clear();
    }

    /// Adds a pair of the present tool sphere and object.
    pub fn push(&mut self, pair: Pair) {
        self.pairs.push(pair);
    }

    /// Moves the pair with the smallest core gap to the front and sets the weights relative to it. Drops each pair
    /// whose core gap is both out of [`reach`] and over `kept`. Returns the smallest core gap, metres; `None` without
    /// pairs. `kept` and the blend length `blend` are in metres.
    fn weigh(&mut self, blend: f64, kept: f64) -> Option<f64> {
        self.effort.weighed += self.pairs.len() as u64;
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
            // Never zero: a seed on another wall, however far above the nearest, has its own row.
            pair.weight = exp_of_loss((smallest - pair.gap) / blend);
        }
        Some(smallest)
    }

    /// Returns the compatibility of pair `k` with `seed`: 1 on one smooth surface, 0 on separate surfaces, smooth
    /// between. `blend` is the blend length, metres.
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

    /// Returns the blended gap of `seed` over the present pairs, metres. `smallest` is the core gap to which the
    /// weights refer. `smallest` and the blend length `blend` are in metres.
    fn gap_of(&self, seed: &Pair, smallest: f64, blend: f64) -> f64 {
        let sum = (0..self.pairs.len()).fold(0.0, |sum, k| {
            sum + self.shared(seed, k, blend) * self.pairs[k].weight
        });
        soft_minimum(smallest, blend, sum)
    }

    /// Returns the smallest blended gap over all pairs as seeds, metres, but at most `limit`. Without pairs the result
    /// is `limit`. `limit` and the blend length `blend` are in metres. Drops the pairs out of reach.
    pub fn least(&mut self, blend: f64, limit: f64) -> f64 {
        let Some(smallest) = self.weigh(blend, f64::NEG_INFINITY) else {
            return limit;
        };
        let nearest = self.pairs[0];
        self.effort.shared += self.pairs.len() as u64;
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
        let mut least = fmin(limit, soft_minimum(smallest, blend, sum));
        if self.left_out.is_empty() {
            return least;
        }
        let mut shared = 0;
        for seed in &self.pairs[1..] {
            // Upper bound of this seed's sum: the sum of the nearest seed plus the shares that the nearest seed leaves
            // out.
            let more = self.left_out.iter().fold(sum, |more, left_out| {
                let k = left_out.pair as usize;
                let now = self.shared(seed, k, blend);
                more + fmax(0.0, now - left_out.share) * self.pairs[k].weight
            });
            shared += self.left_out.len();
            if soft_minimum(smallest, blend, more) < least {
                shared += self.pairs.len();
                least = fmin(least, self.gap_of(seed, smallest, blend));
            }
        }
        self.effort.shared += shared as u64;
        least
    }

    /// Appends the rows of the seeds with a blended gap under `limit`, with their members. On more rows than
    /// [`MAX_SEEDS`] the limit is lowered until all rows fit. `limit` and the blend length `blend` are in metres.
    ///
    /// Returns the limit under which all rows are written, metres, and a lower bound of the blended gaps of all present
    /// seeds, metres. The limit is 0 when not even 1e-6 m fits. The bound is infinite without pairs.
    pub fn rows(&mut self, blend: f64, limit: f64, written: &mut Written<'_>) -> (f64, f64) {
        let count = self.pairs.len();
        // Within the limit the tool may reach any wall in this substep, not only the nearest wall.
        let kept = limit + blend * self.logs[count];
        let Some(smallest) = self.weigh(blend, kept) else {
            return (limit, f64::INFINITY);
        };
        // Lower bound: all pairs on one surface, dropped pairs as near as possible.
        let dropped = (count - self.pairs.len()) as f64 * self.unfelt;
        let sum = self
            .pairs
            .iter()
            .fold(dropped, |sum, pair| sum + pair.weight);
        let least = soft_minimum(smallest, blend, sum) - ROUNDING;
        self.effort.shared += self.pairs.len() as u64;
        // No row if even the surface of the nearest seed is beyond the limit, with the margin for other seeds.
        if least >= limit
            || self.gap_of(&self.pairs[0], smallest, blend) >= limit + OTHER_SEEDS * blend
        {
            return (limit, least);
        }
        // Sorted by gap, then by contact: the choice of the implied rows must not depend on the order of the pairs.
        self.pairs
            .sort_unstable_by(|a, b| a.gap.total_cmp(&b.gap).then(a.contact.cmp(&b.contact)));
        let (contact_rows, members) = (written.contact_rows.len(), written.members.len());
        let mut room = limit;
        while !self.seeds(smallest, blend, room, written) {
            if room <= SMALLEST_PREDICTION {
                return (0.0, least);
            }
            // At least the farthest of the written rows must go.
            let farthest = written.contact_rows[contact_rows..]
                .iter()
                .fold(0.0, |most, line| fmax(most, line.gap));
            written.contact_rows.truncate(contact_rows);
            written.members.truncate(members);
            room = fmax(fmin(SHORTER * room, farthest), SMALLEST_PREDICTION);
        }
        (room, least)
    }

    /// Appends the rows of the seeds with a blended gap under `limit`, except those implied by an earlier row. Returns
    /// false if they are more than [`MAX_SEEDS`]. `smallest` is the smallest core gap. `smallest`, `blend` and `limit`
    /// are in metres.
    fn seeds(&mut self, smallest: f64, blend: f64, limit: f64, written: &mut Written<'_>) -> bool {
        let n = self.pairs.len();
        let most = blend * self.logs[n];
        let all = self.pairs.iter().fold(0.0, |sum, pair| sum + pair.weight);
        self.left_out.clear();
        let mut begins = [0; MAX_SEEDS + 1];
        let mut seeds = 0;
        for j in 0..n {
            let seed = self.pairs[j];
            // This seed's own core is out of reach. A surface within reach is made by nearer spheres, which have their
            // rows.
            if seed.gap - most >= limit {
                return true;
            }
            // Smallest excess of this row's sum over that of an earlier row. A partial sum is enough once a threshold
            // decides.
            let mut beyond = f64::INFINITY;
            let (little, much) = (IMPLIED * seed.weight, IMPLIED * all);
            for kept in 0..seeds {
                let left_out = &self.left_out[begins[kept]..begins[kept + 1]];
                let mut more = 0.0;
                for left_out in left_out {
                    if more > much || more + left_out.rest <= little {
                        break;
                    }
                    self.effort.shared += 1;
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
            self.effort.shared += n as u64;
            self.shares.clear();
            let mut sum = 0.0;
            for k in 0..n {
                let share = self.shared(&seed, k, blend);
                sum += share * self.pairs[k].weight;
                self.shares.push(share);
            }
            let gap = soft_minimum(smallest, blend, sum);
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
