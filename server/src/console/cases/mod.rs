//! Patients and their compiled scenes, for the console.

mod form;
mod worker;

use std::ffi::OsString;
use std::sync::{Mutex, PoisonError};

use sulcus_console::house::Cases;
use sulcus_console::house::cases::{
    Case, Chart, Choice, FieldFault, Loaded, Model, Origin, Refused, Work,
};
use sulcus_core::Scene;
use sulcus_display::Display;
use sulcus_scene::anatomy::mouth::faults;
use sulcus_scene::anatomy::patient::{
    Condition, DEPTH_MM, LOWER, MOST_LOSS_MM, RECESSION_MM, THIRD_MOLARS, ToothChart, generate,
};

use super::feeds;
use crate::cases::{CaseError, CaseStore, Opened, edit, uses};
use crate::plan::Plan;
use crate::state::StateFolder;
use crate::state::date::minute;
use worker::{Ended, Worker};

/// Patients and their compiled scenes, of a running server.
#[derive(Default)]
pub(super) struct OwnCases {
    /// Store; `None`: the server has no state folder, or the folder of cases cannot be used.
    store: Option<CaseStore>,
    worker: Worker,
    /// Turn of the pictures that are drawn: one at a time.
    drawing: Mutex<()>,
}

impl OwnCases {
    /// Cases of a state folder.
    pub fn of(state: Option<&StateFolder>) -> Self {
        let store = state.and_then(|state| match CaseStore::open(state) {
            Ok(store) => Some(store),
            Err(error) => {
                tracing::error!("cases: {error}");
                None
            }
        });
        Self {
            store,
            ..Self::default()
        }
    }

    fn store(&self) -> Result<&CaseStore, Refused> {
        let why = "this server keeps no cases: it has no state folder, or cannot use the folder";
        self.store
            .as_ref()
            .ok_or_else(|| Refused::Fault(why.into()))
    }

    /// Arguments of a command of the server's own program on a case.
    fn arguments(store: &CaseStore, action: &str, name: &str, more: &[&str]) -> Vec<OsString> {
        let mut all: Vec<OsString> = vec!["case".into(), action.into(), name.into()];
        all.extend(["--child".into(), "--state".into()]);
        all.push(store.state().path().into());
        all.extend(more.iter().map(OsString::from));
        all
    }
}

/// Refusal of an error. Details of files are for the log.
fn refused(error: CaseError) -> Refused {
    let told = error.to_string();
    match error {
        CaseError::Unknown { name, .. } => {
            Refused::Unknown(format!("the case `{name}` does not exist"))
        }
        CaseError::Name(_) | CaseError::Exists(_) => Refused::Bad("name", told),
        CaseError::Full(_)
        | CaseError::Conflict(_)
        | CaseError::InUse { .. }
        | CaseError::NotCompiled(_)
        | CaseError::NotValid { .. }
        | CaseError::Form(_) => Refused::Conflict(told),
        CaseError::File(_) | CaseError::NoText(_) | CaseError::State(_) => {
            tracing::error!("cases: {told}");
            let why =
                "the server cannot read or write the file of this case; tell an administrator";
            Refused::Fault(why.into())
        }
    }
}

/// A case for the list. `plans`: plans of all stations.
fn shown(store: &CaseStore, opened: &Opened, plans: &[(String, Plan)]) -> Case {
    let scene = store.scene(&opened.name);
    let users = plans.iter().filter(|(_, plan)| uses::uses(plan, &scene));
    let status = opened.status.as_ref();
    let state = opened.state();
    Case {
        name: opened.name.clone(),
        state: match serde_json::to_value(state) {
            Ok(serde_json::Value::String(name)) => name,
            _ => String::new(),
        },
        words: state.words().into(),
        fault: opened.fault(),
        compiled: status.map_or_else(String::new, |status| minute(status.compiled_unix_s)),
        warnings: status.map_or_else(Vec::new, |status| status.warnings.clone()),
        users: users.map(|(station, _)| station.clone()).collect(),
        chart: opened.patient.as_ref().ok().map(form::chart),
    }
}

fn loaded(store: &CaseStore, opened: &Opened) -> Loaded {
    let plans = uses::plans(store).unwrap_or_default();
    Loaded {
        case: shown(store, opened, &plans),
        version: opened.version.clone(),
        faults: opened.faults.iter().map(form::fault).collect(),
    }
}

fn choice(name: &str, about: &str) -> Choice {
    Choice {
        name: name.to_owned(),
        about: about.to_owned(),
    }
}

/// Words of a condition for teachers.
fn words(condition: Condition) -> &'static str {
    match condition {
        Condition::Healthy => "depths of 1 to 3 mm, few sites bleed",
        Condition::Gingivitis => "depths of 2 to 4 mm, every other site bleeds",
        Condition::Periodontitis => "mild to severe by the seed, depths up to 7 mm",
    }
}

/// Exercises on a whole mouth, and exploration without a grade.
fn exercises() -> Vec<Choice> {
    let all = sulcus_sessions::Exercise::built_in();
    let mouth = sulcus_scene::BuiltIn::Mouth.name();
    let fitting = all.iter().filter(|exercise| exercise.scene == mouth);
    let mut all: Vec<Choice> = fitting
        .map(|exercise| choice(&exercise.name, &exercise.about))
        .collect();
    all.sort_by(|one, other| one.name.cmp(&other.name));
    all.push(choice(Plan::FREE, "free exploration without a grade"));
    all
}

/// Sides of pictures with words.
fn sides() -> Vec<Choice> {
    #[cfg(feature = "lab")]
    let all = sulcus_lab::mouth_sides().map(|side| {
        let about = match side {
            "above" => "from above",
            "front" => "from the front",
            "right-buccal" => "right teeth, from the cheek",
            "left-buccal" => "left teeth, from the cheek",
            "right-lingual" => "right teeth, from the tongue",
            "left-lingual" => "left teeth, from the tongue",
            other => other,
        };
        choice(side, about)
    });
    #[cfg(not(feature = "lab"))]
    let all = [];
    all.into()
}

impl Cases for OwnCases {
    fn model(&self) -> Model {
        Model {
            teeth: LOWER.into(),
            third_molars: THIRD_MOLARS.into(),
            healthy: form::shown(&ToothChart::healthy(LOWER[0])),
            depth_mm: DEPTH_MM,
            recession_mm: RECESSION_MM,
            most_loss_mm: MOST_LOSS_MM,
            conditions: Condition::ALL
                .map(|condition| choice(condition.name(), words(condition)))
                .into(),
            exercises: exercises(),
            sides: sides(),
        }
    }

    fn list(&self) -> Result<Vec<Case>, Refused> {
        let store = self.store()?;
        // A list without users is better than none; a removal asks again.
        let plans = uses::plans(store).unwrap_or_default();
        let mut all = Vec::new();
        for name in store.names().map_err(refused)? {
            match store.read(&name) {
                Ok(opened) => all.push(shown(store, &opened, &plans)),
                // A case that was removed in the meantime.
                Err(CaseError::Unknown { .. }) => {}
                Err(error) => all.push(Case {
                    name,
                    state: "faulty".into(),
                    words: "cannot be read".into(),
                    fault: Some(refused(error).to_string()),
                    ..Case::default()
                }),
            }
        }
        Ok(all)
    }

    fn load(&self, name: &str) -> Result<Loaded, Refused> {
        let store = self.store()?;
        let opened = store.read(name).map_err(refused)?;
        Ok(loaded(store, &opened))
    }

    fn check(&self, chart: &Chart) -> Vec<FieldFault> {
        let found = faults(&form::patient(chart));
        found.iter().map(form::fault).collect()
    }

    fn create(&self, name: &str, origin: &Origin, by: &str) -> Result<(), Refused> {
        let store = self.store()?;
        let text = match origin {
            Origin::Generated { condition, seed } => {
                let condition: Condition = condition
                    .parse()
                    .map_err(|why| Refused::Bad("condition", why))?;
                let patient = generate(*seed, condition);
                edit::written(&patient).unwrap_or_else(|| patient.to_toml())
            }
            Origin::Copy(from) => store.text(from).map_err(refused)?,
        };
        store.create(name, &text).map_err(refused)?;
        tracing::info!("case {name}: made by {by}");
        Ok(())
    }

    fn save(&self, name: &str, version: &str, chart: &Chart, by: &str) -> Result<Loaded, Refused> {
        let store = self.store()?;
        let opened = store.read(name).map_err(refused)?;
        if opened.version != version {
            return Err(refused(CaseError::Conflict(name.to_owned())));
        }
        let text = edit::edited(&opened.text, &form::patient(chart));
        let text = text.ok_or_else(|| refused(CaseError::Form(name.to_owned())))?;
        let opened = store.write(name, version, &text).map_err(refused)?;
        self.worker.forget(name);
        tracing::info!("case {name}: saved by {by}");
        Ok(loaded(store, &opened))
    }

    fn remove(&self, name: &str, by: &str) -> Result<(), Refused> {
        let store = self.store()?;
        store.remove(name).map_err(refused)?;
        self.worker.cancel(name);
        self.worker.forget(name);
        tracing::info!("case {name}: removed by {by}");
        Ok(())
    }

    fn compile(&self, name: &str, by: &str) -> Result<(), Refused> {
        let store = self.store()?;
        let opened = store.read(name).map_err(refused)?;
        if let Some(why) = opened.fault() {
            let name = name.to_owned();
            return Err(refused(CaseError::NotValid { name, why }));
        }
        let command = worker::own(&Self::arguments(store, "compile", name, &[]));
        self.worker.add(name, command.map_err(Refused::Fault)?);
        tracing::info!("case {name}: compilation asked by {by}");
        Ok(())
    }

    fn cancel(&self, name: &str, by: &str) {
        self.worker.cancel(name);
        tracing::info!("case {}: compilation stopped by {by}", name.escape_debug());
    }

    fn work(&self) -> Work {
        self.worker.work()
    }

    fn picture(&self, name: &str, side: &str) -> Result<Vec<u8>, Refused> {
        let store = self.store()?;
        if sides().iter().all(|choice| choice.name != side) {
            return Err(Refused::Unknown(
                "the server draws no picture of this side".into(),
            ));
        }
        let opened = store.read(name).map_err(refused)?;
        if opened.status.is_none() {
            return Err(refused(CaseError::NotCompiled(name.to_owned())));
        }
        let _turn = self.drawing.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(drawn) = store.picture(name, side).map_err(refused)? {
            return Ok(drawn);
        }
        let arguments = Self::arguments(store, "picture", name, &["--side", side]);
        let mut command = worker::own(&arguments).map_err(Refused::Fault)?;
        if let Ended::Badly(why) = worker::run(&mut command) {
            return Err(Refused::Fault(format!(
                "the picture cannot be drawn: {why}"
            )));
        }
        let drawn = store.picture(name, side).map_err(refused)?;
        drawn.ok_or_else(|| Refused::Fault("the picture was not drawn; ask again".into()))
    }

    fn mouth(&self, name: &str) -> Result<Vec<u8>, Refused> {
        let store = self.store()?;
        let opened = store.read(name).map_err(refused)?;
        if opened.status.is_none() {
            return Err(refused(CaseError::NotCompiled(name.to_owned())));
        }
        let program = feeds::program().map_err(Refused::Fault)?;
        let _turn = self.drawing.lock().unwrap_or_else(PoisonError::into_inner);
        let failed = |error: &dyn std::fmt::Display| {
            tracing::error!("case {name}: {error}");
            Refused::Fault("the compiled mouth cannot be read; compile the case again".into())
        };
        let bytes = std::fs::read(store.scene(name)).map_err(|error| failed(&error))?;
        let scene = Scene::from_bytes(&bytes).map_err(|error| failed(&error))?;
        let display = Display::new(&scene).map_err(|error| failed(&error))?;
        feeds::still::drawn(&program, display.bytes()).map_err(Refused::Fault)
    }

    fn plan(&self, name: &str, exercise: &str) -> Result<String, Refused> {
        let store = self.store()?;
        let opened = store.read(name).map_err(refused)?;
        if opened.status.is_none() {
            return Err(refused(CaseError::NotCompiled(name.to_owned())));
        }
        let known = exercises();
        if known.iter().all(|choice| choice.name != exercise) {
            let names: Vec<&str> = known.iter().map(|choice| choice.name.as_str()).collect();
            let found = exercise.escape_debug();
            let why = format!(
                "exercise is `{found}`, expected one of {}",
                names.join(", ")
            );
            return Err(Refused::Bad("exercise", why));
        }
        let mut plan = toml::Table::new();
        plan.insert("exercise".into(), exercise.into());
        let scene = store.scene(name);
        let scene = scene.to_str().ok_or_else(|| {
            Refused::Fault(
                "the path of the state folder is no text, and no plan can name it".into(),
            )
        })?;
        plan.insert("scene".into(), scene.into());
        // The patient of a case is fixed.
        plan.insert("clear".into(), vec!["patient_seed"].into());
        Ok(plan.to_string())
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
