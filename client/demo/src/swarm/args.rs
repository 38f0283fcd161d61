//! Arguments of the command `swarm`.

use std::path::PathBuf;

use clap::Args;

use crate::args::seconds;

/// Arguments of `swarm`.
#[derive(Clone, Debug, Args)]
pub struct SwarmArgs {
    /// Number of stations, 1 to 64. With several numbers, separated by commas, one run for each
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "4", value_parser = clap::value_parser!(u8).range(1..=64))]
    pub stations: Vec<u8>,
    /// Length of each run, seconds, 0.1 to 86400
    #[arg(long, value_name = "S", default_value = "60", value_parser = seconds)]
    pub duration: f64,
    /// Exercise of every station: a name of `demo --list-exercises`, or an exercise file that ends in .toml
    #[arg(long, value_name = "NAME", default_value = "bimanual")]
    pub exercise: String,
    /// Number of stations, the last ones, whose devices leap at random about a narrow pocket
    #[arg(long, value_name = "N", default_value = "0", conflicts_with_all = ["server", "readme"])]
    pub leaps: usize,
    /// Scene file of every station. Default: the scene of the exercise
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Folder for recordings. A missing folder is created
    #[arg(long, value_name = "DIR", default_value = "recordings")]
    pub recordings: PathBuf,
    /// Address of a running server. Default: a server in this process
    #[arg(long, value_name = "HOST:PORT", requires = "tickets")]
    pub server: Option<String>,
    /// Table of tickets (CSV with the columns `station` and `ticket`), as `sulcus-server token add --class` writes it
    #[arg(long, value_name = "FILE", requires = "server")]
    pub tickets: Option<PathBuf>,
    /// Replay every recording, and count those that are not identical
    #[arg(long, conflicts_with = "server")]
    pub replay: bool,
    /// Write the table of the runs into a document, between its markers `<!-- begin: swarm NAME -->` and
    /// `<!-- end: swarm NAME -->`, with the name of the exercise
    #[arg(long, value_name = "FILE", conflicts_with = "server")]
    pub readme: Option<PathBuf>,
    /// Print one JSON object as the last line of standard output: that of the last run
    #[arg(long)]
    pub json: bool,
}
