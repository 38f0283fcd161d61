//! Pause and force limit: levels of the station's side that no client can lift, and levels of the student's own.
#![allow(clippy::unwrap_used)]

use crate::common::{
    Station, epoch_of, force_up, press, press_on, rows_and_events, status_of, tick_of,
};
use sulcus_connection::link::{Link, now_ns};
use sulcus_proto::control::{ButtonEdge, Command};
use sulcus_proto::status;
use sulcus_sessions::{Occurrence, Recording, ReplayOptions, Row, replay};

/// Limit of the station's side, newtons.
const LIMIT: f32 = 0.3;

/// Everything that a client can say in the hope of a stronger force, and twenty button edges.
fn flood(link: &Link) -> u32 {
    for command in [
        Command::Resume,
        Command::ForceLimit(0.0),
        Command::ForceLimit(f32::MAX),
        Command::ForceLimit(f32::NAN),
    ] {
        link.command(command);
    }
    let edge = |k: u8| ButtonEdge {
        tool: k % 2,
        button: k % 16,
        pressed: true,
        device_time_ns: now_ns(),
    };
    (0..20).filter(|k| link.button(edge(*k))).count() as u32
}

fn strongest(row: &Row) -> f32 {
    let forces = row.wrench.iter().flat_map(|wrench| &wrench[..3]);
    forces.fold(0f32, |most, force| most.max(force.abs()))
}

/// A client could resume a session that the instructor had paused, and a ring full of button edges lost his commands; a
/// limit from before the session was thrown away.
#[test]
fn a_flood_of_a_students_requests_lifts_neither_pause_nor_limit() {
    let station = Station::new();
    assert!(station.server().command(Command::Pause));
    assert!(station.server().command(Command::ForceLimit(LIMIT)));
    let mut link = station.connect().unwrap();
    flood(&link);
    link.start();
    // A hand that presses, for at least a thousand points of the grid and ten thousand edges.
    let (mut edges, begin) = (0, now_ns());
    press(&mut link, |link, k| {
        edges += flood(link);
        let packet = link.latest_wrench();
        let force = packet.map_or([0.0; 3], |p| p.datagram.tools[0].wrench.force);
        assert_eq!(force, [0.0; 3], "paused at pose {k}");
        edges > 10_000 && tick_of(link) > 1000
    });
    let rate = f64::from(edges) / ((now_ns() - begin) as f64 * 1e-9);
    println!("{edges} button edges, {rate:.0} a second");
    assert!(station.server().command(Command::Resume));
    let mut felt = 0;
    press_on(&mut link, |link| {
        flood(link);
        assert!(force_up(link) <= LIMIT * 1.0001);
        felt += u32::from(force_up(link) > LIMIT * 0.9);
        felt > 300
    });
    assert!(station.server().command(Command::Pause));
    let mut still = 0;
    press_on(&mut link, |link| {
        flood(link);
        still += u32::from(force_up(link) == 0.0 && status_of(link) & status::PAUSED != 0);
        still > 300
    });
    let summary = link.finish().unwrap();
    assert!(summary.complete);

    let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
    let (rows, events) = rows_and_events(&recording);
    assert!(rows.iter().all(|row| row.input.force_limit_n == LIMIT));
    assert!(rows.iter().all(|row| strongest(row) <= LIMIT));
    let lifted = rows.iter().position(|row| !row.input.paused).unwrap();
    assert!(rows[lifted].tick > 1000, "{}", rows[lifted].tick);
    assert!(rows[..lifted].iter().all(|row| strongest(row) == 0.0));
    let running = rows[lifted..].iter().position(|row| row.input.paused);
    let again = lifted + running.unwrap();
    assert!(rows[again..].iter().all(|row| row.input.paused));
    // The ramp down takes 20 computed ticks.
    let mut still = rows.iter().skip(again + 100);
    assert!(still.all(|row| strongest(row) == 0.0));
    assert_eq!(rows.last().map(strongest), Some(0.0));
    assert!(rows[lifted..again].iter().any(|row| strongest(row) > 0.2));

    let by = |who: &str| {
        let of = move |event: &&Occurrence| event.data["by"] == who;
        let of: Vec<_> = events.iter().filter(of).collect();
        of
    };
    let station_said: Vec<_> = by("station")
        .iter()
        .map(|event| (event.kind.as_str(), event.tick))
        .collect();
    let first = rows[0].tick;
    assert_eq!(
        station_said,
        [
            ("paused", first),
            ("force_limit", first),
            ("resumed", rows[lifted].tick),
            ("paused", rows[again].tick),
        ]
    );
    let student_said = by("student");
    assert!(!student_said.is_empty());
    assert!(student_said.iter().all(|event| event.kind == "force_limit"));
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| ()).unwrap();
    assert!(report.identical && report.gradable, "{report:?}");
}

#[test]
fn a_student_pauses_and_lowers_his_own_session_and_leaves_nothing_to_the_next() {
    let station = Station::new();
    assert!(station.server().command(Command::ForceLimit(LIMIT)));
    let mut link = station.connect().unwrap();
    link.start();
    press(&mut link, |link, _| force_up(link) > 0.25);
    // His own pause, which the station's resume does not lift.
    assert!(link.command(Command::Pause));
    let paused = |link: &mut Link| force_up(link) == 0.0 && status_of(link) & status::PAUSED != 0;
    press_on(&mut link, paused);
    assert!(station.server().command(Command::Resume));
    let resumed = tick_of(&mut link);
    press_on(&mut link, |link| {
        assert_eq!(force_up(link), 0.0);
        tick_of(link) > resumed + 200 && paused(link)
    });
    let before = epoch_of(&mut link);
    assert!(link.command(Command::Resume));
    press_on(&mut link, |link| {
        force_up(link) > 0.25 && epoch_of(link) != before
    });
    // His own limit, lower and never higher than the station's.
    assert!(link.command(Command::ForceLimit(0.1)));
    press_on(&mut link, |link| (0.05..=0.1001).contains(&force_up(link)));
    assert!(link.command(Command::ForceLimit(2.0)));
    press_on(&mut link, |link| force_up(link) > 0.25);
    assert!(force_up(&mut link) <= LIMIT * 1.0001);
    // Left behind: a pause and a low limit.
    assert!(link.command(Command::ForceLimit(0.05)));
    assert!(link.command(Command::Pause));
    press_on(&mut link, paused);
    link.finish().unwrap();

    // Set between two sessions.
    assert!(station.server().command(Command::ForceLimit(0.2)));
    let mut link = station.connect().unwrap();
    link.start();
    press(&mut link, |link, _| force_up(link) > 0.15);
    let summary = link.finish().unwrap();
    let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
    let (rows, _) = rows_and_events(&recording);
    assert!(
        rows.iter()
            .all(|row| !row.input.paused && row.input.force_limit_n == 0.2)
    );
    assert!(rows.iter().all(|row| strongest(row) <= 0.2));
}
