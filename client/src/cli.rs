//! The command line of `sulcus-client`.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use sulcus_core::optimise::SolverKind;
use sulcus_operator::Habit;
use sulcus_sessions::Mode;

/// Periodontal training with touch: the student's side.
///
/// Without a command it runs the demo: an embedded server on loopback, a simulated operator who holds the tongue
/// aside with a mirror and probes two molars of a whole mouth over real QUIC, in about a minute, the session recorded to
/// MCAP and replayed as a check.
#[derive(Debug, Parser)]
#[command(name = "sulcus-client", version, after_long_help = EXAMPLES)]
pub struct Cli {
    /// What to do; the demo when omitted.
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

Exit codes: 0 success, 1 a finding (demo: the replay differs or the recording cannot be graded; run: the server was lost or its
recording is not complete), 2 wrong usage or bad input.";

/// Commands of the client.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run one whole recorded session against an embedded server
    #[command(after_long_help = EXAMPLES)]
    Demo(DemoArgs),
    /// Join a server that is already running
    #[command(after_long_help = EXAMPLES)]
    Run(RunArgs),
}

/// Arguments of `demo`.
#[derive(Clone, Debug, Args)]
pub struct DemoArgs {
    /// Lock-step without sockets or clock, faster than real time
    #[arg(long = "virtual")]
    pub virtual_time: bool,
    /// Length of the session in seconds; the exercise's own when omitted (a hard case has its own always)
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub duration: Option<f64>,
    /// What to perform: an exercise by name (`--list-exercises`), a file of one (ending in .toml), or a hard case as
    /// `hard/NAME`
    #[arg(long, value_name = "NAME", default_value = "bimanual")]
    pub exercise: String,
    /// List the exercises and stop
    #[arg(long)]
    pub list_exercises: bool,
    /// Performs it badly: heavy-hand, wrong-angle, skips-sites, impatient, lets-tongue-go, spot-probes, misreads, stops-short
    #[arg(long, value_name = "NAME")]
    pub habit: Option<Habit>,
    /// Scene file (TOML); when omitted the exercise's own: a molar, a molar with a pocket, or a whole mouth
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Seed of chance: a generated patient (when omitted the scene's own) and the hand's tremor (when omitted 1)
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Solver in the tick: `active-set`, or the judge `clarabel` (slow: with --virtual)
    #[arg(long, value_enum, default_value = "active-set")]
    pub solver: SolverArg,
    /// Ticks a second, 250 to 8000; the scene's own when omitted (1000 unless its file says so)
    #[arg(long, value_name = "HZ")]
    pub rate_hz: Option<u16>,
    /// Folder for recordings; created when missing
    #[arg(long, value_name = "DIR", default_value = "recordings")]
    pub recordings: PathBuf,
    /// Opaque learner id for the recording, never a name: letters, digits, - and _, one digit at least
    #[arg(long, value_name = "ID", default_value = "", value_parser = sulcus_proto::learner::parse)]
    pub learner: String,
    /// What the session is for: it goes into the recording, and `sulcus-sessions grade` shows the grade accordingly; the demo
    /// itself shows depths and grade after practice only
    #[arg(long, value_enum, default_value_t)]
    pub mode: Mode,
    /// Print one JSON object on the last line of standard output
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `run`.
#[derive(Clone, Debug, Args)]
pub struct RunArgs {
    /// Address of the server; of a name with several addresses, each is tried
    #[arg(long, value_name = "HOST:PORT")]
    pub server: String,
    /// The server's ticket, one line as it prints it: token and certificate together; also from the
    /// environment as SULCUS_TICKET, where other users of the machine cannot see it
    #[arg(long, value_name = "LINE", conflicts_with_all = ["token", "certificate"])]
    pub ticket: Option<String>,
    /// The server's token, with --certificate
    #[arg(long, value_name = "T", requires = "certificate")]
    pub token: Option<String>,
    /// The server's certificate (DER), as `sulcus-server serve --certificate-out` writes it
    #[arg(long, value_name = "FILE", requires = "token")]
    pub certificate: Option<PathBuf>,
    /// Device: only `simulated` so far
    #[arg(long, value_name = "NAME", default_value = "simulated")]
    pub device: String,
    /// What the simulated operator performs: an exercise by name, or a file of one (ending in .toml); a station that offers
    /// another refuses, one that offers `free` does not
    #[arg(long, value_name = "NAME", default_value = "crown")]
    pub exercise: String,
    /// Performs it badly: heavy-hand, wrong-angle, skips-sites, impatient, lets-tongue-go, spot-probes, misreads, stops-short
    #[arg(long, value_name = "NAME")]
    pub habit: Option<Habit>,
    /// Scene that the simulated operator knows, when it is not the exercise's own; must be the server's
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Seed of the generated patient, where the server was given one; must be the same
    #[arg(long, value_name = "N")]
    pub patient_seed: Option<u64>,
    /// The server's ticks a second, 250 to 8000; the scene's own when omitted (1000 unless its file says so)
    #[arg(long, value_name = "HZ")]
    pub rate_hz: Option<u16>,
    /// Length of the session in seconds; the exercise's own when omitted
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub duration: Option<f64>,
    /// Read what is called from standard input, a line each while the hands work: tooth, site and depth, then what else was
    /// called of recession (mm, negative above the cemento-enamel junction), bleeding (b or nb) and furcation (f0 to f3), such
    /// as `36 mb 5 -2 b`. The simulated operator then calls nothing, and the session lasts until it is done and the input ends
    #[arg(long)]
    pub readings: bool,
    /// Seed of the simulated operator's tremor
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Opaque learner id for the recording, never a name: letters, digits, - and _, one digit at least
    #[arg(long, value_name = "ID", default_value = "", value_parser = sulcus_proto::learner::parse)]
    pub learner: String,
    /// Print one JSON object on the last line of standard output
    #[arg(long)]
    pub json: bool,
}

/// Solver names on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum SolverArg {
    /// Own dual active set.
    ActiveSet,
    /// Clarabel's interior point.
    Clarabel,
}

impl From<SolverArg> for SolverKind {
    fn from(arg: SolverArg) -> Self {
        match arg {
            SolverArg::ActiveSet => SolverKind::ActiveSet,
            SolverArg::Clarabel => SolverKind::Clarabel,
        }
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(s) if (0.1..=86_400.0).contains(&s) => Ok(s),
        _ => Err(format!(
            "`{text}` is not a number of seconds from 0.1 to 86400"
        )),
    }
}

impl DemoArgs {
    /// Seed of the hand's tremor, and of the habit's mistakes.
    pub fn hand_seed(&self) -> u64 {
        self.seed.unwrap_or(1)
    }
}

impl Default for DemoArgs {
    fn default() -> Self {
        Self {
            virtual_time: false,
            duration: None,
            exercise: "bimanual".into(),
            list_exercises: false,
            habit: None,
            scene: None,
            seed: None,
            solver: SolverArg::ActiveSet,
            rate_hz: None,
            recordings: "recordings".into(),
            learner: String::new(),
            mode: Mode::default(),
            json: false,
        }
    }
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
