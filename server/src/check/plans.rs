//! Plans of the stations: whether each can run, and whether all fit this machine.

use crate::capacity::{Capacity, Cost, Load, Machine, Model, measure_cost};
use crate::plan::{Plan, Prepared, Station, prepare};

use super::{Finding, number};

/// Cost of a station whose plan can run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StationLoad {
    /// Name of the station.
    pub station: String,
    /// Number of tools, one for each hand.
    pub tools: usize,
    /// CPU time of its ticks.
    pub load: Load,
}

/// Findings about the plans, and the costs of those that can run. Stations with the same scene are compiled and
/// measured once.
pub(super) fn plans(
    stations: &[Station],
    progress: &dyn Fn(&str, f64),
) -> (Vec<Finding>, Vec<StationLoad>) {
    let mut findings = Vec::new();
    let mut loads = Vec::new();
    let mut known: Vec<(Plan, Result<Known, String>)> = Vec::new();
    for Station { name, plan } in stations {
        let task = task_of(plan);
        let found = match known.iter().find(|(other, _)| *other == task) {
            Some((_, found)) => found.clone(),
            None => {
                let found = prepare(plan, progress)
                    .map_err(|error| sulcus_sessions::sentence(&error))
                    .and_then(|prepared| Known::of(&prepared));
                known.push((task, found.clone()));
                found
            }
        };
        match found {
            Ok(found) => {
                findings.push(found.finding(name, plan));
                loads.push(StationLoad {
                    station: name.clone(),
                    tools: found.tools,
                    load: found.load,
                });
            }
            Err(why) => findings.push(Finding::problem(
                "plan",
                format!("Station `{name}` cannot run its plan: {why}."),
                format!(
                    "Correct the plan: `sulcus-server plan set {name}`, or the file of --config."
                ),
            )),
        }
    }
    (findings, loads)
}

/// Result for a plan that can run.
#[derive(Clone, Debug)]
struct Known {
    scene: String,
    tools: usize,
    load: Load,
    warnings: Vec<String>,
}

impl Known {
    fn of(prepared: &Prepared) -> Result<Self, String> {
        let scene = &prepared.scene;
        let cost = measure_cost(scene).map_err(|error| error.to_string())?;
        Ok(Self {
            scene: scene.name.clone(),
            tools: scene.tools.len(),
            load: Load {
                cost,
                rate_hz: scene.params.rate_hz,
            },
            warnings: prepared.warnings.clone(),
        })
    }

    fn finding(&self, station: &str, plan: &Plan) -> Finding {
        let Cost {
            mean_us, p999_us, ..
        } = self.load.cost;
        let text = format!(
            "Station `{station}`: exercise `{}` in scene `{}`, mode {}; a tick takes {mean_us:.0} us of CPU time, p99.9 {p999_us:.0} us.",
            plan.exercise, self.scene, plan.mode
        );
        if self.warnings.is_empty() {
            return Finding::ok("plan", text);
        }
        let text = format!("{text} Warning: {}.", self.warnings.join("; "));
        Finding::warning(
            "plan",
            text,
            "Correct the scene, the exercise or the rubric.",
        )
    }
}

/// Parts of a plan that decide whether it can run.
fn task_of(plan: &Plan) -> Plan {
    Plan {
        learner: String::new(),
        time_limit_s: None,
        force_limit_n: None,
        ..plan.clone()
    }
}

/// Whether all stations fit this machine at once.
pub(super) fn capacity(loads: &[StationLoad], stations: usize) -> Finding {
    capacity_on(Machine::here(), loads, stations)
}

/// Whether all stations fit `machine` at once.
pub(super) fn capacity_on(machine: Machine, loads: &[StationLoad], stations: usize) -> Finding {
    let cores = machine.cores.len();
    let mut capacity = Capacity::new(machine, Model::default());
    for (id, station) in (0..).zip(loads) {
        if let Err(refused) = capacity.admit(id, station.load) {
            let name = &station.station;
            return Finding::problem(
                "capacity",
                format!("Station `{name}` does not fit: {refused}."),
                "Use fewer stations at once, a simpler scene, or a second machine.",
            );
        }
    }
    let text = match loads.first() {
        Some(first) => format!(
            "{} of {} fit {}, with room for {} more like `{}`.",
            loads.len(),
            number(stations, "station"),
            number(cores, "core"),
            capacity.room(&first.load),
            first.station
        ),
        None => format!("{}; no plan can run.", number(cores, "core")),
    };
    Finding::ok("capacity", text)
}
