//! What the demo can perform: the scene and the script of an exercise.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, bail};
use sulcus_cases::Case;
use sulcus_cases::table::Driver;
use sulcus_core::Scene;
use sulcus_core::optimise::SolverKind;
use sulcus_operator::crown::{Crown, CrownParams};
use sulcus_operator::probing::{Probing, ProbingParams};
use sulcus_operator::retraction::{Retraction, RetractionParams};
use sulcus_operator::{HandParams, Operator, Script};
use sulcus_scene::BuiltIn;

use crate::progress::Steps;

/// An exercise ready to run.
pub struct Prepared {
    /// Name, as on the command line.
    pub name: String,
    /// What the student is told.
    pub task: &'static str,
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
    pub fn definition(&self, seed: u64) -> String {
        format!(
            "name = {:?}\nseed = {seed}\nduration_s = {}\n",
            self.name,
            self.ticks as f64 * sulcus_core::TICK_S
        )
    }
}

/// An exercise for students.
struct Lesson {
    name: &'static str,
    about: &'static str,
    task: &'static str,
    /// Scene when none is named.
    scene: BuiltIn,
    /// Its script for a length in seconds.
    script: fn(&Scene, f64) -> anyhow::Result<Box<dyn Script + Send>>,
}

const LESSONS: [Lesson; 3] = [
    Lesson {
        name: "crown",
        about: "the probe is led round the crown of a tooth, pressed lightly, lifted now and then",
        task: "Lead the tip of the probe round the crown, with a light hand.",
        scene: BuiltIn::Crown,
        script: |scene, duration| {
            let params = CrownParams {
                duration,
                ..CrownParams::default()
            };
            Ok(Box::new(Crown::new(scene, None, params)?))
        },
    },
    Lesson {
        name: "probing",
        about: "the buccal pocket of one tooth is probed in a walking stroke, three sites read at 0.2 N",
        task: "Probe the buccal side: along the tooth to the floor, 0.2 N, read, walk on.",
        scene: BuiltIn::Pocket,
        script: |scene, duration| {
            let params = ProbingParams {
                duration,
                ..ProbingParams::default()
            };
            Ok(Box::new(Probing::new(scene, None, params)?))
        },
    },
    Lesson {
        name: "retraction",
        about: "the mouth mirror presses the tongue, pushes it aside, holds it, slides along and lets go",
        task: "Hold the tongue aside with the mirror, gently, and let it go again.",
        scene: BuiltIn::Tongue,
        script: |scene, duration| {
            let params = RetractionParams {
                duration,
                ..RetractionParams::default()
            };
            Ok(Box::new(Retraction::new(scene, params)?))
        },
    },
];

/// Names for `--list-exercises`, with what each is about.
pub fn list() -> Vec<(String, &'static str)> {
    let mut names: Vec<(String, &'static str)> = LESSONS
        .iter()
        .map(|lesson| (lesson.name.to_owned(), lesson.about))
        .collect();
    names.extend(
        sulcus_cases::TABLE
            .iter()
            .map(|case| (format!("hard/{}", case.name), case.about)),
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
    duration_s: f64,
    seed: u64,
    solver: SolverKind,
    steps: &Steps,
) -> anyhow::Result<Prepared> {
    let mut warnings = Vec::new();
    let mut hard = None;
    let mut task = "Hold on: this is a hard case, not an exercise.";
    let (mut scene, script, hand): (Scene, Box<dyn Script + Send>, HandParams) =
        if let Some(case) = name.strip_prefix("hard/") {
            let Some(case) = sulcus_cases::find(case) else {
                bail!("{}", unknown(name))
            };
            if scene_file.is_some() {
                bail!("exercise `{name}` brings its own scene: leave --scene out");
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
            let Some(lesson) = LESSONS.iter().find(|lesson| lesson.name == name) else {
                bail!("{}", unknown(name))
            };
            task = lesson.task;
            let compiled = compile(scene_file, lesson.scene, steps)?;
            warnings = compiled.warnings;
            let script = (lesson.script)(&compiled.scene, duration_s)?;
            (compiled.scene, script, HandParams::default())
        };
    scene.params.solver = solver;
    let scene_bytes = scene
        .to_bytes()
        .context("the scene cannot be written as bytes")?;
    let operator = Operator::new(script, hand, seed);
    Ok(Prepared {
        name: name.to_owned(),
        task,
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
