//! Arguments of `serve`.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::Args;
use sulcus_sessions::{Mode, ViewersPolicy};

use crate::commands::StateArgs;

/// Long text of the help.
const ABOUT: &str = "\
Run stations until Ctrl-C.

A station serves one student at a time, simulates its scene at 1000 ticks per second unless a plan sets another rate, and
records and signs every session. Without --config the server has one station, whose plan the options give. With --config it
has the stations of a file. A student whose connection is lost returns to the session within --resume-within seconds.

A student needs the address and a ticket: `sulcus-client run --server ADDRESS:PORT --ticket TICKET`. `sulcus-server token`
makes tickets that last; they stay valid over restarts. At each start the server also prints a ticket for its first station
that is valid until its end.";

/// Text after the options of the help.
const NOTES: &str = "\
Examples:
  sulcus-server serve                       one station, clients on this machine only
  sulcus-server serve --listen 0.0.0.0:4433 --exercise bimanual --recordings /srv/recordings
  sulcus-server serve --config class.toml --check
  sulcus-server serve --config class.toml
  sulcus-server serve --listen 0.0.0.0:4433 --scene my-scene.toml       own scene, without a grade
  sulcus-server serve --json | jq -r '.ticket // empty'                 the ticket of this start alone

File of --config:
  listen = \"0.0.0.0:4433\"
  recordings = \"/srv/recordings\"
  viewers = \"on-demand\"
  recordings_quota_gb = 500        # no session begins that would exceed it
  [class]
  name = \"2026 autumn\"
  [defaults]
  exercise = \"probing\"
  [[station]]
  name = \"room3-1\"
  [[station]]
  name = \"room3-2\"
  plan = { mode = \"exam\", time_limit_s = 1800 }
Parts of a plan: exercise, scene, patient_seed, rate_hz, mode, learner, rubric, time_limit_s, resume_within_s, clock_in_gap,
  force_limit_n, tick_at_hand, detail_budget_us. `sulcus-server plan` shows and changes plans of the running server.

Firewall: open the UDP port of --listen for incoming packets. The server opens no connection by itself.
Real-time scheduling: `setcap cap_sys_nice,cap_ipc_lock+ep sulcus-server`, or `ulimit -r 50` and `ulimit -l unlimited`.
  Without these rights the server warns once and misses more ticks under load.
End: Ctrl-C, SIGTERM or a hang-up of the terminal. Running sessions end, and their recordings are signed. The end takes up
  to 32 seconds on a slow disk.
Cache of scenes: $SULCUS_CACHE, else $XDG_CACHE_HOME/sulcus, else ~/.cache/sulcus.
Logs go to standard error. SULCUS_LOG=debug prints more; the default is SULCUS_LOG=info.

Exit codes: 0 every recording is complete, or --check found no problem; 1 a recording is not complete, or --check found a
problem; 2 wrong usage, bad input, a busy port, or an output that cannot be written.";

/// Run the stations of a class: each with one student at a time, every session recorded and signed
#[derive(Clone, Debug, Args)]
#[command(long_about = ABOUT, after_long_help = NOTES)]
pub struct ServeArgs {
    /// File of stations (TOML): address, folder of recordings, plan of each station. Options replace its values
    #[arg(long, value_name = "FILE", conflicts_with_all = ["station", "token"])]
    pub config: Option<PathBuf>,
    /// Check address, rights, disk, state folder, plans and capacity, then exit without serving
    #[arg(long)]
    pub check: bool,
    /// State folder.
    #[command(flatten)]
    pub state: StateArgs,
    /// TCP address for metrics in the text format of Prometheus, without a check of readers. Default: no metrics
    #[arg(long, value_name = "ADDR:PORT")]
    pub metrics: Option<SocketAddr>,
    /// Admit every session, whatever its measured cost. More ticks are then missed by all sessions
    #[arg(long)]
    pub no_admission: bool,
    /// UDP address to listen on, or a name. 127.0.0.1: clients on this machine only. 0.0.0.0 or `[::]`: every address
    /// of this machine. Port 0: any free port
    /// [default: the address of --config, else 127.0.0.1:4433]
    #[arg(long, value_name = "ADDR:PORT")]
    pub listen: Option<String>,
    /// Scene file (TOML) or compiled scene (.scene). Default: the scene of the exercise
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Seed of the generated patient; refused for a scene without a generated patient. Default: the seed of the scene
    /// file
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Ticks per second, 250 to 8000. Default: the rate of the scene file, else 1000
    #[arg(long, value_name = "HZ")]
    pub rate_hz: Option<u16>,
    /// Folder for recordings. A missing folder is created [default: that of --config, else recordings]
    #[arg(long, value_name = "DIR")]
    pub recordings: Option<PathBuf>,
    /// Channels for viewers of the recordings. on-demand: not written; `sulcus-sessions viewers` makes them from the
    /// exact rows [default: that of --config, else recorded]
    #[arg(long, value_enum)]
    pub viewers: Option<ViewersPolicy>,
    /// Secret of the only station's student besides the stored tokens, 1 to 256 bytes. Other users of the machine see
    /// this option, but not the environment variable SULCUS_TOKEN. Default: SULCUS_TOKEN, else a new random token
    #[arg(long, value_name = "T")]
    pub token: Option<String>,
    /// File for the server's certificate (DER), for clients with `--certificate`. Default: not written
    #[arg(long, value_name = "FILE")]
    pub certificate_out: Option<PathBuf>,
    /// Name of the only station: 1 to 64 ASCII letters, digits, `-` and `_` [default: station]
    #[arg(long, value_name = "NAME")]
    pub station: Option<String>,
    /// Opaque learner id for sessions whose client names none, never a name: letters, digits, `-` and `_`, with at
    /// least one digit
    #[arg(long, value_name = "ID", value_parser = sulcus_proto::learner::parse)]
    pub learner: Option<String>,
    /// Purpose of the sessions. The purpose is recorded and signed, and `sulcus-sessions grade` presents the grade by
    /// it
    #[arg(long, value_enum)]
    pub mode: Option<Mode>,
    /// Exercise: bimanual, crown, probing, retraction, an exercise file that ends in .toml, or `free` without a grade.
    /// The recordings hold its definition and rubric. Default: crown; with --scene: free
    #[arg(long, value_name = "NAME")]
    pub exercise: Option<String>,
    /// Rubric file for the recordings; refused with the exercise `free`. Default: the rubric of the exercise
    #[arg(long, value_name = "FILE")]
    pub rubric: Option<PathBuf>,
    /// Largest mean CPU time of a tick, microseconds, 10 to 900. Tissue is simulated at its fine level while ticks take
    /// less; refused with a rubric. Default: always the coarse level
    #[arg(long, value_name = "US", value_parser = clap::value_parser!(u32).range(10..=900))]
    pub detail_budget: Option<u32>,
    /// Largest force of every session, newtons. A client can lower the limit, never raise it. Default and upper bound:
    /// the limit of the scene
    #[arg(long, value_name = "N", value_parser = newtons)]
    pub force_limit: Option<f32>,
    /// Longest session, seconds, 1 to 86400. Default: no limit
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u32).range(1..=86_400))]
    pub max_session: Option<u32>,
    /// Time for a student's return after a lost connection, seconds, 0 to 3600. 0: a lost connection ends the session
    /// [default: 30]
    #[arg(long, value_name = "S", value_parser = clap::value_parser!(u32).range(0..=3600))]
    pub resume_within: Option<u32>,
    /// File of the key that signs recordings, created on first use. The public key beside it ends in .pub; graders of
    /// exams need it. Default: station.key in $SULCUS_STATE_DIR, else in $XDG_STATE_HOME/sulcus, else in
    /// ~/.local/state/sulcus
    #[arg(long, value_name = "FILE")]
    pub key: Option<PathBuf>,
    /// TCP address of the instructor's console (HTTPS, by the server's own certificate). Needs a build with `--features
    /// console`. Default: no console
    #[arg(long, value_name = "ADDR:PORT")]
    pub console: Option<SocketAddr>,
    /// Folder with clients of this release, which the console offers for download. Default: share/sulcus/clients beside
    /// the folder of the program, if there is one
    #[arg(long, value_name = "DIR")]
    pub clients: Option<PathBuf>,
    /// Do not request real-time scheduling and locked memory
    #[arg(long)]
    pub no_realtime: bool,
    /// Print JSON: an object with address and ticket on the first line, an object with all sessions on the last line
    #[arg(long)]
    pub json: bool,
}

fn newtons(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(force) if force.is_finite() && force > 0.0 => Ok(force),
        _ => Err("expected a force in newtons above 0".to_owned()),
    }
}
