//! Every habit of twenty hands.

use std::sync::Mutex;

use sulcus_operator::Habit;
use sulcus_support::long;

use crate::grades::{PROBING, WHOLE_TOOTH, all_must_hold};

/// Performs an exercise with the habits for every seed, on two threads.
fn hands(exercise: &str, habits: &[Habit], seeds: std::ops::RangeInclusive<u64>) {
    let seeds = Mutex::new(seeds);
    let next = || seeds.lock().expect("no hand panicked").next();
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(seed) = next() {
                    all_must_hold(exercise, habits, seed);
                }
            });
        }
    });
}

#[test]
fn every_habit_of_ten_hands_is_named_and_costs() {
    if long::selected("habits-of-hands-1-to-10") {
        hands(WHOLE_TOOTH, &PROBING, 1..=10);
    }
}

#[test]
fn every_habit_of_ten_more_hands_is_named_and_costs() {
    if long::selected("habits-of-hands-11-to-20") {
        hands(WHOLE_TOOTH, &PROBING, 11..=20);
    }
}

#[test]
fn a_tongue_let_go_by_five_hands_is_named_and_costs() {
    if long::selected("a-tongue-let-go-by-five-hands") {
        hands("bimanual", &[Habit::LetsTongueGo], 1..=5);
    }
}
