//! A mouth mirror on the parametric tongue: what must hold while it presses, slides, lets go.

use std::path::PathBuf;
use std::sync::OnceLock;

use sulcus_core::math::{exp_rotation, norm};
use sulcus_core::{
    NoProbe, Pose, Quat, Scene, State, TickInput, TickOutput, Vec3, Workspace, tick,
};
use sulcus_operator::present;
use sulcus_scene::{BuildOptions, compile_file, default_cache_dir};

/// Height of the tongue's back over its underside where the mirror presses, metres.
const BACK: f64 = 0.0305;

fn tongue() -> &'static Scene {
    static SCENE: OnceLock<Scene> = OnceLock::new();
    SCENE.get_or_init(|| {
        let options = BuildOptions {
            cache: default_cache_dir(),
            ..BuildOptions::default()
        };
        let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../scenes/tongue.toml");
        let compiled = compile_file(&file, &options, &|_, _| {}).expect("the tongue");
        assert!(compiled.warnings.is_empty(), "{:?}", compiled.warnings);
        compiled.scene
    })
}

/// The disc flat, its back down, the handle forwards and up.
fn flat() -> Quat {
    exp_rotation(&Vec3::new(0.0, 0.0, std::f64::consts::PI))
        * exp_rotation(&Vec3::new(0.0, -std::f64::consts::FRAC_PI_4, 0.0))
}

/// A run with the haptic tool's disc where the caller says.
struct Run<'a> {
    scene: &'a Scene,
    state: State,
    ws: Workspace,
    detail: u8,
}

impl<'a> Run<'a> {
    fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            state: State::new(scene),
            ws: Workspace::new(scene),
            detail: 0,
        }
    }

    /// One tick with the underside of the disc's middle at `place`.
    fn at(&mut self, place: Vec3) -> TickOutput {
        let tool = &self.scene.tools[0];
        let turned = flat();
        let pose = Pose::new(
            place + Vec3::new(0.0, 0.0, 1e-3) - turned * tool.working_point,
            turned,
        );
        let mut input = TickInput::IDLE;
        input.detail = self.detail;
        input.tools[0] = present(&pose);
        tick(
            self.scene,
            &mut self.state,
            &mut self.ws,
            &input,
            &mut NoProbe,
        )
    }

    /// Underside of the graphic disc's middle.
    fn graphic(&self) -> Vec3 {
        let tool = &self.scene.tools[0];
        self.state.tools[0].graphic.transform(&tool.working_point) - Vec3::new(0.0, 0.0, 1e-3)
    }
}

#[test]
fn explore() {
    let scene = tongue();
    if let sulcus_core::tissue::TissueModel::Skeleton(model) = &scene.objects[0].tissue {
        for level in [Some(&model.coarse), model.fine.as_ref()]
            .into_iter()
            .flatten()
        {
            println!(
                "nodes {} free {} springs {} mass {:.3} g damping {:.4} pressed {:.2} mm/N, k0 {:?}",
                level.nodes.len(),
                level.free(),
                level.springs.len(),
                level.params.mass * 1e3,
                level.params.damping,
                sulcus_scene::skeleton::pressed(level, &scene.objects[0].tree) * 1e3,
                level.springs[0].stiffness,
            );
        }
    }
    println!(
        "tree nodes {} shape {}",
        scene.objects[0].tree.nodes().len(),
        scene.objects[0].tree.shape_at(3).count()
    );
    for detail in [0, 1] {
        let mut run = Run::new(scene);
        run.detail = detail;
        let mut last = None;
        for k in 0..4000 {
            let down = 0.02 * (k as f64 / 2000.0).min(1.0);
            let out = run.at(Vec3::new(0.005, 0.0, BACK + 0.002 - down));
            if k % 200 == 0 {
                let t = &out.tools[0];
                println!(
                    "{k} graphic z {:.3} mm force {:.3?} rows {} active {} sub {} conv {} status {:x} min gap {:.2e}",
                    (BACK - run.graphic().z) * 1e3,
                    t.raw_wrench.force,
                    t.rows,
                    t.active,
                    t.substeps,
                    t.converged,
                    t.status,
                    t.min_gap
                );
            }
            last = Some(out);
        }
        let _ = (last, norm(&Vec3::zeros()));
    }
}
