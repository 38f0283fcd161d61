//! Fit of one level of spheres as a whole, by polishing and relocation in turns.
//!
//! This module and `relocate` depend on each other: both change a `Level`, and this module calls the relocations.

use sulcus_core::{Sphere, Vec3};

use crate::tree::polish::{Norm, Owned, PolishOptions, Surface, assign, polish, rms_of};
use crate::tree::relocate::{Move, plug, relocate};

/// The spheres of a level with their families, the indices of their parents.
#[derive(Clone)]
pub(crate) struct Level {
    /// The level's own spheres first, then childless ones of coarser levels, which do not move.
    pub spheres: Vec<Sphere>,
    /// Parent of each of the level's own spheres.
    pub families: Vec<u32>,
    /// Parents in the level above.
    pub parents: usize,
}

/// Effort for a level. Coarse levels only serve culling; the finest have many spheres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Error above which the high power dominates, as a multiple of the level's rms error, for each phase.
    pub knees: &'static [f64],
    /// Largest number of relocations in a phase.
    pub relocations: usize,
    /// Rounds of polishing after a relocation.
    pub rounds: usize,
    /// Rounds of polishing at the end.
    pub last_rounds: usize,
    /// Largest number of attempts at the largest error after that.
    pub plugs: usize,
    /// Failed attempts after which they end. After a failure the next largest error follows.
    pub failures: usize,
    /// Rounds in which the places of the largest errors between samples become samples.
    pub exchanges: usize,
    /// Rounds after all others that reduce the largest error of more important places.
    pub tightenings: usize,
    /// Points on a sphere that are tested for its exposed part.
    pub ball_points: usize,
}

impl Effort {
    pub fn of(level: u8) -> Self {
        let (knees, relocations, rounds, last_rounds): (&[f64], _, _, _) = match level {
            0..=2 => (&[3.0], 4, 4, 4),
            3 => (&[2.0, 1.5], 20, 4, 20),
            4 => (&[2.0], 5, 3, 6),
            _ => (&[], 0, 0, 4),
        };
        Self {
            knees,
            relocations,
            rounds,
            last_rounds,
            plugs: if level == 3 { 4 } else { 0 },
            failures: 1,
            exchanges: if level == 3 { 3 } else { 0 },
            tightenings: if level == 3 { 10 } else { 0 },
            ball_points: if level > 3 { 48 } else { 96 },
        }
    }
}

/// Power of the error during relocations, and at the end, where the largest error counts.
const POWER: i32 = 8;
const LAST_POWER: i32 = 16;
/// Error above which that power dominates, as a multiple of the level's rms error.
const LAST_KNEE: f64 = 3.0;
/// Least relative saving of a relocation; a smaller one is the last of its phase.
const LEAST_GAIN: f64 = 0.02;
/// Estimated share of the immediate cost of a sphere's loss, at first and at last.
///
/// Its neighbours move closer afterwards. Only an attempt shows by how much.
const BELIEF: (f64, f64) = (0.15, 1e-3);

/// Fits `level` to the surface. `inscribed` has each sample's inscribed-ball centre.
pub(crate) fn fit_level(
    surface: &Surface<'_>,
    inscribed: &[Vec3],
    level: &mut Level,
    effort: &Effort,
    seed: u64,
) {
    let movable = level.families.len();
    let options = |rounds| PolishOptions {
        rounds,
        ball_points: effort.ball_points,
    };
    let mut owned = assign(surface, &level.spheres, None);
    for (phase, knee) in effort.knees.iter().enumerate() {
        // The norm is fixed within a phase, so that costs can be compared.
        let norm = Norm {
            knee: knee * rms_of(surface, &owned),
            power: POWER,
        };
        let (mut cost, start) = polish(
            surface,
            &mut level.spheres,
            movable,
            norm,
            &options(effort.rounds),
        );
        owned = start;
        let (mut most, mut belief) = (movable.div_ceil(16), BELIEF.0);
        let mut barred = Vec::new();
        for relocation in 0..effort.relocations {
            let mut tried = level.clone();
            let wish = Move {
                norm,
                most,
                belief,
                barred: &barred,
                seed: seed ^ ((phase * 64 + relocation) as u64) << 20,
            };
            let helped = relocate(surface, inscribed, &mut tried, &owned, &wish);
            let moved = helped.len();
            if moved == 0 {
                belief *= 0.1;
                if belief < BELIEF.1 {
                    break;
                }
                continue;
            }
            let (tried_cost, tried_owned) = polish(
                surface,
                &mut tried.spheres,
                movable,
                norm,
                &options(effort.rounds),
            );

            if tried_cost >= cost {
                // A smaller number at once, or other spheres, may still help.
                most = (moved / 4).max(1);
                if moved < 4 {
                    barred.extend(helped);
                }
                continue;
            }
            let gain = 1.0 - tried_cost / cost;
            (*level, cost, owned) = (tried, tried_cost, tried_owned);
            if gain < LEAST_GAIN {
                break;
            }
        }
    }
}

/// Reduces the largest error: polishing with a high power, then spheres for the worst places. Returns the distance to
/// and index of the nearest sphere, per sample.
pub(crate) fn finish_level(
    surface: &Surface<'_>,
    inscribed: &[Vec3],
    level: &mut Level,
    effort: &Effort,
    seed: u64,
) -> Owned {
    let owned = assign(surface, &level.spheres, None);
    let norm = Norm {
        knee: LAST_KNEE * rms_of(surface, &owned),
        power: LAST_POWER,
    };
    lower(surface, inscribed, level, effort, norm, seed)
}

/// Polishes and plugs with a given norm.
pub(crate) fn lower(
    surface: &Surface<'_>,
    inscribed: &[Vec3],
    level: &mut Level,
    effort: &Effort,
    norm: Norm,
    seed: u64,
) -> Owned {
    let movable = level.families.len();
    let options = |rounds| PolishOptions {
        rounds,
        ball_points: effort.ball_points,
    };
    let (mut cost, mut owned) = polish(
        surface,
        &mut level.spheres,
        movable,
        norm,
        &options(effort.last_rounds),
    );
    let mut barred = Vec::new();
    for plugging in 0..effort.plugs {
        let mut tried = level.clone();
        let wish = Move {
            norm,
            most: 1,
            belief: 1.0,
            barred: &barred,
            seed: seed ^ (plugging as u64 + 1) << 32,
        };
        let Some(plugged) = plug(surface, inscribed, &mut tried, &owned, &wish) else {
            break;
        };
        let (tried_cost, tried_owned) = polish(
            surface,
            &mut tried.spheres,
            movable,
            norm,
            &options(effort.rounds),
        );
        if tried_cost < cost {
            (*level, cost, owned) = (tried, tried_cost, tried_owned);
            barred.clear();
        } else {
            barred.push(plugged);
            if barred.len() >= effort.failures {
                break;
            }
        }
    }
    owned
}
