//! Link and server over a real socket. Nothing here asserts how long something takes: the machine
//! may be busy. Counts and eventual conditions only.
#![allow(clippy::unwrap_used)]

use std::time::{Duration, Instant};

use crate::common::{PATIENCE, Station, epoch_of, force_up, press, press_on, status_of, until};
use sulcus_connection::link::{Link, LinkError, Pin, now_ns};
use sulcus_proto::control::{ButtonEdge, Command, EndReason, Event};
use sulcus_proto::status;
use sulcus_server::{ServerConfig, ServerError, StationConfig};
use sulcus_sessions::{Ending, Message, Recording, ReplayOptions, replay};

#[test]
fn a_session_is_felt_recorded_and_replayed() {
    let station = Station::new();
    let mut link = station.connect().unwrap();
    assert_eq!(link.hello().scene, "plate");
    assert_eq!(link.hello().tools.len(), 1);
    let limits = sulcus_core::Params::default();
    assert_eq!(link.hello().max_force_step_n, limits.max_force_step as f32);
    assert_eq!(
        link.hello().max_torque_step_nm,
        limits.max_torque_step as f32
    );
    assert!(link.start());
    assert!(link.event(Event {
        tick: 0,
        kind: "depth_called".into(),
        json: r#"{"mm":3}"#.into()
    }));
    let (mut strongest, mut has_opened) = (0f32, false);
    press(&mut link, |link, k| {
        let gate = link.force_gate(now_ns());
        assert!((0.0..=1.0).contains(&gate));
        has_opened |= gate == 1.0;
        strongest = strongest.max(force_up(link));
        k > 1500 && has_opened && strongest > 0.4 && link.stats().answered > 100
    });
    let newest = link.latest_wrench().unwrap();
    assert!(newest.age_ms().unwrap() > 0.0);
    assert!(
        newest.datagram.tools[0].graphic.position[2] > 0.0015,
        "the ball stays on the plate"
    );
    let stats = link.stats();
    println!("link: {stats:#?}");
    let summary = link.finish().unwrap();
    println!("server: {summary:#?}");

    assert_eq!(summary.end, EndReason::Stopped);
    assert!(summary.complete);
    assert_eq!(
        summary.edges_dropped + summary.malformed + summary.foreign,
        0
    );
    assert!(stats.answered > 100 && stats.rtt_us.p50 > 0.0);
    assert!(stats.wrenches.accepted > 100 && summary.poses.accepted > 100);
    assert!(summary.poses.accepted <= stats.poses_offered);
    assert!(summary.ticks >= stats.wrenches.accepted);
    assert!(summary.max_force_n > 0.4 && summary.max_force_n < 3.4);
    assert!(
        summary.max_residual_um < 1.0,
        "{} um",
        summary.max_residual_um
    );
    assert!(summary.deadline_misses >= summary.skipped);

    let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| ()).unwrap();
    assert_eq!(report.ticks, summary.ticks);
    assert!(
        report.identical && report.chain_ok && !report.is_finding(),
        "{report:?}"
    );
    assert!(
        report.gradable && matches!(report.ending, Ending::Finished),
        "{report:?}"
    );
    let end = recording.facts().end.unwrap();
    assert_eq!((end.ticks, end.skipped), (summary.ticks, summary.skipped));
    let texts = recording
        .messages()
        .filter_map(|message| match message.unwrap() {
            Message::Event(event) => Some(event.text),
            _ => None,
        });
    assert!(
        texts
            .into_iter()
            .any(|text| text.contains("depth_called") && text.contains(r#"{"mm":3}"#))
    );
}

#[test]
fn one_server_serves_one_client_after_the_other() {
    let mut station = Station::new();
    for _ in 0..2 {
        let mut link = station.connect().unwrap();
        link.start();
        press(&mut link, |link, _| {
            link.latest_wrench()
                .is_some_and(|w| w.datagram.tools[0].echo.valid)
        });
        let second = station.connect();
        assert!(
            matches!(&second, Err(LinkError::Busy(text)) if text.contains("in use")),
            "{:?}",
            second.err()
        );
        link.finish().unwrap();
    }
    let server = station.server.take().unwrap();
    server.shutdown();
    let summaries = server.join().unwrap();
    assert_eq!(summaries.len(), 2);
    assert_ne!(summaries[0].recording, summaries[1].recording);
}

#[test]
fn pause_resume_and_limit_reach_the_hand() {
    let station = Station::new();
    let mut link = station.connect().unwrap();
    link.start();
    press(&mut link, |link, _| force_up(link) > 0.4);
    assert!(station.server().command(Command::Pause));
    press_on(&mut link, |link| {
        force_up(link) == 0.0 && status_of(link) & status::PAUSED != 0
    });
    let before = epoch_of(&mut link);
    assert!(station.server().command(Command::Resume));
    // A resume begins an epoch.
    press_on(&mut link, |link| {
        force_up(link) > 0.4 && epoch_of(link) != before
    });
    // A limit that is no force is not taken for "no limit".
    assert!(station.server().command(Command::ForceLimit(0.2)));
    assert!(station.server().command(Command::ForceLimit(f32::NAN)));
    press_on(&mut link, |link| (0.1..=0.201).contains(&force_up(link)));
    assert!(link.button(ButtonEdge {
        tool: 0,
        button: 2,
        pressed: true,
        device_time_ns: now_ns()
    }));
    // The server takes messages in order: a tick with this limit comes with or after the button.
    assert!(link.command(Command::ForceLimit(0.1)));
    press_on(&mut link, |link| {
        link.latest_wrench()
            .is_some_and(|wrench| wrench.datagram.levels.force_limit_n == 0.1)
    });
    let summary = link.finish().unwrap();
    let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
    let rows = recording
        .messages()
        .filter_map(|message| match message.unwrap() {
            Message::Row(row) => Some(row.input),
            _ => None,
        });
    let rows: Vec<_> = rows.collect();
    assert!(
        rows.iter().any(|input| input.paused)
            && rows.iter().any(|input| input.force_limit_n == 0.2)
    );
    assert_eq!(
        rows.iter()
            .filter(|input| input.tools[0].buttons == 4)
            .count(),
        1
    );
    assert!(
        replay(&recording, &ReplayOptions::default(), &mut |_| ())
            .unwrap()
            .identical
    );
}

#[test]
fn a_hand_that_goes_silent_is_let_go() {
    let station = Station::new();
    let mut link = station.connect().unwrap();
    link.start();
    press(&mut link, |link, _| force_up(link) > 0.4);
    // No poses, but the connection lives: wrenches go on and come to zero.
    until("the end of the force", || {
        force_up(&mut link) == 0.0 && status_of(&mut link) & status::STALE != 0
    });
    press_on(&mut link, |link| force_up(link) > 0.4);
    assert!(link.finish().unwrap().stale > 0);
}

#[test]
fn a_server_that_vanishes_closes_the_gate() {
    let mut station = Station::planned(|plan| plan.resume_within = Duration::ZERO);
    let mut link = station.connect().unwrap();
    link.start();
    press(&mut link, |link, _| {
        link.force_gate(now_ns()) == 1.0 && force_up(link) > 0.4
    });
    drop(station.server.take());
    let mut last = 1.0;
    press_on(&mut link, |link| {
        let gate = link.force_gate(now_ns());
        assert!(
            (gate - last).abs() <= 0.151,
            "the gate jumped from {last} to {gate}"
        );
        last = gate;
        gate == 0.0
    });
    assert!(matches!(link.finish(), Err(LinkError::Lost(_))));
    // Its recording was finished all the same.
    let files: Vec<_> = std::fs::read_dir(station.recording("")).unwrap().collect();
    assert_eq!(files.len(), 1);
    let recording = Recording::open(&files[0].as_ref().unwrap().path()).unwrap();
    assert!(
        matches!(recording.ending(), Ending::Finished),
        "{:?}",
        recording.ending()
    );
}

#[test]
fn a_client_that_vanishes_ends_the_session() {
    let mut station = Station::planned(|plan| plan.resume_within = Duration::ZERO);
    let mut link = station.connect().unwrap();
    link.start();
    press(&mut link, |link, _| link.latest_wrench().is_some());
    drop(link);
    until("a free station", || station.connect().is_ok());
    let server = station.server.take().unwrap();
    server.shutdown();
    let summaries = server.join().unwrap();
    assert_eq!(summaries[0].end, EndReason::ConnectionLost);
    assert!(summaries[0].complete);
}

/// The link keeps itself alive, whatever becomes of the device. Such a session would have held the station, and
/// recorded, for ever.
#[test]
fn a_client_that_sends_no_poses_does_not_hold_the_station() {
    let station = Station::planned(|plan| plan.max_silence = Duration::from_millis(400));
    let mut link = station.connect().unwrap();
    link.start();
    // A client that stalls here is silent already.
    press(&mut link, |link, _| {
        link.latest_wrench().is_some() || !link.is_open()
    });
    until("the end of the session", || !link.is_open());
    assert_eq!(link.finish().unwrap().end, EndReason::ConnectionLost);
}

#[test]
fn a_time_limit_and_a_shutdown_say_goodbye() {
    let station = Station::planned(|plan| plan.max_session = Some(Duration::from_millis(300)));
    let mut link = station.connect().unwrap();
    link.start();
    press(&mut link, |link, _| !link.is_open());
    assert_eq!(link.finish().unwrap().end, EndReason::TimeUp);

    let station = Station::new();
    let mut link = station.connect().unwrap();
    link.start();
    press(&mut link, |link, _| link.latest_wrench().is_some());
    station.server().shutdown();
    press(&mut link, |link, _| !link.is_open());
    let goodbye = link.finish_with_text().unwrap();
    assert_eq!(goodbye.summary.end, EndReason::Shutdown);
    assert!(goodbye.text.contains("shutting down"));
}

#[test]
fn a_folder_that_cannot_be_written_ends_with_a_sentence() {
    let station = Station::new();
    let link = station.connect().unwrap();
    std::fs::remove_dir_all(station.recording("")).unwrap();
    link.start();
    let goodbye = link.finish_with_text().unwrap();
    assert_eq!(goodbye.summary.end, EndReason::Recording);
    assert!(
        !goodbye.summary.complete && goodbye.text.contains("cannot make recording"),
        "{}",
        goodbye.text
    );
}

#[test]
fn strangers_are_told_why() {
    let station = Station::planned(|plan| plan.exercise.name = "crown".into());
    let mut token = station.config();
    token.token = "guess".into();
    let error = Link::connect(token).err().unwrap();
    assert!(
        matches!(&error, LinkError::WrongToken(text) if text.contains("does not know the token")),
        "{error}"
    );

    let mut exercise = station.config();
    exercise.exercise = "juggling".into();
    let error = Link::connect(exercise).err().unwrap();
    assert!(
        matches!(&error, LinkError::Refused(text) if text.contains("`juggling`")),
        "{error}"
    );

    let mut device = station.config();
    device.devices[1].name = "x".repeat(1000);
    assert!(matches!(
        Link::connect(device).err(),
        Some(LinkError::Refused(_))
    ));

    let mut certificate = station.config();
    certificate.pin = Pin::Fingerprint([7; 32]);
    assert!(matches!(
        Link::connect(certificate).err(),
        Some(LinkError::WrongCertificate { .. })
    ));

    let mut whole = station.config();
    whole.pin = Pin::Certificate(station.server().certificate_der().to_vec());
    assert!(Link::connect(whole).is_ok());
}

#[test]
fn an_absent_server_is_named() {
    // Bound, so that no other server can be there, but nobody answers.
    let nobody = std::net::UdpSocket::bind("127.0.0.1:0").unwrap();
    let station = Station::new();
    let mut config = station.config();
    config.server = nobody.local_addr().unwrap();
    config.timeout = Duration::from_millis(300);
    let error = Link::connect(config).err().unwrap();
    assert!(matches!(error, LinkError::Absent { .. }), "{error}");
}

/// The client tried the first address of a name alone, and a server listens on one of two.
#[test]
fn all_addresses_of_a_name_are_tried_and_told() {
    let station = Station::new();
    let listening = station.server().local_addr();
    // On loopback, too: one where somebody else's socket stays silent, and one without any.
    let silent = std::net::UdpSocket::bind("127.0.0.2:0").unwrap();
    let silent = silent.local_addr().unwrap();
    let mut config = station.config();
    // In turn, the silent address alone would take longer than the limit of all waits.
    config.timeout = 2 * PATIENCE;
    config.server = silent;
    config.others = vec![silent, "[::1]:9".parse().unwrap(), listening];
    let begun = Instant::now();
    let mut link = Link::connect(config.clone()).unwrap();
    assert!(begun.elapsed() < PATIENCE, "in turn, not beside");
    link.start();
    press(&mut link, |link, _| link.latest_wrench().is_some());
    link.finish().unwrap();

    // Another server, which has another certificate, and one that is silent.
    let other = Station::new();
    config.timeout = Duration::from_millis(1500);
    config.others = vec![other.server().local_addr()];
    let error = loop {
        let error = Link::connect(config.clone()).err().unwrap();
        // A busy machine may need longer for the certificate.
        if error.to_string().contains("another certificate") || config.timeout > PATIENCE / 2 {
            break error;
        }
        config.timeout *= 2;
    };
    let LinkError::Nowhere(tried) = &error else {
        panic!("{error}")
    };
    let tried: Vec<_> = tried.iter().map(|(server, _)| *server).collect();
    assert_eq!(tried, [silent, other.server().local_addr()]);
    let told = error.to_string();
    assert!(
        told.contains(&format!("{silent}: no answer")) && told.contains("another certificate"),
        "{told}"
    );
}

#[test]
fn a_busy_port_is_named() {
    let station = Station::new();
    let busy = station.server().local_addr();
    let folder = tempfile::tempdir().unwrap();
    let plan = StationConfig::new(crate::common::plan());
    let mut config = ServerConfig::new(plan, folder.path().to_owned()).unwrap();
    config.listen = busy;
    config.station_key = Some(folder.path().join("station.key"));
    let error = sulcus_server::Server::start(config).err().unwrap();
    assert!(
        matches!(error, ServerError::PortBusy { listen } if listen == busy),
        "{error}"
    );
}
