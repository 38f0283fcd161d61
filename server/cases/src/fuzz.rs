//! Poses from a random walk with leaps, turns, absences and invalid numbers, about a place with many contacts.
//!
//! No tick may panic, no output may be infinite or not a number, and no converged tick may leave a penetration.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use sulcus_core::math::exp_rotation;
use sulcus_core::{
    MAX_TOOLS, NoProbe, Pose, Quat, RawPose, Scene, State, TickInput, ToolInput, Vec3, Workspace,
    tick,
};
use sulcus_operator::Script;
use sulcus_operator::pocket_path::{Manner, PocketPath};
use sulcus_operator::script::TwoTools;

use crate::measure::{Measures, Observer};
use crate::scenes::{self, device_over};
use crate::table::tissue::mirror;
use crate::tissue_scenes::{organ, pocket, tongue, twice};

/// A scene with places for random poses.
#[derive(Clone, Copy)]
pub struct Fuzz {
    /// Name of the scene in reports.
    pub name: &'static str,
    /// Maker of the scene.
    pub scene: fn() -> Scene,
    /// Device pose about which each tool walks.
    pub homes: fn(&Scene) -> Vec<Pose>,
    /// Largest length of a usual step along each axis, metres.
    pub step: f64,
    /// Bounds on ticks whose substeps ran out. Later ticks finish a leap.
    pub outrun: Outrun,
}

/// Bounds on ticks whose substeps ran out: a little above the results of a thousand and of a million ticks.
#[derive(Clone, Copy)]
pub struct Outrun {
    /// Number of walking tools.
    pub tools: u64,
    /// Largest share of such tool-ticks.
    pub share: f64,
    /// Deepest penetration in a tick that did not converge, metres.
    pub deepest: f64,
}

const fn outrun(tools: u64, share: f64, deepest: f64) -> Outrun {
    Outrun {
        tools,
        share,
        deepest,
    }
}

const RIGID: Outrun = outrun(1, 0.06, 1e-5);
/// Random leaps reach the bound on the work of a tick; a half more is exhausted than without the bound.
const GINGIVA: Outrun = outrun(1, 0.14, 4e-5);
const SKELETON: Outrun = outrun(1, 0.06, 1e-5);
const ORGAN: Outrun = outrun(1, 0.14, 3e-3);
/// Two tools share one problem and one bound on its work, so each waits for the other. In a tick that ends at the bound
/// a probe enters the gingiva by up to 73 um.
const TWO_PROBES: Outrun = outrun(2, 0.2, 1e-4);
const TWO_MIRRORS: Outrun = outrun(2, 0.4, 3e-3);

/// One probe in the narrow pocket.
pub const POCKET: Fuzz = Fuzz {
    name: "pocket (gingiva)",
    scene: || pocket("0.4"),
    homes: |scene| vec![in_pocket(scene, 90.0)],
    step: 1.5e-4,
    outrun: GINGIVA,
};

/// All scenes: every tissue model, one and two tools, and thin, narrow and sharp objects.
pub const ALL: &[Fuzz] = &[
    Fuzz {
        name: "wedge",
        scene: || scenes::scene("wedge", vec![scenes::wedge()]),
        homes: |_| vec![over(-5e-4)],
        step: 1.5e-4,
        outrun: RIGID,
    },
    Fuzz {
        name: "thin plate",
        scene: || scenes::scene("thin plate", vec![scenes::thin_plate()]),
        homes: |_| vec![over(-5e-4)],
        step: 1.5e-4,
        outrun: RIGID,
    },
    Fuzz {
        name: "sharp edge",
        scene: || scenes::scene("sharp edge", vec![scenes::sharp_edge()]),
        homes: |_| vec![over(-1.5e-3)],
        step: 5e-5,
        outrun: RIGID,
    },
    Fuzz {
        name: "blended groove",
        scene: || scenes::scene("groove", vec![scenes::groove(0.785)]),
        homes: |_| vec![over(0.0)],
        step: 1.5e-4,
        outrun: RIGID,
    },
    POCKET,
    Fuzz {
        name: "pocket, two probes (gingiva)",
        scene: || twice(pocket("0.4")),
        homes: |scene| vec![in_pocket(scene, 75.0), in_pocket(scene, 105.0)],
        step: 1.5e-4,
        outrun: TWO_PROBES,
    },
    Fuzz {
        name: "tongue (skeleton)",
        scene: || tongue(0.5),
        homes: |scene| vec![mirror(scene, 0.0).pose(4e-3, 0.0, 0.0)],
        step: 4e-4,
        outrun: SKELETON,
    },
    Fuzz {
        name: "tongue (surface_compliance)",
        scene: || organ(0.5),
        homes: |scene| vec![mirror(scene, 0.0).pose(4e-3, 0.0, 0.0)],
        step: 4e-4,
        outrun: ORGAN,
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
        outrun: TWO_MIRRORS,
    },
];

fn over(z: f64) -> Pose {
    Pose::new(device_over(Vec3::new(0.0, 0.0, z)), Quat::identity())
}

fn in_pocket(scene: &Scene, degrees: f64) -> Pose {
    let path = PocketPath::new(scene, None, 1e-4, Manner::Taught).expect("a tooth with gingiva");
    path.pose(degrees.to_radians(), 3e-3, 0.0, Vec3::zeros())
}

/// Number of ticks from one query of the residual to the next. A query takes longer than a tick.
const RESIDUAL_EVERY: u64 = 16;

impl Fuzz {
    /// Runs `ticks` ticks on the scene that `change` has modified. The walks are those of the unmodified scene.
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

    /// Returns the scene, and the inputs of `ticks` ticks of a walk.
    pub fn inputs(&self, seed: u64, ticks: u64) -> (Scene, Vec<TickInput>) {
        let scene = (self.scene)();
        let homes = (self.homes)(&scene);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut walks = [Walk::default(); MAX_TOOLS];
        let inputs = (0..ticks).map(|_| {
            let mut input = TickInput::IDLE;
            for (t, home) in homes.iter().enumerate() {
                let tip = scene.tools[t].tip;
                input.tools[t] = walks[t].step(&mut rng, home, &tip, self.step);
            }
            input
        });
        let inputs = inputs.collect();
        (scene, inputs)
    }

    /// A walk as a script of `ticks` milliseconds, without invalid numbers, which a script cannot give.
    pub fn script(&self, scene: &Scene, seed: u64, ticks: u64) -> Box<dyn Script + Send> {
        let homes = (self.homes)(scene);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut walks = [Walk::default(); MAX_TOOLS];
        let made_up: Vec<[Option<Pose>; MAX_TOOLS]> = (0..ticks)
            .map(|_| {
                let mut poses = [None; MAX_TOOLS];
                for (t, home) in homes.iter().enumerate() {
                    let (pose, there) = walks[t].go(&mut rng, home, &scene.tools[t].tip, self.step);
                    poses[t] = there.then_some(pose);
                }
                poses
            })
            .collect();
        Box::new(TwoTools {
            poses: move |t: f64| {
                let k = (t * 1e3).round() as usize;
                made_up[k.min(made_up.len() - 1)]
            },
            duration_s: ticks as f64 * 1e-3,
        })
    }

    /// Whether `found` is within the bounds of [`Fuzz::outrun`], with a share of at most `times` the bound.
    pub fn keeps_up(&self, found: &Measures, times: f64) -> bool {
        self.exhausted_share(found) <= times * self.outrun.share
            && found.exhausted_residual <= self.outrun.deepest
    }

    /// Share of the tool-ticks whose substeps ran out.
    pub fn exhausted_share(&self, found: &Measures) -> f64 {
        found.exhausted as f64 / (found.ticks.max(1) * self.outrun.tools) as f64
    }
}

/// A random walk about a pose: small steps, with rare leaps, turns, absences and invalid numbers.
#[derive(Clone, Copy, Default)]
struct Walk {
    off: Vec3,
    turn: Vec3,
}

impl Walk {
    /// Next device pose, and whether the tool is present.
    fn go(&mut self, rng: &mut ChaCha8Rng, home: &Pose, tip: &Vec3, step: f64) -> (Pose, bool) {
        let mut unit = || unit(rng);
        let reach = if unit() < 0.005 { 60.0 * step } else { step };
        self.off = (self.off * 0.995).map(|x| x + 2.0 * (unit() - 0.5) * reach);
        let reach = if unit() < 0.003 { 1.5 } else { 8e-3 };
        self.turn = (self.turn * 0.99).map(|x| x + (unit() - 0.5) * reach);
        let facing = exp_rotation(&self.turn) * home.orientation;
        let at = home.transform(tip) + self.off - facing * tip;
        (Pose::new(at, facing), unit() > 0.001)
    }

    fn step(&mut self, rng: &mut ChaCha8Rng, home: &Pose, tip: &Vec3, step: f64) -> ToolInput {
        let (pose, present) = self.go(rng, home, tip, step);
        let mut unit = || unit(rng);
        let mut tool = ToolInput {
            pose: RawPose::from(&pose),
            present,
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

/// Next random number, 0 to 1.
fn unit(rng: &mut ChaCha8Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_tools_walk_as_are_said_to() {
        for fuzz in ALL {
            let homes = (fuzz.homes)(&(fuzz.scene)()).len() as u64;
            assert_eq!(homes, fuzz.outrun.tools, "{}", fuzz.name);
        }
    }

    #[test]
    fn what_runs_out_too_often_or_too_deep_does_not_keep_up() {
        let found = |exhausted, exhausted_residual| Measures {
            ticks: 1000,
            exhausted,
            exhausted_residual,
            ..Measures::default()
        };
        assert!(ALL[0].keeps_up(&found(59, 9e-6), 1.0));
        assert!(!ALL[0].keeps_up(&found(61, 9e-6), 1.0));
        assert!(!ALL[0].keeps_up(&found(59, 1.1e-5), 1.0));
    }
}
