//! The command line of `sulcus-client`.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use sulcus_demo::args::{DemoArgs, seconds};
use sulcus_demo::swarm::args::SwarmArgs;
use sulcus_operator::Habit;

/// Client of the Sulcus simulator for periodontal training with force feedback.
///
/// Without a command the client runs the demo, which lasts about a minute. The demo starts a server on the loopback
/// interface. A simulated operator holds the tongue aside with a mirror and probes two molars. The session is recorded,
/// replayed as a check, and graded.
#[derive(Debug, Parser)]
#[command(name = "sulcus-client", version, after_long_help = EXAMPLES)]
pub struct Cli {
    /// Command. Default: `demo`
    #[command(subcommand)]
    pub command: Option<Command>,
}

const EXAMPLES: &str = "\
Examples:
  sulcus-client                                   the demo: both hands in a whole mouth, a minute, recorded, replayed, graded
  sulcus-client demo --virtual --duration 60      the same in virtual time, as fast as it goes
  sulcus-client demo --exercise crown --json      the probe round one molar's crown
  sulcus-client demo --exercise probing           one tooth's pocket, in real time
  sulcus-client demo --virtual --exercise retraction --json
  sulcus-client demo --virtual --exercise hard/wedge
  sulcus-client run --server 192.0.2.7:4433 --ticket TOKEN.FINGERPRINT --exercise bimanual
  sulcus-client run --server 192.0.2.7:4433 --ticket TOKEN.FINGERPRINT --exercise probing --readings
  sulcus-client swarm --stations 8 --duration 60 --replay

Ctrl-C ends the session with a stop; a second Ctrl-C ends the program at once.
Logs go to standard error. SULCUS_LOG=debug prints more; the default is SULCUS_LOG=warn.

Exit codes: 0 success, 1 a finding (demo: the replay differs or the recording cannot be graded; run: the server was lost or its
recording is not complete), 2 wrong usage or bad input.";

/// Commands of the client.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run one whole session against an embedded server: recorded, replayed, graded
    #[command(after_long_help = EXAMPLES)]
    Demo(DemoArgs),
    /// Join a running server
    #[command(after_long_help = EXAMPLES)]
    Run(RunArgs),
    /// Run simulated hands on many stations at once, and measure the load of the machine
    #[command(after_long_help = EXAMPLES)]
    Swarm(SwarmArgs),
}

/// Arguments of `run`.
#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    /// Address of the server. All addresses of a name are tried in turn
    #[arg(long, value_name = "HOST:PORT")]
    pub server: String,
    /// Ticket that the server prints: token and certificate in one line. The environment variable SULCUS_TICKET hides
    /// the ticket from other users of the machine
    #[arg(long, value_name = "LINE", conflicts_with_all = ["token", "certificate"])]
    pub ticket: Option<String>,
    /// Token of the server; needs --certificate
    #[arg(long, value_name = "T", requires = "certificate")]
    pub token: Option<String>,
    /// Certificate of the server (DER), written by `sulcus-server serve --certificate-out`
    #[arg(long, value_name = "FILE", requires = "token")]
    pub certificate: Option<PathBuf>,
    /// Haptic device. The only device is `simulated`
    #[arg(long, value_name = "NAME", default_value = "simulated")]
    pub device: String,
    /// Exercise of the simulated operator: a name, or an exercise file that ends in .toml. A server with another
    /// exercise refuses the client; a server with the exercise `free` accepts any
    #[arg(long, value_name = "NAME", default_value = "crown")]
    pub exercise: String,
    /// Simulate a typical student error: heavy-hand, wrong-angle, skips-sites, impatient, lets-tongue-go,
    /// spot-probes, misreads, stops-short
    #[arg(long, value_name = "NAME")]
    pub habit: Option<Habit>,
    /// Scene file for the simulated operator; must be the server's scene. Default: the scene of the exercise
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Seed of the generated patient; must be the server's seed
    #[arg(long, value_name = "N")]
    pub patient_seed: Option<u64>,
    /// Ticks per second of the server, 250 to 8000. Default: the rate of the scene file, else 1000
    #[arg(long, value_name = "HZ")]
    pub rate_hz: Option<u16>,
    /// Length of the session, seconds, 0.1 to 86400. Default: the length of the exercise
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub duration: Option<f64>,
    /// Read called findings from standard input, a line each: tooth, site and depth in mm, then optional recession in
    /// mm (negative above the cemento-enamel junction), bleeding (b or nb) and furcation (f0 to f3). Example: `36 mb
    /// 5 -2 b`. The simulated operator then calls nothing. The session ends when the operator has finished and the
    /// input has ended, at the latest at the session's largest length
    #[arg(long)]
    pub readings: bool,
    /// Random seed of the simulated operator: of its tremor and of its habit's errors
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Opaque learner id for the recording, never a name: letters, digits, `-` and `_`, with at least one digit
    #[arg(long, value_name = "ID", default_value = "", value_parser = sulcus_proto::learner::parse)]
    pub learner: String,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub json: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn the_defaults_of_no_command_are_those_of_the_demo() {
        let Some(Command::Demo(parsed)) = Cli::parse_from(["sulcus-client", "demo"]).command else {
            panic!("demo")
        };
        assert_eq!(format!("{parsed:?}"), format!("{:?}", DemoArgs::default()));
    }
}
