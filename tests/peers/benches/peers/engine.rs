//! What the bench asks of an engine, and its times: thread CPU time around the one call that is a tick.

use sulcus_cases::timing::cpu_ns;
use sulcus_core::{Pose, Vec3};

/// What an engine says after a tick.
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    /// Where it shows the capsule, metres: `world_from_capsule`.
    pub pose: Pose,
    /// Force of its coupling on the hand, newtons.
    pub force: Vec3,
}

/// Deepest overlap of what an engine lets touch.
#[derive(Clone, Copy, Debug)]
pub struct Residual {
    /// In ticks that found their answer, metres.
    pub converged: f64,
    /// In those that left the rest for the next tick, metres.
    pub exhausted: f64,
    /// How many these were.
    pub exhausted_ticks: u64,
}

/// Engine in a scene, from the first tick on.
pub trait Engine {
    /// Hands it the next pose of the hand; not timed.
    fn aim(&mut self, hand: &Pose);
    /// One tick: the call that is timed.
    fn step(&mut self);
    /// What that tick came to.
    fn shown(&self) -> Shown;
    /// Where the points of the surface that the scene asks for are now (metres); empty where nothing yields.
    fn surface(&self, _points: &mut Vec<Vec3>) {}
    /// Distance from what it draws at which it begins to touch, metres.
    fn skin(&self) -> f64 {
        0.0
    }
    /// Looks at the tick for [`Engine::residual`]; not timed, and not done in timed runs.
    fn observe(&mut self) {}
    /// Deepest overlap of what it lets touch, where that is not what it draws.
    fn residual(&self) -> Option<Residual> {
        None
    }
}

/// An engine's place in the table, and how it is made.
pub struct Entrant {
    /// Name in the table.
    pub name: String,
    /// What a reader must know of it.
    pub note: String,
    /// Makes it, ready for the first tick.
    pub make: Box<dyn Fn() -> Box<dyn Engine>>,
}

/// Ticks that one engine makes before it is the next one's turn: a busy neighbour slows all of them.
const TURN: usize = 500;

/// Times of each tick of each engine, nanoseconds: its fastest of `runs` runs of the same path, the engines by turns. (The
/// first tick of a turn finds cold caches, so that turns begin elsewhere in each run.)
pub fn times(entrants: &[Entrant], path: &[Pose], runs: usize) -> Vec<Vec<u64>> {
    let mut best = vec![vec![u64::MAX; path.len()]; entrants.len()];
    let mut last: Vec<Option<Vec3>> = vec![None; entrants.len()];
    for run in 0..runs {
        let mut engines: Vec<_> = entrants.iter().map(|entrant| (entrant.make)()).collect();
        let mut begin = 0;
        let mut end = (TURN * (run + 1) / runs).min(path.len());
        while begin < path.len() {
            for (engine, best) in engines.iter_mut().zip(&mut best) {
                for (hand, best) in path[begin..end].iter().zip(&mut best[begin..end]) {
                    engine.aim(hand);
                    let before = cpu_ns();
                    engine.step();
                    *best = (*best).min(cpu_ns() - before);
                }
            }
            begin = end;
            end = (end + TURN).min(path.len());
        }
        for ((engine, last), entrant) in engines.iter().zip(&mut last).zip(entrants) {
            let now = engine.shown().pose.position;
            if last.replace(now).is_some_and(|before| before != now) {
                println!(
                    "{}: its runs ended differently, so the fastest of each tick mixes them",
                    entrant.name
                );
            }
        }
    }
    best
}
