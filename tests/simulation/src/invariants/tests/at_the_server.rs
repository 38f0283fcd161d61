//! Changes of single ticks, epochs and queues, and the invariants that they break.

use super::*;
use crate::seen::Used;
use play::wrenches;

#[test]
fn a_force_under_a_pause() {
    let Session {
        mut events, paused, ..
    } = session(Faulty::default());
    tick(&mut events, paused).sent = wrenches(0.1);
    assert_breaks(&events, &[2]);
}

#[test]
fn a_force_above_the_limit_of_the_tick() {
    let Session {
        mut events,
        limited,
        ..
    } = session(Faulty::default());
    tick(&mut events, limited[1]).sent = wrenches(1.3);
    assert_breaks(&events, &[3]);
}

#[test]
fn a_fall_to_a_lower_limit_that_waits_for_a_tick() {
    let Session {
        mut events,
        limited,
        ..
    } = session(Faulty::default());
    // The tick obeys the limit, but its force is still the one before.
    tick(&mut events, limited[0]).sent = wrenches(3.3);
    assert!(broken(facts(), &events).contains(&3));
}

#[test]
fn a_torque_above_the_limit() {
    let Session {
        mut events, full, ..
    } = session(Faulty::default());
    tick(&mut events, full).sent[0].torque.x = 0.19;
    assert_breaks(&events, &[]);
    tick(&mut events, full).sent[0].torque.x = 0.201;
    // From 0.165 N m on, the change exceeds 0.03 N m, too.
    assert_breaks(&events, &[3, 5]);
}

#[test]
fn a_jump_of_a_sent_force_or_torque() {
    let Session { events, full, .. } = session(Faulty::default());
    let mut jump = events.clone();
    tick(&mut jump, full).sent[0].force.z = 2.7;
    assert_breaks(&jump, &[5]);
    let mut jump = events;
    tick(&mut jump, full).sent[0].torque.x = 0.1;
    assert_breaks(&jump, &[5]);
}

#[test]
fn a_number_that_is_not_finite() {
    let Session { events, full, .. } = session(Faulty::default());
    let mut nan = events.clone();
    tick(&mut nan, full).sent[1].torque.y = f64::NAN;
    assert_breaks(&nan, &[6]);
    let mut infinite = events;
    tick(&mut infinite, full).force_limit_n = f64::INFINITY;
    assert_breaks(&infinite, &[6]);
}

#[test]
fn a_skipped_grid_point_that_is_not_counted() {
    let Session {
        mut events, full, ..
    } = session(Faulty::default());
    tick(&mut events, full).skipped = 1;
    assert_breaks(&events, &[7]);
}

#[test]
fn a_pose_of_another_epoch_out_of_order_or_from_the_future() {
    let Session { events, full, .. } = session(Faulty::default());
    let used = tick(&mut events.clone(), full).used.expect("a pose");
    for change in [
        Used { epoch: 0, ..used },
        Used { epoch: 2, ..used },
        Used { number: 5, ..used },
        Used {
            arrived_ns: used.arrived_ns + MS,
            ..used
        },
        Used {
            measured_ns: used.arrived_ns + 1,
            ..used
        },
    ] {
        let mut changed = events.clone();
        tick(&mut changed, full).used = Some(change);
        assert_breaks(&changed, &[8]);
    }
}

#[test]
fn a_tool_without_a_pose_or_in_no_slot() {
    let Session {
        events, full, gone, ..
    } = session(Faulty::default());
    let mut absent = events.clone();
    tick(&mut absent, full).used = None;
    assert_breaks(&absent, &[9]);
    let mut third = events.clone();
    tick(&mut third, full).present[1] = true;
    assert_breaks(&third, &[9]);
    let mut returned = events;
    let used = tick(&mut returned, full).used;
    let tick = tick(&mut returned, gone);
    (tick.present[0], tick.used) = (true, used);
    assert!(broken(facts(), &returned).contains(&9));
}

#[test]
fn levels_one_tick_late() {
    let late_levels = true;
    let Session { events, .. } = session(Faulty {
        late_levels,
        ..Faulty::default()
    });
    assert_breaks(&events, &[10]);
}

#[test]
fn a_pause_that_the_other_side_lifts() {
    let mut play = Play::new(Faulty::default());
    play.calm(600);
    play.order(Side::Station, Command::Pause);
    play.calm(60);
    play.order(Side::Station, Command::Resume);
    play.calm(5);
    let mut events = play.events;
    assert_breaks(&events, &[]);
    for (_, seen) in &mut events {
        if let Seen::Ordered(side, Command::Resume) = seen {
            *side = Side::Student;
        }
    }
    assert!(broken(facts(), &events).contains(&10));
}

#[test]
fn a_limit_of_the_plan_that_no_tick_obeys() {
    let Session { events, .. } = session(Faulty::default());
    let plan_limit_n = 2.0;
    let planned = Facts {
        plan_limit_n,
        ..facts()
    };
    assert_eq!(broken(planned, &events), BTreeSet::from([10]));
}

#[test]
fn an_end_of_a_pause_without_an_epoch() {
    let keeps_epoch = true;
    let Session { events, .. } = session(Faulty {
        keeps_epoch,
        ..Faulty::default()
    });
    assert_breaks(&events, &[14]);
}

#[test]
fn an_epoch_that_returns() {
    let Session {
        mut events, gone, ..
    } = session(Faulty::default());
    for (_, seen) in &mut events[gone..] {
        if let Seen::Epoch(epoch) = seen {
            *epoch = 2;
        }
    }
    assert!(broken(facts(), &events).contains(&14));
}

#[test]
fn a_force_on_a_stale_pose() {
    let Session { events, aged, .. } = session(Faulty::default());
    let mut pressed = events.clone();
    tick(&mut pressed, aged).sent = wrenches(0.1);
    assert_breaks(&pressed, &[15]);
    let mut silent = events;
    tick(&mut silent, aged).stale[0] = false;
    assert_breaks(&silent, &[15]);
}

#[test]
fn a_force_for_an_absent_tool() {
    let Session {
        mut events, gone, ..
    } = session(Faulty::default());
    tick(&mut events, gone + 200).sent = wrenches(0.1);
    assert_breaks(&events, &[15]);
}

#[test]
fn a_queue_beyond_its_bound() {
    let Session { mut events, .. } = session(Faulty::default());
    let longest = |events: &mut [(u64, Seen)], length: usize| {
        for (_, seen) in events {
            if let Seen::Queues { recorder } = seen {
                *recorder = length;
            }
        }
    };
    longest(&mut events, 64);
    assert_breaks(&events, &[]);
    longest(&mut events, 65);
    assert_breaks(&events, &[11]);
}
