//! A probe in the pocket of one molar, through the whole tick: depths, forces, turning, release.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use sulcus_cases::pocket::{Way, gingiva_of};
use sulcus_cases::{Measures, Observer};
use sulcus_core::math::norm;
use sulcus_core::output::{ForceZone, status};
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::Gingiva;
use sulcus_core::{
    NoProbe, Node, Pose, Scene, State, TickInput, TickOutput, Vec3, Workspace, Wrench, tick,
};
use sulcus_operator::present;
use sulcus_scene::{BuildOptions, compile_file};

const SHIPPED: &str = sulcus_scene::compile::POCKET_SCENE;

/// Prescribed depths of the shipped scene, metres, and their angles, degrees from mesial over buccal.
const SITES: [(f64, f64); 6] = [
    (35.0, 3e-3),
    (90.0, 2e-3),
    (145.0, 3e-3),
    (215.0, 4e-3),
    (270.0, 2.5e-3),
    (325.0, 3e-3),
];

/// The shipped scene with some of its text changed; trees come from the cache where they can.
fn scene_with(changes: &[(&str, &str)]) -> Scene {
    // One at a time: two tests must not build the same tree side by side.
    static BUILDING: Mutex<()> = Mutex::new(());
    let _building = BUILDING.lock().unwrap_or_else(PoisonError::into_inner);
    let text = changes.iter().fold(SHIPPED.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    });
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let file = folder.join(format!("pocket-{:?}.toml", std::thread::current().id()));
    std::fs::write(&file, text).expect("a scene file");
    compile_file(&file, &BuildOptions::cached(), &|_, _| ())
        .expect("a scene")
        .scene
}

fn model(scene: &mut Scene) -> &mut Gingiva {
    match &mut scene.objects[1].tissue {
        TissueModel::Gingiva(model) => model,
        other => panic!("{other:?}"),
    }
}

/// A simulation with its measures.
struct Run {
    scene: Scene,
    state: State,
    ws: Workspace,
    observer: Observer,
    last: Option<TickOutput>,
    torque_step: f64,
    /// Where the largest jump was, and whether the tool was then let go by something.
    jump: f64,
}

impl Run {
    fn new(scene: &Scene) -> Self {
        let mut observer = Observer::new(scene);
        // Its full query knows rest shapes alone; see `residual` below.
        observer.residual_every = u64::MAX;
        Self {
            scene: scene.clone(),
            state: State::new(scene),
            ws: Workspace::new(scene),
            observer,
            last: None,
            torque_step: 0.0,
            jump: 0.0,
        }
    }

    fn input(pose: &Pose) -> TickInput {
        let mut input = TickInput::IDLE;
        input.tools[0] = present(pose);
        input
    }

    fn tick(&mut self, pose: &Pose) -> TickOutput {
        self.step(&Self::input(pose))
    }

    fn step(&mut self, input: &TickInput) -> TickOutput {
        let out = tick(
            &self.scene,
            &mut self.state,
            &mut self.ws,
            input,
            &mut NoProbe,
        );
        self.observer.observe(&self.scene, input, &out);
        if let Some(last) = &self.last {
            // About the tip's working point, so that the lever to the hand does not hide or make anything.
            let change = norm(&(self.torque(&out) - self.torque(last)));
            self.torque_step = self.torque_step.max(change);
        }
        self.last = Some(out);
        out
    }

    /// Raw torque about the working point of the haptic tool.
    fn torque(&self, out: &TickOutput) -> Vec3 {
        let lever = -(out.tools[0].haptic.orientation * self.scene.tools[0].working_point);
        out.tools[0].raw_wrench.moved(&lever).torque
    }

    fn measures(&self) -> Measures {
        self.observer.measures()
    }

    /// Deepest overlap of any tool leaf with any leaf of tooth cores and gingiva as they are now: a full query.
    fn residual(&self) -> f64 {
        let (tool, graphic) = (&self.scene.tools[0], &self.state.tools[0].graphic);
        let mut depth = 0.0_f64;
        for (k, object) in self.scene.objects.iter().enumerate() {
            let (ids, nodes): (Vec<u32>, Vec<&Node>) = object.tree.shape_at(object.level).unzip();
            let mut centres: Vec<Vec3> = nodes.iter().map(|node| node.centre).collect();
            self.ws.centres_of(k, &ids, &mut centres);
            for (_, a) in tool.tree.shape_at(tool.level) {
                let at = graphic.transform(&a.centre);
                for ((id, node), centre) in ids.iter().zip(&nodes).zip(&centres) {
                    let radius = match self.scene.blend_of(k) > 0.0 {
                        true => object.tree.core_radius(*id, object.level),
                        false => node.contact_radius,
                    };
                    depth = depth.max(radius + a.contact_radius - norm(&(at - centre)));
                }
            }
        }
        depth
    }
}

fn way(scene: &Scene, degrees: f64, depth: f64) -> Way {
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
fn go_in(run: &mut Run, way: &Way, end: f64) {
    let tool = run.scene.tools[0].clone();
    for k in 0..1500 {
        let t = f64::from(k) * 1e-3;
        let above = (8e-3 - 8e-3 * (t - 0.3).max(0.0)).max(end);
        run.tick(&way.pose(&tool, above, 0.0, 0.0));
    }
}

#[test]
fn explore_depths() {
    let scene = scene_with(&[]);
    for (degrees, depth) in SITES {
        let mut run = Run::new(&scene);
        let way = way(&scene, degrees, depth);
        let tool = run.scene.tools[0].clone();
        print!("{degrees}: lean {:.0}: ", libm::acos(way.up.z).to_degrees());
        go_in(&mut run, &way, 0.0);
        let mut marks = vec![0.2, 0.225, 0.25, 0.6, 1.0];
        for k in 0..6000 {
            let out = run.tick(&way.pose(&tool, -1e-6 * f64::from(k), 0.0, 0.0));
            let Some(p) = out.tools[0].pocket else {
                continue;
            };
            if marks.first().is_some_and(|m| p.floor_force >= *m) {
                let f = marks.remove(0);
                print!(
                    "[{f} N: {:.2} mm, hand {:.2} N] ",
                    p.depth * 1e3,
                    norm(&out.tools[0].raw_wrench.force)
                );
            }
        }
        println!("residual {:.2} um", run.residual() * 1e6);
    }
}

#[test]
fn explore_turning() {
    for width in ["0.4", "0.5", "0.65", "0.8"] {
        let scene = scene_with(&[("width_mm = 0.4", &format!("width_mm = {width}"))]);
        for (degrees, depth) in SITES {
            let mut run = Run::new(&scene);
            let way = way(&scene, degrees, depth);
            let tool = run.scene.tools[0].clone();
            go_in(&mut run, &way, 2e-4);
            let m0 = run.measures();
            let ts0 = run.torque_step;
            let side = way.up.cross(&way.outward).normalize();
            let (mut wrong, mut least, mut most) = (0, f64::INFINITY, f64::NEG_INFINITY);
            let mut residual = 0.0_f64;
            let mut exhausted = 0;
            for k in 0..4000 {
                let t = f64::from(k) * 1e-3;
                let turn = 10.0_f64.to_radians() * libm::sin(0.5 * PI * t);
                let out = run.tick(&way.pose(&tool, 2e-4, turn, 4e-3));
                let torque = run.torque(&out).dot(&side);
                least = f64::min(least, torque);
                most = f64::max(most, torque);
                if turn.abs() > 0.05 && torque * turn > 0.0 {
                    wrong += 1;
                }
                if k % 50 == 0 && out.tools[0].converged {
                    residual = residual.max(run.residual());
                }
                exhausted += u32::from(out.tools[0].status & status::EXHAUSTED != 0);
            }
            let m = run.measures();
            println!(
                "{width} {degrees}: lean {:.0} insertion buzz {:.4} jump {:.3} tstep {:.2} | all: buzz {:.4} jump {:.3} mm tstep {:.2} Nmm, torque {:.1}..{:.1} Nmm wrong {wrong}, residual {:.2} um, exhausted {exhausted}, max F {:.2}",
                libm::acos(way.up.z).to_degrees(),
                m0.buzz,
                m0.jump * 1e3,
                ts0 * 1e3,
                m.buzz,
                m.jump * 1e3,
                run.torque_step * 1e3,
                least * 1e3,
                most * 1e3,
                residual * 1e6,
                m.max_raw_force
            );
        }
    }
    let _ = (ForceZone::Light, Wrench::ZERO, model);
}
