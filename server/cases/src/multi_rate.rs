//! The study that the paper leaves open (its section 9): everything in one loop of 1 kHz, against two rates, the tissue at
//! about 60 Hz and the force at 1 kHz.
//!
//! # The two rates
//! What the tissue does in [`EVERY`] ticks is one implicit step of that length. It runs by the tick itself, on a scene whose
//! tissue has its time scaled: a skeleton with its damping over `n` and its mass over `n^2` has in a step of 1 ms exactly
//! the matrix, and the free motion, of the shipped one in a step of `n` ms; a gingiva's time constant scales by `n`. Between two
//! such steps the force loop sees the tissue as it was left, in one of two ways that the literature has:
//!
//! - [`Rates::FrozenCompliance`]: its shape and its compliance in contact are those of the last step; contact is solved anew in every
//!   millisecond, and what it moves is forgotten again until the next step takes its loads (as in multi-rate compliant
//!   mechanisms, the paper's reference 30).
//! - [`Rates::FrozenShape`]: nothing but its shape, as if it were rigid.
//!
//! # What this leaves out
//! Both loops see the same hand without delay, and a step of the tissue takes no time: two threads add at least one period of the slow
//! one. Nor does the tissue get a finer model for the time that it then would have. So this is the better half of
//! what two rates do, and a lower bound of what they cost. Without a [`Rates::Single`] that is as good as
//! the paper's one loop nothing would follow: that one is the program's own tick.
//!
//! At two rates the tick's limit of a change of force (`max_settle_step`) is off: it would hide the steps that are in question, and hold
//! back a tissue that has one tick for many. With one loop it is as shipped, and does not act here.

mod study;

pub use study::{MultiRate, Rated, Study, study};

use sulcus_core::tissue::TissueModel;
use sulcus_core::{
    DisplayMesh, NoProbe, Node, Object, Scene, SphereTree, State, TickInput, TickOutput, Vec3,
    Workspace, tick,
};

/// Ticks in one step of the slow loop: 58.8 Hz, the nearest to 60.
pub const EVERY: u64 = 17;

/// Who advances when.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rates {
    /// All at 1 kHz.
    Single,
    /// Tissue every [`EVERY`] ticks; between these its shape and compliance stay.
    FrozenCompliance,
    /// Tissue every [`EVERY`] ticks; between these it is rigid.
    FrozenShape,
}

impl Rates {
    /// All.
    pub const ALL: [Rates; 3] = [Rates::Single, Rates::FrozenCompliance, Rates::FrozenShape];

    /// For people.
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
    /// As shipped, or with the tissue's time scaled.
    scene: Scene,
    state: State,
    ws: Workspace,
    /// The scene with what yields as it was left, rigid: scene, state and workspace of the force loop.
    frozen: Option<(Scene, State, Workspace)>,
    ticks: u64,
}

impl Loops {
    /// `scene` before its first tick.
    pub fn new(scene: &Scene, rates: Rates) -> Self {
        let mut scene = match rates {
            Rates::Single => scene.clone(),
            _ => slowed(scene, EVERY as f64),
        };
        // Nobody looks, and the rigid copies are made anew 60 times in a second.
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

    /// One millisecond: what the hand gets.
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
        // The slow loop's own contact, from where the force loop has the tool.
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
        // Where it touches the new shape: what it would be inside of otherwise.
        for (tool, slow) in state.tools.iter_mut().zip(&self.state.tools) {
            tool.graphic = slow.graphic;
        }
        output
    }

    /// The workspace that the last tick's wrench is from.
    pub fn workspace(&self) -> &Workspace {
        self.frozen.as_ref().map_or(&self.ws, |(_, _, ws)| ws)
    }
}

/// The scene in which a tick's worth of tissue is `by` ticks' worth.
fn slowed(scene: &Scene, by: f64) -> Scene {
    let mut scene = scene.clone();
    // The tick's own limit of a change of force is per tick: in a step of many it would hold the tissue back.
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

/// The scene with all that yields as `ws` left it (at rest without one), and rigid.
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

/// The tree of object `k` as `ws` has it; none where it is rigid.
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
