//! How far tissue is from its rest: pressed, let go, come back.

use sulcus_core::math::norm;
use sulcus_core::{Scene, Workspace};

use crate::residual::Solid;

/// Displacements under this are rest, metres: rounding and a last creep are no energy.
const REST: f64 = 1e-5;

/// Displacements of a run, over all tissues of a scene.
#[derive(Clone, Debug)]
pub(crate) struct Sway {
    /// Largest displacement of any leaf so far, metres.
    pub indentation: f64,
    /// Largest displacement in the last tick seen, metres.
    pub now: f64,
    /// Energy that appeared after letting go, as a share of what there was.
    pub rebound: f64,
    /// For each object its largest displacement when the last load on it went; none while it bears.
    let_go: Vec<Option<f64>>,
    loaded: Vec<bool>,
}

impl Sway {
    pub fn new(scene: &Scene) -> Self {
        Self {
            indentation: 0.0,
            now: 0.0,
            rebound: 0.0,
            let_go: vec![None; scene.objects.len()],
            loaded: vec![false; scene.objects.len()],
        }
    }

    /// Takes the shapes after a tick in.
    pub fn observe(&mut self, solids: &[Solid], ws: &Workspace) {
        self.loaded.fill(false);
        for (contact, load) in ws.contacts() {
            self.loaded[usize::from(contact.object)] |= load > 0.0;
        }
        self.now = 0.0;
        for (k, solid) in solids.iter().enumerate().filter(|(_, solid)| solid.yields) {
            let leaves = solid.leaves.iter().zip(&solid.rest);
            let moved = if solid.at_rest {
                0.0
            } else {
                leaves.fold(0.0, |most: f64, (leaf, rest)| {
                    most.max(norm(&(leaf.0 - rest)))
                })
            };
            self.now = self.now.max(moved);
            if self.loaded[k] {
                self.let_go[k] = None;
            } else {
                let then = *self.let_go[k].get_or_insert(moved);
                if moved > REST {
                    let share = moved / then.max(REST);
                    self.rebound = self.rebound.max(share * share - 1.0);
                }
            }
        }
        self.indentation = self.indentation.max(self.now);
    }
}
