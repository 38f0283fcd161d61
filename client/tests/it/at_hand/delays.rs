//! Times on the named networks: from a command to the hand, and from a tick at the hand to the server.

use sulcus_proto::control::Command;
use sulcus_relay::{Network, Relay};

use super::{Hand, is_whole, wishing};
use crate::common::Station;
use sulcus_connection::link::LinkConfig;

/// Number of commands on each network.
const COMMANDS: usize = 60;
/// Share of the times that must be within the bound: other programs may hold a shared machine for a while.
const WITHIN: f64 = 0.5;

/// Times of a session, milliseconds.
#[derive(Debug, Default)]
struct Times {
    /// From a pause or its end at the server to the pass that has it.
    commands: Vec<u64>,
    /// Ticks at the hand that the server has not confirmed, in each pass.
    behind: Vec<u64>,
}

/// Value below which a share of the values lies.
fn share(values: &[u64], share: f64) -> u64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable();
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}

/// Performs a session with commands through a network.
fn session(network: Network) -> Times {
    let station = Station::new();
    let relay = Relay::through(network, station.server().local_addr(), 11).unwrap();
    let mut hand = Hand::at(LinkConfig {
        server: relay.address(),
        ..wishing(&station)
    });
    hand.go(1000, |_| ());
    let mut times = Times::default();
    for k in 0..COMMANDS {
        let pause = k % 2 == 0;
        let command = if pause {
            Command::Pause
        } else {
            Command::Resume
        };
        station.server().command(command);
        let given = hand.passes;
        let mut obeyed = false;
        while !obeyed {
            hand.go(1, |pass| obeyed = pass.levels.paused_by_station == pause);
            times.behind.push(hand.link.stats().ticks_behind);
            assert!(hand.passes < given + 5000, "{network}: command {k}");
        }
        times.commands.push(hand.passes - given);
        // The phase to the packets differs from command to command.
        for _ in 0..40 + k {
            hand.go(1, |_| ());
            times.behind.push(hand.link.stats().ticks_behind);
        }
    }
    let (goodbye, log) = hand.end();
    is_whole(&station, &goodbye, &log);
    times
}

mod long {
    use sulcus_support::long;

    use super::*;

    #[test]
    fn commands_reach_the_hand_and_ticks_the_server_in_time_on_every_named_network() {
        if !long::selected("times-at-the-hand") {
            return;
        }
        for network in Network::ALL {
            let rtt = network.up().delay + network.down().delay;
            let rtt_ms = rtt.as_secs_f64() * 1e3;
            let Times { commands, behind } = session(network);
            println!(
                "{network}: round trip {rtt_ms:.0} ms; command to hand p50 {} p90 {} p99 {} ms; behind p50 {} p90 {} \
                 p99 {} ticks",
                share(&commands, 0.5),
                share(&commands, 0.9),
                share(&commands, 0.99),
                share(&behind, 0.5),
                share(&behind, 0.9),
                share(&behind, 0.99),
            );
            let command_ms = share(&commands, WITHIN) as f64;
            assert!(
                command_ms <= rtt_ms / 2.0 + 30.0,
                "{network}: {command_ms} ms"
            );
            let behind_ms = share(&behind, WITHIN) as f64;
            assert!(
                behind_ms <= 3.0 * rtt_ms + 100.0,
                "{network}: {behind_ms} ms"
            );
        }
    }

    #[test]
    fn an_outage_of_twenty_seconds_is_handed_in() {
        if !long::selected("outage-at-the-hand") {
            return;
        }
        // An attempt to return that began in the outage takes up to three seconds more.
        super::super::outage(20_000);
    }
}
