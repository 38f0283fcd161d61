//! Scratch of a tick.

use crate::MAX_TOOLS;
use crate::blend::{Blender, Core, cores};
use crate::contact::broad::Broad;
use crate::contact::{Contact, ContactList, Predictor, Work};
use crate::input::TickInput;
use crate::math::{Pose, Vec3, Wrench};
use crate::optimise::{Problem, Solution, active_set::ActiveSet};
use crate::scene::Scene;
use crate::state::State;
use crate::tick::substep::Substep;
use crate::tick::yielding::Yielding;
use crate::tissue::{Site, SiteLoad, TissueModel};
use crate::tree::Sphere;

/// Scratch of a tick, sized when the scene loads. What outlives a tick in it saves work and never
/// shows in a result: a fresh one gives the same bits.
#[derive(Debug)]
pub struct Workspace {
    pub(crate) predictor: Predictor,
    /// What each tool can come near at all.
    pub(crate) broad: Broad,
    /// Per tool, or in the first tool's place where both share one problem.
    pub(crate) substeps: [Substep; MAX_TOOLS],
    pub(crate) active_set: ActiveSet,
    pub(crate) blender: Blender,
    /// Cores of each object's nodes; none where it is not blended.
    pub(crate) cores: Vec<Vec<Core>>,
    /// Gaps of the rows, to choose among them.
    pub(crate) gaps: Vec<f64>,
    pub(crate) sites: Vec<Site>,
    pub(crate) site_loads: Vec<f64>,
    pub(crate) loads: Vec<Wrench>,
    /// What can yield, in the order of the scene's objects.
    pub(crate) yielding: Vec<Yielding>,
    /// For each object its place in `yielding`.
    pub(crate) slots: Vec<Option<usize>>,
    /// Places in `yielding` of what was request in this tick: all that is not at rest, or has a tool near.
    pub(crate) awake: Vec<usize>,
    /// Whose pass each of `yielding` belongs to in this tick.
    pub(crate) owners: Vec<Option<usize>>,
    /// What ends a query at the first pair.
    pub(crate) any: ContactList,
    /// As many zeros as the longest configuration has numbers.
    pub(crate) zeros: Vec<f64>,
    /// Graphic poses and loads as the tick began.
    pub(crate) before: ([Pose; MAX_TOOLS], Vec<Wrench>),
    /// Whether both tools always share one problem: for tests.
    pub(crate) together: bool,
    /// Places in `yielding` of the pockets, and the balls outside of which no tip reads them.
    pub(crate) pockets: Vec<(usize, Sphere)>,
    pub(crate) tick_loads: Vec<SiteLoad>,
    /// Largest distance of a sphere from the working point, per tool, metres.
    pub(crate) levers: [f64; MAX_TOOLS],
    pub(crate) bytes: Vec<u8>,
}

impl Workspace {
    /// Scratch for `scene`.
    pub fn new(scene: &Scene) -> Self {
        let yielding = Yielding::all(scene);
        let blended = (0..scene.objects.len()).any(|k| scene.blend_of(k) > 0.0);
        let rows = scene.most_contacts() * scene.tools.len();
        let dense = scene.most_rows();
        let tool_nodes = scene
            .tools
            .iter()
            .map(|tool| tool.tree.nodes().len())
            .max()
            .unwrap_or(0);
        let lever = |t: usize| {
            scene
                .tools
                .get(t)
                .map_or(0.0, |tool| tool.tree.lever_from(&tool.working_point))
        };
        let tissues = yielding.len();
        // Only tissue needs the dense matrix.
        let sizes = (rows, if tissues == 0 { 0 } else { dense });
        let pockets = yielding.iter().enumerate();
        let pockets = pockets.filter_map(|(slot, of)| Some((slot, of.model.pocket()?)));
        let longest = yielding.iter().map(|yielding| yielding.shape.len()).max();
        Self {
            predictor: Predictor::new(scene),
            broad: Broad::new(scene),
            substeps: std::array::from_fn(|_| {
                Substep::with_capacity(sizes, blended, tool_nodes, tissues)
            }),
            blender: Blender::with_capacity(if blended { rows } else { 0 }),
            cores: (0..scene.objects.len()).map(|k| cores(scene, k)).collect(),
            pockets: pockets.collect(),
            awake: Vec::with_capacity(tissues),
            owners: vec![None; tissues],
            any: ContactList::with_capacity(1),
            zeros: vec![0.0; longest.unwrap_or(0)],
            before: (
                [Pose::identity(); MAX_TOOLS],
                vec![Wrench::ZERO; scene.tools.len() * scene.objects.len()],
            ),
            together: false,
            active_set: if yielding.is_empty() {
                ActiveSet::rigid_only(rows)
            } else {
                ActiveSet::with_capacity(dense)
            },
            gaps: Vec::with_capacity(rows),
            sites: Vec::with_capacity(rows),
            site_loads: Vec::with_capacity(rows),
            loads: vec![Wrench::ZERO; scene.tools.len() * scene.objects.len()],
            slots: (0..scene.objects.len())
                .map(|k| yielding.iter().position(|yielding| yielding.object == k))
                .collect(),
            tick_loads: Vec::with_capacity(if yielding.is_empty() { 0 } else { rows }),
            yielding,
            levers: std::array::from_fn(lever),
            bytes: Vec::with_capacity(TickInput::BYTES + State::most_bytes(scene)),
        }
    }

    /// Contacts of each tool's last problem, sorted, with their loads (newtons): what a test, a view or
    /// an audit wants to know. A load is the multiplier of the contact's row; on a blended surface
    /// the sum of its shares in the rows' multipliers. Normals times loads add up to the wrench.
    pub fn contacts(&self) -> impl Iterator<Item = (&Contact, f64)> {
        self.substeps.iter().flat_map(Substep::loaded)
    }

    /// The last problem of each tool (or of both together) and its answer, for an independent solver to
    /// judge.
    pub fn last_problems(&self, scene: &Scene) -> impl Iterator<Item = (Problem<'_>, &Solution)> {
        let contact_compliance = scene.params.contact_compliance;
        let max_iterations = usize::from(scene.params.max_iterations);
        let solved = |substep: &&Substep| {
            !substep.rows.is_empty() && substep.solution.lambda.len() == substep.rows.len()
        };
        self.substeps.iter().filter(solved).map(move |substep| {
            let m = substep.rows.len();
            let problem = Problem {
                rows: &substep.rows,
                tissue: substep.tissue.then(|| &substep.gram[..m * m]),
                contact_compliance,
                warm_start: &[],
                max_iterations,
            };
            (problem, &substep.solution)
        })
    }

    /// The same, except that contact prediction traverses the trees anew in every pass: slower, the same
    /// bits. For tests and measurements.
    pub fn plain(scene: &Scene) -> Self {
        Self {
            predictor: Predictor::plain(scene),
            ..Self::new(scene)
        }
    }

    /// The same, except that both tools always share one problem: slower, and the same to rounding. For tests.
    pub fn together(scene: &Scene) -> Self {
        Self {
            together: true,
            ..Self::new(scene)
        }
    }

    /// What contact prediction did since this workspace was made.
    pub fn work(&self) -> Work {
        self.predictor.work()
    }

    /// Present configuration of object `k` at the end of the last tick (displacements), empty for
    /// a rigid one.
    pub fn shape_of(&self, k: usize) -> &[f64] {
        self.slots[k].map_or(&[], |slot| &self.yielding[slot].shape)
    }

    /// Whether object `k` was touched in the last tick or is on its way back to rest; never a rigid one.
    pub fn is_awake(&self, k: usize) -> bool {
        self.slots[k].is_some_and(|slot| !self.yielding[slot].still)
    }

    /// How far the carriers of object `k`'s [`crate::DisplaySkin`] had gone at the end of the last tick, by index, world axes,
    /// metres.
    pub fn carriers_moved(&self, scene: &Scene, k: usize) -> Vec<Vec3> {
        let (object, shape) = (&scene.objects[k], self.shape_of(k));
        if let TissueModel::Surface(_) = object.tissue {
            return shape.chunks_exact(3).map(Vec3::from_column_slice).collect();
        }
        let nodes = object.tree.nodes();
        let ids: Vec<u32> = (0..nodes.len() as u32).collect();
        let mut moved = vec![Vec3::zeros(); nodes.len()];
        if self.centres_of(k, &ids, &mut moved) {
            for (moved, node) in moved.iter_mut().zip(nodes) {
                *moved -= node.centre;
            }
        }
        moved
    }

    /// Centres of the nodes `ids` of object `k` at the end of the last tick, world axes, metres; false
    /// for a rigid object, whose centres are the tree's.
    pub fn centres_of(&self, k: usize, ids: &[u32], out: &mut [Vec3]) -> bool {
        let Some(slot) = self.slots[k] else {
            return false;
        };
        let yielding = &self.yielding[slot];
        yielding.model.centres(&yielding.shape, ids, out);
        true
    }
}
