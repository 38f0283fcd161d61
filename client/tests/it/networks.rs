//! Sessions through a relay that behaves like a poor network.
#![allow(clippy::unwrap_used)]

use std::time::Duration;

use crate::common::{Station, force_up, press, press_on};
use sulcus_connection::link::{Link, now_ns};
use sulcus_proto::SessionSummary;
use sulcus_proto::control::EndReason;
use sulcus_relay::{Conditions, Network, Relay, RelayCounts};
use sulcus_sessions::{Recording, ReplayOptions, replay};

/// A link through `relay` with a hand that presses.
fn pressing(station: &Station, relay: &Relay) -> Link {
    let mut config = station.config();
    config.server = relay.address();
    let mut link = Link::connect(config).unwrap();
    link.start();
    press(&mut link, |link, _| force_up(link) > 0.4);
    link
}

/// Presses on for `seconds`.
fn press_for(link: &mut Link, seconds: u64) {
    let end_ns = now_ns() + seconds * 1_000_000_000;
    press_on(link, |_| now_ns() >= end_ns);
}

/// The recording of an ended session replays identically.
fn is_whole(station: &Station, summary: &SessionSummary) {
    assert_eq!(summary.end, EndReason::Stopped);
    assert!(summary.complete, "{summary:?}");
    let recording = Recording::open(&station.recording(&summary.recording)).unwrap();
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| ()).unwrap();
    assert!(report.identical && report.gradable, "{report:?}");
}

/// Bits on the wire of each direction between two counts, headers of IP and UDP included.
fn bits(before: RelayCounts, after: RelayCounts) -> [u64; 2] {
    [(before.up, after.up), (before.down, after.down)]
        .map(|(before, after)| (after.bytes_on_the_wire() - before.bytes_on_the_wire()) * 8)
}

/// At the full rate a session needs more than twice this rate in each direction.
#[test]
fn on_a_thin_link_both_rates_fall_below_it_and_nothing_waits_in_its_queue() {
    let thin = Conditions {
        delay: Duration::from_millis(5),
        rate: Some(800_000),
        queue: Duration::from_millis(200),
        ..Conditions::default()
    };
    let station = Station::new();
    let relay = Relay::to(station.server().local_addr()).unwrap();
    let mut link = pressing(&station, &relay);
    let begun = relay.counts();
    relay.change([thin, thin]).unwrap();
    press_for(&mut link, 3);
    let settled = relay.counts();
    press_for(&mut link, 4);
    let after = relay.counts();
    let stats = link.stats();
    is_whole(&station, &link.finish().unwrap());
    assert!(stats.rate_divisor >= 4, "{stats:?}");
    assert!(settled.up.arrived > begun.up.arrived);
    let overflow = |counts: RelayCounts| (counts.up.overflow, counts.down.overflow);
    assert_eq!(overflow(after), overflow(settled), "{after:?}");
    // Nine tenths of the limit over four seconds, in each direction.
    for bits in bits(settled, after) {
        assert!(bits <= 800_000 * 4 * 9 / 10, "{bits} bits");
    }
}

#[test]
fn through_poor_networks_a_session_ends_with_a_recording_that_replays() {
    for network in [Network::WifiBad, Network::HomeDsl, Network::Geo] {
        let station = Station::new();
        let relay = Relay::through(network, station.server().local_addr(), 7).unwrap();
        let mut link = pressing(&station, &relay);
        press_for(&mut link, 2);
        let returns = link.stats().returns;
        is_whole(&station, &link.finish().unwrap());
        assert_eq!(returns, 0, "{network}");
        assert!(relay.counts().up.arrived > 100, "{network}");
    }
}
