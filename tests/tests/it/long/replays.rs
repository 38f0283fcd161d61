//! Sessions with every habit, and the speed of a replay against the session's own duration.

use sulcus_operator::Habit;
use sulcus_support::long;
use sulcus_tests::Place;

use crate::replays::{act_and_replay, perform, replay};

#[test]
fn a_replay_is_many_times_as_fast_as_the_session() {
    if !long::selected("replay-is-faster-than-the-session") {
        return;
    }
    let place = Place::new();
    // What is promised is 10 and 4 times on a core of its own; found are 25 and 21 beside other work. Half is asked here, where nobody
    // knows what else the machine does: enough to see a replay that became some times slower.
    for (exercise, seconds, least) in [("probing", "12", 5.0), ("bimanual", "20", 2.0)] {
        let demo = perform(&place, exercise, seconds, &[]);
        let file = demo["recording"].as_str().expect("a path");
        // The best of three: others may have the processor meanwhile.
        let factors = [(); 3].map(|()| {
            let report = replay(&place, &[file], &["--jobs", "1"]);
            report["realtime_factor"].as_f64().expect("a number")
        });
        let best = factors.into_iter().fold(0.0, f64::max);
        assert!(best >= least, "{exercise}: {factors:?}, expected {least}");
    }
}

#[test]
fn every_habit_acts_and_replays() {
    if long::selected("every-habit-replays") {
        act_and_replay(&Habit::ALL);
    }
}
