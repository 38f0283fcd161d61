//! `sulcus-relay`: a UDP relay that delays, loses and reorders packets between clients and a server.

use std::net::{SocketAddr, ToSocketAddrs};
use std::process::ExitCode;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use clap::Parser;
use sulcus_program::{say, tell};
use sulcus_relay::{Conditions, ConditionsError, Counts, Network, Relay, Script};

/// Relay of UDP packets that behaves like a poor network.
///
/// Clients connect to the relay instead of the server. The relay delays, loses, repeats and reorders their packets.
/// With the same seed and the same packets it treats them alike. Ctrl-C ends the relay and prints the counts.
#[derive(Parser)]
#[command(name = "sulcus-relay", version)]
struct Args {
    /// Address of the server.
    #[arg(long, value_name = "HOST:PORT")]
    to: String,
    /// Address for clients.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:0")]
    listen: SocketAddr,
    /// Network: lan, wifi-good, campus, wifi-bad, home-dsl, lte or geo. Other options change it.
    #[arg(long, value_name = "NAME")]
    network: Option<Network>,
    /// Mean round trip, milliseconds.
    #[arg(long, value_name = "MS")]
    rtt: Option<f64>,
    /// Largest deviation of a round trip from its mean, milliseconds.
    #[arg(long, value_name = "MS")]
    jitter: Option<f64>,
    /// Packets lost in each direction, percent.
    #[arg(long, value_name = "PERCENT")]
    loss: Option<f64>,
    /// Mean number of packets lost in a row.
    #[arg(long, value_name = "COUNT")]
    burst: Option<f64>,
    /// Packets that arrive twice, percent.
    #[arg(long, value_name = "PERCENT")]
    duplicate: Option<f64>,
    /// Rate of each direction, Mbit/s.
    #[arg(long, value_name = "MBIT")]
    rate: Option<f64>,
    /// Longest wait in the queue before the slowest link, milliseconds.
    #[arg(long, value_name = "MS")]
    queue: Option<f64>,
    /// Packets keep their order.
    #[arg(long)]
    in_order: bool,
    /// Change after a time: `10=lte`, `20=rate:0.8` in Mbit/s, `30=outage:0.5` in seconds, `40=rebind`. Repeatable.
    #[arg(long = "at", value_name = "SECONDS=CHANGE")]
    changes: Vec<String>,
    /// Seed of the random numbers.
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    seed: u64,
}

/// Largest time in an option, milliseconds.
const LONGEST_MS: f64 = 1e6;

impl Args {
    /// Conditions of one direction, from those of the network.
    fn conditions(&self, of_network: Conditions) -> Result<Conditions, String> {
        let time = |option: &str, value: Option<f64>, share: f64, otherwise: Duration| {
            let Some(value) = value else {
                return Ok(otherwise);
            };
            if !(0.0..=LONGEST_MS).contains(&value) {
                return Err(format!("--{option} {value}: expected 0 to 1,000,000 ms"));
            }
            Ok(Duration::from_secs_f64(value * share / 1e3))
        };
        let share = |option: &str, percent: Option<f64>, otherwise: f64| match percent {
            None => Ok(otherwise),
            Some(percent) if (0.0..100.0).contains(&percent) => Ok(percent / 100.0),
            Some(percent) => Err(format!(
                "--{option} {percent}: expected at least 0 and below 100 percent"
            )),
        };
        let mut conditions = of_network;
        conditions.delay = time("rtt", self.rtt, 0.5, conditions.delay)?;
        conditions.jitter = time("jitter", self.jitter, 0.5, conditions.jitter)?;
        conditions.queue = time("queue", self.queue, 1.0, conditions.queue)?;
        conditions.loss = share("loss", self.loss, conditions.loss)?;
        conditions.burst = self.burst.unwrap_or(conditions.burst);
        conditions.duplicate = share("duplicate", self.duplicate, conditions.duplicate)?;
        conditions.rate = self
            .rate
            .map(|mbit| (mbit * 1e6) as u64)
            .or(conditions.rate);
        conditions.reorder &= !self.in_order;
        if conditions.jitter > conditions.delay {
            let (jitter, rtt) = (2 * conditions.jitter, 2 * conditions.delay);
            return Err(format!(
                "--jitter: found {jitter:?}, expected at most the mean round trip of {rtt:?}"
            ));
        }
        let option = |error: ConditionsError| format!("--{error}");
        conditions.check().map_err(option)?;
        Ok(conditions)
    }
}

fn run(args: &Args) -> Result<(), String> {
    let network = args.network;
    let up = args.conditions(network.map_or_else(Conditions::default, Network::up))?;
    let down = args.conditions(network.map_or_else(Conditions::default, Network::down))?;
    let script = Script::read(args.changes.iter().map(String::as_str))
        .map_err(|error| format!("--at: {error}"))?;
    let server = args
        .to
        .to_socket_addrs()
        .map_err(|error| format!("--to {}: {error}", args.to))?
        .next()
        .ok_or_else(|| format!("--to {}: the name has no address", args.to))?;
    let mut relay = Relay::start(args.listen, server, [up, down], args.seed)
        .map_err(|error| format!("--listen {}: {error}", args.listen))?;
    relay.run(script).map_err(|error| error.to_string())?;
    let (ended, end) = channel();
    ctrlc::set_handler(move || {
        let _ = ended.send(());
    })
    .map_err(|error| error.to_string())?;
    say!("relay on {} to {server}", relay.address());
    while end.recv_timeout(Duration::from_secs(10)) == Err(RecvTimeoutError::Timeout) {
        report(&relay);
    }
    report(&relay);
    Ok(())
}

fn report(relay: &Relay) {
    let counts = relay.counts();
    for (direction, counts) in [("up", counts.up), ("down", counts.down)] {
        let Counts {
            arrived,
            duplicated,
            reordered,
            lost,
            overflow,
            cut,
            bytes,
        } = counts;
        say!(
            "{direction:>4}: {arrived} packets arrived ({bytes} bytes), {lost} lost, {overflow} at a full queue, {cut} \
             in an outage, {duplicated} twice, {reordered} out of order"
        );
    }
}

fn main() -> ExitCode {
    sulcus_program::begin();
    match run(&Args::parse()) {
        Ok(()) => sulcus_program::output::settle(ExitCode::SUCCESS),
        Err(error) => {
            tell!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
