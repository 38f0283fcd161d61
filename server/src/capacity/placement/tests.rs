//! Admission on invented machines.

use proptest::prelude::*;

use super::*;
use crate::capacity::throttle::Throttle;

fn machine(cores: usize) -> Machine {
    let throttle = Throttle {
        real_time_share: Some(0.95),
        ..Throttle::default()
    };
    // Numbers with a gap, as under `taskset`.
    Machine::of((0..cores).map(|core| 2 * core + 1).collect(), &throttle)
}

fn load(mean_us: f64, p999_us: f64) -> Load {
    Load {
        cost: Cost {
            mean_us,
            p50_us: mean_us.min(p999_us),
            p99_us: p999_us,
            p999_us,
        },
        rate_hz: 1000,
    }
}

fn empty(cores: usize) -> Capacity {
    Capacity::new(machine(cores), Model::default())
}

#[test]
fn sessions_are_spread_over_the_cores() {
    let mut capacity = empty(2);
    let cores: Vec<usize> = (0..4)
        .map(|id| capacity.admit(id, load(100.0, 200.0)).expect("room"))
        .collect();
    assert_eq!(cores, [1, 3, 1, 3]);
    capacity.release(1);
    assert_eq!(
        capacity.admit(9, load(100.0, 200.0)),
        Ok(3),
        "the free place"
    );
    let shares: Vec<f64> = capacity
        .cores()
        .iter()
        .map(|core| core.tick_share)
        .collect();
    assert!(
        shares.iter().all(|share| (share - 0.2).abs() < 1e-12),
        "{shares:?}"
    );
}

#[test]
fn ticks_leave_three_tenths_of_a_core_to_the_rest() {
    // A tenth of a core each: seven fill 70 %.
    let mut capacity = empty(1);
    capacity.set_other_share(0.0);
    assert_eq!(capacity.room(&load(99.0, 150.0)), 7);
    for id in 0..7 {
        capacity.admit(id, load(99.0, 150.0)).expect("room");
    }
    let told = capacity
        .admit(7, load(99.0, 150.0))
        .expect_err("full")
        .to_string();
    for part in [
        "room for 7 of",
        "7 run",
        "99 us",
        "1000 Hz",
        "p99.9 150 us",
        "1 core",
    ] {
        assert!(told.contains(part), "{part}: {told}");
    }
}

#[test]
fn a_smaller_real_time_share_of_the_kernel_admits_less() {
    let limited = Machine {
        real_time_share: 0.4,
        ..machine(1)
    };
    let mut capacity = Capacity::new(limited, Model::default());
    capacity.set_other_share(0.0);
    // 90 % of 40 %.
    assert_eq!(capacity.room(&load(100.0, 150.0)), 3);
}

#[test]
fn network_and_recorders_count_against_the_whole_machine_and_a_quota() {
    let mut capacity = empty(2);
    capacity.set_other_share(0.2);
    // 0.25 of a core each, of 90 % of two cores.
    assert_eq!(capacity.room(&load(50.0, 60.0)), 7);
    let mut limited = machine(2);
    limited.quota_cores = 1.0;
    let mut capacity = Capacity::new(limited, Model::default());
    capacity.set_other_share(0.2);
    assert_eq!(capacity.room(&load(50.0, 60.0)), 3);
    capacity.set_other_share(f64::NAN);
    capacity.set_other_share(-1.0);
    assert_eq!(capacity.room(&load(50.0, 60.0)), 3);
}

#[test]
fn the_longest_tick_of_one_session_must_not_cost_another_its_period() {
    // Mean ticks are small, but a tick of 800 us leaves 200 us for the others of its core.
    let mut capacity = empty(1);
    capacity.set_other_share(0.0);
    let rare = load(50.0, 800.0);
    let room = capacity.room(&rare);
    assert_eq!(room, 5, "4 x 50 us + 800 us");
    capacity.admit(0, rare).expect("the first");
    // A session at 4 kHz has a period of 250 us.
    let fast = Load {
        rate_hz: 4000,
        ..load(20.0, 30.0)
    };
    capacity
        .admit(1, fast)
        .expect_err("its ticks would wait for 800 us");
}

#[test]
fn an_empty_machine_takes_any_session_and_only_one_of_them() {
    let mut capacity = empty(2);
    let heavy = load(1500.0, 3000.0);
    assert_eq!(capacity.room(&heavy), 1);
    capacity.admit(0, heavy).expect("the first");
    let told = capacity
        .admit(1, heavy)
        .expect_err("the second")
        .to_string();
    assert!(
        told.contains("room for 1 of") && told.contains("1 run"),
        "{told}"
    );
    // The other core is free.
    assert_eq!(capacity.admit(1, load(20.0, 30.0)), Ok(3));
}

#[test]
fn a_correction_moves_no_session_and_counts_for_the_next() {
    let mut capacity = empty(1);
    capacity.set_other_share(0.0);
    capacity.admit(0, load(99.0, 150.0)).expect("room");
    assert_eq!(capacity.room(&load(99.0, 150.0)), 6);
    capacity.update(0, load(400.0, 500.0).cost);
    assert_eq!(capacity.room(&load(99.0, 150.0)), 3);
    let nonsense = Cost {
        mean_us: f64::NAN,
        ..Cost::default()
    };
    capacity.update(0, nonsense);
    capacity.update(77, load(1.0, 2.0).cost);
    assert_eq!(
        (capacity.room(&load(99.0, 150.0)), capacity.running()),
        (3, 1)
    );
    capacity
        .admit(
            9,
            Load {
                cost: nonsense,
                rate_hz: 1000,
            },
        )
        .expect_err("no cost");
}

#[test]
fn the_sentence_counts_an_empty_machine_of_these_stations() {
    let mut capacity = empty(1);
    capacity.set_other_share(0.0);
    capacity.admit(0, load(600.0, 700.0)).expect("the first");
    let told = capacity
        .admit(1, load(200.0, 250.0))
        .expect_err("full")
        .to_string();
    assert!(
        told.contains("room for 3 of") && told.contains("1 run"),
        "{told}"
    );
}

proptest! {
    /// Whatever is admitted and released, no core is over its share, except one with a first session that is too heavy.
    #[test]
    fn no_core_is_ever_over_its_share(
        cores in 1..5_usize,
        steps in proptest::collection::vec((0..12_u64, 1.0..300.0_f64, 1.0..5.0_f64, any::<bool>()), 1..60),
    ) {
        let mut capacity = empty(cores);
        for (id, mean, factor, leaves) in steps {
            if leaves {
                capacity.release(id);
                continue;
            }
            if capacity.placed.iter().any(|placed| placed.id == id) {
                continue;
            }
            let first = capacity.running() == 0;
            let room = capacity.room(&load(mean, mean * factor));
            let admitted = capacity.admit(id, load(mean, mean * factor));
            prop_assert_eq!(admitted.is_ok(), room > 0);
            if let Ok(core) = admitted {
                prop_assert!(capacity.machine.cores.contains(&core));
            }
            if !first {
                for core in capacity.cores() {
                    prop_assert!(core.tick_share <= 0.7 + 1e-9 || core.sessions == 1, "{core:?}");
                }
            }
        }
        let all = capacity.running();
        prop_assert_eq!(capacity.cores().iter().map(|core| core.sessions).sum::<usize>(), all);
    }
}
