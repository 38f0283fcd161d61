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

/// Motion of the surface under which a sphere is ignored in the sum, metres.
const UNFELT: f64 = 2e-8;
/// Excess of the sagitta over the rise up to which two spheres are on one smooth surface, in blend lengths. Opposite
/// spheres over the pit between four spheres of a properly blended lattice have an excess of 4 to 6.
const ONE_SURFACE: f64 = 7.0;
/// Excess of the sagitta over the rise from which two spheres are on separate surfaces, in blend lengths.
const TWO_SURFACES: f64 = 12.0;
/// Share of its sum that a left-out seed may hold beyond an earlier row. The seed could bind earlier by at most this
/// share of the blend length.
const IMPLIED: f64 = 1e-3;
/// Margin for the rounding of a blended gap, metres: far above the rounding, far below any perceptible distance.
const ROUNDING: f64 = 1e-12;
/// Margin by which another seed's surface may be closer than that of the nearest core, in blend lengths. The case
/// occurs where the nearest core stands alone with a small inset and the other core lies deep among many.
pub(crate) const OTHER_SEEDS: f64 = 3.0;
/// Maximum number of rows of one tool sphere against one object: the walls of a pocket, its floor, and a reserve. Seeds
/// are ordered by their core gap, not by the gap of the surface, so a seed beyond the capacity may be touched. On
/// overflow only seeds within a smaller limit get rows.
pub const MAX_SEEDS: usize = 12;

/// Returns the reach of a sphere, 4 to 10 blend lengths above the smallest core gap. At the reach, unless clamped, the
/// sphere's share, `exp(-reach)` of the blend length, is 20 nm. Dozens of spheres can lie there.
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

/// Pair of a tool sphere and a sphere of a blended object.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// Index in the contact list.
    pub contact: u32,
    /// Core gap, metres.
    pub gap: f64,
    /// Unit vector from the object's sphere to the tool's.
    pub normal: Vec3,
    /// Distance between the centres, metres.
    pub distance: f64,
    /// Weight before compatibility: `exp(-(gap - smallest) / kappa)`; 0 until weighed.
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
    /// Distance between the centres, metres.
    pub distance: f64,
    /// Share of the row's multiplier, 0 to 1. The shares of a row add up to 1.
    pub weight: f64,
}

/// Contact row: a hard contact, or a seed on a blended object with its members.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactRow {
    /// Index in the contact list of the contact, or of the seed of a blended row. Determines tool, object and arm.
    pub contact: u32,
    /// Gap, metres.
    pub gap: f64,
    /// Derivative of the gap by the position of the tool sphere: a unit normal, or the weighted mean of the members'
    /// normals.
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

/// Destination of the written rows.
pub(crate) struct Written<'a> {
    /// Contact rows.
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

/// Returns the cores of the nodes of object `k`; empty for an object without blending.
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

/// Pair with a share under 1 in the sum of a kept row.
#[derive(Clone, Copy, Debug)]
struct LeftOut {
    /// Index in `Blender::pairs`.
    pair: u32,
    /// Share of the pair in the sum, 0 to 1.
    share: f64,
    /// Upper bound of what this pair and the later pairs of the same row can add to the sum of another row.
    rest: f64,
}

/// Scratch for the rows of one tool sphere against one object. Results depend only on the pairs since
/// [`Blender::begin`].
#[derive(Debug)]
pub(crate) struct Blender {
    /// Pairs of one tool sphere and one object.
    pairs: Vec<Pair>,
    /// Pairs with a share under 1 in kept rows, row by row.
    left_out: Vec<LeftOut>,
    /// Share of each pair in the present row.
    shares: Vec<f64>,
    /// Natural logarithm of each number of pairs; 0 for no pairs.
    logs: Vec<f64>,
    /// Last blend length, metres, and its [`reach`].
    reach: (f64, f64),
    /// Largest weight of a pair beyond that reach.
    unfelt: f64,
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
        }
    }

    /// Removes all pairs, for the next tool sphere and object.
    pub fn begin(&mut self) {
        self.pairs.clear();
    }

    /// Adds a pair.
    pub fn push(&mut self, pair: Pair) {
        self.pairs.push(pair);
    }

    /// Moves the nearest pair to the front and sets the weights relative to it. Drops the pairs that are both out of
    /// its reach and farther than `kept` (metres). Returns the smallest core gap, metres; `None` without pairs.
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
            // Never zero: a seed on another wall, however far above the nearest, has its own row.
            pair.weight = exp_of_loss((smallest - pair.gap) / blend);
        }
        Some(smallest)
    }

    /// Returns the compatibility of pair `k` with `seed`, 0 to 1.
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

    /// Returns the blended gap of `seed`, metres.
    fn gap_of(&self, seed: &Pair, smallest: f64, blend: f64) -> f64 {
        let sum = (0..self.pairs.len()).fold(0.0, |sum, k| {
            sum + self.shared(seed, k, blend) * self.pairs[k].weight
        });
        smallest - blend * libm::log(sum)
    }

    /// Returns the smaller of `limit` and the smallest blended gap over all seeds, metres.
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
            // Upper bound of this seed's sum: the sum of the nearest seed plus the shares that the nearest seed leaves
            // out.
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

    /// Writes the rows of the seeds with a gap under `limit` (metres), with their members. On more rows than
    /// [`MAX_SEEDS`] the limit is lowered until all rows fit.
    ///
    /// Returns the limit under which all rows are written, metres, and a lower bound of the gaps of these pairs,
    /// metres. The limit is 0 when not even the smallest limit fits.
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
        let least = smallest - blend * libm::log(sum) - ROUNDING;
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

    /// Writes the rows of the seeds with a gap under `limit`. Returns false if they are more than [`MAX_SEEDS`].
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
