//! What the demo can perform: the scene and the script of an exercise.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, bail};
use sulcus_cases::Case;
use sulcus_cases::table::Driver;
use sulcus_core::Scene;
use sulcus_core::optimise::SolverKind;
use sulcus_operator::bimanual::Bimanual;
use sulcus_operator::crown::{Crown, CrownParams};
use sulcus_operator::retraction::{Retraction, RetractionParams};
use sulcus_operator::tour::Tour;
use sulcus_operator::tour_params::{TourParams, Visit};
use sulcus_operator::{Habit, HandParams, Operator, Script};
use sulcus_scene::BuiltIn;
use sulcus_sessions::exercise::Kind;
use sulcus_sessions::{Events, Exercise};

use crate::progress::Steps;

/// An exercise ready to run.
pub struct Prepared {
    /// What is asked, with the length it has here.
    pub exercise: Exercise,
    /// Compiled scene.
    pub scene: Arc<Scene>,
    /// The same as bytes.
    pub scene_bytes: Arc<Vec<u8>>,
    /// Who performs it.
    pub operator: Operator,
    /// The hard case behind it, if it is one.
    pub case: Option<&'static Case>,
    /// Length, ticks.
    pub ticks: u64,
    /// What was noticed while compiling.
    pub warnings: Vec<String>,
}

impl Prepared {
    /// BLAKE3 of the compiled scene, as a server says it.
    pub fn scene_hash(&self) -> [u8; 32] {
        *blake3::hash(&self.scene_bytes).as_bytes()
    }

    /// The exercise as it goes into the recording (TOML).
    ///
    /// # Errors
    /// Never for an exercise that was read from a valid text.
    pub fn definition(&self, seed: u64) -> anyhow::Result<String> {
        Ok(self.exercise.definition(seed)?)
    }
}

/// The script of an exercise in a scene: which of the simulated hands performs it, and how; with a bad habit, if any.
///
/// # Errors
/// When the scene lacks what the exercise wants, or the habit has nothing to do with it.
pub fn script(
    scene: &Scene,
    exercise: &Exercise,
    habit: Option<Habit>,
    seed: u64,
) -> anyhow::Result<Box<dyn Script + Send>> {
    let duration = exercise.duration_s;
    let probes = matches!(exercise.kind, Kind::Probing | Kind::Bimanual);
    if let Some(habit) = habit.filter(|_| !probes) {
        bail!(
            "habit `{habit}` is one of probing, and exercise `{}` is not",
            exercise.name
        );
    }
    let mut tour: Vec<Visit> = exercise
        .zones
        .iter()
        .map(|zones| Visit {
            tooth: zones.tooth,
            sites: zones.sites.clone(),
        })
        .collect();
    let task = &exercise.probing;
    let mut params = TourParams {
        duration,
        force: task.force_n[0] + 0.3 * (task.force_n[1] - task.force_n[0]),
        advance: task.step_mm * 1e-3,
        ..TourParams::default()
    };
    if let Some(habit) = habit {
        habit.spoil(&mut params, &mut tour, seed);
    }
    Ok(match exercise.kind {
        Kind::Crown => {
            let params = CrownParams {
                duration,
                ..CrownParams::default()
            };
            Box::new(Crown::new(scene, None, params)?)
        }
        Kind::Probing => Box::new(Tour::new(scene, &tour, params)?),
        Kind::Retraction => {
            let params = RetractionParams {
                duration,
                ..RetractionParams::default()
            };
            Box::new(Retraction::new(scene, params)?)
        }
        Kind::Bimanual => {
            let until = if habit == Some(Habit::LetsTongueGo) {
                0.5
            } else {
                1.0
            };
            let mirror = RetractionParams::default();
            Box::new(Bimanual::new(scene, &tour, params, mirror, until)?)
        }
        Kind::Free => bail!(
            "no simulated operator performs exercise `{}`: its kind is free",
            exercise.name
        ),
    })
}

/// The exercise of that name, or in the file of that name (ending in `.toml`).
///
/// # Errors
/// When there is none, or it is not valid: the message says what and where.
pub fn find(name: &str) -> anyhow::Result<Exercise> {
    if name.ends_with(".toml") {
        return Ok(Exercise::open(Path::new(name))?);
    }
    let found = Exercise::built_in()
        .into_iter()
        .find(|one| one.name == name);
    found.with_context(|| unknown(name))
}

/// A scene that is built in, by its name in exercises.
fn built_in_scene(exercise: &Exercise) -> anyhow::Result<BuiltIn> {
    let name = |scene: &BuiltIn| scene.file_name().with_extension("");
    let found = BuiltIn::ALL
        .into_iter()
        .find(|scene| name(scene).as_os_str() == exercise.scene.as_str());
    found.with_context(|| {
        let names: Vec<String> = BuiltIn::ALL
            .iter()
            .map(|scene| name(scene).display().to_string())
            .collect();
        format!(
            "exercise `{}` is performed in scene `{}`, which is not built in (there are {}): name one with --scene",
            exercise.name,
            exercise.scene,
            names.join(", ")
        )
    })
}

/// Names for `--list-exercises`, with what each is about.
pub fn list() -> Vec<(String, String)> {
    let mut names: Vec<(String, String)> = Exercise::built_in()
        .into_iter()
        .map(|one| (one.name, one.about))
        .collect();
    names.extend(
        sulcus_cases::TABLE
            .iter()
            .map(|case| (format!("hard/{}", case.name), case.about.to_owned())),
    );
    names
}

/// Compiles the scene and makes the operator of exercise `name`.
///
/// # Errors
/// When the exercise is unknown, or the scene file cannot be used.
pub fn prepare(
    name: &str,
    scene_file: Option<&Path>,
    duration_s: Option<f64>,
    habit: Option<Habit>,
    seed: u64,
    solver: SolverKind,
    steps: &Steps,
) -> anyhow::Result<Prepared> {
    let mut warnings = Vec::new();
    let mut hard = None;
    let mut exercise = Exercise::free(name, 1.0);
    exercise.task = "Hold on: this is a hard case, not an exercise.".into();
    let (mut scene, script, hand): (Scene, Box<dyn Script + Send>, HandParams) =
        if let Some(case) = name.strip_prefix("hard/") {
            let Some(case) = sulcus_cases::find(case) else {
                bail!("{}", unknown(name))
            };
            if scene_file.is_some() {
                bail!("exercise `{name}` brings its own scene: leave --scene out");
            }
            if let Some(habit) = habit {
                bail!("habit `{habit}` is one of probing, and `{name}` is a hard case");
            }
            hard = Some(case);
            // Where a hand would hide a figure the table moves the tool itself; here a person watches,
            // so a hand follows the same script.
            match case.driver {
                Driver::Kinematic(script) => {
                    let scene = (case.scene)();
                    let script = script(&scene);
                    (scene, script, HandParams::default())
                }
                Driver::Closed(script, hand) => {
                    let scene = (case.scene)();
                    let script = script(&scene);
                    (scene, script, hand())
                }
            }
        } else {
            exercise = find(name)?;
            exercise.duration_s = duration_s.unwrap_or(exercise.duration_s);
            let otherwise = match scene_file {
                Some(_) => BuiltIn::Crown,
                None => built_in_scene(&exercise)?,
            };
            let compiled = compile(scene_file, otherwise, steps)?;
            warnings = compiled.warnings;
            let script = script(&compiled.scene, &exercise, habit, seed)?;
            (compiled.scene, script, HandParams::default())
        };
    scene.params.solver = solver;
    let scene_bytes = scene
        .to_bytes()
        .context("the scene cannot be written as bytes")?;
    let operator = Operator::new(script, hand, seed);
    if hard.is_some() {
        exercise.duration_s = (operator.ticks() as f64 * sulcus_core::TICK_S).max(0.1);
    }
    let lacks = Events::new(&scene, &exercise);
    warnings.extend(lacks.missing().iter().map(|what| {
        format!(
            "exercise `{name}` wants {what}, which scene `{}` has not",
            scene.name
        )
    }));
    Ok(Prepared {
        exercise,
        scene: Arc::new(scene),
        scene_bytes: Arc::new(scene_bytes),
        ticks: operator.ticks(),
        operator,
        case: hard,
        warnings,
    })
}

/// The scene of a file, or a built-in one.
///
/// # Errors
/// When the file cannot be used; the message says what and where.
pub fn compile(
    scene_file: Option<&Path>,
    otherwise: BuiltIn,
    steps: &Steps,
) -> anyhow::Result<sulcus_scene::Compiled> {
    let options = sulcus_scene::BuildOptions {
        cache: sulcus_scene::default_cache_dir(),
        ..Default::default()
    };
    let bar = steps.bar("building the scene");
    let progress = |what: &str, share: f64| bar.set(what, share);
    let compiled = match scene_file {
        Some(file) => sulcus_scene::compile_file(file, &options, &progress)?,
        None => sulcus_scene::compile_built_in(otherwise, &options, &progress)?,
    };
    bar.done();
    Ok(compiled)
}

fn unknown(name: &str) -> String {
    let names: Vec<String> = list().into_iter().map(|(name, _)| name).collect();
    format!(
        "unknown exercise `{name}`, expected one of: {}",
        names.join(", ")
    )
}
