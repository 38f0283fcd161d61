//! Changes of the end of a session and of its replay, and the invariants that they break.

use super::*;

/// Values of the last replay, to change.
fn replay(
    events: &mut [(u64, Seen)],
    change: impl FnOnce(&mut u64, &mut bool, &mut bool, &mut u64),
) {
    match &mut events.last_mut().expect("an observation").1 {
        Seen::Replayed {
            rows,
            is_equal,
            is_whole,
            gaps,
        } => change(rows, is_equal, is_whole, gaps),
        other => panic!("expected a replay, found {other:?}"),
    }
}

/// Index of the end of the session.
fn finished(events: &[(u64, Seen)]) -> usize {
    let found = events
        .iter()
        .position(|(_, seen)| matches!(seen, Seen::Finished { .. }));
    found.expect("the end")
}

#[test]
fn sums_that_differ() {
    let Session { mut events, .. } = session(Faulty::default());
    let end = finished(&events);
    if let Seen::Finished { skipped, .. } = &mut events[end].1 {
        *skipped += 1;
    }
    assert_breaks(&events, &[7]);
}

#[test]
fn a_row_that_is_lost_without_a_count() {
    let Session { mut events, .. } = session(Faulty::default());
    replay(&mut events, |rows, _, _, _| *rows -= 1);
    assert_breaks(&events, &[11]);
    let end = finished(&events);
    if let Seen::Finished { rows_dropped, .. } = &mut events[end].1 {
        *rows_dropped = 1;
    }
    assert_breaks(&events, &[]);
    // With a counted loss, neither the bits of the replay nor the gaps can be asked for.
    replay(&mut events, |_, is_equal, is_whole, _| {
        (*is_equal, *is_whole) = (false, false)
    });
    assert_breaks(&events, &[]);
}

#[test]
fn a_failed_recorder_may_have_fewer_rows_but_none_that_differs() {
    let Session { mut events, .. } = session(Faulty::default());
    let end = finished(&events);
    if let Seen::Finished { error, .. } = &mut events[end].1 {
        *error = Some("no space".to_string());
    }
    replay(&mut events, |rows, _, is_whole, gaps| {
        (*rows, *is_whole, *gaps) = (*rows - 200, false, 0)
    });
    assert_breaks(&events, &[]);
    replay(&mut events, |_, is_equal, _, _| *is_equal = false);
    assert_breaks(&events, &[12]);
    replay(&mut events, |rows, is_equal, _, _| {
        (*rows, *is_equal) = (1_000_000, true)
    });
    assert_breaks(&events, &[11]);
}

#[test]
fn a_replay_that_differs_a_torn_file_and_a_gap_too_many() {
    let Session { events, .. } = session(Faulty::default());
    let mut differs = events.clone();
    replay(&mut differs, |_, is_equal, _, _| *is_equal = false);
    assert_breaks(&differs, &[12]);
    let mut torn = events.clone();
    replay(&mut torn, |_, _, is_whole, _| *is_whole = false);
    assert_breaks(&torn, &[12]);
    for other in [0, 2] {
        let mut gapped = events.clone();
        replay(&mut gapped, |_, _, _, gaps| *gaps = other);
        assert_breaks(&gapped, &[12]);
    }
}

#[test]
fn a_gap_without_a_tick_and_a_gap_without_an_end() {
    for (ticks_in_gap, has_end, allowed) in [(0, true, 0..=0), (5, true, 1..=1), (5, false, 0..=1)]
    {
        let mut play = Play::new(Faulty::default());
        play.calm(20);
        let is_skipped = ticks_in_gap == 0;
        let turn = Turn {
            is_skipped,
            ..Turn::default()
        };
        play.turn(&Turn {
            is_lost: true,
            ..turn.clone()
        });
        play.turns(ticks_in_gap, &turn);
        if has_end {
            play.turn(&Turn {
                is_back: true,
                ..Turn::default()
            });
        }
        play.end();
        for gaps in 0..3 {
            replay(&mut play.events, |_, _, _, named| *named = gaps);
            let expected: &[u8] = if allowed.contains(&gaps) { &[] } else { &[12] };
            assert_breaks(&play.events, expected);
        }
    }
}

#[test]
fn anything_after_the_end() {
    let Session { events, .. } = session(Faulty::default());
    let end = finished(&events);
    let at_ns = events[end].0;
    for seen in [
        Seen::Gone,
        Seen::Epoch(9),
        Seen::Ordered(Side::Station, Command::Pause),
        Seen::Queues { recorder: 0 },
    ] {
        let mut after = events.clone();
        after.insert(end + 1, (at_ns, seen));
        assert_breaks(&after, &[13]);
    }
    let mut after = events.clone();
    let tick = after[tick_at(&after, end - 10)].clone();
    after.insert(end + 1, tick);
    assert!(broken(facts(), &after).contains(&13));
}

#[test]
fn a_wrench_of_a_tick_behind_the_end() {
    let Session { mut events, .. } = session(Faulty::default());
    let end = finished(&events);
    pass(&mut events, end)
        .newest
        .as_mut()
        .expect("a wrench")
        .tick += 1;
    assert!(broken(facts(), &events).contains(&13));
}

#[test]
fn a_replay_twice_or_before_the_end() {
    let Session { events, .. } = session(Faulty::default());
    let replayed = events.last().cloned().expect("a replay");
    let mut twice = events.clone();
    twice.push(replayed.clone());
    assert_breaks(&twice, &[13]);
    let mut early = events;
    let end = finished(&early);
    early.insert(end, replayed);
    assert!(broken(facts(), &early).contains(&13));
}
