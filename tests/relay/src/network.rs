//! Networks by name.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use crate::Conditions;

/// A named network. The figures are assumptions of this project for a typical path of that kind, not measurements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Network {
    /// Cable and switch in one room. Round trip 0.2 ms.
    Lan,
    /// Wi-Fi with little traffic. Round trip 3 ms.
    WifiGood,
    /// Wi-Fi far from the access point, with a scan of 60 ms each five seconds. Round trip 8 ms, 2 % loss in bursts.
    WifiBad,
    /// Cable to another building of the university. Round trip 5 ms.
    Campus,
    /// DSL at home, 2 Mbit/s up. Round trip 20 ms.
    HomeDsl,
    /// Mobile network, with a handover of 150 ms each ten seconds. Round trip 50 ms, no reordering.
    Lte,
    /// Another continent by cable. Round trip 280 ms.
    Geo,
}

impl Network {
    /// All networks, the best one first.
    pub const ALL: [Self; 7] = [
        Self::Lan,
        Self::WifiGood,
        Self::Campus,
        Self::WifiBad,
        Self::HomeDsl,
        Self::Lte,
        Self::Geo,
    ];

    /// Name in arguments and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lan => "lan",
            Self::WifiGood => "wifi-good",
            Self::WifiBad => "wifi-bad",
            Self::Campus => "campus",
            Self::HomeDsl => "home-dsl",
            Self::Lte => "lte",
            Self::Geo => "geo",
        }
    }

    /// Conditions from a client to the server.
    pub fn up(self) -> Conditions {
        let us = Duration::from_micros;
        let ms = Duration::from_millis;
        let mbit = |rate: f64| Some((rate * 1e6) as u64);
        let plain = Conditions::default();
        match self {
            Self::Lan => Conditions {
                delay: us(100),
                jitter: us(30),
                rate: mbit(1000.0),
                ..plain
            },
            Self::WifiGood => Conditions {
                delay: us(1500),
                jitter: ms(1),
                loss: 0.001,
                rate: mbit(100.0),
                ..plain
            },
            Self::WifiBad => Conditions {
                delay: ms(4),
                jitter: ms(3),
                loss: 0.02,
                burst: 3.0,
                duplicate: 0.001,
                rate: mbit(10.0),
                stall: Some((ms(5000), ms(60))),
                ..plain
            },
            Self::Campus => Conditions {
                delay: us(2500),
                jitter: us(300),
                loss: 0.0001,
                rate: mbit(1000.0),
                ..plain
            },
            Self::HomeDsl => Conditions {
                delay: ms(10),
                jitter: ms(1),
                reorder: false,
                loss: 0.001,
                rate: mbit(2.0),
                queue: ms(200),
                ..plain
            },
            Self::Lte => Conditions {
                delay: ms(25),
                jitter: ms(10),
                reorder: false,
                loss: 0.002,
                burst: 2.0,
                rate: mbit(8.0),
                queue: ms(300),
                stall: Some((ms(10_000), ms(150))),
                ..plain
            },
            Self::Geo => Conditions {
                delay: ms(140),
                jitter: ms(3),
                loss: 0.005,
                burst: 2.0,
                rate: mbit(20.0),
                queue: ms(200),
                ..plain
            },
        }
    }

    /// Conditions from the server to a client.
    pub fn down(self) -> Conditions {
        let up = self.up();
        let rate = match self {
            Self::HomeDsl => Some(16_000_000),
            Self::Lte => Some(30_000_000),
            _ => up.rate,
        };
        Conditions { rate, ..up }
    }
}

impl fmt::Display for Network {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that no network has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownNetwork(pub String);

impl fmt::Display for UnknownNetwork {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = Network::ALL.map(Network::name).join(", ");
        write!(f, "unknown network {:?}, expected one of {names}", self.0)
    }
}

impl std::error::Error for UnknownNetwork {}

impl FromStr for Network {
    type Err = UnknownNetwork;

    fn from_str(name: &str) -> Result<Self, UnknownNetwork> {
        let found = Self::ALL.into_iter().find(|network| network.name() == name);
        found.ok_or_else(|| UnknownNetwork(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_network_is_valid_and_found_by_its_name() {
        for network in Network::ALL {
            assert_eq!(network.up().check(), Ok(()), "{network} up");
            assert_eq!(network.down().check(), Ok(()), "{network} down");
            assert_eq!(network.name().parse(), Ok(network));
        }
        let unknown = "moon".parse::<Network>().expect_err("no such network");
        assert!(
            unknown
                .to_string()
                .contains("\"moon\", expected one of lan,")
        );
    }
}
