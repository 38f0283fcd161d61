//! Rules of the simulation channel.

use std::time::Duration;

use serde_json::json;
use sulcus_standin_haply::{EndReason, Omission, Omit, Options, Replies, Service, Violation, What};
use tungstenite::Message;

use crate::client::{ARM, Client, GRIP, force, probe, wait_for};

#[test]
fn one_inventory_then_one_reply_for_each_message() {
    let service = Service::start(Options::default()).unwrap();
    let (mut client, inventory) = Client::connect(&service);
    assert!(inventory["session_id"].is_number());
    let arm = &inventory["inverse3"][0];
    assert_eq!(arm["device_id"], ARM);
    assert_eq!(arm["config"]["type"], "inverse3");
    assert_eq!(arm["config"]["handedness"], "right");
    assert_eq!(arm["config"]["device_info"]["device_type"], 4);
    assert_eq!(arm["status"]["calibrated"], true);
    assert!(arm["state"]["cursor_position"]["x"].is_number());
    assert_eq!(inventory["wireless_verse_grip"][0]["device_id"], GRIP);
    assert_eq!(inventory["verse_grip"], json!([]));
    assert!(
        client.is_silent(Duration::from_millis(100)),
        "no push after the inventory"
    );
    for _ in 0..5 {
        let reply = client.ask(probe());
        assert!(reply.get("session_id").is_none());
        assert!(reply["inverse3"][0].get("config").is_none());
        assert!(reply["inverse3"][0]["state"]["cursor_position"]["z"].is_number());
    }
    assert!(
        client.is_silent(Duration::from_millis(100)),
        "no second reply"
    );
    let log = service.stop().unwrap();
    assert_eq!((log.connections(), log.messages()), (1, 5));
    assert_eq!(log.violations(), vec![]);
}

#[test]
fn full_state_comes_again_on_demand() {
    let service = Service::start(Options::default()).unwrap();
    let (mut client, first) = Client::connect(&service);
    client.ask(probe());
    let again = client.ask(json!({"session": {"force_render_full_state": {}}}));
    assert_eq!(
        again["inverse3"][0]["config"],
        first["inverse3"][0]["config"]
    );
    assert!(again["session_id"].is_number());
}

#[test]
fn a_missing_and_a_repeated_profile_are_told() {
    let service = Service::start(Options::default()).unwrap();
    let mut client = Client::raw(service.port()).unwrap();
    client.read();
    let named = json!({"session": {"configure": {"profile": {"name": "a.b:c"}}}});
    for message in [probe(), named.clone(), named] {
        client
            .socket
            .send(Message::text(message.to_string()))
            .unwrap();
        client.read();
    }
    let log = service.log().unwrap();
    assert_eq!(log.count(Violation::ProfileMissing), 1);
    assert_eq!(log.count(Violation::ProfileRepeated), 1);
}

#[test]
fn pipelined_messages_are_told_and_answered() {
    let service = Service::start(Options::default()).unwrap();
    let (mut client, _) = Client::connect(&service);
    for _ in 0..20 {
        client.ask(probe());
    }
    assert_eq!(service.log().unwrap().count(Violation::Pipelined), 0);
    for _ in 0..4 {
        client
            .socket
            .write(Message::text(probe().to_string()))
            .unwrap();
    }
    client.socket.flush().unwrap();
    for _ in 0..4 {
        client.read();
    }
    // The four messages leave in one write: three of them lie in wait behind the first.
    assert!(service.log().unwrap().count(Violation::Pipelined) >= 1);
    let before = service.log().unwrap().count(Violation::Pipelined);
    for _ in 0..20 {
        client.ask(probe());
    }
    let log = service.log().unwrap();
    assert_eq!(
        log.count(Violation::Pipelined),
        before,
        "the count of bytes is in step again"
    );
    assert_eq!(log.messages(), 44);
}

#[test]
fn broken_messages_are_told_and_answered() {
    let service = Service::start(Options::default()).unwrap();
    let (mut client, _) = Client::connect(&service);
    client.ask(probe());
    for text in [
        "{",
        "[]",
        r#"{"inverse3": {}}"#,
        r#"{"inverse3": [{"commands": {}}]}"#,
    ] {
        client.socket.send(Message::text(text)).unwrap();
        assert!(client.read()["inverse3"].is_array());
    }
    client.ask(force("FFFF", "vector", 1.0));
    client.ask(json!({"inverse3": [{"device_id": ARM, "commands": {"dance": {}}}]}));
    client.ask(json!({"inverse3": [{"device_id": ARM, "commands": {"set_cursor_force": {"vector": {"x": 1}}}}]}));
    client.socket.send(Message::binary(vec![1, 2, 3])).unwrap();
    assert!(wait_for(|| service
        .log()
        .unwrap()
        .count(Violation::NotText)
        == 1));
    let log = service.log().unwrap();
    assert_eq!(log.count(Violation::BadJson), 4);
    assert_eq!(log.count(Violation::UnknownDevice), 1);
    assert_eq!(log.count(Violation::UnknownCommand), 1);
    assert_eq!(log.count(Violation::BadVector), 1);
    assert_eq!(log.events("invalid-value"), 2);
}

#[test]
fn ends_of_connections_are_told() {
    let service = Service::start(Options::default()).unwrap();
    let (mut polite, _) = Client::connect(&service);
    polite.socket.close(None).unwrap();
    while polite.socket.read().is_ok() {}
    let (lost, _) = Client::connect(&service);
    drop(lost);
    let ends = || {
        let log = service.log().unwrap();
        let reason = |what: &What| match what {
            What::Ended { reason, .. } => Some(*reason),
            _ => None,
        };
        log.entries
            .iter()
            .filter_map(|entry| reason(&entry.what))
            .collect::<Vec<_>>()
    };
    assert!(wait_for(|| ends().len() == 2));
    assert!(ends().contains(&EndReason::ClosedByClient));
    assert!(ends().contains(&EndReason::Lost));
}

#[test]
fn replies_leave_parts_out_at_set_times() {
    let omission = |what, first, last| Omission { what, first, last };
    let replies = Replies {
        config_every: 4,
        status_every: 2,
        omissions: vec![
            omission(Omit::Array("inverse3".into()), 1, 1),
            omission(Omit::Array("wireless_verse_grip".into()), 2, 3),
            omission(Omit::Field("cursor_velocity".into()), 3, 3),
            omission(Omit::State, 4, 4),
            omission(Omit::Device(ARM.into()), 5, 5),
        ],
    };
    let service = Service::start(Options {
        replies,
        ..Options::default()
    })
    .unwrap();
    let (mut client, inventory) = Client::connect(&service);
    assert!(inventory["inverse3"].is_array());
    let replies: Vec<_> = (0..6).map(|_| client.ask(probe())).collect();
    assert!(replies[0].get("inverse3").is_none());
    assert!(replies[0]["wireless_verse_grip"][0].get("status").is_none());
    assert!(replies[1].get("wireless_verse_grip").is_none());
    assert!(replies[1]["inverse3"][0]["status"]["ready"].is_boolean());
    assert!(
        replies[2]["inverse3"][0]["state"]
            .get("cursor_velocity")
            .is_none()
    );
    assert!(
        replies[2]["inverse3"][0]["state"]
            .get("cursor_position")
            .is_some()
    );
    assert!(replies[3]["inverse3"][0].get("state").is_none());
    assert!(replies[3]["inverse3"][0]["config"]["type"].is_string());
    assert_eq!(replies[4]["inverse3"], json!([]));
    assert!(replies[5]["inverse3"][0]["state"]["cursor_velocity"]["x"].is_number());
}
