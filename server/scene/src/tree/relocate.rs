//! Relocation of spheres from places of little need to the places of the worst fit.
//!
//! Polishing moves spheres a little; it cannot bring one from a flat cheek to a sharp cusp. Here the sphere whose
//! loss costs least takes half of the samples of the one with the worst fit.
//!
//! A tree node has at most eight children. If the family at the new place is full, neighbours pass from family to
//! family until one has room.

use std::collections::VecDeque;

use sulcus_core::tree::MAX_CHILDREN;
use sulcus_core::{Sphere, Vec3};

use crate::parallel;
use crate::random::Random;
use crate::tree::cluster::{Feature, split};
use crate::tree::fit::fit;
use crate::tree::level::Level;
use crate::tree::nearest_sphere::NearestSphere;
use crate::tree::polish::{Norm, Surface, shares};

/// Share of its cost that a sphere saves by being halved. The error falls to a half, its square to a quarter; the
/// estimate is lower.
const SAVED: f64 = 0.6;
/// Number of families that count as neighbours.
const NEIGHBOURS: usize = 10;

/// Request for relocations.
pub(crate) struct Move<'a> {
    /// Cost of errors.
    pub norm: Norm,
    /// Largest number of spheres that move.
    pub most: usize,
    /// Estimated share of the immediate cost of a sphere's loss.
    pub belief: f64,
    /// Spheres that were helped without success.
    pub barred: &'a [u32],
    /// Seed of the random attempts.
    pub seed: u64,
}

/// Moves the level's own spheres, and changes their families. Returns the spheres that received half of their share
/// of samples.
///
/// `owned` has the distance to the nearest sphere and its index, per sample.
pub(crate) fn relocate(
    surface: &Surface<'_>,
    inscribed: &[Vec3],
    level: &mut Level,
    owned: &[(f64, u32)],
    wish: &Move<'_>,
) -> Vec<u32> {
    let movable = level.families.len();
    let norm = wish.norm;
    let spheres = &mut level.spheres;
    let mine = shares(owned, spheres.len());
    let index = NearestSphere::new(&*spheres);
    // Cost of each sphere now, and the additional cost without it.
    let costs: Vec<(f64, f64)> = parallel::map(movable, |k| {
        let (mut cost, mut loss) = (0.0, 0.0);
        for &s in &mine[k] {
            let now = surface.cost(norm, s, owned[s as usize].0);
            let point = &surface.samples[s as usize].point;
            cost += now;
            loss += surface.cost(norm, s, index.nearest_but(point, k as u32)) - now;
        }
        (cost, loss)
    });
    let mut victims: Vec<usize> = (0..movable).collect();
    victims.sort_by(|&a, &b| costs[a].1.total_cmp(&costs[b].1).then(a.cmp(&b)));
    let mut targets: Vec<usize> = (0..movable)
        .filter(|&k| mine[k].len() >= 8 && !wish.barred.contains(&(k as u32)))
        .collect();
    targets.sort_by(|&a, &b| costs[b].0.total_cmp(&costs[a].0).then(a.cmp(&b)));

    let place = |k: usize| centroid(surface, &mine[k]).unwrap_or(spheres[k].centre);
    let places: Vec<Vec3> = (0..movable).map(place).collect();
    // A victim's neighbours take over its samples, so none of them may be touched in the same round.
    let mut locked = vec![false; movable];
    let (mut moves, mut next) = (Vec::new(), 0);
    for &target in &targets {
        if moves.len() == wish.most {
            break;
        }
        if locked[target] {
            continue;
        }
        while next < victims.len() && (locked[victims[next]] || victims[next] == target) {
            next += 1;
        }
        let Some(&victim) = victims.get(next) else {
            break;
        };
        if costs[victim].1 * wish.belief > costs[target].0 * SAVED {
            break;
        }
        next += 1;
        for &s in &mine[victim] {
            let heir = index.nearest_other(&surface.samples[s as usize].point, victim as u32);
            if let Some(lock) = locked.get_mut(heir as usize) {
                *lock = true;
            }
        }
        locked[victim] = true;
        locked[target] = true;
        moves.push((victim, target));
    }
    let halves = parallel::map(moves.len(), |m| {
        halved(surface, inscribed, &mine[moves[m].1], wish.seed ^ m as u64)
    });
    let mut places = places;
    let mut families = Families::new(&mut level.families, level.parents, &places);
    let mut helped = Vec::new();
    for ((victim, target), halves) in moves.into_iter().zip(halves) {
        let Some([one, other]) = halves else { continue };
        if !families.join(victim, target, &places) {
            continue;
        }
        spheres[target] = one;
        spheres[victim] = other;
        places[victim] = places[target];
        helped.push(target as u32);
    }
    helped
}

/// Brings the least needed sphere to the place of the largest error, between the spheres that leave it open. Other
/// arguments are those of [`relocate`].
pub(crate) fn plug(
    surface: &Surface<'_>,
    inscribed: &[Vec3],
    level: &mut Level,
    owned: &[(f64, u32)],
    wish: &Move<'_>,
) -> Option<u32> {
    let movable = level.families.len();
    let felt = |s: usize| surface.cost(wish.norm, s as u32, owned[s].0);
    let open = |s: &usize| !wish.barred.contains(&owned[*s].1);
    let worst = (0..owned.len())
        .filter(open)
        .max_by(|&a, &b| felt(a).total_cmp(&felt(b)))?;
    let (error, owner) = owned[worst];
    if owner as usize >= movable {
        return None;
    }
    // Samples nearby with an equally bad fit.
    let mine = shares(owned, level.spheres.len());
    let at = surface.samples[worst].point;
    let reach = mine[owner as usize].iter().fold(0.0_f64, |reach, &s| {
        reach.max((surface.samples[s as usize].point - at).norm())
    });
    let hole: Vec<u32> = (0..owned.len())
        .filter(|&s| {
            owned[s].0 * error.signum() > 0.4 * error.abs()
                && (surface.samples[s].point - at).norm() < 0.7 * reach
        })
        .map(|s| s as u32)
        .collect();
    let index = NearestSphere::new(&level.spheres);
    let losses = parallel::map(movable, |k| {
        mine[k].iter().fold(0.0, |loss, &s| {
            let point = &surface.samples[s as usize].point;
            loss + surface.cost(wish.norm, s, index.nearest_but(point, k as u32))
        })
    });
    let victim = (0..movable)
        .filter(|&k| k != owner as usize)
        .min_by(|&a, &b| losses[a].total_cmp(&losses[b]).then(a.cmp(&b)));
    let victim = victim.filter(|_| hole.len() >= 4)?;
    let (_, sphere) = fit(
        surface.distance,
        surface.samples,
        inscribed,
        &hole,
        None,
        surface.smallest,
        &mut Random::new(wish.seed),
    );
    let places: Vec<Vec3> = (0..movable)
        .map(|k| centroid(surface, &mine[k]).unwrap_or(level.spheres[k].centre))
        .collect();
    let mut families = Families::new(&mut level.families, level.parents, &places);
    if !families.join(victim, owner as usize, &places) {
        return None;
    }
    level.spheres[victim] = sphere;
    Some(owner)
}

fn centroid(surface: &Surface<'_>, members: &[u32]) -> Option<Vec3> {
    let sum: Vec3 = members
        .iter()
        .map(|&s| surface.samples[s as usize].point)
        .sum();
    (!members.is_empty()).then(|| sum / members.len() as f64)
}

/// Returns two spheres for the samples of one.
fn halved(
    surface: &Surface<'_>,
    inscribed: &[Vec3],
    members: &[u32],
    seed: u64,
) -> Option<[Sphere; 2]> {
    let mut random = Random::new(seed);
    let mut best: (f64, Option<[Sphere; 2]>) = (f64::INFINITY, None);
    for alpha in [1.0, 0.3] {
        let features: Vec<Feature> = members
            .iter()
            .map(|&m| {
                let p = surface.samples[m as usize].point * alpha;
                let c = inscribed[m as usize] * (1.0 - alpha);
                [p.x, p.y, p.z, c.x, c.y, c.z]
            })
            .collect();
        let parts = split(&features, &vec![1.0; members.len()], 2, &mut random);
        let [one, other] = parts.as_slice() else {
            continue;
        };
        let mut cost = 0.0;
        let spheres = [one, other].map(|part| {
            let part: Vec<u32> = part.iter().map(|&k| members[k as usize]).collect();
            let (own, sphere) = fit(
                surface.distance,
                surface.samples,
                inscribed,
                &part,
                None,
                surface.smallest,
                &mut random,
            );
            cost += own * part.len() as f64;
            sphere
        });
        if cost < best.0 {
            best = (cost, Some(spheres));
        }
    }
    best.1
}

/// Families of the spheres, with room for at most eight each.
struct Families<'a> {
    of: &'a mut [u32],
    counts: Vec<usize>,
    middles: Vec<Vec3>,
}

impl<'a> Families<'a> {
    fn new(of: &'a mut [u32], parents: usize, places: &[Vec3]) -> Self {
        let mut counts = vec![0_usize; parents];
        let mut middles = vec![Vec3::zeros(); parents];
        for (family, place) in of.iter().zip(places) {
            counts[*family as usize] += 1;
            middles[*family as usize] += place;
        }
        for (middle, count) in middles.iter_mut().zip(&counts) {
            if *count > 0 {
                *middle /= *count as f64;
            }
        }
        Self {
            of,
            counts,
            middles,
        }
    }

    /// Brings child `one` into the family of `other`. If that is full, neighbours pass on. Returns false, without any
    /// change, if no family within reach has room.
    fn join(&mut self, one: usize, other: usize, places: &[Vec3]) -> bool {
        let (from, wanted) = (self.of[one], self.of[other]);
        // A parent without children would be part of the shape again.
        if self.counts[from as usize] == 1 && from != wanted {
            return false;
        }
        // The place that it leaves is also room.
        self.of[one] = u32::MAX;
        self.counts[from as usize] -= 1;
        let Some(chain) = self.chain_to_room(wanted) else {
            self.of[one] = from;
            self.counts[from as usize] += 1;
            return false;
        };
        for pair in chain.windows(2).rev() {
            self.hand_on(pair[0], pair[1], places);
        }
        self.of[one] = wanted;
        self.counts[wanted as usize] += 1;
        true
    }

    /// Returns the chain of neighbouring families from `wanted` to the nearest one with room.
    fn chain_to_room(&self, wanted: u32) -> Option<Vec<u32>> {
        let mut reached_from = vec![u32::MAX; self.counts.len()];
        reached_from[wanted as usize] = wanted;
        let mut queue = VecDeque::from([wanted]);
        while let Some(here) = queue.pop_front() {
            if self.counts[here as usize] < MAX_CHILDREN {
                let mut chain = vec![here];
                let mut at = here;
                while at != wanted {
                    at = reached_from[at as usize];
                    chain.push(at);
                }
                chain.reverse();
                return Some(chain);
            }
            for f in self.neighbours(here) {
                if reached_from[f as usize] == u32::MAX {
                    reached_from[f as usize] = here;
                    queue.push_back(f);
                }
            }
        }
        None
    }

    /// Returns the nearest families with children, nearest first.
    fn neighbours(&self, here: u32) -> Vec<u32> {
        let mut near: Vec<(f64, u32)> = Vec::with_capacity(NEIGHBOURS + 1);
        for f in (0..self.counts.len() as u32).filter(|&f| f != here) {
            if self.counts[f as usize] == 0 {
                continue;
            }
            let apart = (self.middles[f as usize] - self.middles[here as usize]).norm_squared();
            if near.len() == NEIGHBOURS && apart >= near[NEIGHBOURS - 1].0 {
                continue;
            }
            let at = near.partition_point(|&(d, _)| d <= apart);
            near.insert(at, (apart, f));
            near.truncate(NEIGHBOURS);
        }
        near.into_iter().map(|(_, f)| f).collect()
    }

    /// Gives family `to` the child of `from` that is nearest to it and farthest from its own.
    fn hand_on(&mut self, from: u32, to: u32, places: &[Vec3]) {
        let child = (0..self.of.len())
            .filter(|&k| self.of[k] == from)
            .min_by(|&a, &b| {
                let loss = |k: usize| {
                    (places[k] - self.middles[to as usize]).norm()
                        - (places[k] - self.middles[from as usize]).norm()
                };
                loss(a).total_cmp(&loss(b)).then(a.cmp(&b))
            });
        if let Some(child) = child {
            self.of[child] = to;
            self.counts[from as usize] -= 1;
            self.counts[to as usize] += 1;
        }
    }
}
