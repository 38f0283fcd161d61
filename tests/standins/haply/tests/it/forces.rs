//! Forces: one tick, watchdog, sum of sources, field of the version.

use std::thread;
use std::time::Duration;

use serde_json::json;
use sulcus_standin_haply::{ArmStatus, Fault, IdleCause, Options, Service, Version, Violation};

use crate::client::{ARM, Client, force, probe, shown, wait_for};

fn patient(watchdog_ms: f64) -> Options {
    Options {
        watchdog_ms,
        ..Options::default()
    }
}

#[test]
fn a_command_holds_for_one_tick() {
    let service = Service::start(patient(5000.0)).unwrap();
    let (mut client, _) = Client::connect(&service);
    let reply = client.push(1.5);
    assert_eq!(shown(&reply), 1.5);
    assert_eq!(reply["inverse3"][0]["state"]["control_mode"], "force");
    let reply = client.ask(probe());
    assert_eq!(shown(&reply), 0.0);
    assert_eq!(reply["inverse3"][0]["state"]["control_mode"], "idle");
    let arm = service.arm(ARM).unwrap();
    assert!(arm.idle && arm.displayed == [0.0; 3]);
    assert_eq!(service.messages(), 2);
    let idles = service.log().unwrap().idles(ARM);
    assert_eq!(idles.len(), 1);
    assert_eq!(idles[0].cause, IdleCause::NotCommanded);
}

#[test]
fn a_silent_client_lets_the_arm_go_idle() {
    let service = Service::start(Options::default()).unwrap();
    let (mut client, _) = Client::connect(&service);
    client.push(2.0);
    assert!(wait_for(|| !service.log().unwrap().idles(ARM).is_empty()));
    let log = service.log().unwrap();
    let idle = log.idles(ARM)[0];
    assert_eq!(idle.cause, IdleCause::Watchdog);
    assert_eq!(idle.after_ns(), 20_000_000);
    assert_eq!(shown(&client.ask(probe())), 0.0);
    assert_eq!(service.log().unwrap().idles(ARM).len(), 1);
}

#[test]
fn the_watchdog_is_settable_and_does_not_hit_a_busy_client() {
    let service = Service::start(patient(300.0)).unwrap();
    let (mut client, _) = Client::connect(&service);
    for _ in 0..30 {
        client.push(0.5);
        thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(service.log().unwrap().idles(ARM), vec![]);
    assert!(wait_for(|| service.log().unwrap().idles(ARM).len() == 1));
    assert_eq!(service.log().unwrap().idles(ARM)[0].after_ns(), 300_000_000);
}

#[test]
fn sources_add_up_and_factors_multiply() {
    let service = Service::start(patient(5000.0)).unwrap();
    let (mut one, _) = Client::connect(&service);
    let (mut two, _) = Client::connect(&service);
    one.push(1.0);
    assert_eq!(shown(&two.push(0.5)), 1.5);
    service.set_second_source(ARM, [0.25, 0.0, 0.0]).unwrap();
    assert_eq!(shown(&two.push(0.5)), 1.75);
    assert_eq!(shown(&two.ask(probe())), 1.25);
    service.fault(Fault::ForceScale { value: 2.0 }).unwrap();
    assert_eq!(shown(&one.push(1.0)), 2.5);
    assert_eq!(
        shown(&one.push(100.0)),
        10.0,
        "the service shortens a force to the peak"
    );
    let log = service.log().unwrap();
    assert_eq!(log.largest_force(ARM), 100.0);
    assert_eq!(log.largest_displayed(ARM), 10.0);
}

#[test]
fn an_end_of_the_client_leaves_its_force_to_the_watchdog() {
    let service = Service::start(patient(150.0)).unwrap();
    let (mut client, _) = Client::connect(&service);
    let (mut other, _) = Client::connect(&service);
    client.push(1.0);
    drop(client);
    let held = shown(&other.ask(probe()));
    assert!(held == 1.0 || held == 0.0);
    assert!(wait_for(|| shown(&other.ask(probe())) == 0.0));
    assert_eq!(
        service.log().unwrap().idles(ARM)[0].cause,
        IdleCause::Watchdog
    );
}

#[test]
fn each_version_understands_its_own_field() {
    for (version, good, bad, event) in [
        (Version::V3_5, "vector", "values", "command-deprecated"),
        (Version::V3_4, "values", "vector", "invalid-value"),
        (Version::V3_1, "values", "vector", "invalid-value"),
    ] {
        let service = Service::start(Options {
            version,
            ..patient(5000.0)
        })
        .unwrap();
        let (mut client, _) = Client::connect(&service);
        let mut events = Client::raw(service.events_port()).unwrap();
        assert!(wait_for(
            || format!("{:?}", service.log().unwrap()).contains("EventsConnected")
        ));
        assert_eq!(shown(&client.ask(force(ARM, good, 0.5))), 0.5);
        assert_eq!(shown(&client.ask(force(ARM, bad, 0.5))), 0.0);
        let told = events.read();
        assert_eq!(told["name"], event);
        assert_eq!(told["data"]["device_id"], ARM);
        let log = service.log().unwrap();
        assert_eq!(log.count(Violation::WrongField), 1);
        let sent = log.forces(ARM);
        assert_eq!(
            sent.iter().map(|sent| sent.done).collect::<Vec<_>>(),
            vec![true, false]
        );
        assert_eq!(sent[1].field.as_deref(), Some(bad));
    }
}

#[test]
fn version_3_1_tells_a_mode() {
    let service = Service::start(Options {
        version: Version::V3_1,
        ..patient(5000.0)
    })
    .unwrap();
    let (mut client, _) = Client::connect(&service);
    let reply = client.ask(force(ARM, "values", 0.5));
    assert_eq!(reply["inverse3"][0]["state"]["mode"], "force");
    assert!(reply["inverse3"][0]["state"].get("control_mode").is_none());
}

#[test]
fn other_commands_and_execute_false() {
    let service = Service::start(patient(5000.0)).unwrap();
    let (mut client, _) = Client::connect(&service);
    let position = json!({"position": {"x": 0, "y": 0.1, "z": 0.1}});
    let mut command =
        |commands| client.ask(json!({"inverse3": [{"device_id": ARM, "commands": commands}]}));
    let reply = command(json!({"set_cursor_position": position}));
    assert_eq!(reply["inverse3"][0]["state"]["control_mode"], "position");
    let vector = json!({"x": 1, "y": 0, "z": 0});
    let reply = command(json!({"set_cursor_force": {"vector": vector, "execute": false}}));
    assert_eq!(shown(&reply), 0.0);
    command(json!({"set_transform": {"transform": {"position": {"x": 1, "y": 2, "z": 3}}}}));
    let reply = command(json!({"probe_position": {}}));
    assert_eq!(
        reply["inverse3"][0]["state"]["transform"]["position"]["y"],
        2
    );
    assert_eq!(service.log().unwrap().violations(), vec![]);
}

#[test]
fn no_force_without_power_or_with_the_brake() {
    let service = Service::start(patient(5000.0)).unwrap();
    let (mut client, _) = Client::connect(&service);
    service
        .fault(Fault::PowerOff { device: ARM.into() })
        .unwrap();
    let reply = client.push(1.0);
    assert_eq!(shown(&reply), 0.0);
    assert_eq!(reply["inverse3"][0]["status"]["power_supply"], false);
    service
        .fault(Fault::PowerOn { device: ARM.into() })
        .unwrap();
    assert_eq!(shown(&client.push(1.0)), 1.0);
    service
        .set_status(
            ARM,
            ArmStatus {
                in_use: true,
                ..ArmStatus::default()
            },
        )
        .unwrap();
    assert_eq!(client.push(1.0)["inverse3"][0]["status"]["in_use"], true);
}
