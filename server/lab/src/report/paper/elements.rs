//! Fig. 15: tissue models against finite elements of the program's own tongue.

use super::answers::Answers;
use crate::tissue::against_fem::AgainstFem;

/// Answers for Fig. 15 from a comparison that was made.
pub(super) fn answer(all: &[AgainstFem], answers: &mut Answers) {
    let of =
        |model: &str| -> Vec<&AgainstFem> { all.iter().filter(|one| one.model == model).collect() };
    let (surface, skeleton) = (of("surface_compliance"), of("skeleton_one_factor"));
    let as_shipped = of("skeleton");
    let most = |all: &[&AgainstFem], number: fn(&AgainstFem) -> f64| {
        all.iter().map(|one| number(one)).fold(0.0, f64::max)
    };
    let how = "static loads on the program's own tongue against its own quadratic finite elements, linear and neo-Hookean; rms over the free vertices of the surface, in percent of the largest displacement; no model was fitted to these loads";
    let (rms, skeleton_rms, shipped_rms) = (
        most(&surface, |one| one.rms_percent),
        most(&skeleton, |one| one.rms_percent),
        most(&as_shipped, |one| one.rms_percent),
    );
    let relative = most(&surface, |one| one.rel_l2_percent);
    let largest = most(&surface, |one| one.max_percent);
    answers.measured(
        "fig15-error-percent",
        format!("surface compliance {rms:.1} % at most (largest error of a vertex {largest:.1} %); springs with their one best factor {skeleton_rms:.1} %; springs as shipped, for a living tongue several times as soft, {shipped_rms:.1} %"),
        &[
            ("surface_rms_percent", rms),
            ("surface_max_percent", largest),
            ("surface_rel_l2_percent", relative),
            ("skeleton_one_factor_rms_percent", skeleton_rms),
            ("skeleton_shipped_rms_percent", shipped_rms),
        ],
        format!("{how}; of the root mean square of the displacement the surface compliance misses {relative:.1} %"),
    );
    let cases: Vec<String> = all
        .iter()
        .map(|one| {
            format!(
                "{}, {}: {:.1} %",
                one.model.replace('_', " "),
                one.case,
                one.rms_percent
            )
        })
        .collect();
    answers.measured("fig15-case-error-percent", cases.join("; "), &[], how);
    answers.measured(
        "tuned-error-percent",
        format!("{skeleton_rms:.1} % at most"),
        &[("skeleton_one_factor_rms_percent", skeleton_rms)],
        format!("{how}; the springs of the shipped skeleton times the one factor that serves best under other loads"),
    );
    let force = most(&surface, |one| one.force_n);
    let displacement = most(&surface, |one| one.max_displacement_mm);
    let least = |number: fn(&AgainstFem) -> f64| {
        surface
            .iter()
            .map(|one| number(one))
            .fold(f64::INFINITY, f64::min)
    };
    let (least_force, least_mm) = (
        least(|one| one.force_n),
        least(|one| one.max_displacement_mm),
    );
    answers.measured(
        "fig15-load-n",
        format!("{least_force} to {force} N"),
        &[("least_n", least_force), ("most_n", force)],
        "chosen here: moderate and large on a tongue of 10 kPa",
    );
    answers.measured(
        "fig15-displacement-mm",
        format!("{least_mm:.2} to {displacement:.2} mm"),
        &[("least_mm", least_mm), ("most_mm", displacement)],
        "largest displacement by finite elements under these loads",
    );
    let mut names: Vec<&str> = surface
        .iter()
        .filter_map(|one| one.case.split(',').next())
        .collect();
    names.dedup();
    answers.measured(
        "fig15-load-cases",
        names.join("; "),
        &[("cases", surface.len() as f64)],
        "broad pushes as a traction, each under linear and neo-Hookean elements; the first two moderate and large, the one all over the back moderate",
    );
}
