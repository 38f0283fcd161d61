//! `picture`: an instant of an exercise, or a scene at rest, as a PNG file.

use anyhow::{Context, anyhow};
use sulcus_connection::progress::Steps;
use sulcus_core::{NoProbe, Scene, State, TickInput, Workspace, tick};
use sulcus_demo::exercise::{self, Asked};
use sulcus_demo::lockstep::as_sent;
use sulcus_display::{Display, Frames};
use sulcus_operator::{Operator, Shown};
use sulcus_program::{PathText, say, tell};
use sulcus_scene::BuiltIn;
use sulcus_screen::gpu::{Backend, Drawing, Graphics, Mode, Renderer};
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;
use sulcus_screen::stage::Stage;
use sulcus_screen::views::View;
use sulcus_sessions::{Events, Exercise, Moved, Sampler, Shapes};

use crate::cli::PictureArgs;

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
    let (display, mut moment) = instant(args, &steps)?;
    if args.no_tools {
        for tool in &mut moment.tools {
            tool.held = false;
        }
    }
    let graphics = Graphics::headless(Backend::Any)?;
    tell!("graphics adapter: {}", graphics.name());
    let stage = Stage::new(display.scene(), quality.looks().merged_um);
    let [width, height] = args.size;
    let aspect = f64::from(width) / f64::from(height);
    let camera = view.camera(display.scene(), &moment, args.tooth, aspect);
    let (turn, tilt) = (args.turn.to_radians(), args.tilt.to_radians());
    let camera = camera.orbited(turn, tilt, 1.0).magnified(args.zoom);
    let triangles = stage.triangles();
    let mut renderer = Renderer::new(graphics, stage, quality, Mode::Beauty);
    let image = renderer.picture(&Drawing::through(camera), &moment, args.size)?;
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
    let mut events = Events::new(scene, exercise);
    let (mut sampler, mut shapes) = (Sampler::new(scene), Shapes::new(scene));
    let (mut moved, mut frames) = (Moved::new(scene), Frames::new(scene, display));
    let (mut shown, mut input) = (Shown::NOTHING, TickInput::IDLE);
    let mut moment = Moment::rest(display.scene());
    for k in 1..=ticks {
        input.tools = operator.step(&shown);
        let output = tick(scene, &mut state, &mut workspace, &input, &mut NoProbe);
        shown = as_sent(&output);
        for event in events.take(scene, &output, None) {
            frames.occurred(&event);
        }
        if sampler.is_due(output.tick) || k == ticks {
            sampler.read(output.tick, &workspace, &mut shapes);
            moved.follow(&shapes);
        }
        let is_due = frames.is_due(output.tick);
        if k == ticks {
            let frame = frames.frame(display, &output, false, &moved);
            moment = Moment::of(display.scene(), &frame);
        }
        if is_due && k % 512 == 0 {
            progress(k as f64 / ticks as f64);
        }
    }
    moment
}
