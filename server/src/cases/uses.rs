//! Plans that use a case.

use std::path::Path;

use super::error::CaseError;
use super::store::CaseStore;
use crate::control_socket::{Request, ask};
use crate::plan::{Plan, PlanBook, Station, StationPlan};
use crate::state::StateError;
use crate::state::classes::{Classes, Task};

/// Names of the stations whose plans use each case: those of the running server, or those kept for its next start.
///
/// # Errors
/// The running server does not answer, or a kept plan cannot be read.
pub fn plans(store: &CaseStore) -> Result<Vec<(String, Plan)>, CaseError> {
    let state = store.state();
    let unclear = |why: String| StateError::content(&state.file("plans"), why);
    let answer = ask(state, &Request::Plans {});
    let plans: Vec<StationPlan> = match answer.map_err(|error| unclear(error.to_string()))? {
        Some(plans) => serde_json::from_value(plans).map_err(|error| unclear(error.to_string()))?,
        None => {
            let kept = PlanBook::kept(state).map_err(|error| unclear(error.to_string()))?;
            let station = |name: String| Station {
                name,
                plan: Plan::default(),
            };
            let stations: Vec<Station> = kept.into_iter().map(station).collect();
            let book = PlanBook::open(&stations, Some(state));
            let book = book.map_err(|error| unclear(error.to_string()))?;
            book.all(|_| None)
        }
    };
    let plans = plans.into_iter().map(|plan| (plan.station, plan.plan));
    Ok(plans.collect())
}

/// Stations, classes and learners whose plans use a case, such as `station chair-1`.
///
/// # Errors
/// The errors of [`plans`], or the classes cannot be read.
pub fn users(store: &CaseStore, name: &str) -> Result<Vec<String>, CaseError> {
    let scene = store.scene(name);
    let plans = plans(store)?.into_iter();
    let stations = plans.filter(|(_, plan)| uses(plan, &scene));
    let mut users: Vec<String> = stations
        .map(|(station, _)| format!("station {station}"))
        .collect();
    let roll = Classes::of(store.state(), "").roll()?;
    let is_of = |task: &Option<Task>| {
        let case = task.as_ref().and_then(|task| task.case.as_deref());
        case == Some(name)
    };
    let classes = roll.classes.iter().filter(|class| is_of(&class.task));
    users.extend(classes.map(|class| format!("class {}", class.name)));
    let learners = roll.learners.iter().filter(|learner| is_of(&learner.task));
    users.extend(learners.map(|learner| format!("learner {}", learner.id)));
    Ok(users)
}

/// Whether a plan names a compiled scene.
pub fn uses(plan: &Plan, scene: &Path) -> bool {
    let Some(named) = &plan.scene else {
        return false;
    };
    let real = |path: &Path| std::fs::canonicalize(path).ok();
    named == scene
        || named.file_name() == scene.file_name()
            && real(named).is_some_and(|named| Some(named) == real(scene))
}
