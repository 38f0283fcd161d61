//! Stations that outlive their connections: gaps, returns, several stations in a server, faults of one of them.
#![allow(clippy::unwrap_used)]

use std::time::Duration;

use crate::common::{
    PATIENCE, Station, force_up, points, pose, press, press_on, rows_and_events, tick_of, until,
};
use sulcus_connection::link::{Link, LinkConfig, LinkError, Pin, now_ns};
use sulcus_proto::control::{Command, EndReason};
use sulcus_proto::station::{Phase, StationStatus};
use sulcus_proto::{Role, status};
use sulcus_relay::Relay;
use sulcus_server::net::tokens::Fixed;
use sulcus_server::state::{ServerIdentity, StateFolder};
use sulcus_server::{Provoked, ServerConfig, StationConfig};
use sulcus_sessions::{Ending, Occurrence, Recording, ReplayOptions, Row, replay};

fn kinds(events: &[Occurrence]) -> Vec<&str> {
    events.iter().map(|event| event.kind.as_str()).collect()
}

/// A server with the stations `a`, `b` and `c`; each station's token is its name doubled.
fn three() -> Station {
    Station::with(|config| {
        let first = config.stations.remove(0);
        for name in ["a", "b", "c"] {
            config.stations.push(StationConfig {
                name: name.into(),
                ..first.clone()
            });
        }
        config.token = "aa".into();
        let tokens = Fixed::default().with("bb", "t-b", Role::Student, Some("b"));
        let tokens = tokens.with("cc", "t-c", Role::Student, Some("c"));
        config.tokens = std::sync::Arc::new(tokens);
    })
}

fn config_of(station: &Station, token: &str) -> LinkConfig {
    LinkConfig {
        token: token.into(),
        ..station.config()
    }
}

/// Session whose path was cut.
struct Cut {
    rows: Vec<Row>,
    events: Vec<Occurrence>,
    /// Number of the client's returns.
    returns: u32,
}

/// Presses in a session over a relay whose path is cut until the status of the station is `enough`.
fn cut(enough: impl Fn(&StationStatus) -> bool) -> Cut {
    let station = Station::new();
    let relay = Relay::to(station.server().local_addr()).unwrap();
    let mut config = station.config();
    config.server = relay.address();
    let mut link = Link::connect(config).unwrap();
    link.start();
    press(&mut link, |link, _| {
        link.force_gate(now_ns()) == 1.0 && force_up(link) > 0.4
    });
    relay.cut(true);
    // The hand goes on while the path is cut, and the gate takes the force away.
    let mut last = 1.0;
    press_on(&mut link, |link| {
        let gate = link.force_gate(now_ns());
        assert!((gate - last).abs() <= 0.151, "from {last} to {gate}");
        last = gate;
        gate == 0.0 && enough(&station.server().status()[0])
    });
    relay.cut(false);
    press_on(&mut link, |link| {
        link.force_gate(now_ns()) == 1.0 && force_up(link) > 0.4
    });
    let returns = link.stats().returns;
    let summary = link.finish().unwrap();
    assert_eq!(summary.end, EndReason::Stopped);
    assert!(summary.complete, "{summary:?}");
    let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| ()).unwrap();
    assert!(report.identical && report.gradable, "{report:?}");
    let (rows, events) = rows_and_events(&recording);
    let gaps = events.iter().filter(|event| event.kind == "detached");
    assert!(gaps.count() <= summary.gaps as usize, "{events:?}");
    Cut {
        rows,
        events,
        returns,
    }
}

#[test]
fn a_path_cut_for_a_second_leaves_the_connection_and_takes_the_force() {
    // A machine that stalls for three seconds loses a connection by itself: another cut then decides.
    until("a cut that leaves the connection", || {
        let age_ms = |status: &StationStatus| status.tools[0].pose_age_ms;
        let cut = cut(|status| age_ms(status) >= 1000 || status.phase == Phase::Waiting);
        // Poses are stale from an age of 50 ms on.
        let stale = points(cut.rows.iter().filter(|row| row.input.tools[0].stale));
        println!("{stale} stale points, {} returns", cut.returns);
        let stays = cut.returns == 0;
        if stays {
            assert!(cut.events.is_empty(), "{:?}", cut.events);
            assert!(stale >= 900, "{stale}");
        }
        stays
    });
}

/// A gap of three seconds ended an exam.
#[test]
fn a_student_who_is_cut_off_returns_to_the_same_session_and_recording() {
    let cut = cut(|status| status.phase == Phase::Waiting && status.gap_ms > 2000);
    assert!(cut.returns > 0);
    // A machine that stalls has further gaps.
    assert!(!cut.events.is_empty());
    for pair in cut.events.chunks(2) {
        assert_eq!(kinds(pair), ["detached", "attached"], "{:?}", cut.events);
        let (out, back) = (pair[0].tick, pair[1].tick);
        assert_eq!(pair[1].data["gap_ticks"], back - out);
        let away = |row: &&Row| (out..back).contains(&row.tick);
        let mut away = cut.rows.iter().filter(away);
        assert!(away.all(|row| !row.input.tools[0].present));
    }
    let (out, back) = (cut.events[0].tick, cut.events[1].tick);
    assert!(back - out > 1000, "from {out} to {back}");
    // After the return the force rises without a step: half a millinewton a tick on the way up is far below a click.
    let back = cut.events[cut.events.len() - 1].tick;
    let steps = cut.rows.windows(2).filter(|pair| pair[0].tick > back);
    let largest = steps
        .map(|pair| (pair[1].wrench[0][2] - pair[0].wrench[0][2]).abs())
        .fold(0.0, f32::max);
    assert!(largest < 0.1, "{largest} N in a tick");
    // The ramp counts computed ticks, and the client has felt four fifths of the force.
    let ramping = |row: &&Row| row.tick > back && row.status[0] & status::RAMPING != 0;
    assert!(cut.rows.iter().filter(ramping).count() >= 50);
}

#[test]
fn a_client_behind_a_nat_that_forgets_it_goes_on() {
    let station = Station::new();
    let relay = Relay::to(station.server().local_addr()).unwrap();
    let mut config = station.config();
    config.server = relay.address();
    let mut link = Link::connect(config).unwrap();
    link.start();
    press(&mut link, |link, _| force_up(link) > 0.4);
    // A machine that stalls for three seconds loses a connection by itself: another time then decides.
    until("a connection that outlives its NAT", || {
        let returns = link.stats().returns;
        relay.rebind().unwrap();
        let before = tick_of(&mut link);
        press_on(&mut link, |link| {
            tick_of(link) > before + 1500 && force_up(link) > 0.4
        });
        link.stats().returns == returns
    });
    assert_eq!(link.finish().unwrap().end, EndReason::Stopped);
}

/// Begins a session and drops its link.
fn vanish(config: LinkConfig) {
    let mut link = Link::connect(config).unwrap();
    link.start();
    press(&mut link, |link, _| link.latest_wrench().is_some());
}

#[test]
fn a_session_waits_for_its_own_learner_and_then_ends() {
    let of = |station: &Station, learner: &str| LinkConfig {
        learner: learner.into(),
        ..station.config()
    };
    let station = Station::planned(|plan| plan.resume_within = 2 * PATIENCE);
    vanish(of(&station, "a7"));
    until("the gap", || {
        station.server().status()[0].phase == Phase::Waiting
    });
    // Another learner on the same seat is told how long the session waits.
    let error = Link::connect(of(&station, "b8")).err().unwrap();
    assert!(
        matches!(&error, LinkError::Busy(text) if text.contains("waits") && text.contains("learner")),
        "{error}"
    );
    // The same learner, with a program that was started anew.
    let mut link = Link::connect(of(&station, "a7")).unwrap();
    assert!(link.hello().resumed);
    press_on(&mut link, |link| {
        link.latest_wrench()
            .is_some_and(|w| w.datagram.tools[0].echo.valid)
    });
    let summary = link.finish().unwrap();
    assert_eq!(summary.end, EndReason::Stopped);
    assert!(summary.complete && summary.gaps > 0, "{summary:?}");
    let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
    let (_, events) = rows_and_events(&recording);
    assert!(kinds(&events).starts_with(&["detached", "attached"]));

    // Nobody comes back to this session.
    let mut station = Station::planned(|plan| plan.resume_within = Duration::from_secs(2));
    vanish(of(&station, "a7"));
    until("the end", || {
        station.server().status()[0].phase == Phase::Free
    });
    let mut link = Link::connect(of(&station, "b8")).unwrap();
    assert!(!link.hello().resumed);
    link.start();
    press(&mut link, |link, _| link.latest_wrench().is_some());
    link.finish().unwrap();
    let server = station.server.take().unwrap();
    server.shutdown();
    let summaries = server.join().unwrap();
    let ends: Vec<_> = summaries.iter().map(|summary| summary.end).collect();
    assert_eq!(ends, [EndReason::ConnectionLost, EndReason::Stopped]);
    assert!(summaries[0].gaps > 0);
    let recording = Recording::open(&station.recording(&summaries[0].recording)).unwrap();
    let (_, events) = rows_and_events(&recording);
    assert_eq!(kinds(&events).last(), Some(&"detached"));
}

#[test]
fn stations_of_a_server_have_their_own_sessions_levels_and_recordings() {
    let station = three();
    let mut links: Vec<Link> = ["aa", "bb", "cc"]
        .iter()
        .map(|token| Link::connect(config_of(&station, token)).unwrap())
        .collect();
    let names: Vec<_> = links
        .iter()
        .map(|link| link.hello().station.clone())
        .collect();
    assert_eq!(names, ["a", "b", "c"]);
    assert!(station.server().command_at("b", Command::ForceLimit(0.2)));
    assert!(!station.server().command_at("d", Command::Pause));
    for link in &mut links {
        link.start();
        press(link, |link, _| force_up(link) > 0.15);
    }
    for k in [0, 2] {
        press_on(&mut links[k], |link| force_up(link) > 0.4);
    }
    press_on(&mut links[1], |link| force_up(link) > 0.19);
    assert!(force_up(&mut links[1]) <= 0.2001);
    assert!(station.server().command_at("c", Command::Pause));
    press_on(&mut links[2], |link| force_up(link) == 0.0);
    press_on(&mut links[0], |link| force_up(link) > 0.4);
    until("all sessions", || {
        let mut stations = station.server().status().into_iter();
        stations.all(|station| station.phase == Phase::Running)
    });
    let files: Vec<_> = links
        .into_iter()
        .map(|link| link.finish().unwrap().recording)
        .collect();
    for (name, file) in names.iter().zip(&files) {
        let recording = Recording::open(&station.recording(file)).unwrap();
        assert_eq!(&recording.header().station, name);
        let report = replay(&recording, &ReplayOptions::default(), &mut |_| ()).unwrap();
        assert!(report.identical && report.gradable, "{report:?}");
    }
}

/// A fault of one station must not reach another: its recording stays whole.
#[test]
fn a_panic_in_any_part_of_a_station_leaves_the_others_whole() {
    for fault in [
        Provoked::Simulation,
        Provoked::Recorder,
        Provoked::Connection,
        Provoked::Station,
    ] {
        let station = three();
        let mut sound = Link::connect(config_of(&station, "bb")).unwrap();
        let mut broken = Link::connect(config_of(&station, "aa")).unwrap();
        for link in [&mut sound, &mut broken] {
            link.start();
            press(link, |link, _| force_up(link) > 0.4);
        }
        assert!(station.server().provoke("a", fault));
        let before = tick_of(&mut sound);
        let mut over = false;
        press_on(&mut sound, |sound| {
            broken.send_pose(&pose(0.001));
            // A panic of the connection's task is a lost connection: the session waits, and the client returns.
            // After a panic of the station's task the session is lost. The client returns as after a restart of the
            // server, mostly before a status shows the station free.
            over |= match fault {
                Provoked::Connection => broken.stats().returns > 0,
                Provoked::Station => {
                    broken.stats().returns > 0 || station.server().status()[0].phase == Phase::Free
                }
                _ => !broken.is_open(),
            };
            over && tick_of(sound) > before + 500
        });
        if let (Provoked::Simulation | Provoked::Recorder, Ok(goodbye)) =
            (fault, broken.finish_with_text())
        {
            let expected = match fault {
                Provoked::Simulation => EndReason::Simulation,
                _ => EndReason::Recording,
            };
            assert_eq!(goodbye.summary.end, expected, "{fault:?}");
            assert!(!goodbye.summary.complete);
        }
        let summary = sound.finish().unwrap();
        assert!(
            summary.complete && summary.end == EndReason::Stopped,
            "{fault:?}"
        );
        let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
        let report = replay(&recording, &ReplayOptions::default(), &mut |_| ()).unwrap();
        assert!(report.identical && report.gradable, "{fault:?} {report:?}");
        // The station can be used again.
        until("a free station", || {
            station.server().status()[0].phase == Phase::Free
        });
        let mut again = Link::connect(config_of(&station, "aa")).unwrap();
        again.start();
        press(&mut again, |link, _| link.latest_wrench().is_some());
        assert!(again.finish().unwrap().complete, "{fault:?}");
    }
}

#[test]
fn a_server_that_ends_closes_every_recording_and_says_goodbye_to_every_student() {
    let mut station = three();
    let mut links: Vec<Link> = ["aa", "bb", "cc"]
        .iter()
        .map(|token| Link::connect(config_of(&station, token)).unwrap())
        .collect();
    for link in &mut links {
        link.start();
        press(link, |link, _| link.latest_wrench().is_some());
    }
    // One of them is in a gap.
    drop(links.pop());
    until("the gap", || {
        station.server().status()[2].phase == Phase::Waiting
    });
    let server = station.server.take().unwrap();
    server.shutdown();
    let summaries = server.join().unwrap();
    assert_eq!(summaries.len(), 3);
    for summary in &summaries {
        assert_eq!(summary.end, EndReason::Shutdown);
        let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
        assert!(matches!(recording.ending(), Ending::Finished));
    }
    for link in links {
        assert_eq!(link.finish().unwrap().end, EndReason::Shutdown);
    }
}

/// The default of a server's configuration is a station, and a second program with the same ticket is no return.
#[test]
fn a_second_program_with_the_same_ticket_does_not_take_a_running_session_over() {
    let station = Station::with(|config: &mut ServerConfig| config.token = "one".into());
    let mut link = station.connect().unwrap();
    link.start();
    press(&mut link, |link, _| link.latest_wrench().is_some());
    let error = station.connect().err().unwrap();
    assert!(
        matches!(&error, LinkError::Busy(text) if text.contains("in use")),
        "{error}"
    );
    let epoch = link.hello().epoch;
    let successor = Link::connect(LinkConfig {
        follows: epoch,
        ..station.config()
    });
    let mut successor = successor.unwrap();
    assert!(successor.hello().resumed && successor.hello().epoch != epoch);
    press_on(&mut successor, |link| {
        link.latest_wrench()
            .is_some_and(|w| w.datagram.tools[0].echo.valid)
    });
    assert!(successor.finish().unwrap().complete);
}

/// Rotates the certificate of a server under a session. Returns whether the connection of the session stays.
fn rotate() -> bool {
    let station = three();
    let mut link = Link::connect(config_of(&station, "aa")).unwrap();
    link.start();
    press(&mut link, |link, _| force_up(link) > 0.4);
    let folder = tempfile::tempdir().unwrap();
    let state = StateFolder::open(Some(folder.path())).unwrap();
    let rotated = ServerIdentity::load_or_create(&state, 1_800_000_000).unwrap();
    let (certificate, key) = (rotated.certificate_der(), rotated.key());
    station
        .server()
        .renew(certificate, key.secret_der())
        .unwrap();
    until("the new certificate", || {
        matches!(
            Link::connect(config_of(&station, "bb")),
            Err(LinkError::WrongCertificate { .. })
        )
    });
    let new = LinkConfig {
        pin: Pin::Fingerprint(rotated.fingerprint()),
        ..config_of(&station, "cc")
    };
    assert!(Link::connect(new).is_ok());
    assert!(station.server().renew(certificate, b"no key").is_err());
    // The session of the first connection goes on.
    let before = tick_of(&mut link);
    press_on(&mut link, |link| {
        tick_of(link) > before + 200 || !link.is_open()
    });
    // A lost link cannot return, because its ticket is that of the former certificate.
    if !link.is_open() || link.stats().returns > 0 {
        return false;
    }
    assert!(link.finish().unwrap().complete);
    true
}

#[test]
fn a_rotated_certificate_leaves_open_connections_and_refuses_tickets_of_the_former_one() {
    // A machine that stalls for three seconds loses a connection by itself: another rotation then decides.
    until("a rotation that leaves the connection", rotate);
}
