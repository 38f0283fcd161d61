//! Poses from a random walk with leaps, turns, absences and bad numbers, about a place where there is much to touch: nothing
//! panics, nothing that is not finite comes out, nothing is penetrated in a converged tick.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use sulcus_core::math::exp_rotation;
use sulcus_core::{
    MAX_TOOLS, NoProbe, Pose, Quat, RawPose, Scene, State, TickInput, ToolInput, Vec3, Workspace,
    tick,
};
use sulcus_operator::pocket_path::{Manner, PocketPath};

use crate::measure::{Measures, Observer};
use crate::scenes::{self, device_over};
use crate::table::tissue::mirror;
use crate::tissue_scenes::{organ, pocket, tongue, twice};

/// Where poses are made up.
#[derive(Clone, Copy)]
pub struct Fuzz {
    /// Name.
    pub name: &'static str,
    /// The scene.
    pub scene: fn() -> Scene,
    /// Poses about which the walks of its tools go.
    pub homes: fn(&Scene) -> Vec<Pose>,
    /// Length of the walk's usual steps, metres.
    pub step: f64,
}

/// All of them: every tissue model, one and two tools, what is thin, narrow and sharp.
pub const ALL: &[Fuzz] = &[
    Fuzz {
        name: "wedge",
        scene: || scenes::scene("wedge", vec![scenes::wedge()]),
        homes: |_| vec![over(-5e-4)],
        step: 1.5e-4,
    },
    Fuzz {
        name: "thin plate",
        scene: || scenes::scene("thin plate", vec![scenes::thin_plate()]),
        homes: |_| vec![over(-5e-4)],
        step: 1.5e-4,
    },
    Fuzz {
        name: "sharp edge",
        scene: || scenes::scene("sharp edge", vec![scenes::sharp_edge()]),
        homes: |_| vec![over(-1.5e-3)],
        step: 5e-5,
    },
    Fuzz {
        name: "blended groove",
        scene: || scenes::scene("groove", vec![scenes::groove(0.785)]),
        homes: |_| vec![over(0.0)],
        step: 1.5e-4,
    },
    Fuzz {
        name: "pocket (gingiva)",
        scene: || pocket("0.4"),
        homes: |scene| vec![in_pocket(scene, 90.0)],
        step: 1.5e-4,
    },
    Fuzz {
        name: "pocket, two probes (gingiva)",
        scene: || twice(pocket("0.4")),
        homes: |scene| vec![in_pocket(scene, 75.0), in_pocket(scene, 105.0)],
        step: 1.5e-4,
    },
    Fuzz {
        name: "tongue (skeleton)",
        scene: || tongue(0.5),
        homes: |scene| vec![mirror(scene, 0.0).pose(4e-3, 0.0, 0.0)],
        step: 4e-4,
    },
    Fuzz {
        name: "tongue (surface_compliance)",
        scene: || organ(0.5),
        homes: |scene| vec![mirror(scene, 0.0).pose(4e-3, 0.0, 0.0)],
        step: 4e-4,
    },
    Fuzz {
        name: "tongue, two mirrors (surface_compliance)",
        scene: || twice(organ(0.5)),
        homes: |scene| {
            [0.3, -0.3]
                .map(|flank| mirror(scene, flank).pose(4e-3, 0.0, 0.0))
                .into()
        },
        step: 4e-4,
    },
];

fn over(z: f64) -> Pose {
    Pose::new(device_over(Vec3::new(0.0, 0.0, z)), Quat::identity())
}

fn in_pocket(scene: &Scene, degrees: f64) -> Pose {
    let path = PocketPath::new(scene, None, 1e-4, Manner::Taught).expect("a tooth with gingiva");
    path.pose(degrees.to_radians(), 3e-3, 0.0, Vec3::zeros())
}

/// Ticks between two full queries of the residual: it costs more than the tick.
const RESIDUAL_EVERY: u64 = 16;

impl Fuzz {
    /// Runs `ticks` ticks; `change` may change the scene first.
    pub fn run(&self, seed: u64, ticks: u64, change: impl FnOnce(&mut Scene)) -> Measures {
        let mut scene = (self.scene)();
        let homes = (self.homes)(&scene);
        change(&mut scene);
        let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
        let mut observer = Observer::new(&scene);
        observer.residual_every = RESIDUAL_EVERY;
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut walks = [Walk::default(); MAX_TOOLS];
        for _ in 0..ticks {
            let mut input = TickInput::IDLE;
            for (t, home) in homes.iter().enumerate() {
                let tip = scene.tools[t].tip;
                input.tools[t] = walks[t].step(&mut rng, home, &tip, self.step);
            }
            let output = tick(&scene, &mut state, &mut ws, &input, &mut NoProbe);
            observer.observe(&scene, &input, &output, &ws);
        }
        observer.measures()
    }
}

/// A walk about home: mostly small steps, now and then a leap, a turn, an absence, a bad number.
#[derive(Clone, Copy, Default)]
struct Walk {
    off: Vec3,
    turn: Vec3,
}

impl Walk {
    fn step(&mut self, rng: &mut ChaCha8Rng, home: &Pose, tip: &Vec3, step: f64) -> ToolInput {
        let mut unit = || (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        let reach = if unit() < 0.005 { 60.0 * step } else { step };
        self.off = (self.off * 0.995).map(|x| x + 2.0 * (unit() - 0.5) * reach);
        let reach = if unit() < 0.003 { 1.5 } else { 8e-3 };
        self.turn = (self.turn * 0.99).map(|x| x + (unit() - 0.5) * reach);
        let facing = exp_rotation(&self.turn) * home.orientation;
        let at = home.transform(tip) + self.off - facing * tip;
        let mut tool = ToolInput {
            pose: RawPose::from(&Pose::new(at, facing)),
            present: unit() > 0.001,
            ..ToolInput::ABSENT
        };
        if unit() < 0.005 {
            const BAD: [f32; 4] = [f32::NAN, f32::INFINITY, f32::MIN_POSITIVE / 4.0, f32::MAX];
            let bad = BAD[(unit() * 4.0) as usize % 4];
            let slot = (unit() * 7.0) as usize % 7;
            if slot < 3 {
                tool.pose.position[slot] = bad;
            } else {
                tool.pose.orientation[slot - 3] = bad;
            }
        }
        tool
    }
}
