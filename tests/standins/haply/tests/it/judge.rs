//! Measures on the log.

use std::thread;
use std::time::Duration;

use sulcus_standin_haply::{Entry, Log, Options, Service, What};

use crate::client::{ARM, Client};

fn log_of(forces: &[(u64, f64)]) -> Log {
    let line = |(us, newtons): &(u64, f64)| {
        let command = serde_json::json!({
            "device": ARM, "name": "set_cursor_force", "field": "vector", "force": [0.0, *newtons, 0.0],
            "done": true, "displayed": [0.0, *newtons, 0.0],
        });
        let what =
            serde_json::json!({"message": {"connection": 1, "number": 1, "commands": [command]}});
        let what: What = serde_json::from_value(what).unwrap();
        Entry {
            t_ns: us * 1000,
            what,
        }
    };
    Log {
        entries: forces.iter().map(line).collect(),
    }
}

#[test]
fn force_step_and_slope() {
    let log = log_of(&[
        (0, 0.0),
        (1000, 0.1),
        (3000, 0.5),
        (3100, 0.6),
        (4000, -0.1),
        (9000, 0.05),
    ]);
    assert_eq!(log.largest_force(ARM), 0.6);
    assert!((log.largest_step(ARM) - 0.7).abs() < 1e-12);
    assert!((log.largest_change_per_ms(ARM) - 0.7).abs() < 1e-12);
    assert_eq!(log.quiet_after_ns(ARM, 2_000_000, 0.2), 1_100_000);
    assert_eq!(log.quiet_after_ns(ARM, 4_000_000, 0.2), 0);
    assert_eq!(log.longest_gap_ns(1), 5_000_000);
    assert_eq!(log.since(3_000_000).messages(), 4);
    assert_eq!(log.largest_force("none"), 0.0);
}

#[test]
fn small_steps_at_a_high_rate_add_up() {
    let log = log_of(&[
        (9000, 0.1),
        (9250, 0.2),
        (9500, 0.3),
        (9750, 0.4),
        (10_000, 0.5),
        (10_250, 0.5),
    ]);
    assert!((log.largest_step(ARM) - 0.1).abs() < 1e-12);
    assert!((log.largest_change_per_ms(ARM) - 0.4).abs() < 1e-12);
    let late = log_of(&[(0, 0.0), (4000, 1.0)]);
    assert!((late.largest_change_per_ms(ARM) - 0.25).abs() < 1e-12);
}

#[test]
fn the_force_after_an_idle_state_counts_from_zero() {
    let service = Service::start(Options {
        watchdog_ms: 10.0,
        ..Options::default()
    })
    .unwrap();
    let (mut client, _) = Client::connect(&service);
    client.push(1.0);
    thread::sleep(Duration::from_millis(60));
    client.push(1.0);
    let log = service.stop().unwrap();
    assert_eq!(log.largest_step(ARM), 1.0);
    assert_eq!(log.forces(ARM).len(), 2);
    assert!((1..=2).contains(&log.idles(ARM).len()));
    let times: Vec<_> = log.forces(ARM).iter().map(|sent| sent.t_ns).collect();
    assert!(times[1] > times[0]);
}
