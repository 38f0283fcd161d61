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
fn every_habit_of_hands_one_to_four_is_named_and_costs() {
    if long::selected("habits-of-hands-1-to-4") {
        hands(WHOLE_TOOTH, &PROBING, 1..=4);
    }
}

#[test]
fn every_habit_of_hands_five_to_eight_is_named_and_costs() {
    if long::selected("habits-of-hands-5-to-8") {
        hands(WHOLE_TOOTH, &PROBING, 5..=8);
    }
}

#[test]
fn every_habit_of_hands_nine_to_twelve_is_named_and_costs() {
    if long::selected("habits-of-hands-9-to-12") {
        hands(WHOLE_TOOTH, &PROBING, 9..=12);
    }
}

#[test]
fn every_habit_of_hands_thirteen_to_sixteen_is_named_and_costs() {
    if long::selected("habits-of-hands-13-to-16") {
        hands(WHOLE_TOOTH, &PROBING, 13..=16);
    }
}

#[test]
fn every_habit_of_hands_seventeen_to_twenty_is_named_and_costs() {
    if long::selected("habits-of-hands-17-to-20") {
        hands(WHOLE_TOOTH, &PROBING, 17..=20);
    }
}

#[test]
fn a_tongue_let_go_by_five_hands_is_named_and_costs() {
    if long::selected("a-tongue-let-go-by-five-hands") {
        hands("bimanual", &[Habit::LetsTongueGo], 1..=5);
    }
}
