//! Tissue in a tick: where it is, its part of the problem, and where it goes under the answer.

use crate::blend::ContactRow;
use crate::contact::soft::SoftNeighbours;
use crate::contact::{ContactList, ContactsFull, Distance, PosedTool, Predictor};
use crate::math::{Vec3, fmax};
use crate::rows::runs;
use crate::state::State;
use crate::tick::substep::Substep;
use crate::tick::workspace::Workspace;
use crate::tissue::{Gram, Hands, Tissue, refit};
use crate::tree::Node;
use crate::{MAX_TOOLS, Scene};

/// An object that can yield, in a workspace.
#[derive(Debug)]
pub(crate) struct Yielding {
    /// Index in the scene.
    pub object: usize,
    /// Its model, made ready.
    pub model: Box<dyn Tissue>,
    /// Present configuration.
    pub shape: Vec<f64>,
    /// Configuration at the end of the tick if nothing touched it.
    pub free: Vec<f64>,
    /// Configuration under the multipliers, and how far the spheres would go there, metres.
    target: Vec<f64>,
    to_target: f64,
    /// Whether it is at rest, would stay there and is not touched: then it costs nothing.
    pub still: bool,
    /// Whether the model was request in this tick: not while the state is at rest and nobody comes near.
    request: bool,
    /// Whether it must be request in any case.
    goes_by_hands: bool,
    /// How far its spheres would go to the free configuration, metres.
    pub relaxing: f64,
    /// Nodes at the present shape, if `fitted`; not kept while still.
    nodes: Vec<Node>,
    fitted: bool,
    /// What is near each tool.
    near: [SoftNeighbours; MAX_TOOLS],
    ids: Vec<u32>,
    centres: Vec<Vec3>,
}

impl Yielding {
    /// All that yields in `scene`, in the order of its objects.
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
                request: false,
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

    /// Whether a tick with `state` in slot `slot` may leave it alone, as the one before did.
    #[inline]
    pub fn may_sleep(&self, state: &State, slot: usize) -> bool {
        !self.request && !self.goes_by_hands && state.tissue.at_rest(slot)
    }

    /// Where it is as a tick begins; returns how far its spheres moved from where this workspace had them, metres.
    pub fn begin(&mut self, state: &State, slot: usize, hands: &Hands<'_>) -> f64 {
        if self.goes_by_hands || !state.tissue.at_rest(slot) {
            return self.evaluate(state, slot, hands);
        }
        // (An unasked one has been put to rest before.)
        if !self.request {
            return 0.0;
        }
        std::mem::swap(&mut self.shape, &mut self.target);
        self.shape.fill(0.0);
        self.free.fill(0.0);
        (self.still, self.request, self.fitted, self.relaxing) = (true, false, false, 0.0);
        self.model.motion(&self.target, &self.shape)
    }

    /// Asks the model where it is and would be; returns how far its spheres moved from where this workspace had them.
    pub fn evaluate(&mut self, state: &State, slot: usize, hands: &Hands<'_>) -> f64 {
        std::mem::swap(&mut self.shape, &mut self.target);
        let state = state.tissue.of(slot);
        self.still = self
            .model
            .free_step(state, hands, &mut self.shape, &mut self.free);
        (self.request, self.fitted) = (true, false);
        self.relaxing = if self.still {
            0.0
        } else {
            self.model.motion(&self.shape, &self.free)
        };
        self.model.motion(&self.target, &self.shape)
    }

    /// Whether the model was request in this tick.
    pub fn is_evaluated(&self) -> bool {
        self.request
    }

    /// How far any sphere is from where it rests, metres; `zeros` are as many as a configuration has, or more.
    pub fn displaced(&self, zeros: &[f64]) -> f64 {
        if self.still {
            0.0
        } else {
            self.model.motion(&zeros[..self.shape.len()], &self.shape)
        }
    }

    /// Goes all the way to where it would be without contact.
    pub fn relax(&mut self) {
        self.shape.copy_from_slice(&self.free);
        self.fitted = false;
    }

    /// Nothing that was found at an earlier shape counts any more.
    pub fn forget(&mut self) {
        self.near.iter_mut().for_each(SoftNeighbours::forget);
    }

    /// Brings the nodes to the present shape.
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

    /// Appends every pair of contact spheres of `tool` and this object at its present shape with a gap under
    /// `d` to `out`.
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
        // The traversal counts itself.
        predictor.work.queries -= 1;
        self.refit();
        let nodes = if self.still { at_rest } else { &self.nodes };
        predictor.predict(tool, (index, nodes, object.level), d, out)
    }

    /// Centre of a node at the present shape, whether refit or not, world axes, metres.
    pub fn centre(&self, scene: &Scene, node: u32) -> Vec3 {
        if self.still {
            return scene.objects[self.object].tree.nodes()[node as usize].centre;
        }
        let mut centre = [Vec3::zeros()];
        self.model.centres(&self.shape, &[node], &mut centre);
        centre[0]
    }

    /// Goes a share of the way to where the multipliers press it; returns how far its spheres moved at most, metres.
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

/// The tissue's part of the problem: compliance and the way from the free shape. False when
/// nothing touched yields.
pub(crate) fn fill_tissue(ws: &mut Workspace, index: usize) -> bool {
    let Substep {
        contacts,
        contact_rows,
        rows,
        tissue,
        gram,
        ..
    } = &mut ws.substeps[index];
    let contacts = contacts.as_slice();
    let about = |row: &ContactRow| &contacts[row.contact as usize];
    let slot_of = |object: u16| ws.slots[usize::from(object)];
    let mut touched = runs(contacts, |contact| contact.object);
    *tissue = touched.any(|run| slot_of(contacts[run.start].object).is_some());
    if !*tissue {
        return false;
    }
    let m = rows.len();
    gram[..m * m].fill(0.0);
    for run in runs(contact_rows, |row| about(row).object) {
        let Some(slot) = slot_of(about(&contact_rows[run.start]).object) else {
            continue;
        };
        let yielding = &mut ws.yielding[slot];
        ws.sites.clear();
        ws.sites.extend(
            contact_rows[run.clone()]
                .iter()
                .map(|row| about(row).site()),
        );
        yielding
            .model
            .add_gram(&ws.sites, &mut Gram::new(gram, m, run.start));
        if yielding.still {
            // Where it is is where it would be.
            continue;
        }
        // n . (u_k - u0): the rows are written at the present shape, the load acts on the free one.
        let mut last = (None, Vec3::zeros());
        for (problem_row, row) in rows[run.clone()].iter_mut().zip(&contact_rows[run]) {
            let contact = about(row);
            // Rows of one sphere stand together.
            if last.0 != Some(contact.object_sphere) {
                let mut centre = [Vec3::zeros(); 2];
                let [now, free] = &mut centre;
                let (id, model) = ([contact.object_sphere], &yielding.model);
                model.centres(&yielding.shape, &id, std::slice::from_mut(now));
                model.centres(&yielding.free, &id, std::slice::from_mut(free));
                last = (Some(contact.object_sphere), *now - *free);
            }
            problem_row.bias += contact.normal.dot(&last.1);
        }
    }
    true
}

/// Finds the configurations of the group's tissues under the multipliers; returns the largest motion to there, which each
/// tissue keeps for [`Yielding::advance`].
pub(crate) fn yield_target(ws: &mut Workspace, index: usize) -> f64 {
    let substep = &ws.substeps[index];
    let mut motion = 0.0;
    for &slot in &substep.tissues {
        let yielding = &mut ws.yielding[slot];
        let object = yielding.object;
        ws.sites.clear();
        ws.site_loads.clear();
        // Contacts are sorted by object.
        let contacts = substep.contacts.as_slice();
        let begin = contacts.partition_point(|contact| usize::from(contact.object) < object);
        let ours = contacts.iter().zip(&substep.shares).skip(begin);
        for (contact, load) in ours.take_while(|ours| usize::from(ours.0.object) == object) {
            ws.sites.push(contact.site());
            ws.site_loads.push(*load);
        }
        if yielding.still {
            if !ws.site_loads.iter().any(|load| *load > 0.0) {
                continue;
            }
            yielding.still = false;
        }
        let Yielding {
            model,
            shape,
            free,
            target,
            to_target,
            ..
        } = yielding;
        model.apply(&ws.sites, &ws.site_loads, free, target);
        *to_target = model.motion(shape, target);
        motion = fmax(motion, *to_target);
    }
    motion
}
