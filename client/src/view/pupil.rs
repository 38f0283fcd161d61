//! First lesson in a window: the session of the exercise `lesson`, with its steps beside the picture.

use std::sync::Arc;

use sulcus_core::math::norm;
use sulcus_proto::display::{DisplayScene, SceneHash};
use sulcus_screen::camera::Vector;
use sulcus_screen::first::{FirstLesson, Seen, Step};
use sulcus_screen::hand::Shared;
use sulcus_screen::moment::Moment;
use sulcus_screen::panel::{Detail, Mode, PanelState, Primitive, lesson};
use sulcus_screen::show::{Act, SCREEN, Show, Wanted};
use sulcus_screen::strings::{ENGLISH, fill};
use sulcus_screen::text::{TextSize, Weight, wrap};
use sulcus_screen::trainer::{BAND_READ, Lesson, Rule, place};
use sulcus_screen::views::View;

use super::live::Live;

/// Number of questions of a series, and the seed of the first series. A beginner needs one right answer.
const QUESTIONS: usize = 50;
const SEED: u64 = 1;

/// Largest number of rows of a task in the picture.
const TASK_ROWS: usize = 4;
/// White of the panel.
const WHITE: [u8; 4] = [255; 4];

/// Session of a first lesson.
pub struct Pupil {
    live: Live,
    /// Lesson and its questions; `None` before the first scene.
    begun: Option<(FirstLesson, Lesson)>,
    /// Step that was finished last.
    finished: Option<Step>,
    wanted: Option<Wanted>,
    tick: u64,
    /// Number of series of questions that have begun.
    series: u64,
}

impl Pupil {
    /// Lesson in a session.
    pub fn new(live: Live) -> Self {
        Self {
            live,
            begun: None,
            finished: None,
            wanted: Some(view_of(Some(Step::Hold))),
            tick: 0,
            series: 0,
        }
    }

    fn step(&self) -> Option<Step> {
        self.begun.as_ref().and_then(|(first, _)| first.step())
    }

    fn begin(&mut self, scene: &DisplayScene) {
        // After a series without a right answer the next one begins.
        let has_more = |(_, questions): &(FirstLesson, Lesson)| questions.task().is_some();
        if self.begun.as_ref().is_some_and(has_more) {
            return;
        }
        let probe = scene.tools.iter().find(|tool| !tool.bands.is_empty());
        let bands = probe.map(|probe| &*probe.bands).unwrap_or_default();
        let seed = SEED + self.series;
        let questions = Lesson::new(bands, Rule::NearestHalfUp, seed, QUESTIONS).ok();
        self.series += 1;
        let begun = self.begun.take().map(|(first, _)| first);
        self.begun = begun.or_else(|| FirstLesson::new(scene)).zip(questions);
    }

    fn see(&mut self, scene: &DisplayScene, moment: &Moment) {
        let glance = self.live.glance();
        let slot = scene.tools.iter().position(|tool| !tool.bands.is_empty());
        let (Some(glance), Some(slot), Some((first, _))) = (glance, slot, &mut self.begun) else {
            return;
        };
        let ticks = glance.tick.saturating_sub(self.tick);
        self.tick = glance.tick;
        // A pause or a lost link is no time of practice.
        let dt_s = (ticks as f64 * scene.tick_ns as f64 / 1e9).min(0.1);
        let force_n = norm(&glance.displayed[slot].force);
        let done = first.see(&Seen::of(scene, moment, force_n, dt_s));
        self.finish(done);
    }

    /// Title of the lesson, and its present task behind the confirmation of the step before.
    fn words(&self) -> Option<[String; 2]> {
        let (first, _) = self.begun.as_ref()?;
        let words = &ENGLISH.first;
        let number = |step: Step| step as usize;
        let done = self.finished.map(|step| words.done[number(step)]);
        let task = match first.step() {
            Some(Step::Touch) if first.is_heavy() => words.heavy,
            Some(Step::Touch) if first.may_lift() => words.lift,
            Some(step) => words.tasks[number(step)],
            None => words.ended,
        };
        let count = Step::ALL.len();
        let present = first.step().map_or(count, |step| number(step) + 1);
        let [present, count] = [present, count].map(|n| n.to_string());
        let title = fill(words.title, &[&present, &count]);
        let task = done.into_iter().chain([task]).collect::<Vec<_>>().join(" ");
        Some([title, task])
    }

    fn finish(&mut self, done: Option<Step>) {
        let Some(step) = done else { return };
        let json = serde_json::json!({ "lesson": step.name() }).to_string();
        self.live.say(SCREEN, json);
        self.finished = Some(step);
        self.wanted = Some(view_of(self.step()));
    }
}

/// View of a step. `None`: the end of the lesson.
fn view_of(step: Option<Step>) -> Wanted {
    let (view, zoom) = match step {
        // The probe rests some centimetres above the tooth.
        Some(Step::Hold) => (View::Buccal, 0.4),
        Some(Step::Read) => (View::CloseUp, 1.0),
        _ => (View::Buccal, 1.0),
    };
    Wanted {
        view,
        tooth: None,
        zoom,
    }
}

impl Show for Pupil {
    fn scene(&mut self) -> Option<(SceneHash, Arc<DisplayScene>)> {
        let (hash, scene) = self.live.scene()?;
        self.begin(&scene);
        Some((hash, scene))
    }

    fn moment(&mut self) -> Option<(Moment, f64)> {
        let (_, scene) = self.scene()?;
        let (moment, age_s) = self.live.moment()?;
        self.see(&scene, &moment);
        let question = self.begun.as_ref().map(|(_, questions)| questions);
        let question = question.filter(|_| self.step() == Some(Step::Read));
        let asked = question.and_then(|questions| {
            place::moment(&scene, questions.task()?, questions.answers().len())
        });
        Some((asked.unwrap_or(moment), age_s))
    }

    fn panel(&mut self, detail: Detail) -> PanelState {
        let mut state = self.live.panel(detail);
        if let Some(words) = self.words() {
            [state.help.title, state.help.task] = words;
        }
        state
    }

    fn overlay(&mut self, window: [u32; 2], scale: f32) -> Option<Vec<Primitive>> {
        // The session draws nothing of its own there, and tells the size.
        self.live.overlay(window, scale);
        let (first, questions) = self.begun.as_ref()?;
        if first.step() != Some(Step::Read) {
            return None;
        }
        let panel = lesson(questions, Mode::Practice, window, scale, &ENGLISH);
        let mut list = panel.list;
        // The question takes the place of the panel, so the step is named in the picture.
        let [title, task] = self.words()?;
        let size = TextSize::at_most(16.0 * scale);
        let row = 1.25 * size.height();
        let columns = size.columns(panel.free.width() - 2.0 * row);
        let lines = [vec![title], wrap(&task, columns, TASK_ROWS)].concat();
        for (k, text) in lines.into_iter().enumerate() {
            list.push(Primitive::Glyphs {
                at: [row, row * (k as f32 + 0.5)],
                size,
                weight: Weight::Bold,
                text,
                rgba: WHITE,
            });
        }
        Some(list)
    }

    fn mark(&mut self) -> Option<Vector> {
        let (first, _) = self.begun.as_ref()?;
        (first.step() == Some(Step::Hold)).then(|| first.mark())
    }

    fn act(&mut self, act: Act) {
        let (Act::Reading(key), Some(Step::Read)) = (act, self.step()) else {
            return self.live.act(act);
        };
        let Some((first, questions)) = &mut self.begun else {
            return;
        };
        if let Some(answer) = questions.press(key) {
            let done = first.answered(answer.error_mm() == 0);
            self.live.say(BAND_READ, answer.json());
            self.finish(done);
        }
    }

    fn hands(&self) -> Option<Arc<Shared>> {
        self.live.hands()
    }

    fn wanted_view(&mut self) -> Option<Wanted> {
        self.wanted.take()
    }

    fn is_over(&mut self) -> bool {
        self.live.is_over()
    }
}
