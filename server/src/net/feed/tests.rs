//! Feeds over loopback: a reader that reads, one that never does, one that has the scene.

use std::net::Ipv4Addr;
use std::time::Duration;

use quinn::{ClientConfig, Endpoint, RecvStream, ServerConfig, TransportConfig};
use sulcus_core::tissue::TissueModel;
use sulcus_core::{DisplayMesh, Object, Pose, Quat, Scene, Sphere, SphereTree, Tool, Vec3};
use sulcus_proto::display::stream::Content;
use sulcus_proto::display::{DisplayFrame, DisplayScene};

use super::*;
use crate::net::identity::Identity;
use crate::outlets::feed::FeedPublisher;

/// Longest time of a test. All of its waits are for conditions.
const LIMIT: Duration = Duration::from_secs(120);

/// A ball, and a rigid object whose mesh has this number of vertices.
fn display(vertices: usize) -> Arc<Display> {
    let ball = [Sphere {
        centre: Vec3::zeros(),
        radius: 1e-3,
    }];
    let tree = SphereTree::over_leaves(&ball).expect("a tree");
    let place = |k: usize| [k as f32 * 1e-6, (k % 97) as f32 * 1e-5, 0.0];
    let scene = Scene {
        name: "ball".into(),
        source_hash: "none".into(),
        params: Default::default(),
        tools: vec![Tool {
            name: "ball".into(),
            tree: tree.clone(),
            level: 3,
            working_point: Vec3::zeros(),
            tip: Vec3::zeros(),
            tip_axis: -Vec3::z(),
            stiffness_n_per_m: 500.0,
            stiffness_nm_per_rad: 0.5,
            park: Pose::new(Vec3::z() * 0.02, Quat::identity()),
            bands: vec![],
            mesh: DisplayMesh::default(),
        }],
        objects: vec![Object {
            name: "ball".into(),
            fdi: 0,
            tree,
            level: 3,
            tissue: TissueModel::Rigid,
            mesh: DisplayMesh {
                vertices: (0..vertices).map(place).collect(),
                ..DisplayMesh::default()
            },
            carriers: Vec::new(),
        }],
    };
    Arc::new(Display::new(&scene).expect("a display"))
}

fn frame(display: &Display, tick: u64) -> DisplayFrame {
    DisplayFrame {
        scene: display.hash().short(),
        tick,
        ..DisplayFrame::default()
    }
}

/// Two ends of one connection, with the transport of the display. No silence ends the connection.
async fn connected(mut of_display: TransportConfig) -> (Connection, Connection, [Endpoint; 2]) {
    of_display.max_idle_timeout(None);
    let mut of_server = sulcus_link::bulk::of_server().expect("settings");
    of_server.max_idle_timeout(None);
    let identity = Identity::generate("localhost").expect("a certificate");
    let mut roots = rustls::RootCertStore::empty();
    roots.add(identity.certificate.clone()).expect("a root");
    let mut server = ServerConfig::with_single_cert(vec![identity.certificate], identity.key)
        .expect("a configuration");
    server.transport_config(Arc::new(of_server));
    let mut client = ClientConfig::with_root_certificates(Arc::new(roots)).expect("settings");
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

fn of_display() -> TransportConfig {
    sulcus_link::bulk::of_display().expect("settings")
}

async fn read(mut stream: RecvStream) -> Result<(Content, Vec<u8>), quinn::ReadToEndError> {
    let mut head = [0; stream::HEAD];
    if stream.read_exact(&mut head).await.is_err() {
        return Err(quinn::ReadToEndError::TooLong);
    }
    let content = stream::content(head).expect("a head");
    Ok((content, stream.read_to_end(content.limit()).await?))
}

fn run(test: impl Future<Output = ()>) {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    let timed = async { tokio::time::timeout(LIMIT, test).await };
    runtime
        .expect("a runtime")
        .block_on(timed)
        .expect("in time");
}

#[test]
fn a_display_gets_the_scene_and_then_frames() {
    run(async {
        let (server, client, _ends) = connected(of_display()).await;
        let (mut publisher, feed) = FeedPublisher::new();
        let serving = tokio::spawn(async move { serve_feed(server, &[], feed).await });
        let display = display(60_000);
        assert!(display.bytes().len() > 8 * 32 * 1024, "many windows long");
        publisher.begin(display.clone());
        let (content, bytes) = read(client.accept_uni().await.expect("a stream"))
            .await
            .expect("whole");
        assert_eq!(content, Content::Scene);
        let (hash, scene) = stream::scene(&bytes).expect("a scene");
        assert_eq!(hash, display.hash());
        let scene = DisplayScene::from_bytes(scene.expect("in full")).expect("a scene");
        assert_eq!(&scene, display.scene());
        for tick in 1..=20 {
            publisher.publish(frame(&display, tick));
            let (content, bytes) = read(client.accept_uni().await.expect("a stream"))
                .await
                .expect("whole");
            assert_eq!(content, Content::Frame);
            let got = DisplayFrame::from_bytes(&bytes).expect("a frame");
            assert_eq!((got.tick, got.sequence), (tick, tick));
        }
        // A second scene, for example after a change of the plan.
        let second = self::display(10);
        publisher.publish(frame(&second, 21));
        assert_eq!(publisher.dropped(), 1, "a frame of no present scene");
        publisher.begin(second.clone());
        let (_, bytes) = read(client.accept_uni().await.expect("a stream"))
            .await
            .expect("whole");
        assert_eq!(stream::scene(&bytes).expect("a scene").0, second.hash());
        drop(publisher);
        let report = serving.await.expect("no panic");
        assert_eq!((report.scenes, report.frames, report.skipped), (2, 20, 0));
        assert_eq!(report.taken + report.reset, 20);
    });
}

#[test]
fn a_display_that_has_the_scene_gets_the_hash_alone() {
    run(async {
        let (server, client, _ends) = connected(of_display()).await;
        let (mut publisher, feed) = FeedPublisher::new();
        let display = display(1000);
        let known = [SceneHash([1; 32]), display.hash()];
        publisher.begin(display.clone());
        let serving = tokio::spawn(async move { serve_feed(server, &known, feed).await });
        let (_, bytes) = read(client.accept_uni().await.expect("a stream"))
            .await
            .expect("whole");
        assert_eq!(stream::scene(&bytes), Ok((display.hash(), None)));
        client.close(0u32.into(), b"seen");
        assert_eq!(serving.await.expect("no panic").scenes, 0);
    });
}

#[test]
fn a_display_that_never_reads_holds_a_bounded_number_of_frames() {
    run(async {
        let mut deaf = of_display();
        deaf.max_concurrent_uni_streams(4u32.into());
        let (server, client, _ends) = connected(deaf).await;
        let (mut publisher, feed) = FeedPublisher::new();
        let display = display(10);
        publisher.begin(display.clone());
        let hash = display.hash();
        let serving = tokio::spawn(async move { serve_feed(server, &[hash], feed).await });
        // The scene's stream is taken; frames are not.
        let first = client.accept_uni().await.expect("a stream");
        read(first).await.expect("whole");
        for tick in 1..=2000 {
            publisher.publish(frame(&display, tick));
            tokio::task::yield_now().await;
        }
        // The server has used every stream that the display granted besides that of the scene.
        let mut unread = Vec::new();
        for _ in 0..3 {
            unread.push(client.accept_uni().await.expect("a stream"));
        }
        for tick in 2001..=4000 {
            publisher.publish(frame(&display, tick));
            tokio::task::yield_now().await;
        }
        client.close(0u32.into(), b"never read");
        drop(unread);
        let report = serving.await.expect("no panic");
        assert!(report.frames <= 8, "{report:?}");
        assert_eq!(report.frames, report.taken + report.reset + report.refused);
    });
}

#[test]
fn a_slow_display_gets_the_newest_frame_and_no_backlog() {
    run(async {
        // A frame is longer than the window of its stream, so that no frame fits before the display reads.
        let mut narrow = of_display();
        narrow.stream_receive_window(8u32.into());
        let (server, client, _ends) = connected(narrow).await;
        let (mut publisher, feed) = FeedPublisher::new();
        let display = display(10);
        publisher.begin(display.clone());
        let hash = display.hash();
        let serving = tokio::spawn(async move { serve_feed(server, &[hash], feed).await });
        read(client.accept_uni().await.expect("a stream"))
            .await
            .expect("whole");
        let last = 400;
        for tick in 1..=last {
            publisher.publish(frame(&display, tick));
            tokio::time::sleep(Duration::from_micros(500)).await;
        }
        // The display wakes after 400 frames: it reads a few streams until the newest.
        let (mut streams, mut newest) = (0u32, 0);
        while newest < last {
            streams += 1;
            if let Ok((_, bytes)) = read(client.accept_uni().await.expect("a stream")).await {
                newest = newest.max(DisplayFrame::from_bytes(&bytes).expect("a frame").tick);
            }
        }
        assert!(
            streams <= 3 * sulcus_link::bulk::STREAMS,
            "{streams} streams"
        );
        client.close(0u32.into(), b"seen");
        let report = serving.await.expect("no panic");
        assert!(report.skipped > 200, "{report:?}");
        assert!(report.reset > 0, "{report:?}");
    });
}
