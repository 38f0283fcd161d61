//! Side of a comparison: one scene with the recorded inputs.

use std::time::Instant;

use serde::Serialize;
use sulcus_core::output::status;
use sulcus_core::{NoProbe, Scene, State, TickInput, TickOutput, Workspace, tick};

/// Result of a side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Side {
    /// Mean wall time of a tick, microseconds.
    pub tick_us: f64,
    /// Ticks with a tool under load.
    pub contact_ticks: u64,
    /// Largest force sent to a hand, newtons.
    pub max_force_n: f64,
    /// Deepest overlap of a converged tick, over the pairs of spheres in its problem, micrometres.
    pub max_residual_um: f64,
    /// Ticks that needed more than the available substeps.
    pub exhausted: u64,
    /// Ticks without a usable answer of the solver.
    pub failed: u64,
    /// Largest depth of a reading in a pocket, millimetres; `None` without a reading.
    pub deepest_mm: Option<f64>,
}

/// State of a side.
pub(super) struct Running<'a> {
    scene: &'a Scene,
    state: State,
    workspace: Workspace,
    side: Side,
    ticks: u64,
    seconds: f64,
}

impl<'a> Running<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            state: State::new(scene),
            workspace: Workspace::new(scene),
            side: Side::default(),
            ticks: 0,
            seconds: 0.0,
        }
    }

    pub fn begin_with(&mut self, state: State) {
        self.state = state;
    }

    /// Starts with the tools of `state`. The first state of a recording suits best, because most tools are in the air.
    /// The memory of tissues is kept if both tissues have as many numbers; otherwise tissues start at rest.
    pub fn begin_like(&mut self, state: &State) {
        let bytes = state.to_bytes();
        if let Ok(same) = State::from_bytes(self.scene, &bytes) {
            self.state = same;
            return;
        }
        self.state.tick = state.tick;
        self.state.hash = state.hash;
        self.state.tools = state.tools;
    }

    /// Runs a tick. `counts` says whether the tick is part of the result.
    pub fn tick(&mut self, input: &TickInput, counts: bool) -> TickOutput {
        let (output, seconds) = timed(|| {
            tick(
                self.scene,
                &mut self.state,
                &mut self.workspace,
                input,
                &mut NoProbe,
            )
        });
        self.ticks += 1;
        self.seconds += seconds;
        if counts {
            self.count(&output);
        }
        output
    }

    fn count(&mut self, output: &TickOutput) {
        let mut bits = 0;
        let mut touches = false;
        for tool in &output.tools {
            bits |= tool.status;
            touches |= tool.active > 0;
            let side = &mut self.side;
            side.max_force_n = side.max_force_n.max(tool.wrench.force.norm());
            if tool.converged && tool.min_gap.is_finite() {
                side.max_residual_um = side.max_residual_um.max(-tool.min_gap * 1e6);
            }
            if let Some(reading) = &tool.pocket {
                let before = side.deepest_mm.unwrap_or_default();
                side.deepest_mm = Some(before.max(reading.depth * 1e3));
            }
        }
        self.side.contact_ticks += u64::from(touches);
        self.side.exhausted += u64::from(bits & status::EXHAUSTED != 0);
        self.side.failed += u64::from(bits & status::SOLVER_FAILED != 0);
    }

    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    pub fn side(&self) -> Side {
        Side {
            tick_us: self.seconds / self.ticks.max(1) as f64 * 1e6,
            ..self.side
        }
    }
}

/// Result and wall time of a call, seconds.
fn timed<T>(f: impl FnOnce() -> T) -> (T, f64) {
    let began = Instant::now();
    let value = f();
    (value, began.elapsed().as_secs_f64())
}
