//! A server against clients that do not play by the rules: raw frames over a real connection.
#![allow(clippy::unwrap_used)]

use crate::common::Station;
use crate::common::raw::{self, Raw};
use sulcus_proto::control::{ClientHello, EndReason, Event, RefusedReason, ServerHello};
use sulcus_proto::frame::{self, LENGTH_BYTES};
use sulcus_proto::{ClientMessage, PROTOCOL_VERSION, PoseDatagram, Role, ServerMessage};

/// A raw connection in a session that runs.
async fn started(station: &Station) -> (Raw, ServerHello) {
    let mut raw = Raw::silent(station).await;
    raw.say(&hello(station)).await;
    let Some(ServerMessage::Hello(server)) = raw.hear().await else {
        panic!("refused")
    };
    raw.say(&ClientMessage::Start).await;
    (raw, server)
}

fn hello(station: &Station) -> ClientMessage {
    raw::hello(Role::Student, &station.server().ticket().token)
}

fn block_on(test: impl Future<Output = ()>) {
    tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .unwrap()
        .block_on(test);
}

#[test]
fn another_version_is_refused_by_name() {
    let station = Station::new();
    block_on(async {
        let mut raw = Raw::silent(&station).await;
        let mut bytes = frame::encode(&hello(&station)).unwrap();
        bytes[LENGTH_BYTES] = PROTOCOL_VERSION + 1;
        raw.send.write_all(&bytes).await.unwrap();
        // The answer has the version of the client, which could not read another one.
        let heard = raw.recv.read_to_end(4096).await.unwrap();
        let (server, client) = (PROTOCOL_VERSION, PROTOCOL_VERSION + 1);
        assert_eq!(heard[LENGTH_BYTES], client);
        let mut own = heard[LENGTH_BYTES..].to_vec();
        own[0] = PROTOCOL_VERSION;
        let Ok(ServerMessage::Refused(refused)) = frame::decode(&own) else {
            panic!("not refused")
        };
        assert_eq!(refused.reason, RefusedReason::Version);
        let expected = format!(
            "this server has protocol version {server}, the client {client}; install the client of release {}",
            env!("CARGO_PKG_VERSION")
        );
        assert_eq!(refused.text, expected);
    });
}

#[test]
fn garbage_is_refused_and_the_server_lives() {
    let station = Station::new();
    block_on(async {
        for garbage in [
            &[255; 64][..],
            &[0, 0, 0, 0],
            &[3, 0, 0, 0, PROTOCOL_VERSION, 9, 9],
        ] {
            let mut raw = Raw::silent(&station).await;
            raw.send.write_all(garbage).await.unwrap();
            let Some(ServerMessage::Refused(refused)) = raw.hear().await else {
                panic!("not refused")
            };
            assert_eq!(refused.reason, RefusedReason::BadHello, "{}", refused.text);
        }
        // A name where an id is asked for.
        let mut raw = Raw::silent(&station).await;
        let ClientMessage::Hello(named) = hello(&station) else {
            panic!("a hello")
        };
        raw.say(&ClientMessage::Hello(ClientHello {
            learner: "Jane Doe".into(),
            ..named
        }))
        .await;
        let Some(ServerMessage::Refused(refused)) = raw.hear().await else {
            panic!("not refused")
        };
        assert_eq!(refused.reason, RefusedReason::BadHello);
        assert!(
            refused.text.contains("learner `Jane Doe`"),
            "{}",
            refused.text
        );
        let mut raw = Raw::silent(&station).await;
        raw.say(&ClientMessage::Start).await;
        assert!(
            matches!(raw.hear().await, Some(ServerMessage::Refused(r)) if r.reason == RefusedReason::BadHello)
        );
        let mut raw = Raw::silent(&station).await;
        raw.say(&hello(&station)).await;
        assert!(matches!(raw.hear().await, Some(ServerMessage::Hello(_))));
    });
}

#[test]
fn bad_datagrams_are_counted_and_move_nothing() {
    let station = Station::new();
    block_on(async {
        let (mut raw, server) = started(&station).await;
        // The first wrench says that the session reads datagrams.
        raw.connection.read_datagram().await.unwrap();
        let pose = |epoch, sequence| {
            PoseDatagram {
                epoch,
                sequence,
                ..Default::default()
            }
            .to_bytes()
            .unwrap()
        };
        let good = [
            pose(server.epoch, 5),
            pose(server.epoch, 5),
            pose(server.epoch, 3),
            pose(server.epoch, 9),
        ];
        let sent = good.iter().map(|bytes| bytes.to_vec()).chain([
            vec![],
            vec![1, 2, 3],
            good[0][..100].to_vec(),
            pose(server.epoch.wrapping_add(1), 77).to_vec(),
        ]);
        for bytes in sent {
            raw.connection
                .send_datagram_wait(bytes.into())
                .await
                .unwrap();
            tokio::time::sleep(std::time::Duration::from_millis(20)).await;
        }
        raw.say(&ClientMessage::Stop).await;
        let Some(ServerMessage::Goodbye(goodbye)) = raw.hear().await else {
            panic!("no goodbye")
        };
        let summary = goodbye.summary;
        assert_eq!(summary.end, EndReason::Stopped);
        assert_eq!((summary.malformed, summary.foreign), (3, 1));
        let poses = summary.poses;
        assert_eq!(
            (poses.accepted, poses.duplicate, poses.late, poses.lost),
            (2, 1, 1, 3)
        );
        assert_eq!(summary.max_force_n, 0.0);
    });
}

#[test]
fn a_second_hello_ends_the_session_with_a_sentence() {
    let station = Station::new();
    block_on(async {
        let (mut raw, _) = started(&station).await;
        raw.say(&hello(&station)).await;
        let Some(ServerMessage::Goodbye(goodbye)) = raw.hear().await else {
            panic!("no goodbye")
        };
        assert_eq!(goodbye.summary.end, EndReason::Protocol);
        assert!(goodbye.text.contains("protocol"));
    });
}

#[test]
fn a_client_that_says_what_only_the_station_says_is_sent_away() {
    // The second would be a line of the log that says "bleeding at tick 5".
    for kind in ["bleeding", "bleeding at tick 5: {\"a\":\""] {
        let station = Station::new();
        block_on(async {
            let (mut raw, _) = started(&station).await;
            raw.say(&ClientMessage::Event(Event {
                tick: 1,
                kind: kind.into(),
                json: "\"}".into(),
            }))
            .await;
            let Some(ServerMessage::Goodbye(goodbye)) = raw.hear().await else {
                panic!("no goodbye")
            };
            assert_eq!(goodbye.summary.end, EndReason::Protocol);
        });
    }
}

#[test]
fn a_client_in_a_crowd_proves_its_address_and_comes_in() {
    let station = Station::new();
    block_on(async {
        // More than half of the server's 64 slots: silent ones first, then one that speaks.
        let mut crowd = Vec::new();
        for _ in 0..40 {
            crowd.push(Raw::silent(&station).await);
        }
        let mut raw = Raw::silent(&station).await;
        raw.say(&hello(&station)).await;
        assert!(matches!(raw.hear().await, Some(ServerMessage::Hello(_))));
    });
}
