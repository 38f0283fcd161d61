//! Tissue in a tick: where it is, its part of the problem, and where it goes under the answer.

use std::ops::Range;

use crate::blend::Line;
use crate::contact::soft::SoftNeighbours;
use crate::contact::{Contact, ContactList, ContactsFull, Distance, PosedTool, Predictor};
use crate::math::{Vec3, fmax};
use crate::rows::runs;
use crate::state::State;
use crate::tick::{Pass, Workspace};
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
    /// Its part of [`State::tissue`].
    pub state: Range<usize>,
    /// Present configuration.
    pub shape: Vec<f64>,
    /// Configuration at the end of the tick if nothing touched it.
    pub free: Vec<f64>,
    /// Configuration under the multipliers.
    target: Vec<f64>,
    /// Whether it is at rest, would stay there and is not touched: then it costs nothing.
    pub still: bool,
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
        let mut begin = 0;
        let ready = scene.objects.iter().enumerate().filter_map(|(k, object)| {
            let first = begin;
            begin += object.tissue.state_len(&object.tree);
            let model = object.tissue.ready(&object.tree, object.level)?;
            let (len, nodes) = (model.shape_len(), object.tree.nodes());
            Some(Self {
                object: k,
                model,
                state: first..begin,
                shape: vec![0.0; len],
                free: vec![0.0; len],
                target: vec![0.0; len],
                still: true,
                nodes: nodes.to_vec(),
                fitted: false,
                near: std::array::from_fn(|t| {
                    SoftNeighbours::new(scene.tools.get(t), len, (nodes, object.level))
                }),
                ids: (0..nodes.len() as u32).collect(),
                centres: vec![Vec3::zeros(); nodes.len()],
            })
        });
        ready.collect()
    }

    /// Asks the model where it is and would be.
    pub fn free_step(&mut self, state: &State, hands: &Hands<'_>) {
        let state = &state.tissue[self.state.clone()];
        self.still = self
            .model
            .free_step(state, hands, &mut self.shape, &mut self.free);
        self.fitted = false;
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

    /// Goes a share of the way to where the multipliers press it.
    pub fn advance(&mut self, share: f64) {
        if !self.still {
            for (shape, target) in self.shape.iter_mut().zip(&self.target) {
                *shape += share * (target - *shape);
            }
            self.fitted = false;
        }
    }
}

/// The tissue's part of the problem: compliance and the way from the free shape. False when
/// nothing touched yields.
pub(crate) fn fill_tissue(scene: &Scene, ws: &mut Workspace, first: usize) -> bool {
    let Pass {
        contacts,
        lines,
        rows,
        tissue,
        ..
    } = &mut ws.passes[first];
    let contacts = contacts.as_slice();
    let about = |line: &Line| &contacts[line.contact as usize];
    let touched = |c: &Contact| !scene.objects[usize::from(c.object)].tissue.is_rigid();
    if ws.yielding.is_empty() || !contacts.iter().any(touched) {
        *tissue = false;
        return false;
    }
    *tissue = true;
    let m = rows.len();
    ws.gram[..m * m].fill(0.0);
    for run in runs(lines, |line| about(line).object) {
        let Some(slot) = ws.slots[usize::from(about(&lines[run.start]).object)] else {
            continue;
        };
        let yielding = &mut ws.yielding[slot];
        ws.sites.clear();
        ws.sites
            .extend(lines[run.clone()].iter().map(|line| about(line).site()));
        yielding
            .model
            .add_gram(&ws.sites, &mut Gram::new(&mut ws.gram, m, run.start));
        if yielding.still {
            // Where it is is where it would be.
            continue;
        }
        // n . (u_k - u0): the rows are written at the present shape, the load acts on the free one.
        let mut last = (None, Vec3::zeros());
        for (row, line) in rows[run.clone()].iter_mut().zip(&lines[run]) {
            let contact = about(line);
            // Rows of one sphere stand together.
            if last.0 != Some(contact.object_sphere) {
                let mut centre = [Vec3::zeros(); 2];
                let [now, free] = &mut centre;
                let (id, model) = ([contact.object_sphere], &yielding.model);
                model.centres(&yielding.shape, &id, std::slice::from_mut(now));
                model.centres(&yielding.free, &id, std::slice::from_mut(free));
                last = (Some(contact.object_sphere), *now - *free);
            }
            row.bias += contact.normal.dot(&last.1);
        }
    }
    true
}

/// Finds the configurations under the multipliers; returns the largest motion to there.
pub(crate) fn yield_target(ws: &mut Workspace, first: usize) -> f64 {
    let mut motion = 0.0;
    for yielding in &mut ws.yielding {
        ws.sites.clear();
        ws.site_loads.clear();
        for (contact, load) in ws.passes[first].loaded() {
            if usize::from(contact.object) == yielding.object {
                ws.sites.push(contact.site());
                ws.site_loads.push(load);
            }
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
            ..
        } = yielding;
        model.apply(&ws.sites, &ws.site_loads, free, target);
        motion = fmax(motion, model.motion(shape, target));
    }
    motion
}
