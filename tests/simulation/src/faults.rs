//! Schedule of a session by seed: commands of both sides, and faults of network, machines and disk.

use fastrand::Rng;
use sulcus_proto::control::Command;
use sulcus_relay::Network;

use crate::seen::Side;

/// Millisecond, nanoseconds.
pub const MS: u64 = 1_000_000;

/// Mean time between two happenings, milliseconds.
const MEAN_MS: u64 = 700;
/// Time before the first happening, milliseconds: the hands arrive.
const QUIET_MS: u64 = 500;

/// Part that stands still for a while.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Thread of the ticks.
    Ticks,
    /// Recorder, as behind a slow disk.
    Recorder,
    /// Network of the server's machine: arrivals wait, and nothing is sent.
    ServerNetwork,
    /// Loop of the device.
    Device,
}

/// Command or fault.
#[derive(Clone, Debug, PartialEq)]
pub enum Happening {
    /// Command of a side.
    Order(Side, Command),
    /// Other conditions on both directions.
    Network(Network),
    /// Cut of both directions, nanoseconds. The ends notice a cut that lasts.
    Cut(u64),
    /// Cut of one direction, nanoseconds; `true`: from the client to the server.
    HalfCut(bool, u64),
    /// New connection that replaces a sound one.
    Replace,
    /// Stop of a part, nanoseconds.
    Stall(Part, u64),
    /// Datagrams at the server that do not decode.
    Garbage(u32),
    /// Repetition of a former datagram of the client, as a stranger may send it.
    Repeat(u32),
    /// Press of a button: tool and button.
    Press(u8, u8),
    /// End of a cut of a direction: 0 to the server, 1 to the client. A run adds it.
    Uncut(usize),
}

/// Happenings with their times, nanoseconds from the begin, ascending.
pub type Schedule = Vec<(u64, Happening)>;

/// Returns the schedule of a session of `length_ns`.
pub fn schedule(rng: &mut Rng, length_ns: u64) -> Schedule {
    let mut schedule = vec![(0, Happening::Network(network(rng)))];
    let mut at_ns = QUIET_MS * MS;
    loop {
        // Some happenings come close together.
        let pause_ms = if rng.u8(0..5) == 0 {
            rng.u64(0..20)
        } else {
            rng.u64(50..2 * MEAN_MS)
        };
        at_ns += pause_ms * MS + rng.u64(0..MS);
        if at_ns >= length_ns {
            return schedule;
        }
        schedule.push((at_ns, happening(rng)));
    }
}

fn network(rng: &mut Rng) -> Network {
    Network::ALL[rng.usize(0..Network::ALL.len())]
}

fn side(rng: &mut Rng) -> Side {
    [Side::Station, Side::Student][rng.usize(0..2)]
}

fn happening(rng: &mut Rng) -> Happening {
    match rng.u8(0..20) {
        0 | 1 => Happening::Order(side(rng), Command::Pause),
        2..=4 => Happening::Order(side(rng), Command::Resume),
        5 => Happening::Order(side(rng), Command::ForceLimit(limit(rng))),
        6 => Happening::Network(network(rng)),
        7 => Happening::Cut(rng.u64(1..60) * MS),
        8 => Happening::Cut(rng.u64(60..6000) * MS),
        9 => Happening::HalfCut(rng.bool(), rng.u64(5..800) * MS),
        10 | 11 => Happening::Replace,
        12 => Happening::Stall(Part::Ticks, rng.u64(1..400) * MS),
        13 => Happening::Stall(Part::Recorder, rng.u64(10..6000) * MS),
        14 => Happening::Stall(Part::ServerNetwork, rng.u64(1..300) * MS),
        15 | 16 => Happening::Stall(Part::Device, rng.u64(1..120) * MS),
        17 => Happening::Garbage(rng.u32(1..50)),
        18 => Happening::Repeat(rng.u32(1..20)),
        _ => Happening::Press(rng.u8(0..3), rng.u8(0..20)),
    }
}

/// Force limit, newtons: valid ones, none, and numbers that are no limit.
fn limit(rng: &mut Rng) -> f32 {
    match rng.u8(0..8) {
        0 | 1 => 0.0,
        2 => [-1.0, f32::NAN, f32::INFINITY][rng.usize(0..3)],
        _ => 0.1 + 2.4 * rng.f32(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_schedule_follows_from_its_seed_alone_and_is_in_the_order_of_time() {
        let of = |seed| format!("{:?}", schedule(&mut Rng::with_seed(seed), 30_000 * MS));
        assert_eq!(of(7), of(7));
        assert_ne!(of(7), of(8));
        let schedule = schedule(&mut Rng::with_seed(7), 30_000 * MS);
        assert!(schedule.len() > 20, "{}", schedule.len());
        assert!(schedule.is_sorted_by_key(|(at_ns, _)| *at_ns));
    }
}
