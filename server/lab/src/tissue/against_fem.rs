//! The program's tissue models against finite elements of its own tongue: what a report shows where there are no outside
//! data.
//!
//! Both models are as shipped: `skeleton` as `tongue.toml` has it, `surface_compliance` as `organ.toml` does. The reference is of the
//! same drawn surface, held where `organ.toml` says, and has its Young's modulus and Poisson's ratio.
//!
//! What is shared and what is not. The surface compliance was condensed from linear elements of the same kind (quadratic tetrahedra
//! of the same mesher), on a lattice of another, wider spacing: so its error against the linear reference is that of condensation
//! to few masters and of the wider lattice, not of the element. Against the neo-Hookean reference that of its term for large
//! displacements comes on top. An error that both lattices have is not seen. The skeleton shares nothing with the reference but
//! surface and support, and its springs were chosen by feel (how far a mirror sinks in), not for a Young's modulus: it is several times
//! too soft here, and misses more than a model that never moves, which has a `rel_l2_percent` of 100. So beside it stands
//! `skeleton_one_factor`: the same with all springs stiffer by the one factor that serves best, found by linear elements on the
//! reference's own lattice under other loads.
//!
//! No model was fitted to any of the loads that it is judged by. A load is a traction; the elements get its
//! consistent forces, the models the same traction lumped to vertices, on their spheres as in `tissue evaluate`, and run
//! tick by tick until they rest. Compared are all free vertices of the reference's surface.

mod drawn;
mod fitted;
mod pushes;
mod reference;

use anyhow::anyhow;
use serde::Serialize;
use sulcus_core::tissue::TissueModel;

use super::judge::compare;
use super::loaded::Loaded;
use fitted::one_factor;
use reference::{Law, Reference, Tongue};

/// A model under one load, against finite elements.
#[derive(Serialize)]
pub(crate) struct AgainstFem {
    /// `skeleton`, `skeleton_one_factor` or `surface_compliance`.
    pub(crate) model: &'static str,
    /// The load, and the law of the finite elements, for people; with the model it tells entries apart.
    pub(crate) case: String,
    /// All of the load, newtons.
    pub(crate) force_n: f64,
    /// Root mean square of the error over the free vertices, in percent of the largest displacement by finite elements.
    pub(crate) rms_percent: f64,
    /// It in percent of the root mean square of the displacement: 100 for a model that never moves.
    pub(crate) rel_l2_percent: f64,
    /// Largest error, in percent of the largest displacement by finite elements.
    pub(crate) max_percent: f64,
    /// Largest displacement of a free vertex by finite elements, millimetres.
    pub(crate) max_displacement_mm: f64,
    /// Both shapes, the model's in the colours of its error; a PNG file.
    #[serde(skip)]
    pub(crate) picture_png: Vec<u8>,
}

/// Share of the time that the reference takes.
const REFERENCE: f64 = 0.8;

/// Compares the models with finite elements under two pushes, each moderate (about 4 mm) and large (about 10 mm), and a third all over
/// the back, moderate; with `quick` under the first, moderate alone. `progress` gets what is being done and how much of it all is done.
///
/// # Errors
/// If there is no equilibrium or a model does not come to rest: a fault of this program, there is no input.
pub(crate) fn against_fem(
    quick: bool,
    progress: &dyn Fn(&str, f64),
) -> anyhow::Result<Vec<AgainstFem>> {
    let tongue = Tongue::built_in(&|what, share| progress(what, 0.1 * share))?;
    // At the same time: the reference of `quick` keeps one processor busy.
    let (references, fitted) = std::thread::scope(|scope| {
        let fitted = scope.spawn(|| one_factor(&tongue));
        let references = tongue.references(quick, &|what, share| {
            progress(what, 0.1 + (REFERENCE - 0.1) * share);
        });
        let fitted = fitted.join();
        (references, fitted)
    });
    let references = references?;
    let fitted = fitted.map_err(|_| anyhow!("the fit of the skeleton broke off"))??;
    let models = [
        ("skeleton", &tongue.skeleton),
        ("skeleton_one_factor", &fitted),
        ("surface_compliance", &tongue.surface),
    ];
    let count = (models.len() * references.len()) as f64;
    let mut all = Vec::new();
    for (model, made) in models {
        for reference in &references {
            progress(
                &format!("{model}: {}", reference.name()),
                REFERENCE + (1.0 - REFERENCE) * all.len() as f64 / count,
            );
            all.push(judged(model, made, &tongue, reference)?);
        }
    }
    progress("compared with finite elements", 1.0);
    Ok(all)
}

fn judged(
    model: &'static str,
    made: &TissueModel,
    tongue: &Tongue,
    reference: &Reference,
) -> anyhow::Result<AgainstFem> {
    let mut made = made.clone();
    // A linear reference asks for the linear part alone, as in `tissue evaluate`.
    if let (TissueModel::Surface(surface), Law::Linear) = (&mut made, reference.law) {
        surface.params.large = 0.0;
    }
    let organ = &tongue.organ;
    let found = Loaded::new(organ, made)?.rest_under(&reference.forces)?;
    let case = reference.name();
    let error = compare(&case, &organ.free, &reference.moved, &found);
    Ok(AgainstFem {
        model,
        case,
        force_n: reference.force,
        rms_percent: error.rms_percent,
        rel_l2_percent: error.rel_l2_percent,
        max_percent: error.max_percent,
        max_displacement_mm: error.max_displacement_mm,
        picture_png: drawn::picture(&model.replace('_', " "), organ, reference, &found)?,
    })
}

#[cfg(test)]
mod long;
