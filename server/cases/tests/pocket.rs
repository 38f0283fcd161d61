//! A probe in the pocket of one molar, through the whole tick.

use std::path::Path;
use std::sync::OnceLock;

use sulcus_cases::pocket::{Way, gingiva_of};
use sulcus_core::math::norm;
use sulcus_core::{NoProbe, Pose, Scene, State, TickInput, TickOutput, Vec3, Workspace, tick};
use sulcus_operator::present;
use sulcus_scene::{BuildOptions, compile_file};

fn scene() -> &'static Scene {
    static SCENE: OnceLock<Scene> = OnceLock::new();
    SCENE.get_or_init(|| {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/pocket.toml");
        compile_file(&file, &BuildOptions::cached(), &|_, _| ())
            .expect("the shipped scene")
            .scene
    })
}

/// Prescribed depths of the shipped scene, metres, and their angles, radians.
const SITES: [(f64, f64); 6] = [
    (35.0, 3e-3),
    (90.0, 2e-3),
    (145.0, 3e-3),
    (215.0, 4e-3),
    (270.0, 2.5e-3),
    (325.0, 3e-3),
];

struct Run {
    scene: Scene,
    state: State,
    ws: Workspace,
}

impl Run {
    fn new(scene: &Scene) -> Self {
        Self {
            scene: scene.clone(),
            state: State::new(scene),
            ws: Workspace::new(scene),
        }
    }
    fn tick(&mut self, pose: &Pose) -> TickOutput {
        let mut input = TickInput::IDLE;
        input.tools[0] = present(pose);
        tick(
            &self.scene,
            &mut self.state,
            &mut self.ws,
            &input,
            &mut NoProbe,
        )
    }
}

fn way(scene: &Scene, degrees: f64, depth: f64) -> Way {
    let (_, _, model) = gingiva_of(scene).expect("a gingiva");
    let around = degrees.to_radians();
    let around = if around > std::f64::consts::PI {
        around - 2.0 * std::f64::consts::PI
    } else {
        around
    };
    let height = model.margin_at(around) - depth + model.params.sink();
    Way::new(scene, 0, &model.tooth, around, height)
}

#[test]
fn explore() {
    for (degrees, depth) in SITES {
        let mut run = Run::new(scene());
        let way = way(scene(), degrees, depth);
        let tool = run.scene.tools[0].clone();
        let lean = libm::acos(way.up.z).to_degrees();
        print!("{degrees}: lean {lean:.0}: ");
        let mut before = TickInput::IDLE;
        let _ = &mut before;
        for k in 0..3500 {
            let t = f64::from(k) * 1e-3;
            // 1 s to come, 1 s down to the floor, then pressed slowly.
            let above = if t < 1.0 {
                8e-3
            } else if t < 2.0 {
                8e-3 * (2.0 - t)
            } else {
                -1.2e-3 * (t - 2.0)
            };
            let out = run.tick(&way.pose(&tool, above, 0.0, 0.0));
            let o = &out.tools[0];
            if k % 250 == 249 && k > 1400 {
                let f = o.raw_wrench.force;
                match o.pocket {
                    Some(p) => print!(
                        "[{:.2} mm {:.2} N of {:.2} ({:.2}), {} rows {} sub {:?}] ",
                        p.depth * 1e3,
                        p.floor_force,
                        f.z,
                        norm(&f),
                        o.rows,
                        o.substeps,
                        p.zone
                    ),
                    None => print!("[- {:.2} N {} rows st {}] ", norm(&f), o.rows, o.status),
                }
            }
        }
        println!();
        let _ = Vec3::zeros();
    }
}
