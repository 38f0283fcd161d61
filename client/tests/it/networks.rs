//! Sessions through a relay that behaves like a poor network.
#![allow(clippy::unwrap_used)]

use std::time::{Duration, Instant};

use crate::common::{Station, force_up, press, press_on, until};
use sulcus_connection::link::Link;
use sulcus_proto::SessionSummary;
use sulcus_proto::control::EndReason;
use sulcus_relay::{Conditions, Counts, Network, Relay};
use sulcus_sessions::{Recording, ReplayOptions, replay};

/// Rate of a thin link, bits per second.
const THIN: u32 = 800_000;

/// A link through `relay` with a hand that presses.
fn pressing(station: &Station, relay: &Relay) -> Link {
    let mut config = station.config();
    config.server = relay.address();
    let mut link = Link::connect(config).unwrap();
    link.start();
    press(&mut link, |link, _| force_up(link) > 0.4);
    link
}

/// The recording of an ended session replays identically.
fn is_whole(station: &Station, summary: &SessionSummary) {
    assert_eq!(summary.end, EndReason::Stopped);
    assert!(summary.complete, "{summary:?}");
    let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| ()).unwrap();
    assert!(report.identical && report.gradable, "{report:?}");
}

/// Time in which a hand pressed on, with the packets of one direction before and after.
#[derive(Clone, Copy, Debug)]
struct Window {
    seconds: f64,
    before: Counts,
    after: Counts,
}

impl Window {
    /// Presses on for at least `seconds`. Returns the windows of both directions.
    fn of(link: &mut Link, relay: &Relay, seconds: u64) -> [Self; 2] {
        let (begun, before) = (Instant::now(), relay.counts());
        press_on(link, |_| begun.elapsed() >= Duration::from_secs(seconds));
        let after = relay.counts();
        let seconds = begun.elapsed().as_secs_f64();
        let window = |before, after| Self {
            seconds,
            before,
            after,
        };
        [window(before.up, after.up), window(before.down, after.down)]
    }

    /// Whether the bits on the wire, headers of IP and UDP included, are at most nine tenths of a thin link's rate.
    fn is_below(&self) -> bool {
        let bytes = self.after.bytes_on_the_wire() - self.before.bytes_on_the_wire();
        (bytes * 8) as f64 <= 0.9 * f64::from(THIN) * self.seconds
    }

    /// Packets that arrived, and packets that found the queue full.
    fn fates(&self) -> (u64, u64) {
        (
            self.after.arrived - self.before.arrived,
            self.after.overflow - self.before.overflow,
        )
    }
}

/// At the full rate a session needs more than twice this rate in each direction.
#[test]
fn on_a_thin_link_both_rates_fall_below_it_and_nothing_waits_in_its_queue() {
    let thin = Conditions {
        delay: Duration::from_millis(5),
        rate: Some(u64::from(THIN)),
        queue: Duration::from_millis(200),
        ..Conditions::default()
    };
    let station = Station::new();
    let relay = Relay::to(station.server().local_addr()).unwrap();
    let mut link = pressing(&station, &relay);
    relay.change([thin, thin]).unwrap();
    until("rates below that of the link", || {
        let windows = Window::of(&mut link, &relay, 1);
        windows.iter().all(Window::is_below) && link.stats().rate_divisor >= 4
    });
    let windows = Window::of(&mut link, &relay, 4);
    println!("{windows:#?}");
    is_whole(&station, &link.finish().unwrap());
    for window in &windows {
        assert!(window.is_below(), "{window:?}");
        // A machine that stalls fills the queue once, with the packets of the stall.
        let (arrived, overflow) = window.fates();
        assert!(arrived > 0 && overflow * 10 <= arrived, "{window:?}");
    }
}

#[test]
fn through_poor_networks_a_session_ends_with_a_recording_that_replays() {
    for network in [Network::WifiBad, Network::HomeDsl, Network::Geo] {
        // A machine that stalls for three seconds loses a connection by itself: another session then decides.
        until("a session without a return", || {
            let station = Station::new();
            let relay = Relay::through(network, station.server().local_addr(), 7).unwrap();
            let mut link = pressing(&station, &relay);
            let begun = Instant::now();
            press_on(&mut link, |_| {
                begun.elapsed() >= Duration::from_secs(2) && relay.counts().up.arrived > 100
            });
            let returns = link.stats().returns;
            println!("{network}: {returns} returns");
            is_whole(&station, &link.finish().unwrap());
            returns == 0
        });
    }
}
