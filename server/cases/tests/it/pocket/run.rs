//! A probe at a site of the shipped pocket scene, tick by tick, with its measures.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use sulcus_cases::pocket::{Way, gingiva_of};
use sulcus_cases::{Measures, Observer};
use sulcus_core::math::norm;
use sulcus_core::output::PocketReading;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::Gingiva;
use sulcus_core::{NoProbe, Pose, Scene, State, TickInput, TickOutput, Vec3, Workspace, tick};
use sulcus_operator::present;
use sulcus_scene::{BuildOptions, compile_text};

fn shipped() -> &'static str {
    sulcus_scene::BuiltIn::Pocket.text()
}

/// Prescribed depths of the shipped scene, metres, and their angles, degrees from mesial over buccal.
pub const SITES: [(f64, f64); 6] = [
    (35.0, 3e-3),
    (90.0, 2e-3),
    (145.0, 3e-3),
    (215.0, 4e-3),
    (270.0, 2.5e-3),
    (325.0, 3e-3),
];

/// The shipped scene with some of its text changed. Tests share compiled scenes.
pub fn scene_with(changes: &[(&str, &str)]) -> Scene {
    static BUILT: Mutex<BTreeMap<String, Scene>> = Mutex::new(BTreeMap::new());
    let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    let text = changes
        .iter()
        .fold(shipped().to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        });
    let compile = |text: &String| {
        let file = Path::new("pocket.toml");
        let compiled = compile_text(text, file, &BuildOptions::cached(), &|_, _| ());
        compiled.expect("a scene").scene
    };
    built
        .entry(text)
        .or_insert_with_key(|text| compile(text))
        .clone()
}

pub fn model(scene: &mut Scene) -> &mut Gingiva {
    match &mut scene.objects[1].tissue {
        TissueModel::Gingiva(model) => model,
        other => panic!("{other:?}"),
    }
}

/// A simulation with its measures.
pub struct Run {
    pub scene: Scene,
    pub state: State,
    pub ws: Workspace,
    observer: Observer,
    pub last: Option<TickOutput>,
    /// Largest change of the torque in a tick, N m.
    pub torque_step: f64,
}

impl Run {
    pub fn new(scene: &Scene) -> Self {
        let mut observer = Observer::new(scene);
        observer.residual_every = 100;
        Self {
            scene: scene.clone(),
            state: State::new(scene),
            ws: Workspace::new(scene),
            observer,
            last: None,
            torque_step: 0.0,
        }
    }

    pub fn input(pose: &Pose) -> TickInput {
        let mut input = TickInput::IDLE;
        input.tools[0] = present(pose);
        input
    }

    pub fn tick(&mut self, pose: &Pose) -> TickOutput {
        self.step(&Self::input(pose))
    }

    pub fn step(&mut self, input: &TickInput) -> TickOutput {
        let out = tick(
            &self.scene,
            &mut self.state,
            &mut self.ws,
            input,
            &mut NoProbe,
        );
        self.observer.observe(&self.scene, input, &out, &self.ws);
        if let Some(last) = &self.last {
            // About the tip's working point, so that the lever to the hand does not hide or make anything.
            let change = norm(&(self.torque(&out) - self.torque(last)));
            self.torque_step = self.torque_step.max(change);
        }
        self.last = Some(out);
        out
    }

    /// Raw torque about the working point of the haptic tool.
    pub fn torque(&self, out: &TickOutput) -> Vec3 {
        let lever = -(out.tools[0].haptic.orientation * self.scene.tools[0].working_point);
        out.tools[0].raw_wrench.moved(&lever).torque
    }

    pub fn measures(&self) -> Measures {
        self.observer.measures()
    }
}

pub fn way(scene: &Scene, degrees: f64, depth: f64) -> Way {
    let (_, _, model) = gingiva_of(scene).expect("a gingiva");
    let around = degrees.to_radians();
    let around = if around > PI {
        around - 2.0 * PI
    } else {
        around
    };
    let height = model.margin_at(around) - depth + model.params.sink();
    Way::new(scene, 0, &model.tooth, around, height)
}

/// Comes in 8 mm over the floor, goes down at 8 mm/s to `end` over it.
pub fn go_in(run: &mut Run, way: &Way, end: f64) {
    let tool = run.scene.tools[0].clone();
    for k in 0..1500 {
        let t = f64::from(k) * 1e-3;
        let above = (8e-3 - 8e-3 * (t - 0.3).max(0.0)).max(end);
        run.tick(&way.pose(&tool, above, 0.0, 0.0));
    }
}

/// A hand that presses along the tooth's axis and yields to and from the tooth, as one does that feels for the floor and not
/// against the tooth; round the tooth it holds, or it would slide down to where the floor is deeper.
#[derive(Clone, Copy, Default)]
pub struct Feeler {
    /// How far it has pressed, metres.
    pressed: f64,
    /// How far it has yielded.
    aside: Vec3,
}

impl Feeler {
    pub fn step(&mut self, run: &mut Run, way: &Way, by: f64) -> TickOutput {
        self.pressed += by;
        let mut pose = way.pose(&run.scene.tools[0], 0.0, 0.0, 0.0);
        pose.position += self.aside - Vec3::z() * self.pressed;
        let out = run.tick(&pose);
        let force = out.tools[0].raw_wrench.force;
        // A coupling of 500 N/m follows in 200 ticks.
        self.aside += way.outward * (way.outward.dot(&force) * 1e-5);
        out
    }

    /// Presses at a millimetre a second until the floor bears `newtons`; the reading there.
    pub fn press_to(&mut self, run: &mut Run, way: &Way, newtons: f64) -> PocketReading {
        for _ in 0..10_000 {
            let out = self.step(run, way, 1e-6);
            if let Some(reading) = out.tools[0].pocket.filter(|p| p.floor_force >= newtons) {
                return reading;
            }
        }
        panic!("the floor never bore {newtons} N: {:?}", run.last);
    }
}
