//! The slow variants of hard cases, and every hard case with the judge in the tick.

use sulcus_cases::{Case, TABLE, find};
use sulcus_core::optimise::SolverKind;
use sulcus_support::long;

use crate::hard_cases::{SLOW, hold};

/// A quarter of the table: every fourth case, so that the expensive tissues are shared out.
fn quarter(first: usize) -> impl Iterator<Item = &'static Case> {
    TABLE.iter().skip(first).step_by(4)
}

#[test]
fn the_slow_variants_of_hard_cases_hold() {
    if !long::selected("slow-variants-of-hard-cases") {
        return;
    }
    let cases = SLOW.map(|name| find(name).expect("in the table"));
    // Two threads share the work.
    let (one, other) = cases.split_at(4);
    std::thread::scope(|scope| {
        for part in [one, other] {
            scope.spawn(move || hold(part.iter().copied(), SolverKind::ActiveSet));
        }
    });
}

#[test]
fn the_first_quarter_of_the_cases_holds_with_the_judge_in_the_tick() {
    if long::selected("judge-in-every-case-1") {
        hold(quarter(0), SolverKind::Clarabel);
    }
}

#[test]
fn the_second_quarter_of_the_cases_holds_with_the_judge_in_the_tick() {
    if long::selected("judge-in-every-case-2") {
        hold(quarter(1), SolverKind::Clarabel);
    }
}

#[test]
fn the_third_quarter_of_the_cases_holds_with_the_judge_in_the_tick() {
    if long::selected("judge-in-every-case-3") {
        hold(quarter(2), SolverKind::Clarabel);
    }
}

#[test]
fn the_fourth_quarter_of_the_cases_holds_with_the_judge_in_the_tick() {
    if long::selected("judge-in-every-case-4") {
        hold(quarter(3), SolverKind::Clarabel);
    }
}
