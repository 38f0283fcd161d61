//! One level of spheres fitted as a whole: polishing and relocation in turns.

use sulcus_core::{Sphere, Vec3};

use crate::tree::polish::{Norm, Owned, PolishOptions, Surface, assign, polish, rms_of};
use crate::tree::relocate::{Move, plug, relocate};

/// The spheres of a level with their families, that is, their parents' indices.
#[derive(Clone)]
pub(crate) struct Level {
    /// First the level's own spheres, then childless ones of coarser levels, which stay.
    pub spheres: Vec<Sphere>,
    /// Parent of each of the level's own spheres.
    pub families: Vec<u32>,
    /// Parents in the level above.
    pub parents: usize,
}

/// How much work a level is worth: the coarse ones only serve culling, the finest are many.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Error, as a multiple of the level's rms error, above which the high power rules: one phase each.
    pub knees: &'static [f64],
    /// Most relocations in a phase.
    pub relocations: usize,
    /// Rounds of polishing after a relocation.
    pub rounds: usize,
    /// Rounds of polishing at the end.
    pub last_rounds: usize,
    /// Most tries at the largest error after that.
    pub plugs: usize,
    /// Failed ones after which the tries end; after a failure the next largest error is tried.
    pub failures: usize,
    /// Times that the places where the error is largest between the samples are made samples.
    pub exchanges: usize,
    /// Times that the largest error of the more important places is brought down after all that.
    pub tightenings: usize,
    /// Points on a sphere that are looked at for its exposed part.
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

/// Power of the error while spheres are relocated, and at the end, where the largest error counts.
const POWER: i32 = 8;
const LAST_POWER: i32 = 16;
/// Error, as a multiple of the level's rms error, above which that power rules.
const LAST_KNEE: f64 = 3.0;
/// A relocation that saves less than this share is the last of its phase.
const LEAST_GAIN: f64 = 0.02;
/// How much of what a sphere's loss would cost at once is believed, at first and at last: its neighbours
/// close up afterwards, by how much only a try can tell.
const BELIEF: (f64, f64) = (0.15, 1e-3);

/// Fits `level` to the surface. `inscribed` holds each sample's inscribed-ball centre.
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
        // Fixed within a phase, so that costs compare.
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
                // Fewer at once may still help, or others.
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

/// Brings down the largest error: polishing with a high power, then spheres for the worst places. Returns the
/// distance to and index of the nearest sphere, per sample.
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

/// Polishes and plugs by a given norm.
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
