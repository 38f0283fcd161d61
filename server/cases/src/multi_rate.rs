//! Study of a question that the paper leaves open in its section 9: one loop of 1 kHz compared with two rates, the
//! tissue at about 60 Hz and the force at 1 kHz.
//!
//! # The two rates
//! The tissue makes one implicit step for [`EVERY`] ticks. The program's own tick computes the step, on a scene whose
//! tissue has a scaled time. The damping of a skeleton is divided by `n`, its mass by `n^2`. In a step of 1 ms it then
//! has the matrix and the free motion of the shipped skeleton in a step of `n` ms. The time constant of a gingiva is
//! divided by `n`.
//!
//! Between two steps the force loop sees the tissue of the last step, in one of two ways of the literature:
//!
//! - [`Rates::FrozenCompliance`]: shape and compliance are those of the last step. Contact is solved in every tick, and
//!   its displacements are dropped until the next step takes its loads. The paper's reference 30 has such multi-rate
//!   mechanisms.
//! - [`Rates::FrozenShape`]: the shape is that of the last step, and the tissue is rigid.
//!
//! # Limits of the study
//! Both loops see the same hand without delay, and a step of the tissue takes no time. Two threads would add at least
//! one period of the slow loop. The tissue has no finer model for the time that it gains. The results are therefore a
//! lower bound of the errors of two rates. The reference [`Rates::Single`] is the program's own tick.
//!
//! At two rates the tick's limit of a force change, `max_settle_step`, is off. The limit would hide the force steps in
//! question, and delay a tissue with one tick for many. In one loop the limit has its shipped value, and does not act
//! here.

mod study;

pub use study::{MultiRate, Rated, Study, study};

use sulcus_core::tissue::TissueModel;
use sulcus_core::{
    DisplayMesh, NoProbe, Node, Object, Scene, SphereTree, State, TickInput, TickOutput, Vec3,
    Workspace, tick,
};

/// Number of ticks in one step of the slow loop: 58.8 Hz, the nearest rate to 60 Hz.
pub const EVERY: u64 = 17;

/// Rates of force and tissue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rates {
    /// Force and tissue at 1 kHz.
    Single,
    /// Tissue every [`EVERY`] ticks, with constant shape and compliance in between.
    FrozenCompliance,
    /// Tissue every [`EVERY`] ticks, rigid in between.
    FrozenShape,
}

impl Rates {
    /// All rates, in the order of reports.
    pub const ALL: [Rates; 3] = [Rates::Single, Rates::FrozenCompliance, Rates::FrozenShape];

    /// Name for reports.
    pub fn name(self) -> &'static str {
        match self {
            Rates::Single => "one loop",
            Rates::FrozenCompliance => "two rates, compliance frozen",
            Rates::FrozenShape => "two rates, shape frozen",
        }
    }
}

/// A simulation at these rates.
pub struct Loops {
    rates: Rates,
    /// The shipped scene, or the scene with the scaled time of the tissue.
    scene: Scene,
    state: State,
    ws: Workspace,
    /// Scene, state and workspace of the force loop with a rigid copy of the tissue, for [`Rates::FrozenShape`].
    frozen: Option<(Scene, State, Workspace)>,
    ticks: u64,
}

impl Loops {
    /// Simulation of `scene` before its first tick.
    pub fn new(scene: &Scene, rates: Rates) -> Self {
        let mut scene = match rates {
            Rates::Single => scene.clone(),
            _ => slowed(scene, EVERY as f64),
        };
        // Meshes are of no use here, and rigid copies are made 60 times in a second.
        for object in &mut scene.objects {
            object.mesh = DisplayMesh::default();
            object.carriers.clear();
        }
        for tool in &mut scene.tools {
            tool.mesh = DisplayMesh::default();
        }
        let (state, ws) = (State::new(&scene), Workspace::new(&scene));
        let frozen = (rates == Rates::FrozenShape).then(|| {
            let rigid = rigid_copy(&scene, None);
            let (state, ws) = (State::new(&rigid), Workspace::new(&rigid));
            (rigid, state, ws)
        });
        Self {
            rates,
            scene,
            state,
            ws,
            frozen,
            ticks: 0,
        }
    }

    /// Runs one tick of the force loop and returns its output.
    pub fn tick(&mut self, input: &TickInput) -> TickOutput {
        self.ticks += 1;
        let advances = self.ticks.is_multiple_of(EVERY);
        let Some((rigid, state, ws)) = &mut self.frozen else {
            let left =
                (self.rates != Rates::Single && !advances).then(|| self.state.tissue.clone());
            let output = tick(
                &self.scene,
                &mut self.state,
                &mut self.ws,
                input,
                &mut NoProbe,
            );
            if let Some(left) = left {
                self.state.tissue = left;
            }
            return output;
        };
        if !advances {
            return tick(rigid, state, ws, input, &mut NoProbe);
        }
        // The slow loop solves its own contact, from the tool's position in the force loop.
        self.state.tick = state.tick;
        self.state.tools = state.tools;
        self.state.loads.clone_from(&state.loads);
        tick(
            &self.scene,
            &mut self.state,
            &mut self.ws,
            input,
            &mut NoProbe,
        );
        let output = tick(rigid, state, ws, input, &mut NoProbe);
        *rigid = rigid_copy(&self.scene, Some(&self.ws));
        *ws = Workspace::new(rigid);
        // The graphic tool moves to its contact with the new shape. Otherwise it could be inside that shape.
        for (tool, slow) in state.tools.iter_mut().zip(&self.state.tools) {
            tool.graphic = slow.graphic;
        }
        output
    }

    /// Workspace of the tick that gave the last wrench.
    pub fn workspace(&self) -> &Workspace {
        self.frozen.as_ref().map_or(&self.ws, |(_, _, ws)| ws)
    }
}

/// The scene whose tissue advances in one tick by the time of `by` ticks.
fn slowed(scene: &Scene, by: f64) -> Scene {
    let mut scene = scene.clone();
    // The limit of a force change is for one tick. In a step of many ticks it would delay the tissue.
    scene.params.max_settle_step = 50.0;
    for object in &mut scene.objects {
        match &mut object.tissue {
            TissueModel::Skeleton(skeleton) => {
                let levels = [Some(&mut skeleton.coarse), skeleton.fine.as_mut()];
                for level in levels.into_iter().flatten() {
                    level.params.mass /= by * by;
                    level.params.damping /= by;
                }
            }
            TissueModel::Gingiva(gingiva) => gingiva.params.relaxation /= by,
            _ => {}
        }
    }
    scene
}

/// The scene with all deformable objects as rigid copies in the shape of `ws`; without `ws`, at rest.
fn rigid_copy(scene: &Scene, ws: Option<&Workspace>) -> Scene {
    let copy = |(k, object): (usize, &Object)| {
        let mut copy = object.clone();
        copy.tissue = TissueModel::Rigid;
        if let Some(tree) = ws.and_then(|ws| moved(k, object, ws)) {
            copy.tree = tree;
        }
        copy
    };
    Scene {
        objects: scene.objects.iter().enumerate().map(copy).collect(),
        ..scene.clone()
    }
}

/// Tree of object `k` in the shape of `ws`; `None` for a rigid object.
fn moved(k: usize, object: &Object, ws: &Workspace) -> Option<SphereTree> {
    let nodes = object.tree.nodes();
    let ids: Vec<u32> = (0..nodes.len() as u32).collect();
    let mut centres = vec![Vec3::zeros(); nodes.len()];
    if !ws.centres_of(k, &ids, &mut centres) {
        return None;
    }
    let nodes = nodes.iter().zip(centres);
    let nodes = nodes.map(|(node, centre)| Node { centre, ..*node });
    let tree = SphereTree::with_bounds(nodes.collect()).expect("a tissue's shape is finite");
    let blended = tree.with_blending(object.tree.blending().clone());
    Some(blended.expect("the same tree, moved"))
}
