//! Arguments of `run`.

use std::path::PathBuf;

use clap::Args;
use sulcus_demo::args::{Ticks, seconds};
use sulcus_operator::Habit;

use super::hand;
use crate::devices::choose::Named;
use crate::devices::settings::Hand;

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
    /// Haptic device and its hand, as `sulcus-client devices` lists it: a serial number, LIBRARY:SERIAL, or a library
    /// with one device, with =left or =right where the hand is not stored yet. Given twice for two hands.
    /// `playback:FILE` plays the hands of a recording. Default: `simulated`, the simulated operator
    #[arg(long, value_name = "NAME[=left|right]")]
    pub device: Vec<Named>,
    /// Hand of the first tool, the probe: right, left. The other device has the second tool, the mirror
    #[arg(long, value_name = "NAME", default_value = "right", value_parser = hand)]
    pub probe_hand: Hand,
    /// Recording whose hands appear as a ghost and can guide the hands of this session. Its scene must be the server's
    #[arg(long, value_name = "FILE")]
    pub ghost: Option<PathBuf>,
    /// Largest force with which the ghost pulls the tip of the tool, newtons, 0 to 0.3
    #[arg(long, value_name = "N", default_value_t = 0.0, requires = "ghost", value_parser = guide)]
    pub guide: f64,
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
    /// Length of the session, seconds, 0.1 to 86400. Default: the simulated operator's own length; a person leaves
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
    /// Code of the learner, six digits from the instructor's list, in place of --learner. The server then gives the
    /// plan of this learner to the station
    #[arg(long, value_name = "CODE", value_parser = code, conflicts_with = "learner")]
    pub code: Option<String>,
    /// End that computes the ticks that the hand feels. Ticks at the hand need the server's scene: the same exercise,
    /// scene file and patient seed as at the server
    #[arg(long, value_enum, default_value_t)]
    pub tick: Ticks,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub json: bool,
}

/// Claim of a typed code for the hello.
fn code(text: &str) -> Result<String, String> {
    let claim = sulcus_proto::learner::claim(text);
    match sulcus_proto::learner::code_of(&claim) {
        Some(_) => Ok(claim),
        None => Err("expected six digits, such as 123456 or \"123 456\"".into()),
    }
}

/// Force of a guide on the command line, newtons.
fn guide(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(n) if (0.0..=0.3).contains(&n) => Ok(n),
        _ => Err(format!("`{text}` is not a force from 0 to 0.3 newtons")),
    }
}
