//! Faults.

use std::time::{Duration, Instant};

use serde_json::Value;
use sulcus_standin_haply::{
    BadNumber, EndReason, Fault, Omit, Options, Place, SafetyCause, Service, Violation, What,
};

use crate::client::{ARM, Client, GRIP, probe, shown, wait_for};

fn start() -> (Service, Client) {
    let service = Service::start(Options {
        watchdog_ms: 5000.0,
        ..Options::default()
    })
    .unwrap();
    let (client, _) = Client::connect(&service);
    (service, client)
}

#[test]
fn a_drop_ends_the_connection_and_a_new_one_stands() {
    let (service, mut client) = start();
    client.ask(probe());
    service.fault(Fault::DropConnections).unwrap();
    assert!(client.text().is_err());
    let fault = |what: &What| {
        matches!(
            what,
            What::Ended {
                reason: EndReason::Fault,
                ..
            }
        )
    };
    assert!(wait_for(|| service
        .log()
        .unwrap()
        .entries
        .iter()
        .any(|entry| fault(&entry.what))));
    let (mut client, inventory) = Client::connect(&service);
    assert!(inventory["session_id"].is_number());
    client.ask(probe());
    assert_eq!(service.log().unwrap().connections(), 2);
}

#[test]
fn a_close_takes_the_place_of_the_reply() {
    let (service, mut client) = start();
    service.fault(Fault::CloseConnections).unwrap();
    client.send(probe());
    assert!(client.socket.read().unwrap().is_close());
}

#[test]
fn a_stall_delays_the_reply_and_the_watchdog_goes_on() {
    let service = Service::start(Options::default()).unwrap();
    let (mut client, _) = Client::connect(&service);
    client.push(1.0);
    let start = Instant::now();
    service.fault(Fault::Stall { ms: 120 }).unwrap();
    let reply = client.ask(probe());
    assert!(start.elapsed() >= Duration::from_millis(110));
    assert_eq!(shown(&reply), 0.0);
    let log = service.log().unwrap();
    assert_eq!(log.idles(ARM).len(), 1);
    assert_eq!(log.faults()[0].1, Fault::Stall { ms: 120 });
}

#[test]
fn refused_connections_and_the_same_ports_later() {
    let (service, mut client) = start();
    service
        .fault(Fault::RefuseConnections { on: true })
        .unwrap();
    assert!(Client::raw(service.port()).is_err());
    assert!(Client::raw(service.events_port()).is_err());
    client.ask(probe());
    service
        .fault(Fault::RefuseConnections { on: false })
        .unwrap();
    assert!(Client::raw(service.port()).is_ok());
    assert!(Client::raw(service.events_port()).is_ok());
}

#[test]
fn replies_that_are_no_json() {
    let (service, mut client) = start();
    service.fault(Fault::Malformed { replies: 1 }).unwrap();
    client.send(probe());
    assert!(serde_json::from_str::<Value>(&client.text().unwrap()).is_err());
    service.fault(Fault::Truncated { replies: 2 }).unwrap();
    for _ in 0..2 {
        client.send(probe());
        let text = client.text().unwrap();
        assert!(text.starts_with('{') && serde_json::from_str::<Value>(&text).is_err());
    }
    client.ask(probe());
}

#[test]
fn numbers_that_are_none() {
    let (service, mut client) = start();
    let cases = [
        (BadNumber::Missing, "\"cursor_position\":{\"y\":"),
        (BadNumber::Null, "\"cursor_position\":{\"x\":null,"),
        (BadNumber::Text, "\"cursor_position\":{\"x\":\"0.1\","),
        (BadNumber::NanWord, "\"cursor_position\":{\"x\":NaN,"),
        (BadNumber::Overflow, "\"cursor_position\":{\"x\":1e400,"),
        (BadNumber::Absurd(1e30), "\"cursor_position\":{\"x\":1e30,"),
    ];
    for (value, part) in cases {
        let fault = Fault::BadNumber {
            device: ARM.into(),
            place: Place::Position,
            value,
            replies: 1,
        };
        service.fault(fault).unwrap();
        client.send(probe());
        let text = client.text().unwrap();
        assert!(text.contains(part), "{text}");
        client.ask(probe());
    }
    let fault = Fault::BadNumber {
        device: GRIP.into(),
        place: Place::Orientation,
        value: BadNumber::Null,
        replies: 1,
    };
    service.fault(fault).unwrap();
    assert!(client.ask(probe())["wireless_verse_grip"][0]["state"]["orientation"]["w"].is_null());
}

#[test]
fn safety_event_takes_the_force_until_the_release() {
    let (service, mut client) = start();
    let mut events = Client::raw(service.events_port()).unwrap();
    assert!(wait_for(
        || format!("{:?}", service.log().unwrap()).contains("EventsConnected")
    ));
    let safety = |cause| Fault::Safety {
        device: ARM.into(),
        cause,
    };
    service.fault(safety(SafetyCause::EbrakeTriggered)).unwrap();
    let event = events.read();
    assert_eq!(event["name"], "device-safety-triggered");
    assert_eq!(event["data"]["reason"], "ebrake_triggered");
    for name in ["category", "level", "message"] {
        assert!(event[name].is_string());
    }
    assert_eq!(shown(&client.push(1.0)), 0.0);
    service.fault(safety(SafetyCause::EbrakeReleased)).unwrap();
    assert_eq!(shown(&client.push(1.0)), 1.0);
    events
        .socket
        .send(tungstenite::Message::text("hello"))
        .unwrap();
    assert!(wait_for(|| service
        .log()
        .unwrap()
        .count(Violation::WroteToEvents)
        == 1));
    service.fault(Fault::DropEvents).unwrap();
    while events.socket.read().is_ok() {}
    client.ask(probe());
}

#[test]
fn a_device_goes_and_comes_back_with_its_config() {
    let (service, mut client) = start();
    service
        .fault(Fault::Disconnect { device: ARM.into() })
        .unwrap();
    assert_eq!(client.push(1.0)["inverse3"].as_array().unwrap().len(), 0);
    assert_eq!(service.log().unwrap().count(Violation::AbsentDevice), 1);
    service
        .fault(Fault::Reconnect { device: ARM.into() })
        .unwrap();
    let reply = client.push(1.0);
    assert_eq!(reply["inverse3"][0]["config"]["type"], "inverse3");
    assert_eq!(shown(&reply), 1.0);
    assert!(client.push(1.0)["inverse3"][0].get("config").is_none());
    let log = service.log().unwrap();
    assert_eq!(
        (
            log.events("device-disconnected"),
            log.events("device-connected")
        ),
        (1, 1)
    );
}

#[test]
fn lost_calibration_is_told_in_status_and_event() {
    let (service, mut client) = start();
    service
        .fault(Fault::CalibrationLost { device: ARM.into() })
        .unwrap();
    assert_eq!(
        client.push(1.0)["inverse3"][0]["status"]["calibrated"],
        false
    );
    service
        .fault(Fault::Calibrated { device: ARM.into() })
        .unwrap();
    assert_eq!(
        client.push(1.0)["inverse3"][0]["status"]["calibrated"],
        true
    );
    assert_eq!(
        service.log().unwrap().events("device-calibration-failed"),
        1
    );
    let event = Fault::Event {
        name: "device-battery-low".into(),
        level: "warning".into(),
        device: GRIP.into(),
    };
    service.fault(event).unwrap();
    assert_eq!(service.log().unwrap().events("device-battery-low"), 1);
}

#[test]
fn replies_twice_none_or_without_a_part() {
    let (service, mut client) = start();
    service.fault(Fault::TwiceReply { replies: 1 }).unwrap();
    let first = client.ask(probe());
    assert_eq!(client.read(), first);
    service.fault(Fault::TwiceDevice { replies: 1 }).unwrap();
    assert_eq!(client.ask(probe())["inverse3"].as_array().unwrap().len(), 2);
    assert_eq!(client.ask(probe())["inverse3"].as_array().unwrap().len(), 1);
    service.fault(Fault::Silence { messages: 2 }).unwrap();
    client.send(probe());
    client.send(probe());
    assert!(client.is_silent(Duration::from_millis(100)));
    assert!(client.ask(probe())["inverse3"].is_array());
    service
        .fault(Fault::Omit {
            what: Omit::Field("cursor_position".into()),
            replies: 1,
        })
        .unwrap();
    assert!(
        client.ask(probe())["inverse3"][0]["state"]
            .get("cursor_position")
            .is_none()
    );
    assert!(
        client.ask(probe())["inverse3"][0]["state"]
            .get("cursor_position")
            .is_some()
    );
    assert!(
        service
            .fault(Fault::Sleep {
                device: "none".into()
            })
            .is_err()
    );
}

#[test]
fn reports_of_the_rate_come_by_themselves() {
    let service = Service::start(Options {
        rate_report_ms: Some(20),
        ..Options::default()
    })
    .unwrap();
    let mut events = Client::raw(service.events_port()).unwrap();
    assert_eq!(events.read()["name"], "system-rate-report");
    assert_eq!(events.read()["name"], "system-rate-report");
}
