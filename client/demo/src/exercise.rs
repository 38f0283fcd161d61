//! What the demo can perform: the scene and the script of an exercise.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, bail};
use sulcus_cases::Case;
use sulcus_cases::table::Driver;
use sulcus_core::Scene;
use sulcus_core::optimise::SolverKind;
use sulcus_core::scene::displayable::too_stiff;
use sulcus_operator::bimanual::Bimanual;
use sulcus_operator::crown::{Crown, CrownParams};
use sulcus_operator::retraction::{Retraction, RetractionParams};
use sulcus_operator::tour::Tour;
use sulcus_operator::tour_params::{TourParams, Visit};
use sulcus_operator::{Habit, HandParams, Operator, Script};
use sulcus_scene::BuiltIn;
use sulcus_sessions::exercise::Kind;
use sulcus_sessions::{Events, Exercise, Mode, Rubric};

use crate::progress::Steps;

/// What is to be performed, and how.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// Name of an exercise, file of one (ending in `.toml`), or a hard case as `hard/NAME`.
    pub exercise: &'a str,
    /// Scene file; none: the exercise's own scene.
    pub scene: Option<&'a Path>,
    /// Length, seconds; none: the exercise's own.
    pub duration_s: Option<f64>,
    /// Performs it badly.
    pub habit: Option<Habit>,
    /// Seed of a generated patient; none: the scene's own.
    pub patient_seed: Option<u64>,
    /// Seed of the hand's tremor and of mistakes.
    pub hand_seed: u64,
    /// Solver in the tick.
    pub solver: SolverKind,
    /// Ticks a second; none: the scene's own.
    pub rate_hz: Option<u16>,
}

impl<'a> Asked<'a> {
    /// An exercise in its own scene and length, performed well.
    pub fn of(exercise: &'a str) -> Self {
        Self {
            exercise,
            scene: None,
            duration_s: None,
            habit: None,
            patient_seed: None,
            hand_seed: 1,
            solver: SolverKind::ActiveSet,
            rate_hz: None,
        }
    }
}

/// An exercise ready to run.
pub struct Prepared {
    /// What is asked, with the length it has here.
    pub exercise: Exercise,
    /// Compiled scene.
    pub scene: Arc<Scene>,
    /// The same as bytes.
    pub scene_bytes: Arc<Vec<u8>>,
    /// Text of the scene's patient; empty where it has none.
    pub patient: String,
    /// Opaque learner id for a recording; may be empty.
    pub learner: String,
    /// What the session is for, for a recording.
    pub mode: Mode,
    /// Who performs it.
    pub operator: Operator,
    /// The hard case behind it, if it is one.
    pub case: Option<&'static Case>,
    /// Length, ticks; the most of it where it ends with the operator.
    pub ticks: u64,
    /// Whether it ends when the operator has nothing left to do: where no length was asked for.
    pub until_done: bool,
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

    /// The rubric as it goes into the recording (TOML), definitions included; empty where nothing is asked that is graded.
    ///
    /// # Errors
    /// Never for a rubric that is built in.
    pub fn rubric(&self) -> anyhow::Result<String> {
        let rubric = Rubric::of(&self.exercise);
        let text = rubric.map(|rubric| rubric.definition()).transpose()?;
        Ok(text.unwrap_or_default())
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
    if habit == Some(Habit::LetsTongueGo) && exercise.kind != Kind::Bimanual {
        bail!(
            "habit `lets-tongue-go` is the mirror's, and exercise `{}` has none",
            exercise.name
        );
    }
    // (What a patient lacks is left out; the warnings say so.)
    let is_there = |fdi: u8| scene.objects.iter().any(|object| object.fdi == fdi);
    let mut tour: Vec<Visit> = exercise
        .zones
        .iter()
        .filter(|zones| is_there(zones.tooth))
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
    hand(scene, exercise, habit, &tour, params).with_context(|| {
        format!(
            "exercise `{}` cannot be performed in scene `{}` (name another with --exercise)",
            exercise.name, scene.name
        )
    })
}

/// The simulated hands for an exercise's kind.
fn hand(
    scene: &Scene,
    exercise: &Exercise,
    habit: Option<Habit>,
    tour: &[Visit],
    params: TourParams,
) -> anyhow::Result<Box<dyn Script + Send>> {
    let duration = exercise.duration_s;
    Ok(match exercise.kind {
        Kind::Crown => {
            let params = CrownParams {
                duration,
                ..CrownParams::default()
            };
            Box::new(Crown::new(scene, None, params)?)
        }
        Kind::Probing => Box::new(Tour::new(scene, tour, params)?),
        Kind::Retraction => {
            let target = exercise.target.as_ref().and_then(|target| {
                let tooth = scene.objects.iter().find(|o| o.fdi == target.tooth)?;
                Some(tooth.tree.nodes()[0].centre)
            });
            let params = RetractionParams {
                duration,
                work: target,
                ..RetractionParams::default()
            };
            Box::new(Retraction::new(scene, params)?)
        }
        Kind::Bimanual => {
            let until = Habit::holds_until(habit);
            let mirror = RetractionParams::default();
            Box::new(Bimanual::new(scene, tour, params, mirror, until)?)
        }
        Kind::Free => bail!("its kind is free: no simulated operator performs it"),
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

/// Compiles the scene and makes the operator of an exercise.
///
/// # Errors
/// When the exercise is unknown, or the scene file cannot be used.
pub fn prepare(asked: &Asked<'_>, steps: &Steps) -> anyhow::Result<Prepared> {
    let (name, habit) = (asked.exercise, asked.habit);
    let mut warnings = Vec::new();
    let mut hard = None;
    let mut patient = String::new();
    let mut exercise = Exercise::free(name, 1.0);
    exercise.task = "Hold on: this is a hard case, not an exercise.".into();
    let (mut scene, script, hand): (Scene, Box<dyn Script + Send>, HandParams) =
        if let Some(case) = name.strip_prefix("hard/") {
            let Some(case) = sulcus_cases::find(case) else {
                bail!("{}", unknown(name))
            };
            if asked.scene.is_some() {
                bail!("exercise `{name}` brings its own scene: leave --scene out");
            }
            if let Some(habit) = habit {
                bail!("habit `{habit}` is one of probing, and `{name}` is a hard case");
            }
            hard = Some(case);
            // Where a hand would hide a figure the table moves the tool itself; here a person watches,
            // so a hand follows the same script.
            let mut scene = (case.scene)();
            at_rate(&mut scene, asked.rate_hz)?;
            match case.driver {
                Driver::Kinematic(script) => {
                    let script = script(&scene);
                    (scene, script, HandParams::default())
                }
                Driver::Closed(script, hand) => {
                    let script = script(&scene);
                    (scene, script, hand())
                }
            }
        } else {
            exercise = find(name)?;
            exercise.duration_s = asked.duration_s.unwrap_or(exercise.duration_s);
            let otherwise = match asked.scene {
                Some(_) => BuiltIn::Crown,
                None => BuiltIn::named(&exercise.scene)
                    .with_context(|| format!("exercise `{}`", exercise.name))?,
            };
            let mut compiled = compile(asked.scene, otherwise, asked.patient_seed, steps)?;
            warnings = compiled.warnings;
            patient = compiled.patient.unwrap_or_default();
            at_rate(&mut compiled.scene, asked.rate_hz)?;
            let script = script(&compiled.scene, &exercise, habit, asked.hand_seed)?;
            (compiled.scene, script, HandParams::default())
        };
    let too_stiff = too_stiff(&scene);
    let graded = hard.is_none() && Rubric::of(&exercise).is_some();
    warnings.extend(too_stiff.iter().map(|coupling| match graded {
        true => format!("{coupling}; the session is not graded"),
        false => coupling.to_string(),
    }));
    scene.params.solver = asked.solver;
    let scene_bytes = scene
        .to_bytes()
        .context("the scene cannot be written as bytes")?;
    let hand = HandParams {
        period_s: scene.tick_s(),
        ..hand
    };
    let operator = Operator::new(script, hand, asked.hand_seed);
    if hard.is_some() {
        exercise.duration_s = (operator.ticks() as f64 * scene.tick_s()).max(0.1);
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
        patient,
        ticks: operator.ticks(),
        until_done: asked.duration_s.is_none(),
        learner: String::new(),
        mode: Mode::default(),
        operator,
        case: hard,
        warnings,
    })
}

/// Has `scene` tick so many times a second, where something else than its own rate is asked for.
///
/// # Errors
/// When the rate is out of range, or something of the scene is not stable at it.
fn at_rate(scene: &mut Scene, rate_hz: Option<u16>) -> anyhow::Result<()> {
    let Some(rate_hz) = rate_hz else {
        return Ok(());
    };
    scene.params.rate_hz = rate_hz;
    scene
        .validate()
        .with_context(|| format!("scene `{}` at {rate_hz} Hz", scene.name))
}

/// The scene of a file, or a built-in one; of another generated patient where `patient_seed` says so.
///
/// # Errors
/// When the file cannot be used; the message says what and where.
pub fn compile(
    scene_file: Option<&Path>,
    otherwise: BuiltIn,
    patient_seed: Option<u64>,
    steps: &Steps,
) -> anyhow::Result<sulcus_scene::Compiled> {
    let options = sulcus_scene::BuildOptions {
        seed: patient_seed,
        ..sulcus_scene::BuildOptions::cached()
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
