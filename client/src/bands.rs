//! `bands`: a lesson in reading the bands of a probe.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, anyhow};
use serde_json::json;
use sulcus_connection::progress::Steps;
use sulcus_demo::exercise;
use sulcus_display::Display;
use sulcus_program::{PathText, say, tell};
use sulcus_proto::display::{DisplayScene, SceneHash};
use sulcus_scene::BuiltIn;
use sulcus_screen::gpu::{Backend, Drawing, Graphics, Mode as Kind, Renderer};
use sulcus_screen::handed::Handed;
use sulcus_screen::material::Glass;
use sulcus_screen::moment::Moment;
use sulcus_screen::panel::{Detail, Mode, PanelState, Primitive, lesson};
use sulcus_screen::quality::Quality;
use sulcus_screen::show::{Act, Show};
use sulcus_screen::stage::Stage;
use sulcus_screen::strings::ENGLISH;
use sulcus_screen::trainer::{Lesson, LessonGrade, Rule, place};
use sulcus_screen::views::View;
use sulcus_screen::window::{self, Settings};

use crate::cli::BandsArgs;

/// Gives the lesson, or writes its pictures. Returns the exit code 0.
///
/// # Errors
/// A rule without this name, a scene without a probe, no display or adapter, or a file that cannot be written.
pub fn run(args: &BandsArgs) -> anyhow::Result<u8> {
    let names = Rule::ALL.map(Rule::name).join(", ");
    let rule = Rule::from_name(&args.rule).with_context(|| {
        format!(
            "--rule: `{}` is no rule, expected one of: {names}",
            args.rule
        )
    })?;
    let compiled = exercise::compile(args.scene.as_deref(), BuiltIn::Mouth, None, &Steps)?;
    let display = Display::new(&compiled.scene)?;
    let scene = Arc::new(display.scene().clone());
    let probe = scene.tools.iter().find(|tool| !tool.bands.is_empty());
    let bands = probe.map(|probe| probe.bands.clone()).unwrap_or_default();
    let tasks = Lesson::new(&bands, rule, args.seed, usize::from(args.count))
        .with_context(|| format!("scene `{}`", compiled.scene.name))?;
    match &args.pictures {
        Some(folder) => pictures(args, &scene, tasks, folder)?,
        None => in_a_window(args, scene, display.hash(), tasks)?,
    }
    Ok(0)
}

/// Lesson behind a window.
struct Taught {
    scene: Arc<DisplayScene>,
    hash: SceneHash,
    lesson: Lesson,
    /// Result for the program, after the window.
    ended: std::sync::mpsc::Sender<Lesson>,
}

impl Show for Taught {
    fn scene(&mut self) -> Option<(SceneHash, Arc<DisplayScene>)> {
        Some((self.hash, self.scene.clone()))
    }

    fn moment(&mut self) -> Option<(Moment, f64)> {
        let number = self.lesson.answers().len();
        // After the last answer its own picture stays.
        let last = || {
            self.lesson
                .answers()
                .last()
                .map(|answer| (answer.task, number - 1))
        };
        let (task, number) = self
            .lesson
            .task()
            .map(|task| (task, number))
            .or_else(last)?;
        Some((place::moment(&self.scene, task, number)?, 0.0))
    }

    fn panel(&mut self, _: Detail) -> PanelState {
        PanelState::default()
    }

    fn overlay(&mut self, window: [u32; 2], scale: f32) -> Option<Vec<Primitive>> {
        Some(lesson(&self.lesson, Mode::Practice, window, scale, &ENGLISH).list)
    }

    fn act(&mut self, act: Act) {
        if let Act::Reading(key) = act {
            self.lesson.press(key);
        }
    }

    fn is_over(&mut self) -> bool {
        false
    }
}

impl Drop for Taught {
    fn drop(&mut self) {
        // The program waits for it, unless it has ended with an error.
        let _ = self.ended.send(self.lesson.clone());
    }
}

fn in_a_window(
    args: &BandsArgs,
    scene: Arc<DisplayScene>,
    hash: SceneHash,
    lesson: Lesson,
) -> anyhow::Result<()> {
    let (ended, result) = std::sync::mpsc::channel();
    let settings = Settings {
        title: "Sulcus: bands".into(),
        view: View::CloseUp,
        quality: None,
        has_real_time: true,
        mirrored: false,
        glass: Glass::Clean,
        hand: Handed::Right,
        pedal: None,
    };
    let taught = Taught {
        scene,
        hash,
        lesson,
        ended,
    };
    let report = window::run(Box::new(taught), settings)?;
    if let Some(why) = report.failed {
        tell!("warning: the window has ended: {why}");
    }
    tell_grade(args, &result.recv().context("the window left no lesson")?);
    Ok(())
}

/// Prints the result of a lesson.
fn tell_grade(args: &BandsArgs, lesson: &Lesson) {
    let grade = lesson.grade();
    if args.json {
        let answers: Vec<_> = lesson
            .answers()
            .iter()
            .map(|answer| answer.data())
            .collect();
        let right = grade.as_ref().map(|grade| grade.right);
        let mean = grade.as_ref().map(|grade| grade.mean_error_mm);
        return say!(
            "{}",
            json!({ "right": right, "mean_error_mm": mean, "answers": answers })
        );
    }
    match grade {
        None => say!("no answer was given"),
        Some(LessonGrade {
            answers,
            right,
            mean_error_mm,
            ..
        }) => say!(
            "{answers} of {} tasks answered, {:.0} % right, {mean_error_mm:+.2} mm on average (rule {})",
            lesson.len(),
            100.0 * right,
            lesson.rule().name()
        ),
    }
}

/// Writes a picture for each task, and the right answers.
fn pictures(
    args: &BandsArgs,
    scene: &DisplayScene,
    mut lesson: Lesson,
    folder: &Path,
) -> anyhow::Result<()> {
    let context = || format!("--pictures {}: cannot write", folder.shown());
    std::fs::create_dir_all(folder).with_context(context)?;
    let graphics = Graphics::headless(Backend::Any)?;
    let mut renderer = Renderer::new(graphics, Stage::new(scene, 0), Quality::Full, Kind::Beauty);
    let [width, height] = args.size;
    let mut tasks = Vec::new();
    while let Some(task) = lesson.task() {
        let number = lesson.answers().len();
        let moment = place::moment(scene, task, number)
            .ok_or_else(|| anyhow!("the scene has no gingiva with sites, or no probe"))?;
        let camera =
            View::CloseUp.camera(scene, &moment, None, f64::from(width) / f64::from(height));
        let image = renderer.picture(&Drawing::through(camera), &moment, args.size)?;
        let file = format!("{:02}.png", number + 1);
        std::fs::write(folder.join(&file), image.png()?).with_context(context)?;
        let right = lesson.rule().whole_mm(task.tenths);
        lesson.answer(right);
        tasks.push(json!({ "picture": file, "shown_mm": f64::from(task.tenths) / 10.0, "right_mm": right }));
    }
    let text = json!({ "rule": lesson.rule().name(), "seed": args.seed, "tasks": tasks });
    std::fs::write(folder.join("tasks.json"), format!("{text:#}\n")).with_context(context)?;
    say!(
        "wrote {} pictures and tasks.json into {}",
        tasks.len(),
        folder.shown()
    );
    Ok(())
}
