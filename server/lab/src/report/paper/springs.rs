//! Sections 3.1, 4.4 and 8.1: the springs of the tongue, and what explicit Euler can do with them.

use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::printed::PrintedSkeleton;
use sulcus_core::tissue::printed::stability::Spectrum;
use sulcus_core::{Object, Params};

use super::answers::Answers;

/// Answers for the skeleton of `organ`.
pub(super) fn answer(organ: &Object, answers: &mut Answers) {
    let TissueModel::Skeleton(model) = &organ.tissue else {
        return;
    };
    let coarse = &model.coarse;
    let level = coarse
        .nodes
        .iter()
        .map(|&node| organ.tree.nodes()[node as usize].level)
        .max();
    let level = f64::from(level.unwrap_or(0));
    let how =
        "the shipped tongue; a finer skeleton stands beside it and is used where time is left";
    answers.measured(
        "skeleton-level",
        format!("{level}"),
        &[("level", level)],
        how,
    );
    let (nodes, springs) = (coarse.nodes.len(), coarse.springs.len());
    let held = coarse.fixed.iter().filter(|fixed| **fixed).count();
    answers.measured(
        "skeleton-spheres",
        format!("{nodes}, {held} of them held"),
        &[("spheres", nodes as f64), ("held", held as f64)],
        how,
    );
    answers.measured(
        "skeleton-springs",
        format!("{springs}"),
        &[("springs", springs as f64)],
        how,
    );
    let stiffness: Vec<f64> = coarse.springs.iter().flat_map(|s| s.stiffness).collect();
    let mean = stiffness.iter().sum::<f64>() / stiffness.len().max(1) as f64 * 1e-3;
    answers.measured(
        "fig15-spring",
        format!("{mean:.4} N/mm on average"),
        &[("n_per_mm", mean)],
        "the shipped tongue, so soft that it gives way 10 mm at 1 to 2 N",
    );
    let damping = coarse.params.damping * 1e-3;
    answers.measured(
        "fig15-damping",
        format!("{damping} N s/mm"),
        &[("n_s_per_mm", damping)],
        "the shipped tongue, each node against the world",
    );
    for (id, value, unit) in [
        ("fig15-young-kpa", 10.0, "kPa"),
        ("fig15-poisson", 0.49, ""),
    ] {
        answers.measured(
            id,
            format!("{value} {unit}").trim().to_owned(),
            &[("value", value)],
            "of the finite elements here, as the scene `organ` has them; results in percent do not depend on a linear reference's modulus",
        );
    }
    explicit(organ, answers);
}

/// What Eq. 9 says of the tongue's own springs.
fn explicit(organ: &Object, answers: &mut Answers) {
    let TissueModel::Skeleton(model) = &organ.tissue else {
        return;
    };
    let printed = PrintedSkeleton::of(&model.coarse, &organ.tree);
    let spectrum = printed
        .spectrum(&organ.tree)
        .expect("the springs of the shipped tongue");
    let limit = |damping: f64, mass: f64| spectrum.largest_time_step(damping, mass) * 1e3;
    let own = limit(printed.damping_n_s_per_m, printed.mass_kg);
    // The printed constants: 0.5 N/mm, 0.6 N s/mm.
    let (spring, damping) = (500.0, 600.0);
    let scaled = spectrum.scaled(spring / printed.spring_n_per_m, 0.0);
    let grams = printed.mass_kg * 1e3;
    let as_printed = scaled.largest_time_step(damping, printed.mass_kg) * 1e3;
    let needed = scaled.smallest_mass(damping, Params::default().tick_s()) * 1e3;
    answers.measured(
        "eq9-tongue-limit-ms",
        format!("{as_printed:.4} ms with the printed constants and {grams} g a sphere (1 ms would take {needed:.0} g a sphere); {own:.2} ms with this program's"),
        &[
            ("printed_constants_ms", as_printed),
            ("mass_for_1_ms_g", needed),
            ("own_constants_ms", own),
        ],
        format!("Eq. 9 by the largest eigenvalue of the shipped tongue's {} springs; own constants of the method as printed: {:.4} N/mm, {} N s/m, {grams} g", printed.springs.len(), printed.spring_n_per_m * 1e-3, printed.damping_n_s_per_m),
    );
    let fine = model.fine.as_ref();
    let fine = fine.expect("the shipped tongue has a finer skeleton");
    let springs: Vec<[u32; 2]> = fine
        .springs
        .iter()
        .map(|s| [u32::from(s.a), u32::from(s.b)])
        .collect();
    let found = Spectrum::of_unit_springs(fine.nodes.len(), &springs, &fine.fixed);
    let found = found.scaled(printed.spring_n_per_m, 0.0);
    let found = found.largest_time_step(printed.damping_n_s_per_m, printed.mass_kg) * 1e3;
    answers.measured(
        "open-finer-stability",
        format!("limit {found:.2} ms on {} springs, {own:.2} ms on {}", springs.len(), printed.springs.len()),
        &[("fine_ms", found), ("coarse_ms", own)],
        "explicit Euler by Eq. 9 on the finer skeleton with the same stiffness, damping and mass of each; the default model is implicit and has no such limit",
    );
}
