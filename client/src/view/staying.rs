//! Window that stays after its session: the end page, and the worst finding in a loop.
//!
//! The page shows a grade after practice alone. After an exam the page says that the session has ended,
//! and in self-assessment that the own score comes first.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender};
use std::time::Instant;

use sulcus_connection::interrupt;
use sulcus_demo::seat::Ending;
use sulcus_program::tell;
use sulcus_proto::TOOLS;
use sulcus_proto::display::{DisplayScene, SceneHash};
use sulcus_screen::hand::Shared;
use sulcus_screen::moment::{Moment, ToolAt};
use sulcus_screen::panel::{self, Detail, End, PanelState, Primitive};
use sulcus_screen::show::{Act, Show, Wanted};
use sulcus_screen::strings::ENGLISH;
use sulcus_screen::views::View;
use sulcus_sessions::Mode;

use super::live::Live;
use super::replay::Replay;

/// Age of a replayed frame, seconds: no state of a running session.
const REPLAYED_S: f64 = 1e9;

/// Page after a session.
pub struct Page {
    end: End,
    /// Loop of the worst finding, with its view and tooth.
    replay: Option<(Replay, View, u8)>,
}

/// Sends the pages of an ending to the window. Called on the thread of the session.
pub fn send(ending: &Ending<'_>, to: &Sender<Page>) {
    let mut page = Page {
        end: of(ending),
        replay: None,
    };
    if let (
        End::Graded { .. },
        Ending::Replayed {
            recording, worst, ..
        },
    ) = (&page.end, ending)
        && let Some(worst) = worst
    {
        // The grade shows while the loop is made.
        let early = Page {
            end: page.end.clone(),
            replay: None,
        };
        let _ = to.send(early);
        let view = worst.view.parse().unwrap_or(View::CloseUp);
        match Replay::around(recording, worst.tick) {
            Ok(replay) => page.replay = Some((replay, view, worst.tooth)),
            Err(error) => tell!("warning: the finding is not replayed: {error:#}"),
        }
    }
    // A closed window needs no page.
    let _ = to.send(page);
}

/// Content of the page.
fn of(ending: &Ending<'_>) -> End {
    match ending {
        Ending::Replaying => End::Replaying,
        Ending::Elsewhere(mode) if *mode == Mode::Exam.name() => End::Silent,
        Ending::Elsewhere(_) => End::Elsewhere,
        Ending::Replayed {
            mode: Mode::Exam, ..
        } => End::Silent,
        Ending::Replayed {
            mode: Mode::SelfAssessment,
            ..
        } => End::OwnScoreFirst,
        Ending::Replayed {
            mode: Mode::Practice,
            grade,
            worst,
            ..
        } => End::Graded {
            score: grade.and_then(|grade| grade.score),
            passed: grade.and_then(|grade| grade.passed) == Some(true),
            advice: grade.map_or(Vec::new(), |grade| {
                let texts = grade.advice.iter().map(|advice| advice.text.clone());
                texts.collect()
            }),
            finding: worst.map(|worst| worst.words(&worst.tooth.to_string())),
        },
    }
}

/// Session whose window stays at its end.
pub struct Staying {
    live: Live,
    pages: Receiver<Page>,
    page: Option<Page>,
    /// Begin of the loop.
    begun: Instant,
    wanted: Option<Wanted>,
    over: Arc<AtomicBool>,
    /// For a session by mouse: ends the session.
    ends: Option<Arc<AtomicBool>>,
    left: bool,
}

impl Staying {
    /// Session with the pages of its end. `over` tells that the thread of the session has ended. `ends` ends a session
    /// by mouse.
    pub fn new(
        live: Live,
        pages: Receiver<Page>,
        over: Arc<AtomicBool>,
        ends: Option<Arc<AtomicBool>>,
    ) -> Self {
        Self {
            live,
            pages,
            page: None,
            begun: Instant::now(),
            wanted: None,
            over,
            ends,
            left: false,
        }
    }

    fn take_pages(&mut self) {
        while let Ok(page) = self.pages.try_recv() {
            if let Some((_, view, tooth)) = &page.replay {
                self.wanted = Some(Wanted {
                    view: *view,
                    tooth: Some(*tooth),
                    zoom: 1.0,
                });
                self.begun = Instant::now();
            }
            self.page = Some(page);
        }
    }

    fn replay(&self) -> Option<&Replay> {
        let (replay, _, _) = self.page.as_ref()?.replay.as_ref()?;
        Some(replay)
    }
}

impl Show for Staying {
    fn scene(&mut self) -> Option<(SceneHash, Arc<DisplayScene>)> {
        if let Some(replay) = self.replay() {
            return Some((replay.hash, replay.scene.clone()));
        }
        self.live.scene()
    }

    fn moment(&mut self) -> Option<(Moment, f64)> {
        if let Some(replay) = self.replay() {
            let elapsed_s = self.begun.elapsed().as_secs_f64();
            return Some((replay.moment(elapsed_s), REPLAYED_S));
        }
        self.live.moment()
    }

    fn panel(&mut self, detail: Detail) -> PanelState {
        self.live.panel(detail)
    }

    fn overlay(&mut self, window: [u32; 2], scale: f32) -> Option<Vec<Primitive>> {
        let Some(page) = &self.page else {
            return self.live.overlay(window, scale);
        };
        Some(panel::end(&page.end, window, scale, &ENGLISH).list)
    }

    fn ghosts(&mut self) -> [Option<ToolAt>; TOOLS] {
        if self.page.is_some() {
            return [None; TOOLS];
        }
        self.live.ghosts()
    }

    fn act(&mut self, act: Act) {
        match (&self.page, act) {
            (Some(_), Act::Pause) => self.left = true,
            // The session takes no more acts.
            (Some(_), _) => {}
            (None, act) => self.live.act(act),
        }
    }

    fn hands(&self) -> Option<Arc<Shared>> {
        self.live.hands()
    }

    fn wanted_view(&mut self) -> Option<Wanted> {
        self.wanted.take()
    }

    fn hands_are_done(&self) -> bool {
        self.page.is_some()
    }

    fn leaves(&mut self) -> bool {
        let ends = self.ends.take();
        match ends.filter(|_| self.page.is_none()) {
            // The first time ends a session by mouse, and the window shows its end.
            Some(ends) => {
                ends.store(true, Ordering::Release);
                false
            }
            None => true,
        }
    }

    fn is_over(&mut self) -> bool {
        // Read before the pages: the last page is sent before the flag is set.
        let is_over = self.over.load(Ordering::Acquire);
        self.take_pages();
        let is_last = !matches!(
            &self.page,
            None | Some(Page {
                end: End::Replaying,
                ..
            })
        );
        self.left || is_over && (!is_last || interrupt::asked())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use sulcus_core::tissue::gingiva::Site;
    use sulcus_sessions::pages::instants;

    #[test]
    fn only_practice_shows_a_finding() {
        let worst = instants::Instant {
            tooth: 36,
            site: Site::Buccal,
            tick: 1,
            view: "close-up",
            says: "the tip stood here.".into(),
        };
        let replayed = |mode| Ending::Replayed {
            recording: Path::new("a.mcap"),
            mode,
            grade: None,
            worst: Some(&worst),
        };
        assert_eq!(of(&replayed(Mode::Exam)), End::Silent);
        assert_eq!(of(&replayed(Mode::SelfAssessment)), End::OwnScoreFirst);
        let End::Graded { finding, score, .. } = of(&replayed(Mode::Practice)) else {
            panic!("no grade")
        };
        let words = "36 buccal: the tip stood here.";
        assert_eq!((finding.as_deref(), score), (Some(words), None));
        assert_eq!(of(&Ending::Elsewhere("exam")), End::Silent);
        assert_eq!(of(&Ending::Elsewhere("practice")), End::Elsewhere);
        // No replay is begun for a page without a finding: the file does not exist.
        let (to, pages) = std::sync::mpsc::channel();
        send(&replayed(Mode::Exam), &to);
        let sent: Vec<Page> = pages.try_iter().collect();
        assert!(sent.len() == 1 && sent[0].replay.is_none());
    }
}
