//! A tissue model of the core under loads on the skin, tick by tick until it rests.

use anyhow::bail;
use sulcus_core::tissue::{Hands, Site, SiteLoad, Tissue, TissueModel};
use sulcus_core::{DisplaySkin, MAX_TOOLS, Vec3};

use super::organ::{LEVEL, Organ};
use super::pushed::push;
use sulcus_cases::timing::cpu_ns;

/// Ticks in which it must come to rest: a minute.
const MOST_TICKS: usize = 60_000;
/// Length of a tick in which a model comes to rest, seconds.
const TICK_S: f64 = 1e-3;
/// Share of the displacement that may be left to go.
const LEFT: f64 = 1e-5;
/// Displacements under this are none, metres.
const NOTHING: f64 = 1e-12;

/// A tissue model made ready for an organ.
pub(crate) struct Loaded<'a> {
    organ: &'a Organ,
    model: TissueModel,
    /// The surface, as the model carries it.
    skin: DisplaySkin,
    ready: Box<dyn Tissue>,
    ids: Vec<u32>,
    ns: Vec<u64>,
}

impl<'a> Loaded<'a> {
    /// # Errors
    /// If the model cannot stand.
    pub(crate) fn new(organ: &'a Organ, model: TissueModel) -> anyhow::Result<Self> {
        model.validate(&organ.tree, TICK_S)?;
        let Some(ready) = model.ready(&organ.tree, LEVEL, TICK_S) else {
            bail!("found a rigid model, expected one that yields");
        };
        let vertices = &organ.surface.vertices;
        let skin = DisplaySkin::of_tissue(&organ.tree, LEVEL, &model, vertices);
        Ok(Self {
            ready,
            skin,
            model,
            ids: (0..organ.tree.nodes().len() as u32).collect(),
            organ,
            ns: Vec::new(),
        })
    }

    /// Displacements of the surface's vertices (metres) at rest under forces on them (newtons).
    ///
    /// # Errors
    /// If it does not come to rest.
    pub(crate) fn rest_under(&mut self, forces: &[Vec3]) -> anyhow::Result<Vec<Vec3>> {
        let tree = &self.organ.tree;
        let mut loads = vec![Vec3::zeros(); tree.nodes().len()];
        match &self.model {
            TissueModel::Surface(model) => {
                let on = (self.organ.surface.vertices.as_slice(), forces);
                push(model, (tree, LEVEL), on, &mut loads);
            }
            _ => self.skin.loads(forces, &mut loads),
        }
        let pushed = loads.iter().enumerate().filter(|(_, f)| f.norm() > 0.0);
        let given: Vec<SiteLoad> = pushed
            .map(|(k, f)| SiteLoad {
                sphere: k as u32,
                tool: 0,
                force: *f,
            })
            .collect();
        // One site for each sphere, against its force.
        let sites: Vec<Site> = given
            .iter()
            .map(|l| Site {
                sphere: l.sphere,
                normal: -l.force.normalize(),
            })
            .collect();
        let lambda: Vec<f64> = given.iter().map(|l| l.force.norm()).collect();
        let hands = Hands {
            tools: [None; MAX_TOOLS],
            detail: 0,
        };
        let mut state = vec![0.0; self.model.state_len(tree)];
        let n = self.ready.shape_len();
        let (mut shape, mut free, mut now) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let rest = vec![0.0; n];
        let (mut last, mut calm, mut ticks) = (f64::INFINITY, 0, 0);
        while calm < 3 {
            if ticks == MOST_TICKS {
                bail!("the model did not come to rest in {ticks} ticks");
            }
            ticks += 1;
            let start = cpu_ns();
            self.ready.free_step(&state, &hands, &mut shape, &mut free);
            self.ready.apply(&sites, &lambda, &free, &mut now);
            self.ready.commit(&now, Some(&given), &hands, &mut state);
            self.ns.push(cpu_ns() - start);
            if !now.iter().all(|x| x.is_finite()) {
                bail!("the model went beyond all bounds in tick {ticks}");
            }
            // What is left of a geometric series whose terms shrink so fast.
            let step = self.ready.motion(&shape, &now);
            let far = self.ready.motion(&rest, &now);
            let left = if step < last {
                step * step / (last - step)
            } else {
                step / LEFT
            };
            calm = if step <= NOTHING || left <= LEFT * far {
                calm + 1
            } else {
                0
            };
            last = step;
        }
        let carriers = match &self.model {
            TissueModel::Surface(_) => now.chunks_exact(3).map(Vec3::from_column_slice).collect(),
            _ => {
                let mut centres = vec![Vec3::zeros(); self.ids.len()];
                self.ready.centres(&now, &self.ids, &mut centres);
                for (centre, node) in centres.iter_mut().zip(tree.nodes()) {
                    *centre -= node.centre;
                }
                centres
            }
        };
        let mut moved = vec![Vec3::zeros(); forces.len()];
        self.skin.displacements(&carriers, &mut moved);
        Ok(moved)
    }

    /// CPU time of each tick that the tissue took to get there, nanoseconds.
    pub(crate) fn tick_ns(&self) -> &[u64] {
        &self.ns
    }
}

#[cfg(test)]
mod tests;
