//! Arguments of the command `demo`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use sulcus_connection::at_hand::TickPlace;
use sulcus_core::optimise::SolverKind;
use sulcus_operator::Habit;
use sulcus_sessions::Mode;

/// Arguments of `demo`.
#[derive(Clone, Debug, Args)]
pub struct DemoArgs {
    /// Run without sockets and without a clock, faster than real time
    #[arg(long = "virtual")]
    pub virtual_time: bool,
    /// Length of the session, seconds, 0.1 to 86400. Default: the simulated operator's own length; a person leaves. A
    /// hard case ignores this option
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub duration: Option<f64>,
    /// Exercise: a name of `--list-exercises`, an exercise file that ends in .toml, or a hard case as `hard/NAME`
    #[arg(long, value_name = "NAME", default_value = "bimanual")]
    pub exercise: String,
    /// List the exercises, then exit
    #[arg(long)]
    pub list_exercises: bool,
    /// Simulate a typical student error: heavy-hand, wrong-angle, skips-sites, impatient, lets-tongue-go,
    /// spot-probes, misreads, stops-short
    #[arg(long, value_name = "NAME")]
    pub habit: Option<Habit>,
    /// Scene file (TOML). Default: the scene of the exercise (a molar, a molar with a pocket, or a whole mouth)
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Random seed of the generated patient, of the hand's tremor and of the habit's errors. Default: the scene's
    /// patient, and 1 for tremor and errors
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Solver of the tick: `active-set`, or the independent `clarabel`, which is slower than real time: use it with
    /// --virtual
    #[arg(long, value_enum, default_value = "active-set")]
    pub solver: SolverArg,
    /// Ticks per second, 250 to 8000. Default: the rate of the scene file, else 1000
    #[arg(long, value_name = "HZ")]
    pub rate_hz: Option<u16>,
    /// Folder for recordings. A missing folder is created
    #[arg(long, value_name = "DIR", default_value = "recordings")]
    pub recordings: PathBuf,
    /// Opaque learner id for the recording, never a name: letters, digits, `-` and `_`, with at least one digit
    #[arg(long, value_name = "ID", default_value = "", value_parser = sulcus_proto::learner::parse)]
    pub learner: String,
    /// Purpose of the session. The purpose is recorded, and `sulcus-sessions grade` presents the grade by it. The demo
    /// prints depths and grade for practice only
    #[arg(long, value_enum, default_value_t)]
    pub mode: Mode,
    /// Draw the findings that cost points into the student's page, at most six. Needs a build of this program with
    /// `--features view`, and one more replay
    #[arg(long)]
    pub pictures: bool,
    /// Put a simulated network between the student and the server: lan, wifi-good, campus, wifi-bad, home-dsl, lte, geo
    #[cfg(feature = "embedded")]
    #[arg(long, value_name = "NAME", conflicts_with = "virtual_time")]
    pub network: Option<sulcus_relay::Network>,
    /// End that computes the ticks that the hand feels
    #[cfg(feature = "embedded")]
    #[arg(long, value_enum, default_value_t = Ticks::Server, conflicts_with = "virtual_time")]
    pub tick: Ticks,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub json: bool,
}

/// End that computes the ticks, on the command line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Ticks {
    /// The hand if the round trip is above 3 ms and nothing is against it, else the server
    #[default]
    Auto,
    /// The server
    Server,
    /// The hand, beside the device, if nothing is against it
    Hand,
}

impl From<Ticks> for TickPlace {
    fn from(ticks: Ticks) -> Self {
        match ticks {
            Ticks::Auto => Self::Auto,
            Ticks::Server => Self::Server,
            Ticks::Hand => Self::Hand,
        }
    }
}

/// Solver names on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum SolverArg {
    /// Dual active-set solver of this project.
    ActiveSet,
    /// Interior-point solver Clarabel.
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

/// Length of a session on the command line, seconds, 0.1 to 86400.
///
/// # Errors
/// The text is no number, or out of range.
pub fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(s) if (0.1..=86_400.0).contains(&s) => Ok(s),
        _ => Err(format!(
            "`{text}` is not a number of seconds from 0.1 to 86400"
        )),
    }
}

impl DemoArgs {
    /// Random seed of the hand's tremor and of the habit's errors.
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
            pictures: false,
            #[cfg(feature = "embedded")]
            network: None,
            #[cfg(feature = "embedded")]
            tick: Ticks::Server,
            json: false,
        }
    }
}
