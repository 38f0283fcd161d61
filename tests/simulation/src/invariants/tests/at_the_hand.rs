//! Changes of single passes of a device, and the invariants that they break.

use super::*;
use play::wrenches;

#[test]
fn a_force_before_the_first_wrench() {
    let mut play = Play::new(Faulty::default());
    let loses_wrench = true;
    play.turns(
        5,
        &Turn {
            loses_wrench,
            ..Turn::default()
        },
    );
    play.calm(5);
    let mut events = play.events;
    assert_breaks(&events, &[]);
    pass(&mut events, 0).displayed = wrenches(0.1);
    assert_breaks(&events, &[1]);
}

#[test]
fn a_force_under_a_pause() {
    let Session {
        mut events, paused, ..
    } = session(Faulty::default());
    pass(&mut events, paused).displayed = wrenches(0.1);
    assert_breaks(&events, &[2]);
}

#[test]
fn a_force_above_the_limit_of_the_datagram() {
    let Session {
        events,
        limited,
        full,
        ..
    } = session(Faulty::default());
    let mut above = events.clone();
    pass(&mut above, limited[1]).displayed = wrenches(1.3);
    assert_breaks(&above, &[3]);
    let mut above = events;
    pass(&mut above, full).displayed = wrenches(3.35);
    assert_breaks(&above, &[3]);
}

#[test]
fn a_brake_may_exceed_the_limit_of_the_datagram_by_one_newton() {
    let Session {
        mut events,
        limited,
        ..
    } = session(Faulty::default());
    // Up and down with the slew limit: 1.4, 1.9, 1.9, 1.4 N.
    let mut from = limited[1];
    for (force, braked) in [(1.4, true), (1.9, true), (1.9, true), (1.4, false)] {
        let pass = pass(&mut events, from);
        pass.displayed = wrenches(force);
        pass.braked = braked;
        from = pass_at(&events, from) + 1;
    }
    assert_breaks(&events, &[]);
    // Without the brake the same force breaks the limit.
    let second = pass_at(&events, pass_at(&events, limited[1]) + 1);
    pass(&mut events, second).braked = false;
    assert_breaks(&events, &[3]);
}

#[test]
fn a_force_after_a_silence() {
    let Session {
        mut events, silent, ..
    } = session(Faulty::default());
    pass(&mut events, silent).displayed = wrenches(0.1);
    assert_breaks(&events, &[4]);
}

#[test]
fn a_jump_of_the_displayed_force() {
    let Session { events, full, .. } = session(Faulty::default());
    let mut jump = events.clone();
    pass(&mut jump, full).displayed = wrenches(2.9);
    assert_breaks(&jump, &[]);
    pass(&mut jump, full).displayed = wrenches(2.7);
    assert_breaks(&jump, &[5]);
    let mut overslept = events;
    let pass = pass(&mut overslept, full);
    (pass.displayed, pass.overslept) = (wrenches(2.7), 5);
    assert_breaks(&overslept, &[5]);
}

#[test]
fn a_brake_may_reduce_at_once_and_grows_slowly() {
    let Session {
        mut events, full, ..
    } = session(Faulty::default());
    let mut from = full;
    for force in [1.0, 1.5, 2.0, 2.5, 3.0] {
        let pass = pass(&mut events, from);
        pass.displayed = wrenches(force);
        pass.braked = true;
        from = pass_at(&events, from) + 1;
    }
    assert_breaks(&events, &[]);
    let second = pass_at(&events, pass_at(&events, full) + 1);
    pass(&mut events, second).displayed = wrenches(1.6);
    assert_breaks(&events, &[5]);
}

#[test]
fn a_displayed_number_that_is_not_finite() {
    let Session { events, full, .. } = session(Faulty::default());
    let mut nan = events.clone();
    pass(&mut nan, full).displayed[0].force.x = f64::NAN;
    assert_breaks(&nan, &[6]);
    let mut infinite = events;
    pass(&mut infinite, full).displayed[0].torque.x = f64::NEG_INFINITY;
    assert_breaks(&infinite, &[6]);
}

#[test]
fn a_force_on_an_old_pose() {
    let Session {
        mut events, aged, ..
    } = session(Faulty::default());
    pass(&mut events, aged).displayed = wrenches(0.1);
    assert_breaks(&events, &[16]);
}

#[test]
fn a_wrench_that_goes_back() {
    let Session { events, full, .. } = session(Faulty::default());
    let newest = |events: &mut [(u64, Seen)], change: fn(&mut crate::seen::Newest)| {
        change(pass(events, full).newest.as_mut().expect("a wrench"));
    };
    let changes: [fn(&mut crate::seen::Newest); 6] = [
        |newest| newest.tick -= 5,
        |newest| newest.tick += 5,
        |newest| newest.epoch += 1,
        |newest| newest.epoch -= 1,
        |newest| newest.arrived_ns += MS,
        |newest| newest.force_limit_n = 3.0,
    ];
    for change in changes {
        let mut changed = events.clone();
        newest(&mut changed, change);
        assert!(broken(facts(), &changed).contains(&17));
    }
    let mut paused = events.clone();
    newest(&mut paused, |newest| newest.paused = true);
    assert_breaks(&paused, &[17]);
    // A wrench of the same tick comes twice.
    let mut twice = events;
    let before = *pass(&mut twice, full).newest.as_ref().expect("a wrench");
    let next = pass_at(&twice, full) + 1;
    pass(&mut twice, next).newest = Some(crate::seen::Newest {
        arrived_ns: before.arrived_ns + 100_000,
        ..before
    });
    assert_breaks(&twice, &[17]);
}

#[test]
fn a_gate_that_opens_too_fast() {
    let Session { events, gone, .. } = session(Faulty::default());
    // 20 ms behind the first wrench, and behind the return after a lost connection.
    let is_back = |(_, seen): &(u64, Seen)| matches!(seen, Seen::Epoch(_));
    let back = gone + events[gone..].iter().position(is_back).expect("a return");
    for begin in [0, back] {
        let mut fast = events.clone();
        let at_ns = fast[begin].0 + 20 * MS;
        let from = fast
            .iter()
            .position(|(at, _)| *at >= at_ns)
            .expect("an observation");
        pass(&mut fast, from).displayed = wrenches(0.4);
        assert_breaks(&fast, &[18]);
    }
}

#[test]
fn an_overslept_gate_shuts_in_passes() {
    // A silence of 100 ms with a pass every tenth millisecond: ten passes, so the gate need not be shut.
    let mut play = Play::new(Faulty::default());
    play.calm(700);
    for millisecond in 0..100 {
        play.turn(&Turn {
            loses_wrench: true,
            is_overslept: millisecond % 10 != 0,
            ..Turn::default()
        });
    }
    play.calm(5);
    assert_breaks(&play.events, &[]);
}
