//! Claims of the invariants: a faultless sequence breaks none, and a small change breaks the one that it is about.

mod at_the_hand;
mod at_the_server;
mod calm;
mod end;
mod play;

use std::collections::BTreeSet;

use sulcus_proto::control::Command;

use super::{INVARIANTS, Watch};
use crate::seen::{Facts, Pass, Seen, Side, Tick};
use play::{Faulty, MS, Play, Turn, facts};

/// Numbers of the invariants that a sequence breaks.
fn broken(facts: Facts, events: &[(u64, Seen)]) -> BTreeSet<u8> {
    let mut watch = Watch::new(facts);
    events
        .iter()
        .flat_map(|(at_ns, seen)| watch.see(*at_ns, seen))
        .map(|broken| broken.number)
        .collect()
}

/// Asserts that a sequence breaks exactly the given invariants.
#[track_caller]
fn assert_breaks(events: &[(u64, Seen)], numbers: &[u8]) {
    let expected: BTreeSet<u8> = numbers.iter().copied().collect();
    assert_eq!(broken(facts(), events), expected);
}

/// Faultless session with places to change.
struct Session {
    events: Vec<(u64, Seen)>,
    /// Index of the first observation with full force at the hand.
    full: usize,
    /// Index of an observation 60 ms behind the order of a pause.
    paused: usize,
    /// Index of the first observation behind the order of a limit of 1 N, and one 60 ms later.
    limited: [usize; 2],
    /// Index of an observation in a silence of 70 ms, 60 ms behind its begin.
    silent: usize,
    /// Index of an observation without a new pose for 170 ms.
    aged: usize,
    /// Index of the first observation of a lost connection.
    gone: usize,
}

/// Plays a session with a pause, a limit, a silence, lost poses and a lost connection.
fn session(faulty: Faulty) -> Session {
    let mut play = Play::new(faulty);
    play.calm(700);
    let full = play.mark();
    play.calm(20);
    play.order(Side::Station, Command::Pause);
    play.calm(60);
    let paused = play.mark();
    play.calm(20);
    play.order(Side::Station, Command::Resume);
    play.calm(600);
    let limit_at = play.mark();
    play.order(Side::Student, Command::ForceLimit(1.0));
    play.calm(60);
    let limited = [limit_at, play.mark()];
    play.calm(20);
    play.order(Side::Student, Command::ForceLimit(0.0));
    play.calm(60);
    let loses_wrench = true;
    play.turns(
        60,
        &Turn {
            loses_wrench,
            ..Turn::default()
        },
    );
    let silent = play.mark();
    play.turns(
        10,
        &Turn {
            loses_wrench,
            ..Turn::default()
        },
    );
    play.calm(600);
    let loses_pose = true;
    play.turns(
        170,
        &Turn {
            loses_pose,
            ..Turn::default()
        },
    );
    let aged = play.mark();
    play.turns(
        10,
        &Turn {
            loses_pose,
            ..Turn::default()
        },
    );
    play.calm(600);
    let gone = play.mark();
    play.turn(&Turn {
        is_lost: true,
        ..Turn::default()
    });
    play.calm(300);
    play.turn(&Turn {
        is_back: true,
        ..Turn::default()
    });
    play.calm(700);
    play.end();
    Session {
        events: play.events,
        full,
        paused,
        limited,
        silent,
        aged,
        gone,
    }
}

/// Index of the first tick at or behind an index.
fn tick_at(events: &[(u64, Seen)], from: usize) -> usize {
    let found = events[from..]
        .iter()
        .position(|(_, seen)| matches!(seen, Seen::Tick(_)));
    from + found.expect("a tick")
}

/// Index of the first pass at or behind an index.
fn pass_at(events: &[(u64, Seen)], from: usize) -> usize {
    let found = events[from..]
        .iter()
        .position(|(_, seen)| matches!(seen, Seen::Pass(_)));
    from + found.expect("a pass")
}

/// The first tick at or behind an index, to change.
fn tick(events: &mut [(u64, Seen)], from: usize) -> &mut Tick {
    let index = tick_at(events, from);
    match &mut events[index].1 {
        Seen::Tick(tick) => tick,
        other => panic!("expected a tick, found {other:?}"),
    }
}

/// The first pass at or behind an index, to change.
fn pass(events: &mut [(u64, Seen)], from: usize) -> &mut Pass {
    let index = pass_at(events, from);
    match &mut events[index].1 {
        Seen::Pass(pass) => pass,
        other => panic!("expected a pass, found {other:?}"),
    }
}

#[test]
fn the_numbers_of_the_table_are_in_order() {
    for (index, (number, sentence)) in INVARIANTS.iter().enumerate() {
        assert_eq!(usize::from(*number), index + 1);
        assert!(sentence.ends_with('.'), "{sentence}");
    }
}
