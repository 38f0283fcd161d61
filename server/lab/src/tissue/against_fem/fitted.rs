//! The shipped skeleton made as stiff as the finite elements.

use anyhow::{Context, bail};
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::skeleton::Skeleton;
use sulcus_fem::Factored;

use super::reference::Tongue;
use crate::tissue::fit::{Example, Fit, Freedom};
use crate::tissue::loads::training;

/// Places of training loads on patches, each loaded along three axes, and training loads spread all over. One number is sought:
/// more tell no more.
const PATCHES: usize = 10;
const SPREAD: usize = 6;
/// Steps of the fit at most.
const STEPS: usize = 40;

/// The skeleton with one factor on all its springs: the one that serves best under training loads (of which none is a load that
/// it is then judged by), linear. What is left is what no choice of a stiffness mends.
///
/// # Errors
/// If the springs do not hold it: a fault of this program.
pub(super) fn one_factor(tongue: &Tongue) -> anyhow::Result<TissueModel> {
    let TissueModel::Skeleton(shipped) = &tongue.skeleton else {
        bail!("tongue.toml: found another tissue, expected a skeleton");
    };
    let organ = &tongue.organ;
    let loads = training(organ, PATCHES, SPREAD);
    let on_nodes: Vec<_> = loads.iter().map(|load| load.on_nodes.clone()).collect();
    let moved = Factored::new(&organ.elements, &tongue.material)?.solve(&on_nodes)?;
    let examples: Vec<Example> = loads
        .into_iter()
        .zip(&moved)
        .map(|(load, moved)| Example {
            forces: load.on_vertices,
            moved: tongue.on_surface(moved),
        })
        .collect();
    let fit = Fit::new(organ, &shipped.coarse, &examples, Freedom::One);
    let (coarse, _, _) = fit
        .run(STEPS, &|_, _| ())
        .context("the skeleton of the tongue cannot be solved")?;
    Ok(TissueModel::Skeleton(Box::new(Skeleton {
        coarse,
        fine: None,
    })))
}
