//! Exercises of the demo and of `run`: scene, script and simulated operator.

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

use crate::lesson;
use sulcus_connection::progress::Steps;

/// Force at which the simulated operator reads, as a share of the way through the taught range: near its lower end,
/// because the tooth that a leaning shaft is pressed against adds to the force along the probe.
const AIM: f64 = 0.1;

/// Request for an exercise.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// Name of a built-in exercise, an exercise file that ends in `.toml`, or a hard case as `hard/NAME`.
    pub exercise: &'a str,
    /// Scene file; `None`: the scene of the exercise.
    pub scene: Option<&'a Path>,
    /// Length, seconds; `None`: the length of the exercise. A hard case ignores this field.
    pub duration_s: Option<f64>,
    /// Habit of the operator; `None`: a good operator.
    pub habit: Option<Habit>,
    /// Seed of the generated patient; `None`: the seed of the scene. A hard case ignores this field.
    pub patient_seed: Option<u64>,
    /// Seed of the hand's tremor and of the habit's errors.
    pub hand_seed: u64,
    /// Solver of the tick.
    pub solver: SolverKind,
    /// Ticks per second, 250 to 8000; `None`: the rate of the scene.
    pub rate_hz: Option<u16>,
}

impl<'a> Asked<'a> {
    /// An exercise in its own scene and length, by a good operator.
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

/// Longest session of a person, seconds.
const DAY_S: f64 = 86_400.0;

/// An exercise ready to run.
pub struct Prepared {
    /// Exercise with the length of this session.
    pub exercise: Exercise,
    /// Compiled scene.
    pub scene: Arc<Scene>,
    /// Bytes of the compiled scene.
    pub scene_bytes: Arc<Vec<u8>>,
    /// Text of the scene's patient; empty for a scene without a patient.
    pub patient: String,
    /// Opaque learner id for a recording; empty after [`prepare`].
    pub learner: String,
    /// Purpose of the session, for a recording; the default after [`prepare`].
    pub mode: Mode,
    /// Operator that performs the exercise.
    pub operator: Operator,
    /// Hard case of the exercise; `None` for other exercises.
    pub case: Option<&'static Case>,
    /// Largest length, ticks.
    pub ticks: u64,
    /// Whether the session ends with the operator's last task. This is so unless a length was requested.
    pub until_done: bool,
    /// Warnings about the scene, its couplings, and teeth that the exercise needs.
    pub warnings: Vec<String>,
}

impl Prepared {
    /// BLAKE3 of the compiled scene, as in the hello of a server.
    pub fn scene_hash(&self) -> [u8; 32] {
        *blake3::hash(&self.scene_bytes).as_bytes()
    }

    /// Number of ticks of a live session with a length of `asked_s` seconds, if a length was asked for. Else a person
    /// has a day, because the person or the server's time limit ends the session. The simulated operator has its own
    /// length.
    pub fn periods(&self, asked_s: Option<f64>, is_person: bool) -> u64 {
        let length_s = asked_s.or(is_person.then_some(DAY_S));
        match length_s.filter(|_| self.case.is_none()) {
            Some(length_s) => (length_s * (1.0 / self.scene.tick_s())) as u64,
            None => self.ticks,
        }
    }

    /// Definition of the exercise for a recording (TOML), with `seed`.
    ///
    /// # Errors
    /// The definition cannot be written as TOML. An exercise from a valid text has no such error.
    pub fn definition(&self, seed: u64) -> anyhow::Result<String> {
        Ok(self.exercise.definition(seed)?)
    }

    /// Rubric of the exercise for a recording (TOML) with the definitions of its metrics; empty if the exercise has no
    /// rubric.
    ///
    /// # Errors
    /// The rubric cannot be written as TOML. A built-in rubric has no such error.
    pub fn rubric(&self) -> anyhow::Result<String> {
        let rubric = Rubric::of(&self.exercise);
        let text = rubric.map(|rubric| rubric.definition()).transpose()?;
        Ok(text.unwrap_or_default())
    }
}

/// Script of an exercise in a scene, with a habit if one is given. `seed` decides the errors of the habit `misreads`.
///
/// # Errors
/// The scene lacks a tooth, tissue or tool of the exercise, the habit does not belong to the exercise, or the exercise
/// is `free`.
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
            "habit `{habit}` needs an exercise with probing, but exercise `{}` has none",
            exercise.name
        );
    }
    if habit == Some(Habit::LetsTongueGo) && exercise.kind != Kind::Bimanual {
        bail!(
            "habit `lets-tongue-go` needs an exercise with a mirror and a probe, but exercise `{}` has no mirror",
            exercise.name
        );
    }
    // Zones of a tooth that the patient lacks are skipped; the warnings name them.
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
        force: task.force_n[0] + AIM * (task.force_n[1] - task.force_n[0]),
        advance: task.step_mm * 1e-3,
        ..TourParams::default()
    };
    if let Some(habit) = habit {
        habit.spoil(&mut params, &mut tour, seed);
    }
    hand(scene, exercise, habit, &tour, params).with_context(|| {
        format!(
            "exercise `{}` cannot be performed in scene `{}`; choose another with --exercise",
            exercise.name, scene.name
        )
    })
}

/// Script for the kind of an exercise.
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
        Kind::Free => bail!("kind is `free`, which no simulated operator performs"),
    })
}

/// The built-in exercise `name`, or the exercise of the file `name` that ends in `.toml`.
///
/// # Errors
/// An unknown name, or a file that cannot be read or is not valid. The message names the file and the field.
pub fn find(name: &str) -> anyhow::Result<Exercise> {
    if name.ends_with(".toml") {
        return Ok(Exercise::open(Path::new(name))?);
    }
    if name == lesson::NAME {
        return Ok(lesson::exercise());
    }
    let found = Exercise::built_in()
        .into_iter()
        .find(|one| one.name == name);
    found.with_context(|| unknown(name))
}

/// Names and descriptions for `--list-exercises`: built-in exercises, then hard cases.
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

/// Compiles the scene of an exercise and makes its operator.
///
/// # Errors
/// An unknown exercise, an invalid scene, a rate that does not fit the scene, or an error of [`script`].
pub fn prepare(asked: &Asked<'_>, steps: &Steps) -> anyhow::Result<Prepared> {
    let (name, habit) = (asked.exercise, asked.habit);
    let mut warnings = Vec::new();
    let mut hard = None;
    let mut patient = String::new();
    let mut exercise = Exercise::free(name, 1.0);
    exercise.task = "This is a hard case of the simulation, not an exercise.".into();
    let (mut scene, script, hand): (Scene, Box<dyn Script + Send>, HandParams) = if let Some(case) =
        name.strip_prefix("hard/")
    {
        let Some(case) = sulcus_cases::find(case) else {
            bail!("{}", unknown(name))
        };
        if asked.scene.is_some() {
            bail!("exercise `{name}` has its own scene: omit --scene");
        }
        if let Some(habit) = habit {
            bail!("habit `{habit}` needs an exercise with probing, but `{name}` is a hard case");
        }
        hard = Some(case);
        // Some cases of the table move the tool without a hand, for exact numbers. In the demo a hand follows the same
        // script.
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
        let script = match name {
            lesson::NAME => lesson::script(&compiled.scene),
            _ => script(&compiled.scene, &exercise, habit, asked.hand_seed)?,
        };
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
            "exercise `{name}` needs {what}, which scene `{}` lacks",
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

/// Sets the rate of `scene`, ticks per second; `None`: no change.
///
/// # Errors
/// The rate is out of range, or a tissue of the scene is not stable at it.
fn at_rate(scene: &mut Scene, rate_hz: Option<u16>) -> anyhow::Result<()> {
    let Some(rate_hz) = rate_hz else {
        return Ok(());
    };
    scene.params.rate_hz = rate_hz;
    scene
        .validate()
        .with_context(|| format!("scene `{}` at {rate_hz} Hz", scene.name))
}

/// Compiles the scene of a file, or without a file the built-in scene `otherwise`. `patient_seed` replaces the seed of
/// a generated patient.
///
/// # Errors
/// The file cannot be read or is not valid. The message names the file and the field.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_that_was_asked_for_holds_and_a_person_is_not_bound_by_the_operators_length() {
        let prepared = |name| prepare(&Asked::of(name), &Steps).expect("an exercise");
        let probing = prepared("probing");
        for is_person in [false, true] {
            assert_eq!(probing.periods(Some(600.0), is_person), 600_000);
        }
        assert_eq!(probing.periods(None, false), probing.ticks);
        assert_eq!(probing.periods(None, true), 86_400_000);
        // A hard case has its own length.
        let hard = prepared("hard/teleport");
        assert_eq!(hard.periods(Some(600.0), true), hard.ticks);
    }
}
