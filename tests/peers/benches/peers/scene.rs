//! A scene with its path, its entrants and how deep the tool is in what it touches; from it the rows of the table.

use sulcus_cases::statistics::{Percentiles, percentiles_us};
use sulcus_core::{Pose, Vec3};

use crate::engine::{Engine, Entrant, Shown, times};

/// Says how deep the shown tool is in what the engine shows of the object, metres: above 0 in it, below 0 apart from it. The
/// points are the surface's, where it yields.
pub type Depth = dyn Fn(&Pose, &[Vec3]) -> f64;

/// One scene for all engines.
pub struct Scene {
    /// Name.
    pub name: &'static str,
    /// Poses of the hand, tick by tick.
    pub path: Vec<Pose>,
    /// For each whether the hand's tool is in the object as it is at rest.
    pub touches: Vec<bool>,
    /// The one definition of penetration.
    pub depth: Box<Depth>,
    /// Every how many ticks it is asked for.
    pub every: usize,
    /// Who takes part.
    pub entrants: Vec<Entrant>,
}

/// What one engine comes to.
#[derive(Clone, Debug)]
pub struct Row {
    /// The scene.
    pub scene: &'static str,
    /// The engine.
    pub engine: String,
    /// Times of the ticks in which the hand touches, and of all.
    pub touching: Percentiles,
    /// Of all ticks.
    pub all: Percentiles,
    /// Deepest that the shown tool ever is, metres; 0 when it is never inside.
    pub penetration: f64,
    /// Farthest that it ever stays away while the coupling bears more than [`PRESSED`], metres.
    pub apart: f64,
    /// Deepest overlap of what the engine itself lets touch, metres; 0 when there never is one.
    pub residual: f64,
    /// Largest change of the coupling's force in a tick, newtons: the hand's own motion is in it.
    pub force_step: f64,
    /// Largest force of the coupling, newtons.
    pub max_force: f64,
    /// What a reader must know.
    pub note: String,
}

/// Force from which a tool is pressed against something, newtons.
const PRESSED: f64 = 0.3;

impl Scene {
    /// Times all entrants, then looks at each once more.
    pub fn rows(&self, runs: usize) -> Vec<Row> {
        let times = times(&self.entrants, &self.path, runs);
        let rows = self.entrants.iter().zip(times);
        rows.map(|(entrant, times)| self.row(entrant, times))
            .collect()
    }

    fn row(&self, entrant: &Entrant, times: Vec<u64>) -> Row {
        let mut engine = (entrant.make)();
        let (mut deepest, mut apart) = (f64::NEG_INFINITY, 0.0_f64);
        let (mut force_step, mut max_force) = (0.0_f64, 0.0_f64);
        let mut last: Option<Vec3> = None;
        let mut points = Vec::new();
        for (k, hand) in self.path.iter().enumerate() {
            let shown = ticked(engine.as_mut(), hand);
            engine.observe();
            let force = shown.force.norm();
            max_force = max_force.max(force);
            let change = last.replace(shown.force);
            force_step = force_step.max(change.map_or(0.0, |last| (shown.force - last).norm()));
            if k % self.every == 0 {
                engine.surface(&mut points);
                let depth = (self.depth)(&shown.pose, &points);
                deepest = deepest.max(depth);
                if force > PRESSED {
                    apart = apart.max(-depth);
                }
            }
        }
        let touching = times.iter().zip(&self.touches);
        let touching = touching.filter_map(|(time, touches)| touches.then_some(*time));
        let (mut residual, mut note) = ((deepest + engine.skin()).max(0.0), entrant.note.clone());
        if let Some(own) = engine.residual() {
            residual = own.converged;
            if own.exhausted_ticks > 0 {
                let (ticks, deep) = (own.exhausted_ticks, own.exhausted * 1e6);
                note += &format!("; {ticks} ticks ran out of passes, at up to {deep:.1} um");
            }
        }
        Row {
            scene: self.name,
            engine: entrant.name.clone(),
            touching: percentiles_us(touching),
            all: percentiles_us(times.iter().copied()),
            penetration: deepest.max(0.0),
            apart,
            residual,
            force_step,
            max_force,
            note,
        }
    }
}

/// One tick, and what it came to.
pub fn ticked(engine: &mut dyn Engine, hand: &Pose) -> Shown {
    engine.aim(hand);
    engine.step();
    engine.shown()
}
