//! A feed from the publisher of a station to the window's end, over loopback, with the transports of both ends.

use std::net::Ipv4Addr;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use quinn::crypto::rustls::QuicServerConfig;
use quinn::{Endpoint, ServerConfig};
use rustls::pki_types::PrivatePkcs8KeyDer;
use sulcus_connection::display::{Cache, receive, transport};
use sulcus_connection::link::{Pin, client_config};
use sulcus_core::{NoProbe, State, TickInput, Workspace, tick};
use sulcus_display::Display;
use sulcus_proto::ALPN;
use sulcus_scene::{BuildOptions, BuiltIn, compile_built_in};
use sulcus_server::{FeedPublisher, SessionFeed, fingerprint, serve_feed};
use sulcus_sessions::Moved;

#[test]
fn a_feed_reaches_the_window_and_the_second_time_without_the_scene() {
    let scene = compile_built_in(BuiltIn::Tongue, &BuildOptions::cached(), &|_, _| ());
    let scene = scene.expect("a scene").scene;
    let display = Arc::new(Display::new(&scene).expect("a display"));
    let folder = tempfile::tempdir().expect("folder");
    let cache = Cache::new(folder.path());
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .expect("a runtime");
    runtime.block_on(async {
        let made = rcgen::generate_simple_self_signed(vec!["localhost".into()]).expect("made");
        let certificate = made.cert.der().clone();
        let pin = fingerprint(&certificate).expect("a digest");
        let key = PrivatePkcs8KeyDer::from(made.signing_key.serialize_der());
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let mut tls = rustls::ServerConfig::builder_with_provider(provider)
            .with_protocol_versions(&[&rustls::version::TLS13])
            .expect("TLS 1.3")
            .with_no_client_auth()
            .with_single_cert(vec![certificate], key.into())
            .expect("a certificate");
        tls.alpn_protocols = vec![ALPN.to_vec()];
        let crypto = QuicServerConfig::try_from(tls).expect("a suite");
        let mut server = ServerConfig::with_crypto(Arc::new(crypto));
        let settings = sulcus_link::bulk::of_server().expect("settings");
        server.transport_config(Arc::new(settings));
        let any = (Ipv4Addr::LOCALHOST, 0).into();
        let listening = Endpoint::server(server, any).expect("a socket");
        let address = listening.local_addr().expect("an address");

        for round in 0..2 {
            let mismatch = Arc::new(AtomicBool::new(false));
            let mut client = client_config(Pin::Fingerprint(pin), mismatch).expect("settings");
            client.transport_config(Arc::new(transport().expect("settings")));
            let calling = Endpoint::client(any).expect("a socket");
            let connecting = calling
                .connect_with(client, address, "localhost")
                .expect("begun");
            let accepting = async { listening.accept().await.expect("an endpoint").await };
            let (accepted, client) = tokio::join!(accepting, connecting);
            let connection = accepted.expect("accepted");
            let client = client.expect("connected");

            let known = cache.known();
            assert_eq!(known.len(), round);
            let (mut publisher, feed) = FeedPublisher::new();
            let serving = tokio::spawn(async move { serve_feed(connection, &known, feed).await });
            let (mut window, reading) = receive(client.clone(), Some(cache.clone()));
            let reading = tokio::spawn(reading);

            let mut session = SessionFeed::begin(&mut publisher, &scene, display.clone());
            while window.newest().is_none() {
                tokio::time::sleep(Duration::from_millis(2)).await;
            }
            let moved = Moved::new(&scene);
            let (mut state, mut workspace) = (State::new(&scene), Workspace::new(&scene));
            let mut input = TickInput::IDLE;
            input.paused = true;
            for _ in 0..320 {
                let output = tick(&scene, &mut state, &mut workspace, &input, &mut NoProbe);
                session.tick(&mut publisher, &output, input.paused, &moved);
                tokio::time::sleep(Duration::from_micros(200)).await;
            }
            let newest = |window: &mut sulcus_connection::display::Feed| {
                let picture = window.newest().expect("a picture");
                assert_eq!(&*picture.scene, display.scene());
                picture
                    .frame
                    .as_ref()
                    .map(|frame| (frame.tick, frame.paused))
            };
            while newest(&mut window) != Some((320, true)) {
                tokio::time::sleep(Duration::from_millis(2)).await;
            }
            let stats = window.stats();
            assert_eq!((stats.malformed, stats.foreign), (0, 0), "{stats:?}");
            let scenes = (stats.scenes, stats.scenes_cached);
            assert_eq!(scenes, if round == 0 { (1, 0) } else { (0, 1) });
            // The first tick is due, then every sixteenth.
            assert_eq!(stats.frames + stats.lost, 21, "{stats:?}");
            while cache.known() != [display.hash()] {
                tokio::time::sleep(Duration::from_millis(2)).await;
            }
            client.close(0u32.into(), b"seen");
            let report = serving.await.expect("no panic");
            assert_eq!(report.scenes, 1 - round as u64);
            reading.await.expect("no panic");
        }
    });
}
