//! The skeleton of the core under loads on the skin, tick by tick until it rests.

use anyhow::bail;
use sulcus_core::tissue::printed::PrintedSkeleton;
use sulcus_core::tissue::skeleton::{CARRIERS, Skeleton, SkeletonLevel, Spring, StretchLaw};
use sulcus_core::tissue::{Hands, Site, SiteLoad, Tissue, TissueModel};
use sulcus_core::{MAX_TOOLS, Vec3};

use super::judge::Judged;
use super::organ::{LEVEL, Organ};
use crate::realtime::thread_cpu_ns;

/// Ticks in which it must come to rest: a minute.
const MOST_TICKS: usize = 60_000;
/// Share of the displacement that may be left to go.
const LEFT: f64 = 1e-5;
/// Displacements under this are none, metres.
const NOTHING: f64 = 1e-12;

/// A skeleton made ready for an organ.
pub(crate) struct Loaded<'a> {
    organ: &'a Organ,
    model: TissueModel,
    ready: Box<dyn Tissue>,
    ids: Vec<u32>,
    ns: Vec<u64>,
}

impl<'a> Loaded<'a> {
    /// # Errors
    /// If the skeleton cannot stand.
    pub(crate) fn new(organ: &'a Organ, skeleton: Skeleton) -> anyhow::Result<Self> {
        let model = TissueModel::Skeleton(Box::new(skeleton));
        model.validate(&organ.tree)?;
        let Some(ready) = model.ready(&organ.tree, LEVEL) else {
            bail!("found a rigid model, expected one that yields");
        };
        Ok(Self {
            ready,
            model,
            ids: (0..organ.tree.nodes().len() as u32).collect(),
            organ,
            ns: Vec::new(),
        })
    }
}

impl Judged for Loaded<'_> {
    fn rest_under(&mut self, forces: &[Vec3]) -> anyhow::Result<Vec<Vec3>> {
        let tree = &self.organ.tree;
        let mut loads = vec![Vec3::zeros(); tree.nodes().len()];
        self.organ.skin.loads(forces, &mut loads);
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
            let start = thread_cpu_ns();
            self.ready.free_step(&state, &hands, &mut shape, &mut free);
            self.ready.apply(&sites, &lambda, &free, &mut now);
            self.ready.commit(&now, Some(&given), &hands, &mut state);
            self.ns.push(thread_cpu_ns() - start);
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
        let mut centres = vec![Vec3::zeros(); self.ids.len()];
        self.ready.centres(&now, &self.ids, &mut centres);
        for (centre, node) in centres.iter_mut().zip(tree.nodes()) {
            *centre -= node.centre;
        }
        let mut moved = vec![Vec3::zeros(); forces.len()];
        self.organ.skin.displacements(&centres, &mut moved);
        Ok(moved)
    }

    fn tick_ns(&self) -> &[u64] {
        &self.ns
    }
}

/// What a skeleton as printed comes to rest at: all its springs as stiff, each sphere after one of the skeleton's. Its explicit
/// Euler and this implicit one differ on the way, not at rest, where springs balance loads.
pub(crate) fn as_printed(skeleton: &Skeleton, organ: &Organ) -> Skeleton {
    let printed = PrintedSkeleton::of(&skeleton.coarse, &organ.tree);
    let mut coarse: SkeletonLevel = skeleton.coarse.clone();
    coarse.params.law = StretchLaw::LINEAR;
    for spring in &mut coarse.springs {
        *spring = Spring {
            stiffness: [printed.spring_n_per_m; 3],
            coupling: [0.0; 3],
            ..*spring
        };
    }
    one_carrier(&mut coarse);
    Skeleton { coarse, fine: None }
}

/// Leaves each sphere the one node that carries most of it.
pub(crate) fn one_carrier(level: &mut SkeletonLevel) {
    for skin in &mut level.skin {
        let most = (1..CARRIERS).fold(0, |most, k| {
            if skin.weights[k] > skin.weights[most] {
                k
            } else {
                most
            }
        });
        skin.weights = std::array::from_fn(|k| f64::from(u8::from(k == most)));
    }
}

#[cfg(test)]
mod tests;
