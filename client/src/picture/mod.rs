//! `picture`: an instant of an exercise or of a recording, or a scene at rest, as a PNG file.

mod follower;

use std::path::Path;

use anyhow::{Context, anyhow, bail};
use sulcus_connection::progress::Steps;
use sulcus_core::{NoProbe, Scene, State, TickInput, TickOutput, Workspace, tick};
use sulcus_demo::exercise::{self, Asked};
use sulcus_demo::lockstep::as_sent;
use sulcus_display::Display;
use sulcus_operator::{Operator, Shown};
use sulcus_program::{PathText, say, tell};
use sulcus_scene::BuiltIn;
use sulcus_screen::gpu::{Backend, Drawing, Graphics, Mode, Renderer};
use sulcus_screen::material::Glass;
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;
use sulcus_screen::stage::Stage;
use sulcus_screen::views::View;
use sulcus_sessions::{Exercise, Recording, ReplayOptions, Span, replay_observed};

use crate::cli::PictureArgs;
use follower::Follower;

/// Exercise of a picture without a scene.
const USUAL: &str = "bimanual";

/// Draws the picture and writes the file. Returns the exit code 0.
///
/// # Errors
/// An unknown name, a scene that cannot be compiled, no graphics adapter, or a file that cannot be written.
pub fn run(args: &PictureArgs) -> anyhow::Result<u8> {
    let steps = Steps;
    let named = |error: String| anyhow!(error);
    let view: View = args.view.parse().map_err(named).context("--view")?;
    let quality: Quality = args.quality.parse().map_err(named).context("--quality")?;
    let glass: Glass = args.glass.parse().map_err(named).context("--glass")?;
    let (display, mut moment) = instant(args, &steps)?;
    if args.no_tools {
        for tool in &mut moment.tools {
            tool.held = false;
        }
    }
    let graphics = Graphics::headless(Backend::Any)?;
    tell!("graphics adapter: {}", graphics.name());
    let stage = Stage::new(display.scene(), quality.looks().thinned_um);
    let [width, height] = args.size;
    let aspect = f64::from(width) / f64::from(height);
    let camera = view.camera(display.scene(), &moment, args.tooth, aspect);
    let (turn, tilt) = (args.turn.to_radians(), args.tilt.to_radians());
    let camera = camera.orbited(turn, tilt, 1.0).magnified(args.zoom);
    let triangles = stage.triangles();
    let mut drawing = Drawing::through(camera);
    (drawing.fog, drawing.scratches) = glass.looks();
    let mut renderer = Renderer::new(graphics, stage, quality, Mode::Beauty);
    let image = renderer.picture(&drawing, &moment, args.size)?;
    let png = image.png()?;
    std::fs::write(&args.out, png)
        .with_context(|| format!("--out {}: cannot write", args.out.shown()))?;
    say!(
        "wrote {}: {width} x {height} pixels, {triangles} triangles, {:.3} s in the session",
        args.out.shown(),
        moment.time_s
    );
    Ok(0)
}

/// Returns the display of the scene, and the instant to be drawn.
fn instant(args: &PictureArgs, steps: &Steps) -> anyhow::Result<(Display, Moment)> {
    if let Some(file) = &args.recording {
        return replayed(file, args.at, steps);
    }
    let name = match (&args.exercise, &args.scene) {
        (Some(name), _) => name,
        (None, None) => USUAL,
        (None, Some(file)) => {
            let compiled = exercise::compile(Some(file), BuiltIn::Crown, args.patient_seed, steps)?;
            let display = Display::new(&compiled.scene)?;
            let moment = Moment::rest(display.scene());
            return Ok((display, moment));
        }
    };
    let asked = Asked {
        scene: args.scene.as_deref(),
        patient_seed: args.patient_seed,
        ..Asked::of(name)
    };
    let mut prepared = exercise::prepare(&asked, steps)?;
    let display = Display::new(&prepared.scene)?;
    let bar = steps.bar("performing");
    let ticks = (args.at / prepared.scene.tick_s()).round() as u64;
    let progress = |share| bar.set("performing", share);
    let moment = performed(
        (&prepared.scene, &display),
        &mut prepared.operator,
        &prepared.exercise,
        ticks,
        &progress,
    );
    bar.done();
    Ok((display, moment))
}

/// Performs an exercise up to a tick, and returns the instant after it. Tick 0 is the scene at rest.
fn performed(
    (scene, display): (&Scene, &Display),
    operator: &mut Operator,
    exercise: &Exercise,
    ticks: u64,
    progress: &dyn Fn(f64),
) -> Moment {
    let (mut state, mut workspace) = (State::new(scene), Workspace::new(scene));
    let mut follower = Follower::new(scene, display, exercise);
    let (mut shown, mut input) = (Shown::NOTHING, TickInput::IDLE);
    for k in 1..=ticks {
        input.tools = operator.step(&shown);
        let output = tick(scene, &mut state, &mut workspace, &input, &mut NoProbe);
        shown = as_sent(&output);
        follower.tick(&output, &workspace, k == ticks);
        if k.is_multiple_of(500) {
            progress(k as f64 / ticks as f64);
        }
    }
    follower.moment()
}

/// Replays a recording from its begin up to a time, and returns the last instant.
fn replayed(file: &Path, at_s: f64, steps: &Steps) -> anyhow::Result<(Display, Moment)> {
    let context = || file.shown().to_string();
    let recording = Recording::open(file).with_context(context)?;
    let scene = recording.scene().with_context(context)?;
    let display = Display::new(&scene)?;
    let text = &recording.header().exercise;
    // A recording of no exercise has an empty text: a free session.
    let exercise = Exercise::parse(text).unwrap_or_else(|_| Exercise::free("free", 1.0));
    let last = (at_s / scene.tick_s()).round() as u64;
    let mut follower = Follower::new(&scene, &display, &exercise);
    let options = ReplayOptions {
        span: Span {
            from_s: None,
            to_s: Some(at_s),
        },
        ..ReplayOptions::default()
    };
    let bar = steps.bar("replaying");
    let mut progress = |ticks: u64| bar.set("replaying", ticks as f64 / last.max(1) as f64);
    let mut seen = 0;
    let mut observe = |_: &Scene, _: &TickInput, output: &TickOutput, workspace: &Workspace| {
        seen = output.tick;
        // The grid point at the time itself may be missing.
        follower.tick(output, workspace, output.tick + 20 >= last);
    };
    let report =
        replay_observed(&recording, &options, &mut progress, &mut observe).with_context(context)?;
    bar.done();
    if let Some(tick) = report.first_divergent_tick {
        tell!("warning: the replay differs from tick {tick} on");
    }
    if seen == 0 {
        bail!("{}: no tick was recorded before {at_s} s", file.shown());
    }
    let moment = follower.moment();
    Ok((display, moment))
}
