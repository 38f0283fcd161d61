//! Entries of the corpus: exercises and hard cases, with scene, operator and disturbance of the input.

use anyhow::Context;
use sulcus_cases::table::Driver;
use sulcus_connection::progress::Steps;
use sulcus_core::optimise::SolverKind;
use sulcus_core::{Scene, TickInput};
use sulcus_demo::exercise;
use sulcus_operator::{HandParams, Operator};
use sulcus_scene::BuiltIn;
use sulcus_sessions::Exercise;

use crate::cut;

/// Source of one recording.
pub struct Entry {
    /// Name of the file, without its ending.
    pub name: &'static str,
    /// Name of the exercise, or `hard/NAME`.
    pub exercise: &'static str,
    /// Makes the scene.
    pub scene: fn() -> anyhow::Result<Scene>,
    /// Length of the performance, seconds. A hard case ignores this field and has its own length.
    pub performed_s: f64,
    /// Largest number of ticks recorded.
    pub ticks: u64,
    /// Disturbs the input of a tick as an instructor or the network does. The number of the tick counts from 0.
    pub disturb: fn(u64, &mut TickInput),
}

const fn exercise(
    name: &'static str,
    scene: fn() -> anyhow::Result<Scene>,
    performed_s: f64,
) -> Entry {
    Entry {
        name,
        exercise: name,
        scene,
        performed_s,
        ticks: 1200,
        disturb: |_, _| {},
    }
}

macro_rules! hard {
    ($($name:literal)*) => {
        [$(Entry {
            name: concat!("hard-", $name),
            exercise: concat!("hard/", $name),
            scene: || {
                let case = sulcus_cases::find($name).context("no such case")?;
                cut::small((case.scene)(), |_| true, false)
            },
            performed_s: 0.0,
            ticks: 800,
            disturb: |_, _| {},
        }),*]
    };
}

const EXERCISES: [Entry; 7] = [
    exercise("crown", || built_in(BuiltIn::Crown), 20.0),
    exercise("probing", || built_in(BuiltIn::Pocket), 20.0),
    exercise("retraction", || built_in(BuiltIn::Tongue), 20.0),
    exercise("bimanual", one_tooth, 30.0),
    Entry {
        name: "commands",
        disturb: commands,
        ..exercise("crown", || built_in(BuiltIn::Crown), 10.0)
    },
    Entry {
        name: "crown-2khz",
        ..exercise("crown", fast, 10.0)
    },
    Entry {
        name: "crown-judged",
        ..exercise("crown", judged, 10.0)
    },
];

const HARD: [Entry; 8] = hard![
    "wedge" "peg-in-hole" "infeasible" "thin-plate-0.3mm-2" "nan-poses" "two-probes" "tongue-teleport" "pocket-flicker"
];

/// All entries.
pub const ENTRIES: [&Entry; 15] = {
    let mut all = [&EXERCISES[0]; 15];
    let mut k = 0;
    while k < 15 {
        all[k] = if k < 7 { &EXERCISES[k] } else { &HARD[k - 7] };
        k += 1;
    }
    all
};

/// Disturbance of the input with a period of 600 ticks: a pause, a force limit, skipped ticks, a stale and an absent
/// tool.
fn commands(tick: u64, input: &mut TickInput) {
    let k = tick % 600;
    input.paused = (50..100).contains(&k);
    input.force_limit_n = if (200..300).contains(&k) { 0.08 } else { 0.0 };
    input.skipped = if k == 350 { 3 } else { 0 };
    input.tools[0].stale = (400..430).contains(&k);
    input.tools[0].age_ticks = if input.tools[0].stale { 60 } else { 0 };
    input.tools[0].present &= !(500..520).contains(&k);
}

fn built_in(which: BuiltIn) -> anyhow::Result<Scene> {
    let scene = exercise::compile(None, which, None, &Steps)?.scene;
    cut::small(scene, |_| true, false)
}

/// Scene of the exercise `crown` at 2000 ticks per second.
fn fast() -> anyhow::Result<Scene> {
    let mut scene = built_in(BuiltIn::Crown)?;
    scene.params.rate_hz = 2000;
    Ok(scene)
}

/// Scene of the exercise `crown` with the solver Clarabel.
fn judged() -> anyhow::Result<Scene> {
    let mut scene = built_in(BuiltIn::Crown)?;
    scene.params.solver = SolverKind::Clarabel;
    Ok(scene)
}

/// Part of the whole mouth: tooth 36, with which the exercise `bimanual` begins, its gingiva, and the tongue.
fn one_tooth() -> anyhow::Result<Scene> {
    let scene = exercise::compile(None, BuiltIn::Mouth, None, &Steps)?.scene;
    cut::small(
        scene,
        |object| object.fdi == 36 || object.name == "tongue",
        true,
    )
}

impl Entry {
    /// Exercise with the length of the performance. A hard case is a free exercise.
    ///
    /// # Errors
    /// The name of the exercise is unknown.
    pub fn definition(&self) -> anyhow::Result<Exercise> {
        if self.exercise.starts_with("hard/") {
            return Ok(Exercise::free(self.exercise, 1.0));
        }
        let mut exercise = exercise::find(self.exercise)?;
        exercise.duration_s = self.performed_s;
        Ok(exercise)
    }

    /// Operator that performs the entry in `scene`.
    ///
    /// # Errors
    /// The name is unknown, or the scene lacks a tooth, tissue or tool of the exercise.
    pub fn operator(&self, scene: &Scene) -> anyhow::Result<Operator> {
        let (script, hand) = match self.exercise.strip_prefix("hard/") {
            Some(case) => match sulcus_cases::find(case).context("no such case")?.driver {
                Driver::Kinematic(script) => (script(scene), HandParams::default()),
                Driver::Closed(script, hand) => (script(scene), hand()),
            },
            None => {
                let script = exercise::script(scene, &self.definition()?, None, 1)?;
                (script, HandParams::default())
            }
        };
        let hand = HandParams {
            period_s: scene.tick_s(),
            ..hand
        };
        Ok(Operator::new(script, hand, 1))
    }

    /// Disturbs the input of a tick: first as the hard case, then as the entry demands. `tick` counts from 0.
    pub fn disturb(&self, tick: u64, input: &mut TickInput) {
        if let Some(case) = self
            .exercise
            .strip_prefix("hard/")
            .and_then(sulcus_cases::find)
        {
            (case.disturb)(tick, input);
        }
        (self.disturb)(tick, input);
    }
}
