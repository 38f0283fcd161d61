//! Comparison of ticks with a bound on their work to ticks without, from the same states on the same inputs.
//!
//! At each exhausted tick of a bounded run both ways begin: from the state before that tick, with the input of the
//! tick, and then with the hand held still. After [`TICKS`] further ticks forces and places are compared.

use sulcus_core::math::norm;
use sulcus_core::output::status;
use sulcus_core::{MAX_TOOLS, NoProbe, Scene, State, TickInput, TickOutput, Vec3, Workspace, tick};

use crate::run::Seen;

/// Number of ticks after the exhausted tick: 5 ms at 1 kHz.
pub const TICKS: u32 = 5;
/// Force below which a difference of forces is relative to this force, newtons: the smallest force that a finger feels.
pub const FELT_N: f64 = 0.05;

/// Largest differences between bounded and unbounded ticks, [`TICKS`] ticks after an exhausted one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Number of exhausted ticks compared.
    pub forks: u64,
    /// Number of them in which the unbounded tick is exhausted, too.
    pub both: u64,
    /// Largest difference of the raw forces, relative to the unbounded force, or to [`FELT_N`] if that is larger.
    pub force: f64,
    /// Largest distance of the graphic working points, metres.
    pub place: f64,
    /// Number of forks beyond 10 % of the force or 0.1 mm.
    pub beyond: u64,
    /// Number of the tick with the largest distance, on the clock's grid.
    pub worst: u64,
}

/// Comparison over a run: the scene without a bound, the workspaces of both ways, and the differences so far.
#[derive(Debug, Default)]
pub struct Comparison {
    scene: Option<Scene>,
    workspaces: Option<[Workspace; 2]>,
    /// Largest differences so far.
    pub found: Deviation,
}

/// Runs the input from a copy of `state`, then holds the hand still. Returns the first and the last output.
fn held(
    scene: &Scene,
    ws: &mut Workspace,
    state: &State,
    input: &TickInput,
) -> (TickOutput, TickOutput) {
    let mut state = state.clone();
    let first = tick(scene, &mut state, ws, input, &mut NoProbe);
    let mut still = *input;
    still.skipped = 0;
    let mut last = first;
    for _ in 0..TICKS {
        last = tick(scene, &mut state, ws, &still, &mut NoProbe);
    }
    (first, last)
}

fn exhausted(output: &TickOutput) -> bool {
    let tools = output.tools.iter();
    tools.fold(0, |bits, tool| bits | tool.status) & status::EXHAUSTED != 0
}

impl Comparison {
    /// Compares the tick, if it is exhausted.
    pub fn observe(&mut self, seen: &Seen<'_>) {
        if !exhausted(seen.output) {
            return;
        }
        let scene = self.scene.get_or_insert_with(|| {
            let mut scene = seen.scene.clone();
            scene.params.max_work = u32::MAX;
            scene
        });
        let [one, other] = self
            .workspaces
            .get_or_insert_with(|| std::array::from_fn(|_| Workspace::new(seen.scene)));
        let (_, bounded) = held(seen.scene, one, seen.before, seen.input);
        let (first, free) = held(scene, other, seen.before, seen.input);
        let found = &mut self.found;
        found.forks += 1;
        found.both += u64::from(exhausted(&first));
        let mut beyond = false;
        for t in 0..seen.scene.tools.len().min(MAX_TOOLS) {
            let (one, other) = (&bounded.tools[t], &free.tools[t]);
            let point = &seen.scene.tools[t].working_point;
            let apart: Vec3 = one.graphic.transform(point) - other.graphic.transform(point);
            let force = norm(&other.raw_wrench.force).max(FELT_N);
            let off = norm(&(one.raw_wrench.force - other.raw_wrench.force)) / force;
            beyond |= off > 0.1 || norm(&apart) > 1e-4;
            found.force = found.force.max(off);
            if norm(&apart) > found.place {
                (found.place, found.worst) = (norm(&apart), seen.output.tick);
            }
        }
        found.beyond += u64::from(beyond);
    }
}
