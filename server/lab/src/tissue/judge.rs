//! How far a tissue model comes to rest from where finite elements say.

use serde::Serialize;
use sulcus_cases::statistics::{Percentiles, percentiles_us};
use sulcus_core::Vec3;

use super::cases::Case;
use super::loaded::Loaded;
use super::organ::Organ;

/// The measures of one case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct CaseError {
    /// Name of the case.
    pub(crate) name: String,
    /// Root mean square of the error over the free vertices, in percent of the case's largest displacement.
    pub(crate) rms_percent: f64,
    /// It in percent of the root mean square of the displacement.
    pub(crate) rel_l2_percent: f64,
    /// Largest error, in percent of the case's largest displacement.
    pub(crate) max_percent: f64,
    /// Largest displacement of a free vertex by finite elements, millimetres.
    pub(crate) max_displacement_mm: f64,
    /// By the model.
    pub(crate) model_max_displacement_mm: f64,
}

/// One case with all that a picture of it needs.
pub(crate) struct Outcome {
    /// The measures.
    pub(crate) error: CaseError,
    /// Displacements by finite elements, metres.
    pub(crate) wanted: Vec<Vec3>,
    /// And by the model.
    pub(crate) found: Vec<Vec3>,
}

/// Judges a model on a case. The displacements are read when the model is at rest.
///
/// # Errors
/// If the model does not come to rest or the displacements cannot be read.
pub(crate) fn judge(model: &mut Loaded<'_>, organ: &Organ, case: &Case) -> anyhow::Result<Outcome> {
    let found = model.rest_under(&case.forces)?;
    let wanted = case.displacements(organ)?;
    Ok(Outcome {
        error: compare(&case.name, &organ.free, &wanted, &found),
        wanted,
        found,
    })
}

/// The measures of displacements `found` against those `wanted` at the vertices `free`, metres.
pub(crate) fn compare(name: &str, free: &[usize], wanted: &[Vec3], found: &[Vec3]) -> CaseError {
    let (mut error, mut size) = (0.0, 0.0);
    let (mut worst, mut most, mut model) = (0.0_f64, 0.0_f64, 0.0_f64);
    for &v in free {
        let off = (found[v] - wanted[v]).norm();
        error += off * off;
        size += wanted[v].norm_squared();
        worst = worst.max(off);
        most = most.max(wanted[v].norm());
        model = model.max(found[v].norm());
    }
    let count = free.len() as f64;
    CaseError {
        name: name.to_owned(),
        rms_percent: 100.0 * (error / count).sqrt() / most,
        rel_l2_percent: 100.0 * (error / size).sqrt(),
        max_percent: 100.0 * worst / most,
        max_displacement_mm: 1e3 * most,
        model_max_displacement_mm: 1e3 * model,
    }
}

/// CPU time per tick, microseconds.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct TickTime {
    pub(crate) p50: f64,
    pub(crate) p999: f64,
}

impl TickTime {
    /// Percentiles of times in nanoseconds.
    pub(crate) fn of(ns: &[u64]) -> Self {
        let Percentiles { p50, p999, .. } = percentiles_us(ns.iter().copied());
        Self { p50, p999 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_that_never_moves_misses_all_of_the_displacement() {
        let wanted = [Vec3::x() * 3e-3, Vec3::y() * 4e-3, Vec3::z()];
        let still = compare("still", &[0, 1], &wanted, &[Vec3::zeros(); 3]);
        assert!(
            (still.rel_l2_percent - 100.0).abs() < 1e-9 && (still.max_percent - 100.0).abs() < 1e-9
        );
        assert!((still.rms_percent - 100.0 * 12.5_f64.sqrt() / 4.0).abs() < 1e-9);
        assert!(
            (still.max_displacement_mm - 4.0).abs() < 1e-12
                && still.model_max_displacement_mm == 0.0
        );
        let half = wanted.map(|u| u * 0.5);
        assert!((compare("half", &[0, 1], &wanted, &half).rel_l2_percent - 50.0).abs() < 1e-9);
    }
}
