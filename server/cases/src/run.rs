//! Runs a case of the table.

use sulcus_core::{MAX_TOOLS, NoProbe, Params, State, TickInput, Workspace, Wrench, tick};
use sulcus_operator::{Operator, present};

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
    let mut scene = (case.scene)();
    adjust(&mut scene.params);
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let mut observer = Observer::new(&scene);
    let mut felt = [Wrench::ZERO; MAX_TOOLS];
    let mut margin = f64::INFINITY;
    let mut operator = match case.driver {
        Driver::Closed(script, params) => Some(Operator::new(script(&scene), params(), case.seed)),
        Driver::Kinematic(_) => None,
    };
    let mut script = match case.driver {
        Driver::Kinematic(script) | Driver::Closed(script, _) => script(&scene),
    };
    let ticks = script.duration_s() * 1e3;
    let mut hands = [None; MAX_TOOLS];
    for k in 0..ticks as u64 {
        let mut input = TickInput::IDLE;
        input.tools = match &mut operator {
            Some(operator) => operator.step(&felt),
            None => {
                script.feel(&felt, &hands);
                hands = script.targets(k as f64 * sulcus_core::TICK_S);
                hands.map(|target| match target {
                    Some(pose) => present(&pose),
                    None => sulcus_core::ToolInput::ABSENT,
                })
            }
        };
        (case.disturb)(k, &mut input);
        let output = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
        observer.observe(&scene, &input, &output, &ws);
        felt = std::array::from_fn(|t| output.tools[t].wrench);
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
