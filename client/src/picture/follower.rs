//! Follower of ticks: keeps the shapes, and makes the instants of pictures.

use sulcus_core::{Scene, TickOutput, Workspace};
use sulcus_display::{Display, Frames};
use sulcus_screen::moment::Moment;
use sulcus_sessions::{Events, Exercise, Moved, Sampler, Shapes};

/// Follower of one session, from its first tick on.
pub struct Follower<'a> {
    scene: &'a Scene,
    display: &'a Display,
    events: Events,
    sampler: Sampler,
    shapes: Shapes,
    moved: Moved,
    frames: Frames,
    moment: Moment,
}

impl<'a> Follower<'a> {
    /// Follower of a session of `exercise` in `scene`.
    pub fn new(scene: &'a Scene, display: &'a Display, exercise: &Exercise) -> Self {
        Self {
            scene,
            display,
            events: Events::new(scene, exercise),
            sampler: Sampler::new(scene),
            shapes: Shapes::new(scene),
            moved: Moved::new(scene),
            frames: Frames::new(scene, display),
            moment: Moment::rest(display.scene()),
        }
    }

    /// Takes a tick. `is_shown`: the tick has a picture. Its instant is returned.
    pub fn tick(
        &mut self,
        output: &TickOutput,
        workspace: &Workspace,
        is_shown: bool,
    ) -> Option<&Moment> {
        for event in self.events.take(self.scene, output, None) {
            self.frames.occurred(&event);
        }
        if self.sampler.is_due(output.tick) || is_shown {
            self.sampler.read(output.tick, workspace, &mut self.shapes);
            self.moved.follow(&self.shapes);
        }
        if is_shown {
            let frame = self.frames.frame(self.display, output, false, &self.moved);
            self.moment = Moment::of(self.display.scene(), &frame);
        }
        is_shown.then_some(&self.moment)
    }
}
