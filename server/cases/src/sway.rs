//! Displacement of tissue from its rest, under load and after the load.

use sulcus_core::math::norm;
use sulcus_core::{Scene, Workspace};

use crate::residual::Solid;

/// Smallest displacement that counts, metres. Rounding and a slow creep below it are no energy.
const REST: f64 = 1e-5;

/// Displacements of a run, over all tissues of a scene.
#[derive(Clone, Debug)]
pub(crate) struct Sway {
    /// Largest displacement of any leaf so far, metres.
    pub indentation: f64,
    /// Largest displacement of any leaf in the last observed tick, metres.
    pub now: f64,
    /// Largest energy gain after the end of a load, relative to the energy at that moment.
    pub rebound: f64,
    /// For each object its largest displacement, metres, in the first tick without a load; `None` under load.
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

    /// Takes the shapes after a tick; `solids` hold these shapes.
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
