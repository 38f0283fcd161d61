//! Tissue in a tick: where it is, its part of the problem, and where it goes under the answer.

use std::ops::Range;

use crate::Scene;
use crate::blend::Line;
use crate::contact::Contact;
use crate::math::{Vec3, fmax};
use crate::rows::runs;
use crate::state::State;
use crate::tick::{Pass, Workspace};
use crate::tissue::{Gram, Hands, Tissue, refit};
use crate::tree::Node;

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
    /// Nodes at the present shape; not kept while still.
    nodes: Vec<Node>,
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
    }

    /// Brings the nodes to the present shape.
    pub fn refit(&mut self) {
        if !self.still {
            let Self {
                model,
                shape,
                nodes,
                ids,
                centres,
                ..
            } = self;
            refit(model.as_ref(), shape, ids, centres, nodes);
        }
    }

    /// Nodes at the shape of the last [`Yielding::refit`].
    pub fn nodes<'a>(&'a self, scene: &'a Scene) -> &'a [Node] {
        if self.still {
            scene.objects[self.object].tree.nodes()
        } else {
            &self.nodes
        }
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
        for (row, line) in rows[run.clone()].iter_mut().zip(&lines[run]) {
            let contact = about(line);
            let mut free = [Vec3::zeros()];
            yielding
                .model
                .centres(&yielding.free, &[contact.object_sphere], &mut free);
            let now = yielding.nodes[contact.object_sphere as usize].centre;
            row.bias += contact.normal.dot(&(now - free[0]));
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
