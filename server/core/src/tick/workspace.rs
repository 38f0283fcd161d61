//! Workspace: scratch and caches of a tick.

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
use crate::work::Counts;

/// Scratch and caches of a tick, allocated when the scene loads. A cache saves work and never affects a result: a fresh
/// workspace gives the same bits.
#[derive(Debug)]
pub struct Workspace {
    pub(crate) predictor: Predictor,
    /// Broad phase: the objects that each tool can come near.
    pub(crate) broad: Broad,
    /// Last substep of each group, at the slot of its first tool.
    pub(crate) substeps: [Substep; MAX_TOOLS],
    pub(crate) active_set: ActiveSet,
    pub(crate) blender: Blender,
    /// Cores of the nodes of each object; empty for an object without blending.
    pub(crate) cores: Vec<Vec<Core>>,
    /// Scratch: gaps of the rows, metres, for the selection of the smallest.
    pub(crate) gaps: Vec<f64>,
    pub(crate) sites: Vec<Site>,
    pub(crate) site_loads: Vec<f64>,
    pub(crate) loads: Vec<Wrench>,
    /// Yielding objects, in the order of the scene's objects.
    pub(crate) yielding: Vec<Yielding>,
    /// Index in `yielding` of each object; `None` for a rigid object.
    pub(crate) slots: Vec<Option<usize>>,
    /// Indices in `yielding` of the tissues evaluated in this tick: out of rest, driven by the hands, or near a tool.
    pub(crate) awake: Vec<usize>,
    /// Index in `substeps` of the group that has claimed each tissue in this tick, in the order of `yielding`; `None`
    /// without a claim.
    pub(crate) owners: Vec<Option<usize>>,
    /// Contact list of capacity 1, which ends a query at the first pair.
    pub(crate) any: ContactList,
    /// Zeros, as many as the longest configuration has numbers.
    pub(crate) zeros: Vec<f64>,
    /// Graphic poses by slot and loads at the start of the tick, for a restart of the tick.
    pub(crate) before: ([Pose; MAX_TOOLS], Vec<Wrench>),
    /// Whether both tools always share one problem; for tests.
    pub(crate) together: bool,
    /// Indices in `yielding` of the pockets, each with the ball (world axes, metres) outside of which no tip reads the
    /// pocket.
    pub(crate) pockets: Vec<(usize, Sphere)>,
    pub(crate) tick_loads: Vec<SiteLoad>,
    /// Largest distance of a sphere's centre from the working point, per tool, metres.
    pub(crate) levers: [f64; MAX_TOOLS],
    pub(crate) bytes: Vec<u8>,
    /// Counts of the present or last tick.
    pub(crate) counts: Counts,
    /// Number of spheres in contact of each tool.
    pub(crate) spheres: [u64; MAX_TOOLS],
    /// Contacts of the last solved substep, while the next substep lists its own.
    pub(crate) solved: ContactList,
}

impl Workspace {
    /// Returns the workspace for `scene`.
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
            active_set: match (yielding.is_empty(), scene.params.max_work) {
                (true, _) => ActiveSet::rigid_only(rows),
                (false, 0) => ActiveSet::with_capacity(dense),
                (false, _) => ActiveSet::with_capacity(dense).entering_few(),
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
            counts: Counts::default(),
            spheres: std::array::from_fn(|t| {
                let tool = scene.tools.get(t);
                tool.map_or(0, |tool| tool.tree.shape_at(tool.level).count() as u64)
            }),
            solved: ContactList::with_capacity(rows),
        }
    }

    /// Returns the contacts of the last problem of each group, sorted, with their loads in newtons; for tests, views
    /// and audits.
    ///
    /// The load of a hard contact is the multiplier of its row. On a blended surface the load is the sum of the
    /// contact's shares in the multipliers of the rows. Normals times loads add up to the wrench.
    pub fn contacts(&self) -> impl Iterator<Item = (&Contact, f64)> {
        self.substeps.iter().flat_map(Substep::loaded)
    }

    /// Returns the last problem of each group with its solution, for a check by an independent solver. A group is one
    /// tool, or both together. Groups without rows are left out.
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

    /// Returns a workspace without caches in contact prediction: the trees are traversed in every substep. Slower, the
    /// same bits; for tests and measurements.
    pub fn plain(scene: &Scene) -> Self {
        Self {
            predictor: Predictor::plain(scene),
            ..Self::new(scene)
        }
    }

    /// Returns a workspace in which both tools always share one problem. Slower, the same up to rounding; for tests.
    pub fn together(scene: &Scene) -> Self {
        Self {
            together: true,
            ..Self::new(scene)
        }
    }

    /// Returns the work counters of contact prediction, such as queries and tested pairs, since this workspace was
    /// created.
    pub fn work(&self) -> Work {
        self.predictor.work()
    }

    /// Returns the counts of the last tick, of which [`crate::TickOutput::work`] is the weighted sum.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Returns the configuration of object `k` at the end of the last tick; empty for a rigid object. The tissue model
    /// defines the layout: displacements from rest, metres, and further numbers in some models.
    pub fn shape_of(&self, k: usize) -> &[f64] {
        self.slots[k].map_or(&[], |slot| &self.yielding[slot].shape)
    }

    /// Whether object `k` was touched in the last tick or is on its way back to rest; false for a rigid object.
    pub fn is_awake(&self, k: usize) -> bool {
        self.slots[k].is_some_and(|slot| !self.yielding[slot].still)
    }

    /// Returns the displacements of the carriers of object `k`'s [`crate::DisplaySkin`] at the end of the last tick,
    /// world axes, metres. Carriers are the moving masters of a surface compliance, otherwise the nodes of the tree;
    /// zero for a rigid object.
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

    /// Writes the centres of the nodes `ids` of object `k` at the end of the last tick to `out`, world axes, metres.
    /// Returns false for a rigid object, whose centres are those of the tree.
    pub fn centres_of(&self, k: usize, ids: &[u32], out: &mut [Vec3]) -> bool {
        let Some(slot) = self.slots[k] else {
            return false;
        };
        let yielding = &self.yielding[slot];
        yielding.model.centres(&yielding.shape, ids, out);
        true
    }
}
