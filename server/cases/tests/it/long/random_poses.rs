//! A million random poses, and a hundred thousand with the judge in the tick.

use sulcus_core::optimise::SolverKind;
use sulcus_support::long;

use crate::random_poses::walk;

#[test]
fn a_million_random_poses() {
    if long::selected("random-poses") {
        walk(1_000_000, 0, SolverKind::ActiveSet, 1.0);
    }
}

#[test]
fn a_hundred_thousand_random_poses_with_the_judge_in_the_tick() {
    if long::selected("judged-random-poses") {
        walk(100_000, 100, SolverKind::Clarabel, 1.0);
    }
}
