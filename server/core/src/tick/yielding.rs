//! Tissue in a tick: its present configuration, the one without contact, and the target under the multipliers.

use crate::contact::soft::SoftNeighbours;
use crate::contact::{ContactList, ContactsFull, Distance, PosedTool, Predictor};
use crate::math::Vec3;
use crate::state::State;
use crate::tissue::{Effort, Hands, Site, Tissue, refit};
use crate::tree::Node;
use crate::{MAX_TOOLS, Scene};

/// Yielding object of the scene in a workspace: its model, its shapes in the present tick, and its caches.
#[derive(Debug)]
pub(crate) struct Yielding {
    /// Index of the object in the scene.
    pub object: usize,
    /// Tissue model, prepared for this object.
    pub model: Box<dyn Tissue>,
    /// Present configuration: displacements from rest, in the layout of `model`.
    pub shape: Vec<f64>,
    /// Configuration at the end of the tick without contact.
    pub free: Vec<f64>,
    /// Configuration at the end of the tick under the multipliers of the present substep.
    target: Vec<f64>,
    /// Largest motion of a sphere from `shape` to `target`, metres.
    to_target: f64,
    /// Whether the tissue is at rest, stays at rest and is not touched. Such a tissue costs nothing.
    pub still: bool,
    /// Whether the model was evaluated in this tick: false while the state is at rest and no tool is near.
    evaluated: bool,
    /// Whether the model must be evaluated in every tick ([`Tissue::goes_by_hands`]).
    goes_by_hands: bool,
    /// Largest motion of a sphere from its place at the last evaluation to `free`, metres; 0 for a tissue at rest.
    pub relaxing: f64,
    /// Nodes of the object's tree, at the present shape if `fitted`; invalid while `still`.
    nodes: Vec<Node>,
    fitted: bool,
    /// Cached neighbour list of each tool slot on this object.
    near: [SoftNeighbours; MAX_TOOLS],
    /// Indices of all nodes of the tree, for a refit. The next field is scratch for their centres.
    ids: Vec<u32>,
    centres: Vec<Vec3>,
}

impl Yielding {
    /// Returns the yielding objects of `scene`, in the order of its objects.
    pub fn all(scene: &Scene) -> Vec<Self> {
        let ready = scene.objects.iter().enumerate().filter_map(|(k, object)| {
            let model = object
                .tissue
                .ready(&object.tree, object.level, scene.tick_s())?;
            let (len, nodes) = (model.shape_len(), object.tree.nodes());
            Some(Self {
                object: k,
                goes_by_hands: model.goes_by_hands(),
                model,
                shape: vec![0.0; len],
                free: vec![0.0; len],
                target: vec![0.0; len],
                to_target: 0.0,
                still: true,
                evaluated: false,
                relaxing: 0.0,
                nodes: nodes.to_vec(),
                fitted: false,
                near: std::array::from_fn(|t| {
                    SoftNeighbours::new(scene.tools.get(t), (k, len), (nodes, object.level))
                }),
                ids: (0..nodes.len() as u32).collect(),
                centres: vec![Vec3::zeros(); nodes.len()],
            })
        });
        ready.collect()
    }

    /// Whether a tick with `state` may skip the tissue `slot` (index among the yielding objects), as the previous tick
    /// did.
    #[inline]
    pub fn may_sleep(&self, state: &State, slot: usize) -> bool {
        !self.evaluated && !self.goes_by_hands && state.tissue.at_rest(slot)
    }

    /// Sets the configurations at the start of a tick. Returns the largest motion of a sphere since the last
    /// configuration in this workspace, metres.
    pub fn begin(&mut self, state: &State, slot: usize, hands: &Hands<'_>) -> f64 {
        if self.goes_by_hands || !state.tissue.at_rest(slot) {
            return self.evaluate(state, slot, hands);
        }
        // Already reset to rest in an earlier tick; nothing to do.
        if !self.evaluated {
            return 0.0;
        }
        std::mem::swap(&mut self.shape, &mut self.target);
        self.shape.fill(0.0);
        self.free.fill(0.0);
        (self.still, self.evaluated, self.fitted, self.relaxing) = (true, false, false, 0.0);
        self.model.motion(&self.target, &self.shape)
    }

    /// Evaluates the model: present and free configuration. Returns the largest motion of a sphere since the last
    /// configuration in this workspace, metres.
    pub fn evaluate(&mut self, state: &State, slot: usize, hands: &Hands<'_>) -> f64 {
        std::mem::swap(&mut self.shape, &mut self.target);
        let state = state.tissue.of(slot);
        self.still = self
            .model
            .free_step(state, hands, &mut self.shape, &mut self.free);
        (self.evaluated, self.fitted) = (true, false);
        self.relaxing = if self.still {
            0.0
        } else {
            self.model.motion(&self.shape, &self.free)
        };
        self.model.motion(&self.target, &self.shape)
    }

    /// Returns the declared work of the model.
    pub fn effort(&self) -> Effort {
        self.model.effort()
    }

    /// Whether the model was evaluated in this tick.
    pub fn is_evaluated(&self) -> bool {
        self.evaluated
    }

    /// Returns the largest distance of a sphere from its place at rest, metres. `zeros` must be at least as long as a
    /// configuration.
    pub fn displaced(&self, zeros: &[f64]) -> f64 {
        if self.still {
            0.0
        } else {
            self.model.motion(&zeros[..self.shape.len()], &self.shape)
        }
    }

    /// Sets the present configuration to `free`, the configuration without contact.
    pub fn relax(&mut self) {
        self.shape.copy_from_slice(&self.free);
        self.fitted = false;
    }

    /// Invalidates the cached neighbours of all tools.
    pub fn forget(&mut self) {
        self.near.iter_mut().for_each(SoftNeighbours::forget);
    }

    /// Returns the nodes at the present shape, world axes, metres. Computes them if no query has done so.
    pub fn fitted_nodes<'a>(&'a mut self, scene: &'a Scene) -> &'a [Node] {
        if self.still {
            return scene.objects[self.object].tree.nodes();
        }
        self.refit();
        &self.nodes
    }

    /// Updates the nodes to the present shape.
    fn refit(&mut self) {
        if !self.still && !self.fitted {
            let Self {
                model,
                shape,
                nodes,
                ids,
                centres,
                ..
            } = self;
            refit(model.as_ref(), shape, ids, centres, nodes);
            self.fitted = true;
        }
    }

    /// Appends to `out` every pair of contact spheres of `tool` and this object with a gap under `d`, at the present
    /// shape.
    ///
    /// # Errors
    /// The list is full and its overflow mode is `Overflow::Stop`.
    pub fn predict(
        &mut self,
        scene: &Scene,
        predictor: &mut Predictor,
        tool: &PosedTool<'_>,
        d: Distance,
        out: &mut ContactList,
    ) -> Result<(), ContactsFull> {
        let (object, index) = (&scene.objects[self.object], self.object as u16);
        let at_rest = object.tree.nodes();
        let slot = usize::from(tool.slot);
        predictor.work.queries += 1;
        if !predictor.is_plain() {
            let shape = (!self.still).then_some(self.shape.as_slice());
            if !self.near[slot].covers(predictor, tool.level, (self.model.as_ref(), shape), d) {
                self.refit();
                let nodes = if self.still { at_rest } else { &self.nodes };
                let listed = (nodes, object.level);
                let shape = (!self.still).then_some(self.shape.as_slice());
                self.near[slot].list(predictor, tool, listed, shape, d);
            }
            let now = (self.model.as_ref(), self.shape.as_slice());
            if self.near[slot].usable() {
                return self.near[slot].query(predictor, tool, (index, at_rest), now, d, out);
            }
            predictor.work.unlisted += 1;
        }
        // `Predictor::predict` counts the query itself.
        predictor.work.queries -= 1;
        self.refit();
        let nodes = if self.still { at_rest } else { &self.nodes };
        predictor.predict(tool, (index, nodes, object.level), d, out)
    }

    /// Returns the centre of a node at the present shape, world axes, metres. Needs no refit.
    pub fn centre(&self, scene: &Scene, node: u32) -> Vec3 {
        if self.still {
            return scene.objects[self.object].tree.nodes()[node as usize].centre;
        }
        let mut centre = [Vec3::zeros()];
        self.model.centres(&self.shape, &[node], &mut centre);
        centre[0]
    }

    /// Sets the target configuration under `loads` at `sites`, newtons against the normals, for [`Yielding::advance`].
    /// Returns the largest motion of a sphere to the target, metres; 0 for a tissue at rest without a load, which has
    /// no target.
    pub fn aim(&mut self, sites: &[Site], loads: &[f64]) -> f64 {
        if self.still {
            if !loads.iter().any(|load| *load > 0.0) {
                return 0.0;
            }
            self.still = false;
        }
        self.model.apply(sites, loads, &self.free, &mut self.target);
        self.to_target = self.model.motion(&self.shape, &self.target);
        self.to_target
    }

    /// Moves by `share` (0 to 1) of the way to the target configuration. Returns the largest motion of a sphere,
    /// metres.
    pub fn advance(&mut self, share: f64) -> f64 {
        if self.still {
            return 0.0;
        }
        for (shape, target) in self.shape.iter_mut().zip(&self.target) {
            *shape += share * (target - *shape);
        }
        self.fitted = false;
        share * self.to_target
    }
}
