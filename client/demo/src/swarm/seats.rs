//! Seats of a swarm: stations of a server in this process, or tickets of a running server.

use std::net::ToSocketAddrs;
use std::path::Path;

use anyhow::{Context, bail};
use sulcus_connection::link::LinkConfig;
use sulcus_program::PathText;
use sulcus_proto::Ticket;

use crate::exercise::Prepared;

/// Seats, and the server in this process.
pub(super) struct Seats {
    /// Configuration of each seat's link.
    pub configs: Vec<LinkConfig>,
    #[cfg(feature = "embedded")]
    server: Option<sulcus_server::ServerHandle>,
}

impl Seats {
    /// Stations of a server in this process, one for each hand.
    ///
    /// # Errors
    /// The server does not start.
    #[cfg(feature = "embedded")]
    pub fn embedded(hands: &[Prepared], recordings: &Path) -> anyhow::Result<Self> {
        use std::sync::Arc;

        use sulcus_proto::Role;
        use sulcus_proto::hex::hex;
        use sulcus_server::net::tokens::Fixed;
        use sulcus_server::{Exercise, Server, ServerConfig, SessionPlan, StationConfig};

        let mut stations = Vec::new();
        for (k, hand) in hands.iter().enumerate() {
            let mut plan = SessionPlan::new(hand.scene.clone(), hand.scene_bytes.clone());
            let seed = k as u64 + 1;
            plan.exercise = Exercise {
                name: hand.exercise.name.clone(),
                text: hand.exercise.task.clone(),
                definition: hand.definition(seed)?,
                seed,
            };
            plan.patient.clone_from(&hand.patient);
            plan.rubric = hand.rubric()?;
            let mut station = StationConfig::new(plan);
            station.name = format!("swarm-{:02}", k + 1);
            stations.push(station);
        }
        let first = stations
            .first()
            .context("a swarm has at least one station")?;
        let mut config = ServerConfig::new(first.clone(), recordings.to_owned())?;
        let mut tokens = Fixed::default();
        let mut secrets = Vec::new();
        for station in &stations {
            let mut secret = [0; 32];
            getrandom::fill(&mut secret).map_err(|error| anyhow::anyhow!("{error}"))?;
            let secret = hex(&secret);
            let name = station.name.as_str();
            tokens = tokens.with(&secret, name, Role::Student, Some(name));
            secrets.push(secret);
        }
        config.tokens = Arc::new(tokens);
        config.stations = stations;
        let server = Server::start(config)?;
        let configs = secrets.into_iter().map(|token| {
            let ticket = Ticket {
                token,
                fingerprint: server.ticket().fingerprint,
            };
            LinkConfig::new(server.local_addr(), &ticket, "simulated")
        });
        Ok(Self {
            configs: configs.collect(),
            server: Some(server),
        })
    }

    /// A program without an embedded server has no seats of its own.
    ///
    /// # Errors
    /// Always.
    #[cfg(not(feature = "embedded"))]
    pub fn embedded(_: &[Prepared], _: &Path) -> anyhow::Result<Self> {
        bail!("this program has no server of its own: give --server and --tickets")
    }

    /// The first `stations` tickets of a table, for a running server.
    ///
    /// # Errors
    /// The address or the table cannot be read, or the table has fewer tickets.
    pub fn of_server(server: &str, tickets: &Path, stations: usize) -> anyhow::Result<Self> {
        let address = server
            .to_socket_addrs()
            .with_context(|| format!("--server is `{server}`, expected HOST:PORT"))?
            .next()
            .with_context(|| format!("--server is `{server}`, a name without an address"))?;
        let text = std::fs::read_to_string(tickets)
            .with_context(|| format!("--tickets {}: cannot read", tickets.shown()))?;
        let mut configs = Vec::new();
        for ticket in read(&text).with_context(|| format!("--tickets {}", tickets.shown()))? {
            if configs.len() < stations {
                configs.push(LinkConfig::new(address, &ticket, "simulated"));
            }
        }
        if configs.len() < stations {
            bail!(
                "--tickets {} has {} tickets, expected {stations} or more",
                tickets.shown(),
                configs.len()
            );
        }
        Ok(Self {
            configs,
            #[cfg(feature = "embedded")]
            server: None,
        })
    }

    /// Ends the server in this process.
    ///
    /// # Errors
    /// The server ended with an error.
    pub fn end(self) -> anyhow::Result<()> {
        #[cfg(feature = "embedded")]
        if let Some(server) = self.server {
            server.shutdown();
            server.join()?;
        }
        Ok(())
    }
}

/// Tickets of a table with a heading; the column is `ticket`.
fn read(text: &str) -> anyhow::Result<Vec<Ticket>> {
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let heading = lines.next().context("the table is empty")?;
    let column = heading
        .split(',')
        .position(|name| name.trim().eq_ignore_ascii_case("ticket"))
        .context("the table has no column `ticket`")?;
    let mut tickets = Vec::new();
    for (k, line) in lines.enumerate() {
        let cell = line.split(',').nth(column);
        let cell = cell.with_context(|| format!("line {}: no ticket", k + 2))?;
        let ticket = cell.trim().trim_matches('"').parse::<Ticket>();
        tickets.push(ticket.with_context(|| format!("line {}", k + 2))?);
    }
    Ok(tickets)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tickets_are_read_from_their_column() {
        let ticket = format!("secret.{}", "ab".repeat(32));
        let text = format!("learner,station,Ticket\na1,s1,{ticket}\n\na2,s2,\"{ticket}\"\n");
        assert_eq!(read(&text).expect("read").len(), 2);
        for (bad, told) in [
            ("", "empty"),
            ("learner,station\n", "no column `ticket`"),
            ("a,ticket\nx\n", "line 2"),
            ("ticket\nnone\n", "line 2"),
        ] {
            let error = format!("{:#}", read(bad).expect_err("refused"));
            assert!(error.contains(told), "{error}");
        }
    }
}
