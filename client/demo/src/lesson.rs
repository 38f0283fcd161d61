//! Session of the first lesson: one tooth with a pocket, without a rubric.

use sulcus_core::{MAX_TOOLS, Pose, Scene};
use sulcus_operator::Script;
use sulcus_sessions::Exercise;

/// Name of the exercise.
pub const NAME: &str = "lesson";
/// Largest length, seconds: far over the time that a beginner needs.
const DURATION_S: f64 = 1800.0;

/// Exercise of the lesson.
pub fn exercise() -> Exercise {
    let mut exercise = Exercise::free(NAME, DURATION_S);
    exercise.about = "first lesson: hold, touch, read a band, walk".into();
    exercise.scene = "pocket".into();
    exercise
}

/// Operator that holds the first tool at its place of rest and does nothing.
pub fn script(scene: &Scene) -> Box<dyn Script + Send> {
    Box::new(Still {
        at: scene.tools.first().map(|tool| tool.park),
    })
}

struct Still {
    at: Option<Pose>,
}

impl Script for Still {
    fn targets(&self, _: f64) -> [Option<Pose>; MAX_TOOLS] {
        std::array::from_fn(|slot| self.at.filter(|_| slot == 0))
    }

    fn duration_s(&self) -> f64 {
        DURATION_S
    }
}
