//! Stiffness of a wall that the hand feels, with ticks at the hand and of the server.

use std::time::Duration;

use sulcus_connection::link::{Link, LinkConfig, now_ns};

use super::{Hand, far_away, is_whole, wishing};
use crate::common::{Station, pose};

/// Depth of a motion of `amplitude_mm` from peak to peak across the wall, a millisecond number after its begin, metres:
/// a triangle of one second about the first contact.
fn depth(ms: u64, amplitude_mm: f64) -> f64 {
    let phase = (ms % 1000) as f64 / 500.0;
    let triangle = if phase < 1.0 { phase } else { 2.0 - phase };
    (triangle - 0.5) * amplitude_mm * 1e-3
}

/// Height of the ball at first contact with the plate, metres.
const WALL: f64 = 0.002;

/// Wall as a hand feels it.
#[derive(Clone, Copy, Debug)]
struct Felt {
    /// Slope of force over depth in the contact, least squares through zero, N/m.
    n_per_m: f64,
    /// Deviation of the force from that slope, root of the mean square, newtons.
    off_n: f64,
}

/// Number of samples in the contact that make a slope.
const SAMPLES: usize = 1200;

/// Number of passes in a row, one in each millisecond, behind which a sample counts. A pass after a stall of the
/// machine compares the force of the depth before the stall with the depth after it.
const IN_A_ROW: u64 = 5;

/// Motion across the wall from `began_ns` on, until there are [`SAMPLES`]. `felt` performs the pass of a millisecond
/// with the ball at a height, metres, and gives the force at the hand. Passes for which the machine is too busy are
/// skipped, as a device skips them.
fn across(amplitude_mm: f64, began_ns: u64, mut felt: impl FnMut(u64, f64) -> f64) -> Felt {
    let mut pairs = Vec::new();
    let (mut next, mut in_a_row) = (0, 0);
    while pairs.len() < SAMPLES {
        assert!(next < 90_000, "{} samples in 90 s", pairs.len());
        let ms = next.max(now_ns().saturating_sub(began_ns) / 1_000_000);
        in_a_row = if ms == next { in_a_row + 1 } else { 0 };
        next = ms + 1;
        let depth = depth(ms, amplitude_mm);
        let force = felt(ms, WALL - depth);
        // The first second brings the tool from its park to the wall.
        if ms >= 1000 && in_a_row > IN_A_ROW && depth > 0.1 * amplitude_mm * 1e-3 {
            pairs.push((depth, force));
        }
    }
    let sum = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
    let n_per_m = sum(|(depth, force)| depth * force) / sum(|(depth, _)| depth * depth);
    let squares = pairs
        .iter()
        .map(|(depth, force)| (force - n_per_m * depth).powi(2));
    let off_n = (squares.sum::<f64>() / pairs.len() as f64).sqrt();
    Felt { n_per_m, off_n }
}

/// Wall with ticks at the hand over a path with a round trip.
fn at_hand(rtt: Duration, amplitude_mm: f64) -> Felt {
    let station = Station::new();
    let relay = far_away(&station, rtt);
    let mut hand = Hand::at(LinkConfig {
        server: relay.address(),
        ..wishing(&station)
    });
    let felt = across(amplitude_mm, hand.began_ns, |ms, height| {
        // The device displays the wrench of the tick before.
        let newest = hand.ticker.newest(None, now_ns());
        let force = newest.map_or(0.0, |packet| packet.datagram.tools[0].wrench.force[2]);
        hand.step(ms, height);
        f64::from(force)
    });
    let (goodbye, log) = hand.end();
    is_whole(&station, &goodbye, &log);
    felt
}

/// Wall with ticks of the server over a path with a round trip.
fn at_server(rtt: Duration, amplitude_mm: f64) -> Felt {
    let station = Station::new();
    let relay = far_away(&station, rtt);
    let mut link = Link::connect(LinkConfig {
        server: relay.address(),
        ..station.config()
    })
    .unwrap();
    link.start();
    let began = now_ns();
    let felt = across(amplitude_mm, began, |ms, height| {
        sulcus_link::clock::sleep_until(began + ms * 1_000_000);
        let force = crate::common::force_up(&mut link);
        link.send_pose(&pose(height));
        f64::from(force)
    });
    link.finish().unwrap();
    felt
}

#[test]
fn a_wall_is_as_stiff_at_a_round_trip_of_forty_milliseconds_as_without_one() {
    let far = Duration::from_millis(40);
    for amplitude_mm in [0.5, 2.0, 5.0] {
        let near = at_hand(Duration::ZERO, amplitude_mm);
        let away = at_hand(far, amplitude_mm);
        let server = at_server(far, amplitude_mm);
        println!(
            "{amplitude_mm} mm: near {near:?}, at 40 ms {away:?}, ticks of the server at 40 ms {server:?}"
        );
        let off = (away.n_per_m - near.n_per_m).abs();
        assert!(off <= 0.01 * near.n_per_m, "{near:?} and {away:?}");
        assert!(near.n_per_m > 300.0, "{near:?}");
        // The force of server ticks is that of the depth 40 ms ago: too soft on the way in, too stiff on the way out.
        assert!(server.off_n > 2.0 * away.off_n, "{server:?}, {away:?}");
    }
}
