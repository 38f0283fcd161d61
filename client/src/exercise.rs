//! What the demo can perform: the scene and the script of an exercise.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, bail};
use sulcus_cases::Case;
use sulcus_cases::table::Driver;
use sulcus_core::Scene;
use sulcus_core::optimise::SolverKind;
use sulcus_operator::crown::{Crown, CrownParams};
use sulcus_operator::{HandParams, Operator, Script};

use crate::progress::Steps;

/// An exercise ready to run.
pub struct Prepared {
    /// Name, as on the command line.
    pub name: String,
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

/// Names for `--list-exercises`, with what each is about.
pub fn list() -> Vec<(String, &'static str)> {
    let mut names = vec![(
        "crown".to_owned(),
        "the probe is led round the crown of a tooth, pressed lightly, lifted now and then",
    )];
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
                Driver::Kinematic(script) => ((case.scene)(), script(), HandParams::default()),
                Driver::Closed(script, hand) => ((case.scene)(), script(), hand()),
            }
        } else if name == "crown" {
            let compiled = compile(scene_file, steps)?;
            warnings = compiled.warnings;
            let params = CrownParams {
                duration: duration_s,
                ..CrownParams::default()
            };
            let script = Crown::new(&compiled.scene, None, params)?;
            (compiled.scene, Box::new(script), HandParams::default())
        } else {
            bail!("{}", unknown(name));
        };
    scene.params.solver = solver;
    let scene_bytes = scene
        .to_bytes()
        .context("the scene cannot be written as bytes")?;
    let operator = Operator::new(script, hand, seed);
    Ok(Prepared {
        name: name.to_owned(),
        scene: Arc::new(scene),
        scene_bytes: Arc::new(scene_bytes),
        ticks: operator.ticks(),
        operator,
        case: hard,
        warnings,
    })
}

/// The scene of a file, or the built-in one.
///
/// # Errors
/// When the file cannot be used; the message says what and where.
pub fn compile(scene_file: Option<&Path>, steps: &Steps) -> anyhow::Result<sulcus_scene::Compiled> {
    let options = sulcus_scene::BuildOptions {
        cache: sulcus_scene::default_cache_dir(),
        ..Default::default()
    };
    let bar = steps.bar("building the scene");
    let progress = |what: &str, share: f64| bar.set(what, share);
    let compiled = match scene_file {
        Some(file) => sulcus_scene::compile_file(file, &options, &progress)?,
        None => sulcus_scene::compile_default(&options, &progress)?,
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
