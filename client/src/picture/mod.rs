//! `picture`: instants of an exercise or of a recording, or a scene at rest, as PNG files.
//!
//! Pictures of a run are drawn in one pass through the session.

mod album;
mod follower;
mod shots;

use std::path::Path;

use anyhow::{Context, bail};
use sulcus_connection::progress::Steps;
use sulcus_core::{NoProbe, Scene, State, TickInput, TickOutput, Workspace, tick};
use sulcus_demo::exercise::{self, Asked};
use sulcus_demo::lockstep::as_sent;
use sulcus_display::Display;
use sulcus_operator::{Operator, Shown};
use sulcus_program::{PathText, tell};
use sulcus_scene::BuiltIn;
use sulcus_screen::gpu::{Backend, Graphics};
use sulcus_screen::moment::Moment;
use sulcus_sessions::{Exercise, Recording, ReplayOptions, Span, replay_observed};

use crate::cli::PictureArgs;
use album::Album;
pub(crate) use follower::Follower;
use shots::Shots;

/// Time behind the end of a recording, seconds, at which its last tick is still drawn: whole seconds are usually asked
/// for.
const BEYOND_S: f64 = 1.0;
/// Exercise of a picture without a scene.
const USUAL: &str = "bimanual";

/// Draws the pictures and writes the files. Returns the exit code 0.
///
/// # Errors
/// An unknown name, a scene that cannot be compiled, no graphics adapter, or a file that cannot be written.
pub fn run(args: &PictureArgs) -> anyhow::Result<u8> {
    let steps = Steps;
    let shots = Shots::of(args)?;
    // Before the replay, which would be in vain without an adapter.
    let graphics = Graphics::headless(Backend::Any)?;
    tell!("graphics adapter: {}", graphics.name());
    if let Some(file) = &args.recording {
        return replayed(file, args, shots, graphics, &steps);
    }
    let name = match (&args.exercise, &args.scene) {
        (Some(name), _) => name,
        (None, None) => USUAL,
        (None, Some(file)) => {
            let compiled =
                exercise::compile(Some(file), BuiltIn::Crown, args.patient_seed, &steps)?;
            let display = Display::new(&compiled.scene)?;
            let mut album = Album::new(args, shots, &display, compiled.scene.tick_s(), graphics)?;
            // Nothing moves, so every time shows the same.
            album.all(&Moment::rest(display.scene()))?;
            return Ok(0);
        }
    };
    let asked = Asked {
        scene: args.scene.as_deref(),
        patient_seed: args.patient_seed,
        ..Asked::of(name)
    };
    let mut prepared = exercise::prepare(&asked, &steps)?;
    let display = Display::new(&prepared.scene)?;
    let album = Album::new(args, shots, &display, prepared.scene.tick_s(), graphics)?;
    let bar = steps.bar("performing");
    let progress = |share| bar.set("performing", share);
    performed(
        (&prepared.scene, &display),
        &mut prepared.operator,
        &prepared.exercise,
        album,
        &progress,
    )?;
    bar.done();
    Ok(0)
}

/// Performs an exercise up to the last picture.
fn performed(
    (scene, display): (&Scene, &Display),
    operator: &mut Operator,
    exercise: &Exercise,
    mut album: Album<'_>,
    progress: &dyn Fn(f64),
) -> anyhow::Result<()> {
    let (mut state, mut workspace) = (State::new(scene), Workspace::new(scene));
    let mut follower = Follower::new(scene, display, exercise);
    let (mut shown, mut input) = (Shown::NOTHING, TickInput::IDLE);
    let last = album.last_tick();
    for k in 1..=last {
        input.tools = operator.step(&shown);
        let output = tick(scene, &mut state, &mut workspace, &input, &mut NoProbe);
        shown = as_sent(&output);
        if let Some(moment) = follower.tick(&output, &workspace, album.is_due(k)) {
            album.tick(k, moment)?;
        }
        if k.is_multiple_of(500) {
            progress(k as f64 / last as f64);
        }
    }
    Ok(())
}

/// Replays a recording from its begin up to the last picture.
fn replayed(
    file: &Path,
    args: &PictureArgs,
    shots: Shots,
    graphics: Graphics,
    steps: &Steps,
) -> anyhow::Result<u8> {
    let context = || file.shown().to_string();
    let recording = Recording::open(file).with_context(context)?;
    let scene = recording.scene().with_context(context)?;
    let display = Display::new(&scene)?;
    let text = &recording.header().exercise;
    // A recording of no exercise has an empty text: a free session.
    let exercise = Exercise::parse(text).unwrap_or_else(|_| Exercise::free("free", 1.0));
    let tick_s = scene.tick_s();
    let mut album = Album::new(args, shots, &display, tick_s, graphics)?;
    let mut follower = Follower::new(&scene, &display, &exercise);
    let last = album.last_tick();
    // A tick of the grid may be missing: the next one serves, or the last one of the recording.
    let end = recording.facts().ticks.map_or(0, |ticks| ticks.1);
    let [last_s, end_s] = [last, end].map(|tick| tick as f64 * tick_s);
    if last_s > end_s + BEYOND_S {
        bail!(
            "{}: a picture is asked for at {last_s:.3} s, expected at most {end_s:.3} s, the end of the recording",
            file.shown()
        );
    }
    let options = ReplayOptions {
        span: Span {
            from_s: None,
            // Half a tick beyond: a product may be rounded to just below the last tick.
            to_s: Some((last as f64 + 0.5) * tick_s),
        },
        ..ReplayOptions::default()
    };
    let bar = steps.bar("replaying");
    let mut progress = |ticks: u64| bar.set("replaying", ticks as f64 / last.max(1) as f64);
    let mut drawn = Ok(());
    let mut observe = |_: &Scene, _: &TickInput, output: &TickOutput, workspace: &Workspace| {
        let now = if output.tick >= end {
            u64::MAX
        } else {
            output.tick
        };
        let due = drawn.is_ok() && album.is_due(now);
        if let Some(moment) = follower.tick(output, workspace, due) {
            drawn = album.tick(now, moment);
        }
    };
    let report =
        replay_observed(&recording, &options, &mut progress, &mut observe).with_context(context)?;
    bar.done();
    drawn?;
    if let Some(tick) = report.first_divergent_tick {
        tell!("warning: the replay differs from tick {tick} on");
    }
    album.is_complete().with_context(context)?;
    Ok(0)
}
