//! Runs a case of the table.

use sulcus_core::{
    MAX_TOOLS, NoProbe, Params, Scene, State, TickInput, TickOutput, Workspace, tick,
};
use sulcus_operator::{Felt, Operator, Shown, present};

use crate::measure::{Measures, Observer};
use crate::table::{Case, Driver};

/// How a case went.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseReport {
    /// Name in the table.
    pub name: &'static str,
    /// The measures.
    pub measures: Measures,
    /// Smallest value of the case's own margin (positive: never through), metres.
    pub margin: f64,
    /// What does not hold, in words; empty when the case passes.
    pub broken: Vec<String>,
}

/// Runs `case` in virtual time; `adjust` may change the parameters first (another solver, another
/// contact compliance).
pub fn run(case: &Case, adjust: impl FnOnce(&mut Params)) -> CaseReport {
    run_on(case, |scene| adjust(&mut scene.params), |_, _, _, _| {})
}

/// Runs `case` on its scene as `change` leaves it, the hand's way being that of the scene as it was; `each` sees every
/// tick: the scene, the state before, the output, the state after.
pub fn run_on(
    case: &Case,
    change: impl FnOnce(&mut Scene),
    mut each: impl FnMut(&Scene, &State, &TickOutput, &State),
) -> CaseReport {
    let mut scene = (case.scene)();
    let mut operator = match case.driver {
        Driver::Closed(script, params) => Some(Operator::new(script(&scene), params(), case.seed)),
        Driver::Kinematic(_) => None,
    };
    let mut script = match case.driver {
        Driver::Kinematic(script) | Driver::Closed(script, _) => script(&scene),
    };
    change(&mut scene);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut observer = Observer::new(&scene);
    let mut shown = Shown::NOTHING;
    let mut margin = f64::INFINITY;
    let ticks = script.duration_s() * 1e3;
    let mut hands = [None; MAX_TOOLS];
    for k in 0..ticks as u64 {
        let mut input = TickInput::IDLE;
        input.tools = match &mut operator {
            Some(operator) => operator.step(&shown),
            None => {
                script.feel(&Felt { shown, hands });
                hands = script.targets(k as f64 * sulcus_core::TICK_S);
                hands.map(|target| match target {
                    Some(pose) => present(&pose),
                    None => sulcus_core::ToolInput::ABSENT,
                })
            }
        };
        (case.disturb)(k, &mut input);
        let before = state.clone();
        let output = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        each(&scene, &before, &output, &state);
        observer.observe(&scene, &input, &output, &ws);
        shown = Shown::from(&output);
        margin = margin.min((case.margin)(&scene, &output));
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
