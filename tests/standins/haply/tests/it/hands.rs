//! Motions of the hand.

use std::time::{Duration, Instant};

use sulcus_standin_haply::{Mechanics, Motion, Options, Point, Service};

use crate::client::{ARM, Client, probe, vector};

const HOME: [f64; 3] = [0.0, 0.1, 0.1];

fn start(position_step_m: f64) -> (Service, Client) {
    let mut options = Options {
        watchdog_ms: 5000.0,
        ..Options::default()
    };
    options.arms[0].mechanics = Mechanics {
        position_step_m,
        ..Mechanics::default()
    };
    let service = Service::start(options).unwrap();
    let (client, _) = Client::connect(&service);
    (service, client)
}

fn for_ms(ms: u64, mut body: impl FnMut()) {
    let start = Instant::now();
    while start.elapsed() < Duration::from_millis(ms) {
        body();
    }
}

#[test]
fn a_hand_at_rest_does_not_yield_and_steps_are_rounded() {
    let (service, mut client) = start(1e-3);
    service
        .set_hand(
            ARM,
            Motion::Rest {
                at: [0.01234, 0.1, 0.1],
            },
        )
        .unwrap();
    let reply = client.push(5.0);
    let position = vector(&reply, "cursor_position");
    assert!((position[0] - 0.012).abs() < 1e-12);
    assert_eq!(vector(&reply, "cursor_velocity"), [0.0; 3]);
}

#[test]
fn a_sine_moves_between_its_ends() {
    let (service, mut client) = start(0.0);
    service
        .set_hand(
            ARM,
            Motion::Sinusoid {
                centre: HOME,
                amplitude: [0.02, 0.0, 0.01],
                hz: 5.0,
            },
        )
        .unwrap();
    let (mut low, mut high) = (f64::MAX, f64::MIN);
    for_ms(500, || {
        let position = vector(&client.ask(probe()), "cursor_position");
        low = low.min(position[0]);
        high = high.max(position[0]);
        assert!((position[2] - 0.1 - position[0] / 2.0).abs() < 1e-9);
    });
    assert!(low > -0.020001 && low < -0.01, "{low}");
    assert!(high < 0.020001 && high > 0.01, "{high}");
}

#[test]
fn a_path_starts_and_ends_at_rest() {
    let (service, mut client) = start(0.0);
    let end = [0.05, 0.1, 0.1];
    let points = vec![Point { t_s: 0.0, at: HOME }, Point { t_s: 0.3, at: end }];
    service
        .set_hand(
            ARM,
            Motion::Path {
                points,
                repeat: false,
            },
        )
        .unwrap();
    let mut last = 0.0;
    let mut fastest: f64 = 0.0;
    for_ms(400, || {
        let reply = client.ask(probe());
        let x = vector(&reply, "cursor_position")[0];
        assert!(x >= last);
        last = x;
        fastest = fastest.max(vector(&reply, "cursor_velocity")[0]);
    });
    let reply = client.ask(probe());
    assert_eq!(vector(&reply, "cursor_position"), end);
    assert_eq!(vector(&reply, "cursor_velocity"), [0.0; 3]);
    assert!(
        fastest > 0.1 && fastest <= 1.875 * 0.05 / 0.3 + 1e-9,
        "{fastest}"
    );
}

#[test]
fn a_jump_takes_no_time() {
    let (service, mut client) = start(0.0);
    let to = [0.0, 0.1, 0.12];
    service
        .set_hand(
            ARM,
            Motion::Jump {
                from: HOME,
                to,
                after_ms: 100.0,
            },
        )
        .unwrap();
    let mut seen = Vec::new();
    for_ms(200, || {
        let position = vector(&client.ask(probe()), "cursor_position");
        if seen.last() != Some(&position) {
            seen.push(position);
        }
    });
    assert_eq!(seen.last(), Some(&to));
    assert!(seen.len() <= 2, "{seen:?}");
}

#[test]
fn a_force_pushes_a_held_hand_by_its_stiffness() {
    let (service, mut client) = start(0.0);
    let anchor = Box::new(Motion::Rest { at: HOME });
    let motion = Motion::Held {
        anchor,
        mass_kg: 0.2,
        stiffness_n_per_m: 200.0,
        damping_n_s_per_m: 10.0,
    };
    service.set_hand(ARM, motion).unwrap();
    let mut position = [0.0; 3];
    for_ms(600, || {
        position = vector(&client.push(2.0), "cursor_position")
    });
    // 2 N on 200 N/m are 10 mm; the steps of the force are 14 mN.
    assert!((position[0] - 0.01).abs() < 3e-4, "{position:?}");
    assert!((position[1] - 0.1).abs() < 1e-9);
    for_ms(600, || {
        position = vector(&client.ask(probe()), "cursor_position")
    });
    assert!(position[0].abs() < 3e-4, "{position:?}");
}
