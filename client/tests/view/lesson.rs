//! Steps of the first lesson in a real session of the core, with the simulated hand as the beginner.

use sulcus_connection::progress::Steps;
use sulcus_core::math::norm;
use sulcus_core::{
    NoProbe, Pose, RawPose, Scene, State, TickInput, TickOutput, Vec3, Workspace, tick,
};
use sulcus_demo::exercise::{self, Asked};
use sulcus_demo::lockstep::as_sent;
use sulcus_display::Display;
use sulcus_operator::crown::{Crown, CrownParams};
use sulcus_operator::script::OneTool;
use sulcus_operator::{HandParams, Operator, Script, Shown};
use sulcus_proto::datagram::WirePose;
use sulcus_screen::first::{FirstLesson, Seen, Step};
use sulcus_screen::moment::{Moment, ToolAt};

use crate::display::{Turn, turn};

/// Ticks between two pictures.
const EVERY: u64 = 16;
/// Ticks without a hand between two parts of the session.
const AWAY: u64 = 400;

/// Session of the lesson. A session computes for seconds, so that no window is open beside it.
struct Session {
    _turn: Turn,
    scene: std::sync::Arc<Scene>,
    display: Display,
    state: State,
    workspace: Workspace,
    lesson: FirstLesson,
    now: u64,
}

impl Session {
    fn new() -> Self {
        let turn = turn();
        let asked = Asked::of(sulcus_demo::lesson::NAME);
        let prepared = exercise::prepare(&asked, &Steps).expect("prepared");
        let display = Display::new(&prepared.scene).expect("a display");
        Self {
            _turn: turn,
            lesson: FirstLesson::new(display.scene()).expect("a pocket"),
            state: State::new(&prepared.scene),
            workspace: Workspace::new(&prepared.scene),
            scene: prepared.scene,
            display,
            now: 0,
        }
    }

    fn tick(&mut self, input: &TickInput) -> (TickOutput, Option<Step>) {
        let output = tick(
            &self.scene,
            &mut self.state,
            &mut self.workspace,
            input,
            &mut NoProbe,
        );
        self.now += 1;
        if !self.now.is_multiple_of(EVERY) {
            return (output, None);
        }
        let mut moment = Moment::rest(self.display.scene());
        for (k, at) in moment.tools.iter_mut().enumerate() {
            let RawPose {
                position,
                orientation,
            } = RawPose::from(&output.tools[k].graphic);
            let pose = WirePose {
                position,
                orientation,
            };
            *at = ToolAt::new(input.tools[k].present, &pose);
        }
        let force_n = norm(&output.tools[0].wrench.force);
        let dt_s = EVERY as f64 * self.scene.tick_s();
        let seen = Seen::of(self.display.scene(), &moment, force_n, dt_s);
        (output, self.lesson.see(&seen))
    }

    /// Lets a hand perform a script until it completes a step, at most for `seconds`.
    fn perform(&mut self, script: Box<dyn Script + Send>, seconds: f64) -> Option<Step> {
        for _ in 0..AWAY {
            assert_eq!(self.tick(&TickInput::IDLE).1, None, "without a hand");
        }
        let mut operator = Operator::new(script, HandParams::default(), 1);
        let (mut shown, mut input) = (Shown::NOTHING, TickInput::IDLE);
        for _ in 0..(seconds / self.scene.tick_s()) as u64 {
            input.tools = operator.step(&shown);
            let (output, step) = self.tick(&input);
            shown = as_sent(&output);
            if step.is_some() {
                return step;
            }
        }
        None
    }

    /// Pose with the tip of the probe at a place, metres, upright as at rest.
    fn with_tip(&self, at: Vec3) -> Pose {
        let tool = &self.scene.tools[0];
        let tip = tool.park.transform(&tool.tip);
        Pose {
            position: tool.park.position + (at - tip),
            ..tool.park
        }
    }
}

#[test]
fn a_beginner_reaches_all_four_steps_in_their_order() {
    let mut session = Session::new();
    let mark = session.with_tip(session.lesson.mark() * 1e-3);
    let hold = OneTool {
        pose: move |_| mark,
        duration_s: 60.0,
    };
    assert_eq!(session.perform(Box::new(hold), 5.0), Some(Step::Hold));
    let params = CrownParams {
        press: 1.2e-3,
        ..CrownParams::default()
    };
    let touch = Crown::new(&session.scene, None, params).expect("a crown");
    assert_eq!(session.perform(Box::new(touch), 10.0), Some(Step::Touch));
    // The hand cannot read; the keys do.
    assert_eq!(session.lesson.answered(false), None);
    assert_eq!(session.lesson.answered(true), Some(Step::Read));
    let mut probing = exercise::find("probing").expect("built in");
    probing.duration_s = 60.0;
    let walk = exercise::script(&session.scene, &probing, None, 1).expect("a tour");
    assert_eq!(session.perform(walk, 60.0), Some(Step::Walk));
    assert_eq!(session.lesson.step(), None);
}

#[test]
fn a_hand_that_does_nothing_reaches_no_step() {
    let mut session = Session::new();
    let script = sulcus_demo::lesson::script(&session.scene);
    assert_eq!(session.perform(script, 15.0), None);
    assert_eq!(session.lesson.step(), Some(Step::Hold));
}

#[test]
fn a_heavy_hand_does_not_pass_as_a_soft_touch() {
    let mut session = Session::new();
    let mark = session.with_tip(session.lesson.mark() * 1e-3);
    let hold = OneTool {
        pose: move |_| mark,
        duration_s: 60.0,
    };
    assert_eq!(session.perform(Box::new(hold), 5.0), Some(Step::Hold));
    // 8 mm of press are far over a newton.
    let params = CrownParams {
        press: 8e-3,
        lift_every: 1e6,
        ..CrownParams::default()
    };
    let press = Crown::new(&session.scene, None, params).expect("a crown");
    assert_eq!(session.perform(Box::new(press), 6.0), None);
}
