//! The receiver against a sender of the test: scenes, frames in any order, streams of nonsense.

use std::net::Ipv4Addr;
use std::time::Duration;

use quinn::crypto::rustls::QuicClientConfig;
use quinn::{ClientConfig, Connection, Endpoint, ServerConfig, VarInt};
use rustls::pki_types::{PrivateKeyDer, PrivatePkcs8KeyDer};
use sulcus_proto::datagram::WirePose;
use sulcus_proto::display::{DisplayMesh, DisplayTool, Moved, MovedHandle, stream};

use super::*;

fn scene() -> DisplayScene {
    let mesh = DisplayMesh::new(&[], &[], [0; 4], &[]).expect("a mesh");
    DisplayScene {
        tick_ns: 1_000_000,
        tools: vec![DisplayTool {
            name: "ball".into(),
            mesh,
            glass: None,
            bands: vec![],
            tip: [0.0; 3],
            tip_axis: [0.0, 0.0, -1.0],
            park: WirePose::IDENTITY,
        }],
        objects: vec![],
    }
}

fn frame(hash: &SceneHash, sequence: u64) -> DisplayFrame {
    DisplayFrame {
        scene: hash.short(),
        sequence,
        tick: 16 * sequence,
        ..DisplayFrame::default()
    }
}

async fn connected() -> (Connection, Connection, [Endpoint; 2]) {
    let made = rcgen::generate_simple_self_signed(vec!["localhost".into()]).expect("made");
    let key = PrivatePkcs8KeyDer::from(made.signing_key.serialize_der());
    let certificate = made.cert.der().clone();
    let mut roots = rustls::RootCertStore::empty();
    roots.add(certificate.clone()).expect("a root");
    let server = ServerConfig::with_single_cert(vec![certificate], PrivateKeyDer::from(key));
    let mut server = server.expect("a configuration");
    // No silence of a busy machine ends the connection.
    let mut of_server = TransportConfig::default();
    of_server.max_idle_timeout(None);
    server.transport_config(Arc::new(of_server));
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let tls = rustls::ClientConfig::builder_with_provider(provider)
        .with_protocol_versions(&[&rustls::version::TLS13])
        .expect("TLS 1.3")
        .with_root_certificates(roots)
        .with_no_client_auth();
    let crypto = QuicClientConfig::try_from(tls).expect("a suite");
    let mut client = ClientConfig::new(Arc::new(crypto));
    let mut of_display = transport().expect("settings");
    of_display.max_idle_timeout(None);
    client.transport_config(Arc::new(of_display));
    let any = (Ipv4Addr::LOCALHOST, 0).into();
    let listening = Endpoint::server(server, any).expect("a socket");
    let calling = Endpoint::client(any).expect("a socket");
    let address = listening.local_addr().expect("an address");
    let connecting = calling
        .connect_with(client, address, "localhost")
        .expect("begun");
    let accepting = async { listening.accept().await.expect("an endpoint").await };
    let (accepted, connection) = tokio::join!(accepting, connecting);
    let accepted = accepted.expect("accepted");
    (
        accepted,
        connection.expect("connected"),
        [listening, calling],
    )
}

/// Sends one stream, and waits until it is read.
async fn send(connection: &Connection, parts: &[&[u8]]) {
    let mut stream = connection.open_uni().await.expect("a stream");
    for part in parts {
        stream.write_all(part).await.expect("written");
    }
    stream.finish().expect("finished");
    let _ = stream.stopped().await;
}

async fn send_frame(connection: &Connection, frame: &DisplayFrame) {
    let bytes = frame.to_bytes().expect("encodes");
    send(connection, &[&stream::frame_head(), &bytes]).await;
}

/// Waits until the counts are as expected.
async fn until(feed: &Feed, holds: impl Fn(&FeedStats) -> bool) {
    while !holds(&feed.stats()) {
        tokio::time::sleep(Duration::from_millis(2)).await;
    }
}

/// Runs a test, whose waits are all for conditions, for two minutes at most.
fn run(test: impl Future<Output = ()>) {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    let timed = async { tokio::time::timeout(Duration::from_secs(120), test).await };
    runtime
        .expect("a runtime")
        .block_on(timed)
        .expect("in time");
}

#[test]
fn the_newest_frame_wins_and_all_others_are_counted() {
    run(async {
        let (server, client, _ends) = connected().await;
        let folder = tempfile::tempdir().expect("folder");
        let cache = Cache::new(folder.path());
        let (mut feed, reading) = receive(client, Some(cache.clone()));
        let reading = tokio::spawn(reading);
        assert!(feed.newest().is_none());
        let bytes = scene().to_bytes().expect("encodes");
        let hash = SceneHash::of(&bytes);
        send(&server, &[&stream::scene_head(&hash), &bytes]).await;
        until(&feed, |stats| stats.scenes == 1).await;
        for sequence in [5, 9, 7] {
            send_frame(&server, &frame(&hash, sequence)).await;
            until(&feed, |stats| stats.frames > 0).await;
        }
        until(&feed, |stats| stats.frames == 3).await;
        let picture = feed.newest().expect("a picture");
        assert_eq!((picture.hash, &*picture.scene), (hash, &scene()));
        assert_eq!(picture.frame.as_ref().expect("a frame").sequence, 9);
        let stats = feed.stats();
        assert_eq!((stats.late, stats.lost), (1, 2));
        while cache.known() != [hash] {
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
        server.close(0u32.into(), b"end");
        assert!(matches!(
            reading.await.expect("no panic"),
            FeedEnd::Closed(_)
        ));
        assert!(feed.newest().is_some(), "the last picture stays");
    });
}

#[test]
fn nonsense_is_counted_and_the_feed_goes_on() {
    run(async {
        let (server, client, _ends) = connected().await;
        let (mut feed, reading) = receive(client.clone(), None);
        tokio::spawn(reading);
        let bytes = scene().to_bytes().expect("encodes");
        let hash = SceneHash::of(&bytes);
        send(&server, &[&stream::scene_head(&hash), &bytes]).await;
        until(&feed, |stats| stats.scenes == 1).await;
        send(&server, &[]).await;
        send(&server, &[b"x"]).await;
        send(&server, &[b"nonsense"]).await;
        send(&server, &[&stream::frame_head(), &[0xff; 100]]).await;
        send(&server, &[&stream::frame_head(), &vec![0; 70_000]]).await;
        // A scene that is not the one of its hash.
        send(&server, &[&stream::scene_head(&SceneHash([0; 32])), &bytes]).await;
        until(&feed, |stats| stats.malformed == 6).await;
        // A stream whose head has arrived.
        let arrived = || client.stats().frame_rx.stream;
        let before = arrived();
        let mut reset = server.open_uni().await.expect("a stream");
        reset
            .write_all(&stream::frame_head())
            .await
            .expect("written");
        while arrived() == before {
            tokio::time::sleep(Duration::from_millis(2)).await;
        }
        reset.reset(VarInt::from_u32(1)).expect("open");
        until(&feed, |stats| stats.reset == 1).await;
        // A frame of another scene, and one with a handle that this scene lacks.
        send_frame(&server, &frame(&SceneHash([0; 32]), 1)).await;
        let mut wrong = frame(&hash, 2);
        let handles = vec![MovedHandle {
            handle: 0,
            by: [1; 3],
        }];
        wrong.moved.push(Moved { object: 0, handles });
        send_frame(&server, &wrong).await;
        until(&feed, |stats| stats.foreign == 2).await;
        assert!(feed.newest().expect("a scene").frame.is_none());
        send_frame(&server, &frame(&hash, 3)).await;
        until(&feed, |stats| stats.frames == 3).await;
        assert!(feed.newest().expect("a scene").frame.is_some());
    });
}

#[test]
fn a_known_scene_comes_from_the_cache_and_a_lost_one_ends_the_feed() {
    run(async {
        let folder = tempfile::tempdir().expect("folder");
        let cache = Cache::new(folder.path());
        let bytes = scene().to_bytes().expect("encodes");
        let hash = SceneHash::of(&bytes);
        cache.store(&bytes).expect("stored");
        let (server, client, _ends) = connected().await;
        let (mut feed, reading) = receive(client, Some(cache));
        let reading = tokio::spawn(reading);
        send(&server, &[&stream::scene_head(&hash)]).await;
        until(&feed, |stats| stats.scenes_cached == 1).await;
        assert_eq!(*feed.newest().expect("a picture").scene, scene());
        send(&server, &[&stream::scene_head(&SceneHash([7; 32]))]).await;
        let end = reading.await.expect("no panic");
        assert!(matches!(end, FeedEnd::Missing(SceneHash([7, ..]))), "{end}");
    });
}
