//! Check of the path to a server: figures, the named network that it is like, and what to expect there.

use sulcus_connection::at_hand::FAR;
use sulcus_connection::link::{LinkConfig, LinkError, PathFigures, measure_path};
use sulcus_devices::doctor::Check;
use sulcus_proto::Ticket;

use crate::join::resolve;

/// Named network with the figures by which a path is compared, and what a session is like there.
struct Like {
    name: &'static str,
    rtt_ms: f64,
    lost_share: f64,
    expect: &'static str,
}

/// Named networks, those of the relay in `tests/relay`.
const NETWORKS: [Like; 7] = [
    Like {
        name: "lan",
        rtt_ms: 0.2,
        lost_share: 0.0,
        expect: "the server computes the ticks, and the force is 1 to 2 ms old",
    },
    Like {
        name: "wifi-good",
        rtt_ms: 3.0,
        lost_share: 0.001,
        expect: "the force of server ticks is about 5 ms old; ticks at the hand feel crisper",
    },
    Like {
        name: "campus",
        rtt_ms: 5.0,
        lost_share: 0.0001,
        expect: "the ticks run at the hand and feel as on a LAN",
    },
    Like {
        name: "wifi-bad",
        rtt_ms: 8.0,
        lost_share: 0.02,
        expect: "the ticks run at the hand and feel as on a LAN; server ticks lose packets, prefer a cable",
    },
    Like {
        name: "home-dsl",
        rtt_ms: 20.0,
        lost_share: 0.001,
        expect: "the ticks run at the hand and feel as on a LAN; server ticks are soft at walls",
    },
    Like {
        name: "lte",
        rtt_ms: 50.0,
        lost_share: 0.002,
        expect: "the ticks run at the hand and feel as on a LAN; server ticks are unusable at walls",
    },
    Like {
        name: "geo",
        rtt_ms: 280.0,
        lost_share: 0.005,
        expect: "the ticks run at the hand and feel as on a LAN; the instructor sees them 0.3 s later",
    },
];

/// Network that a path is like: the nearest in the logarithm of the round trip, and in losses.
fn like(figures: &PathFigures) -> &'static Like {
    let distance = |like: &Like| {
        let trip = (figures.rtt_ms.max(0.1) / like.rtt_ms).ln();
        // A per cent more of losses counts as much as a round trip that is twice as long.
        let lost = (figures.lost_share - like.lost_share) * 100.0 * std::f64::consts::LN_2;
        trip * trip + lost * lost
    };
    let nearest = NETWORKS
        .iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.unwrap_or(&NETWORKS[0])
}

/// Check of the path to `server` with the station's ticket.
pub fn check(server: &str, ticket: Option<&Ticket>) -> Check {
    const NAME: &str = "path server";
    let Some(ticket) = ticket else {
        return Check::fine(
            NAME,
            "not measured: set SULCUS_TICKET to the ticket of this station, which names the server's certificate.",
        );
    };
    let measured = resolve(server)
        .map_err(|error| format!("{error:#}"))
        .and_then(|(first, others)| {
            let config = LinkConfig {
                others,
                ..LinkConfig::new(first, ticket, "")
            };
            measure_path(&config).map_err(|error| advice(&error))
        });
    match measured {
        Ok(figures) => told(NAME, &figures),
        Err(reason) => Check::wrong(NAME, reason),
    }
}

fn advice(error: &LinkError) -> String {
    match error {
        LinkError::Absent { server } => format!(
            "no answer from {server}: start the server, or let the firewalls on the way pass UDP to this port."
        ),
        other => format!("{other}."),
    }
}

fn told(name: &str, figures: &PathFigures) -> Check {
    let PathFigures {
        rtt_ms,
        variation_ms,
        lost_share,
        packets,
    } = figures;
    let like = like(figures);
    let place = if *rtt_ms > FAR.as_secs_f64() * 1e3 {
        "hand"
    } else {
        "server"
    };
    Check::fine(
        name,
        format!(
            "round trip {rtt_ms:.1} ms, variation {variation_ms:.1} ms, {:.1} % of {packets} packets lost: like \
             `{}`. Ticks by choice at the {place}. Expect: {}.",
            lost_share * 100.0,
            like.name,
            like.expect
        ),
    )
}

#[cfg(test)]
mod tests {
    use sulcus_relay::Network;

    use super::*;

    #[test]
    fn the_named_networks_are_those_of_the_relay() {
        for (like, network) in NETWORKS.iter().zip(Network::ALL) {
            let (up, down) = (network.up(), network.down());
            let rtt_ms = (up.delay + down.delay).as_secs_f64() * 1e3;
            assert_eq!(like.name, network.name());
            assert!(
                (like.rtt_ms - rtt_ms).abs() < 1e-9,
                "{network}: {rtt_ms} ms"
            );
            assert_eq!(like.lost_share, up.loss, "{network}");
        }
    }

    #[test]
    fn a_path_is_like_the_network_with_its_figures_also_when_they_are_measured_roughly() {
        for like_this in &NETWORKS {
            for (factor, more) in [(1.0, 0.0), (0.85, 0.002), (1.15, -0.001)] {
                let figures = PathFigures {
                    rtt_ms: like_this.rtt_ms * factor,
                    lost_share: (like_this.lost_share + more).max(0.0),
                    ..PathFigures::default()
                };
                assert_eq!(like(&figures).name, like_this.name, "{figures:?}");
            }
        }
    }

    #[test]
    fn the_message_fits_and_says_where_the_ticks_run() {
        for (rtt_ms, place) in [(0.4, "at the server"), (40.0, "at the hand")] {
            let figures = PathFigures {
                rtt_ms,
                variation_ms: 1234.5,
                lost_share: 0.123,
                packets: 123_456,
            };
            let check = told("path server", &figures);
            assert!(check.ok && check.message.contains(place), "{check:?}");
            assert!(check.message.ends_with('.') && !check.message.contains("..."));
        }
    }
}
