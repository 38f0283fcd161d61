//! Runs of a case of the table, or of any script in closed loop.

use sulcus_core::{
    MAX_TOOLS, NoProbe, Params, Scene, State, TickInput, TickOutput, Workspace, tick,
};
use sulcus_operator::{Felt, HandParams, Operator, Script, Shown, present};

use crate::measure::{Measures, Observer};
use crate::table::margin::Moment;
use crate::table::{Case, Driver};

/// Result of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseReport {
    /// Name in the table.
    pub name: &'static str,
    /// Measures of the run.
    pub measures: Measures,
    /// Smallest value of the case's own margin, metres; positive: nothing was passed through; infinite: nothing was
    /// measured.
    pub margin: f64,
    /// Broken bounds in words; empty when the case passes.
    pub broken: Vec<String>,
}

/// Tick of a case, for an observer.
pub struct Seen<'a> {
    /// Scene of the run, with its changes.
    pub scene: &'a Scene,
    /// Input of the tick.
    pub input: &'a TickInput,
    /// State before the tick.
    pub before: &'a State,
    /// Output of the tick.
    pub output: &'a TickOutput,
    /// State after the tick.
    pub after: &'a State,
}

/// Runs `case` in virtual time. `adjust` may change the parameters first, such as solver or contact compliance.
pub fn run(case: &Case, adjust: impl FnOnce(&mut Params)) -> CaseReport {
    run_on(case, |scene| adjust(&mut scene.params), |_| {})
}

/// Runs `case` on its scene after `change`. The hand's path is that of the unchanged scene. `each` observes every tick.
pub fn run_on(case: &Case, change: impl FnOnce(&mut Scene), each: impl FnMut(&Seen)) -> CaseReport {
    run_at(case, Params::default().rate_hz, change, each)
}

/// Runs `case` as [`run_on`] does, at another rate of simulation, hand and device. A disturbance of the input keeps its
/// tick numbers.
pub fn run_at(
    case: &Case,
    rate_hz: u16,
    change: impl FnOnce(&mut Scene),
    mut each: impl FnMut(&Seen),
) -> CaseReport {
    let mut scene = (case.scene)();
    scene.params.rate_hz = rate_hz;
    let mut operator = match case.driver {
        Driver::Closed(script, params) => {
            let hand = HandParams {
                period_s: scene.tick_s(),
                ..params()
            };
            Some(Operator::new(script(&scene), hand, case.seed))
        }
        Driver::Kinematic(_) => None,
    };
    let mut script = match case.driver {
        Driver::Kinematic(script) | Driver::Closed(script, _) => script(&scene),
    };
    change(&mut scene);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut observer = Observer::new(&scene);
    let mut shown = Shown::NOTHING;
    let (mut margin, mut last) = (f64::INFINITY, None);
    let ticks = script.duration_s() * (1.0 / scene.tick_s());
    let mut hands = [None; MAX_TOOLS];
    for k in 0..ticks as u64 {
        let mut input = TickInput::IDLE;
        input.tools = match &mut operator {
            Some(operator) => operator.step(&shown),
            None => {
                script.feel(&Felt { shown, hands });
                hands = script.targets(k as f64 * scene.tick_s());
                hands.map(|target| match target {
                    Some(pose) => present(&pose),
                    None => sulcus_core::ToolInput::ABSENT,
                })
            }
        };
        (case.disturb)(k, &mut input);
        let before = state.clone();
        let output = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        each(&Seen {
            scene: &scene,
            input: &input,
            before: &before,
            output: &output,
            after: &state,
        });
        observer.observe(&scene, &input, &output, &ws);
        shown = Shown::from(&output);
        let moment = Moment {
            scene: &scene,
            ticks: [last.as_ref().unwrap_or(&output), &output],
            workspace: &ws,
        };
        margin = margin.min((case.margin)(&moment));
        last = Some(output);
    }
    let measures = observer.measures();
    let broken = case.bounds.broken(&measures, margin);
    CaseReport {
        name: case.name,
        measures,
        margin,
        broken,
    }
}

/// Tick of [`record`].
#[derive(Clone, Copy, Debug)]
pub struct Played<'a> {
    /// Input of the tick.
    pub input: &'a TickInput,
    /// Output of the tick.
    pub output: &'a TickOutput,
    /// Workspace after the tick.
    pub workspace: &'a Workspace,
}

/// Runs a hand with a script on `scene` in closed loop and returns the inputs of all ticks. `each` observes every tick
/// with its number.
pub fn record(
    scene: &Scene,
    script: Box<dyn Script + Send>,
    (hand, seed): (HandParams, u64),
    ticks: u64,
    mut each: impl FnMut(u64, Played<'_>),
) -> Vec<TickInput> {
    let hand = HandParams {
        period_s: scene.tick_s(),
        ..hand
    };
    let mut operator = Operator::new(script, hand, seed);
    let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
    let mut shown = Shown::NOTHING;
    let inputs = (0..ticks).map(|k| {
        let mut input = TickInput::IDLE;
        input.tools = operator.step(&shown);
        let out = tick(scene, &mut state, &mut ws, &input, &mut NoProbe);
        shown = Shown::from(&out);
        each(
            k,
            Played {
                input: &input,
                output: &out,
                workspace: &ws,
            },
        );
        input
    });
    inputs.collect()
}
