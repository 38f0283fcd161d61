//! Scene, exercise and rubric of a plan: found, loaded and compiled.

use std::path::Path;

use anyhow::{Context, bail};
use sulcus_core::Scene;
use sulcus_core::scene::displayable::too_stiff;
use sulcus_program::PathText;
use sulcus_scene::{BuildOptions, BuiltIn, compile_built_in, compile_file};
use sulcus_sessions::{Events, Rubric};

use super::Plan;
use super::fields::PatientSeed;
use crate::Exercise;

/// All that a session needs of its plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    /// Compiled scene at the rate of the plan.
    pub scene: Scene,
    /// The same scene as bytes, for its hash and for the recording.
    pub bytes: Vec<u8>,
    /// Text of the patient; empty for a scene without a patient, and for a compiled scene that is no case.
    pub patient: String,
    /// Seed of the generated patient; `None` for any other patient. The seed of an exam is a secret until its end.
    pub seed: Option<u64>,
    /// Exercise as offered and recorded.
    pub exercise: Exercise,
    /// Text of the rubric; empty if the exercise is not graded.
    pub rubric: String,
    /// Faults that do not prevent a session, a sentence each.
    pub warnings: Vec<String>,
}

/// Finds, loads and compiles the parts of a plan. Each call draws the seed of an exam anew. `progress` gets stages and
/// their share of the whole, 0 to 1.
///
/// # Errors
/// The plan names an unknown exercise, a file that is not valid, a rate that does not fit the scene, or a seed for
/// a scene without a generated patient. A graded exercise needs a scene that a device can display.
pub fn prepare(plan: &Plan, progress: &dyn Fn(&str, f64)) -> anyhow::Result<Prepared> {
    let asked = exercise_of(plan)?;
    let mut warnings = Vec::new();
    let (exercise, rubric) = recorded(asked.as_ref(), plan.rubric.as_deref(), &mut warnings)?;
    let otherwise = match &asked {
        Some(exercise) if plan.scene.is_none() => BuiltIn::named(&exercise.scene)
            .with_context(|| format!("exercise `{}`", exercise.name))?,
        _ => BuiltIn::Crown,
    };
    let mut prepared = match &plan.scene {
        Some(path) if path.extension().is_some_and(|ending| ending == "scene") => {
            compiled_scene(plan, path)?
        }
        _ => compile(plan, otherwise, progress)?,
    };
    prepared.warnings.splice(..0, warnings);
    prepared.exercise = exercise;
    prepared.rubric = rubric;
    if let Some(exercise) = &asked {
        for what in Events::new(&prepared.scene, exercise).missing() {
            let (name, scene) = (&exercise.name, &prepared.scene.name);
            let warning = format!("exercise `{name}` needs {what}, which scene `{scene}` lacks");
            prepared.warnings.push(warning);
        }
    }
    for coupling in too_stiff(&prepared.scene) {
        if !prepared.rubric.is_empty() {
            bail!(
                "exercise `{}` is graded and needs a coupling that a device can display: {coupling}",
                prepared.exercise.name
            );
        }
        prepared.warnings.push(coupling.to_string());
    }
    if plan.detail_budget_us.is_some() && !prepared.rubric.is_empty() {
        bail!(
            "detail_budget_us is given, expected none with exercise `{}`, which is graded at a fixed level of detail",
            prepared.exercise.name
        );
    }
    Ok(prepared)
}

/// Exercise of a plan; `None` for free exploration.
fn exercise_of(plan: &Plan) -> anyhow::Result<Option<sulcus_sessions::Exercise>> {
    let name = plan.exercise.as_str();
    if name == Plan::FREE {
        return Ok(None);
    }
    if name.ends_with(".toml") {
        return Ok(Some(sulcus_sessions::Exercise::open(Path::new(name))?));
    }
    let all = sulcus_sessions::Exercise::built_in();
    let names: Vec<String> = all.iter().map(|one| one.name.clone()).collect();
    let found = all.into_iter().find(|one| one.name == name);
    found.map(Some).with_context(|| {
        format!(
            "exercise is `{}`, expected one of {}, {}, or an exercise file that ends in .toml",
            name.escape_debug(),
            names.join(", "),
            Plan::FREE
        )
    })
}

/// Exercise as offered and recorded, and the text of its rubric.
fn recorded(
    asked: Option<&sulcus_sessions::Exercise>,
    rubric: Option<&Path>,
    warnings: &mut Vec<String>,
) -> anyhow::Result<(Exercise, String)> {
    let Some(one) = asked else {
        return Ok((Exercise::default(), String::new()));
    };
    let rubric = match rubric {
        Some(file) => {
            let rubric = Rubric::open(file)?;
            rubric.fits(one)?;
            Some(rubric)
        }
        None => Rubric::of(one),
    };
    if let Some(Err(error)) = rubric.as_ref().map(|rubric| rubric.fits(one)) {
        warnings.push(format!("the recordings cannot be graded: {error}"));
    }
    let rubric = rubric.map(|rubric| rubric.definition()).transpose()?;
    let exercise = Exercise {
        name: one.name.clone(),
        text: one.task.clone(),
        definition: one.definition(0)?,
        seed: 0,
    };
    Ok((exercise, rubric.unwrap_or_default()))
}

/// Parts of a compiled scene's file. Exercise and rubric follow.
fn compiled_scene(plan: &Plan, path: &Path) -> anyhow::Result<Prepared> {
    if let Some(PatientSeed::Number(_)) = plan.patient_seed {
        bail!(
            "patient_seed is a number, expected none with {}: the patient of a compiled scene is fixed",
            path.shown()
        );
    }
    let mut bytes =
        std::fs::read(path).with_context(|| format!("{}: cannot read the scene", path.shown()))?;
    let mut scene = Scene::from_bytes(&bytes).with_context(|| path.shown().to_string())?;
    let patient = crate::cases::store::patient_of(path, &bytes);
    if let Some(rate_hz) = plan.rate_hz {
        scene.params.rate_hz = rate_hz;
        scene.validate()?;
        bytes = scene.to_bytes()?;
    }
    let mut prepared = of(scene, bytes);
    prepared.patient = patient.unwrap_or_default();
    Ok(prepared)
}

/// Parts of a scene file or a built-in scene. Exercise and rubric follow.
fn compile(
    plan: &Plan,
    otherwise: BuiltIn,
    progress: &dyn Fn(&str, f64),
) -> anyhow::Result<Prepared> {
    // A scene without a generated patient ignores the seed.
    let seed = plan.seed_of_session(true)?;
    let is_drawn = seed.is_some() && !matches!(plan.patient_seed, Some(PatientSeed::Number(_)));
    let mut options = BuildOptions {
        seed,
        ..BuildOptions::cached()
    };
    if is_drawn && plan.scene.is_none() {
        // The patient is used once. Its trees come with the program, and the cache would keep an exam's answers.
        options.cache = None;
    }
    let mut compiled = match &plan.scene {
        Some(path) => compile_file(path, &options, progress)?,
        None => compile_built_in(otherwise, &options, progress)?,
    };
    if let (Some(PatientSeed::Number(_)), None) = (plan.patient_seed, compiled.seed) {
        let has = match compiled.patient {
            Some(_) => "a written patient (`patient` of `[mouth]`)",
            None => "no patient (no table `[mouth]`)",
        };
        bail!(
            "patient_seed is a number, expected none: scene `{}` has {has}",
            compiled.scene.name
        );
    }
    if let Some(rate_hz) = plan.rate_hz {
        compiled.scene.params.rate_hz = rate_hz;
        compiled.scene.validate()?;
    }
    let bytes = compiled.scene.to_bytes()?;
    let mut prepared = of(compiled.scene, bytes);
    prepared.patient = compiled.patient.unwrap_or_default();
    prepared.seed = compiled.seed;
    prepared.warnings = compiled.warnings;
    Ok(prepared)
}

fn of(scene: Scene, bytes: Vec<u8>) -> Prepared {
    Prepared {
        scene,
        bytes,
        patient: String::new(),
        seed: None,
        exercise: Exercise::default(),
        rubric: String::new(),
        warnings: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::PlanChange;

    fn plan(change: &str) -> Plan {
        let change: PlanChange = crate::exact::read(change).expect("a change");
        Plan::of(&change).expect("a plan")
    }

    fn prepared(change: &str) -> Prepared {
        prepare(&plan(change), &|_, _| ()).expect(change)
    }

    fn refused(change: &str, words: &[&str]) {
        let error = prepare(&plan(change), &|_, _| ()).expect_err(change);
        let told = sulcus_sessions::sentence(&error);
        for word in words {
            assert!(told.contains(word), "`{word}` is missing: {told}");
        }
    }

    #[test]
    fn an_exercise_brings_its_scene_and_its_rubric() {
        let crown = prepared("rate_hz = 2000");
        assert_eq!(
            (crown.exercise.name.as_str(), crown.scene.name.as_str()),
            ("crown", "crown")
        );
        assert_eq!((crown.scene.params.rate_hz, crown.seed), (2000, None));
        assert!(
            !crown.rubric.is_empty() && crown.warnings.is_empty(),
            "{:?}",
            crown.warnings
        );
        assert_eq!(
            Scene::from_bytes(&crown.bytes).expect("a scene"),
            crown.scene
        );
        let free = prepared("exercise = \"free\"");
        assert!(free.rubric.is_empty() && free.exercise == Exercise::default());
    }

    #[test]
    fn parts_that_cannot_be_had_are_named() {
        refused("exercise = \"juggling\"", &["`juggling`", "crown", ".toml"]);
        refused("exercise = \"/no/such.toml\"", &["/no/such.toml"]);
        refused("rubric = \"/no/such.toml\"", &["/no/such.toml"]);
        refused("patient_seed = 7", &["patient_seed", "crown", "no patient"]);
        refused("detail_budget_us = 300", &["detail_budget_us", "`crown`"]);
    }

    #[test]
    fn the_patient_of_a_compiled_scene_is_fixed() {
        let place = tempfile::tempdir().expect("temporary folder");
        let file = place.path().join("crown.scene");
        std::fs::write(&file, prepared("").bytes).expect("writes");
        let scene = format!("scene = {file:?}\n");
        assert_eq!(prepared(&scene).exercise.name, "free");
        let exam = prepared(&format!("{scene}exercise = \"crown\"\nmode = \"exam\""));
        assert_eq!(exam.seed, None);
        refused(
            &format!("{scene}patient_seed = 7"),
            &["patient_seed", "crown.scene"],
        );
    }

    #[test]
    fn an_exam_has_a_patient_of_its_own() {
        let exam = prepared("exercise = \"bimanual\"\nmode = \"exam\"");
        let practice = prepared("exercise = \"bimanual\"");
        assert!(exam.seed.is_some() && practice.seed.is_some());
        assert_ne!(exam.seed, practice.seed);
        assert_ne!(exam.patient, practice.patient);
    }
}
