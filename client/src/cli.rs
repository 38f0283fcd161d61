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
  sulcus-client bands --count 20
  sulcus-client lesson
  sulcus-client picture --exercise bimanual --at 20 --view buccal --out picture.png
  sulcus-client picture --recording session.mcap --from 12 --to 15 --fps 25 --out 'frames/%05d.png'

Ctrl-C ends the session with a stop; a second Ctrl-C ends the program at once.
Logs go to standard error. SULCUS_LOG=debug prints more; the default is SULCUS_LOG=warn.

Exit codes: 0 success, 1 a finding (demo: the replay differs or the recording cannot be graded; run: the server was lost or its
recording is not complete), 2 wrong usage or bad input.";

/// Commands of the client.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run one whole session against an embedded server: recorded, replayed, graded
    #[command(after_long_help = EXAMPLES)]
    Demo(WithView<DemoArgs>),
    /// Join a running server
    #[command(after_long_help = EXAMPLES)]
    Run(WithView<RunArgs>),
    /// Run simulated hands on many stations at once, and measure the load of the machine
    #[command(after_long_help = EXAMPLES)]
    Swarm(SwarmArgs),
    /// Draw instants of an exercise or of a recording, or a scene at rest, into PNG files, without a display. Needs a
    /// build with `--features view`
    #[command(after_long_help = EXAMPLES)]
    Picture(PictureArgs),
    /// Lesson in reading the bands of a probe: a window shows a probe in a pocket and asks for the depth. Needs a build
    /// with `--features view`
    #[command(after_long_help = EXAMPLES)]
    Bands(BandsArgs),
    /// First lesson with mouse and keyboard, without an instructor: hold the probe, touch a tooth, read a band, walk
    /// along a margin. The session is recorded. Needs a build with `--features view`
    #[command(after_long_help = EXAMPLES)]
    Lesson(LessonArgs),
}

/// Arguments of `lesson`.
#[derive(Clone, Debug, Args)]
pub struct LessonArgs {
    /// Folder for the recording. A missing folder is created
    #[arg(long, value_name = "DIR", default_value = "recordings")]
    pub recordings: PathBuf,
    /// Quality of the window: full, plain, low, lowest. Default: as for `demo --view`
    #[arg(long, value_name = "NAME")]
    pub quality: Option<String>,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub json: bool,
}

impl LessonArgs {
    /// The same session as a demo with a window and a mouse.
    ///
    /// # Errors
    /// A name of the options does not exist. The tests exclude this.
    pub fn demo(&self) -> Result<WithView<DemoArgs>, clap::Error> {
        let mut arguments: Vec<std::ffi::OsString> = [
            "sulcus-client",
            "demo",
            "--view",
            "--mouse",
            "--close-at-end",
            "--exercise=lesson",
            "--recordings",
        ]
        .map(Into::into)
        .to_vec();
        arguments.push(self.recordings.clone().into());
        arguments.extend(
            self.quality
                .iter()
                .map(|name| format!("--quality={name}").into()),
        );
        arguments.extend(self.json.then(|| "--json".into()));
        match Cli::try_parse_from(arguments)?.command {
            Some(Command::Demo(args)) => Ok(args),
            _ => Err(clap::Error::new(clap::error::ErrorKind::InvalidSubcommand)),
        }
    }
}

/// Arguments of `bands`.
#[derive(Clone, Debug, Args)]
pub struct BandsArgs {
    /// Number of tasks, 1 to 200
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..=200))]
    pub count: u16,
    /// Seed of the tasks
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Rule of rounding to whole millimetres: nearest_half_up, up, down
    #[arg(long, value_name = "NAME", default_value = "nearest_half_up")]
    pub rule: String,
    /// Scene file (TOML) with a probe and gingivae. Default: the built-in mouth
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Write a picture of each task and the file `tasks.json` with the right answers into this folder, instead of
    /// opening a window
    #[arg(long, value_name = "DIR")]
    pub pictures: Option<PathBuf>,
    /// Size of the pictures, pixels
    #[arg(long, value_name = "WxH", default_value = "960x540", value_parser = size, requires = "pictures")]
    pub size: [u32; 2],
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `picture`.
#[derive(Clone, Debug, Args)]
pub struct PictureArgs {
    /// Exercise, performed by the simulated operator in virtual time. Default: `bimanual`, or none with --scene
    #[arg(long, value_name = "NAME")]
    pub exercise: Option<String>,
    /// Scene file (TOML). Without --exercise, the scene is drawn at rest
    #[arg(long, value_name = "FILE")]
    pub scene: Option<PathBuf>,
    /// Recording. The picture shows the replay
    #[arg(long, value_name = "FILE", conflicts_with_all = ["exercise", "scene", "patient_seed"])]
    pub recording: Option<PathBuf>,
    /// Seed of the generated patient. Default: the scene's patient
    #[arg(long, value_name = "N")]
    pub patient_seed: Option<u64>,
    /// Time in the session, seconds, 0 to 3600. May be given several times. Default: 0
    #[arg(long, value_name = "S", value_parser = instant, conflicts_with_all = ["from", "list"])]
    pub at: Vec<f64>,
    /// First time of a sequence of pictures, seconds
    #[arg(long, value_name = "S", value_parser = instant, requires = "to", conflicts_with = "list")]
    pub from: Option<f64>,
    /// Last time of the sequence, seconds
    #[arg(long, value_name = "S", value_parser = instant, requires = "from")]
    pub to: Option<f64>,
    /// Pictures of the sequence for each second, 0.01 to 240. Default: 25
    #[arg(long, value_name = "N", value_parser = fps, requires = "from")]
    pub fps: Option<f64>,
    /// File with a line for each picture: seconds, view, tooth or `-`, file of the picture. One replay serves all
    #[arg(long, value_name = "FILE", conflicts_with_all = ["view", "tooth", "out"])]
    pub list: Option<PathBuf>,
    /// View: overview, front, buccal, lingual, mirror, close-up
    #[arg(long, value_name = "NAME", default_value = "overview")]
    pub view: String,
    /// FDI number of the tooth in the middle of the views buccal and lingual
    #[arg(long, value_name = "FDI")]
    pub tooth: Option<u8>,
    /// Turn of the camera to the right, degrees
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    pub turn: f64,
    /// Tilt of the camera upwards, degrees
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    pub tilt: f64,
    /// Magnification
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    pub zoom: f64,
    /// Hand of the operator's probe: right, left. The views of a left-handed operator are mirrored
    #[arg(long, value_name = "NAME", default_value = "right")]
    pub hand: String,
    /// Turn of the patient's head to the patient's left, degrees, -45 to 45
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0,
        allow_negative_numbers = true
    )]
    pub head_turn: i16,
    /// Tilt of the patient's head with the chin upwards, degrees, -30 to 30
    #[arg(
        long,
        value_name = "DEG",
        default_value_t = 0,
        allow_negative_numbers = true
    )]
    pub head_tilt: i16,
    /// Size of the picture, pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    pub size: [u32; 2],
    /// Quality: full, plain, low, lowest
    #[arg(long, value_name = "NAME", default_value = "full")]
    pub quality: String,
    /// Glass of the mirror: clean, fogged, scratched
    #[arg(long, value_name = "NAME", default_value = "clean")]
    pub glass: String,
    /// Leave out the instruments
    #[arg(long)]
    pub no_tools: bool,
    /// File of the picture. For several pictures the name has a place for their numbers, such as %05d
    #[arg(long, value_name = "FILE.png", required_unless_present = "list")]
    pub out: Option<PathBuf>,
}

/// Time in a session on the command line, seconds.
fn instant(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(s) if (0.0..=3600.0).contains(&s) => Ok(s),
        _ => Err(format!(
            "`{text}` is not a number of seconds from 0 to 3600"
        )),
    }
}

/// Pictures for each second on the command line.
fn fps(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(fps) if (0.01..=240.0).contains(&fps) => Ok(fps),
        _ => Err(format!(
            "`{text}` is not a number of pictures for each second from 0.01 to 240"
        )),
    }
}

/// Size of a picture on the command line.
fn size(text: &str) -> Result<[u32; 2], String> {
    let parsed = text
        .split_once('x')
        .and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    let is_right = |size: &[u32; 2]| size.iter().all(|n| (16..=8192).contains(n));
    parsed.filter(is_right).ok_or_else(|| {
        format!("`{text}` is not a size of 16 to 8192 pixels for each edge, as in 1280x720")
    })
}

/// Arguments of a session that may have a window.
#[derive(Clone, Debug, Args)]
pub struct WithView<A: Args> {
    /// Arguments of the session.
    #[command(flatten)]
    pub session: A,
    /// Arguments of the window.
    #[command(flatten)]
    pub view: ViewArgs,
}

/// Arguments of a window.
#[derive(Clone, Debug, Args)]
pub struct ViewArgs {
    /// Show the session in a window. Needs a build with `--features view`. Keys: F1 to F6 choose the view, a drag
    /// turns, the wheel magnifies, Home resets, F7 hides the panel, F10 closes, Escape pauses, w wipes blood away, F11
    /// is full screen. Shift and an arrow turns or tilts the patient's head. Findings: digits, b, s, r, f, u, Return
    #[arg(long)]
    pub view: bool,
    /// First view of the window: overview, front, buccal, lingual, mirror, close-up
    #[arg(
        long,
        value_name = "NAME",
        default_value = "overview",
        requires = "view"
    )]
    pub camera: String,
    /// Quality of the window: full, plain, low, lowest. Default: by the graphics adapter, and lowered when pictures
    /// take too long
    #[arg(long, value_name = "NAME", requires = "view")]
    pub quality: Option<String>,
    /// Move the tools with mouse and keyboard, or a 3D mouse of spacenavd, instead of the simulated operator. There is
    /// no force. The space bar takes the tool and holds it still again; F10 or closing the window ends the session.
    /// Builds with `--features gamepad` or `hid` take a gamepad, or a 3D mouse without spacenavd
    #[arg(long, requires = "view")]
    pub mouse: bool,
    /// Pedal of the findings: the key that a USB pedal types, such as b, f13 or pagedown; a button as mouse-middle; or,
    /// in a build with `--features gamepad`, a button as pad-start
    #[arg(long, value_name = "KEY", requires = "view")]
    pub pedal: Option<String>,
    /// Use of the pedal. `alone`: short presses count millimetres; one long press confirms, two undo, three say
    /// bleeding, four suppuration. `beside` a keyboard: one press confirms, two say bleeding, three suppuration, a long
    /// press undoes
    #[arg(long, value_name = "NAME", default_value = "alone", requires = "pedal")]
    pub pedal_use: String,
    /// Hand of the probe and of the mouse: right, left. The recording names the hand
    #[arg(long, value_name = "NAME", default_value = "right", requires = "view")]
    pub hand: String,
    /// Finger rest that the student declares: none, tooth, chin. The recording names the rest
    #[arg(long, value_name = "NAME", default_value = "none", requires = "view")]
    pub finger_rest: String,
    /// Glass of the mirror: clean, fogged, scratched
    #[arg(long, value_name = "NAME", default_value = "clean", requires = "view")]
    pub glass: String,
    /// Flip the window left to right, for a screen that is seen in a half mirror
    #[arg(long, requires = "view")]
    pub half_mirror: bool,
    /// Speak the next step of a practice by `espeak-ng` or `spd-say`, whichever is installed
    #[arg(long, requires = "view")]
    pub speak: bool,
    /// Play the sound of contact with teeth and soft tissue by `paplay` or `aplay`, whichever is installed
    #[arg(long, requires = "view")]
    pub sound: bool,
    /// Close the window when the session ends. Otherwise the window stays until Escape or F10: after practice with
    /// score, advice and the worst finding in a loop
    #[arg(long, requires = "view")]
    pub close_at_end: bool,
    /// Print frame age and frame time of the window at the end
    #[arg(long, requires = "view")]
    pub stats: bool,
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
    fn a_lesson_is_a_demo_by_mouse_in_a_window() {
        let parsed = Cli::parse_from(["sulcus-client", "lesson", "--quality", "low", "--json"]);
        let Some(Command::Lesson(lesson)) = parsed.command else {
            panic!("lesson")
        };
        let demo = lesson.demo().expect("arguments of a demo");
        assert!(demo.view.view && demo.view.mouse && demo.session.json);
        assert_eq!(demo.session.exercise, sulcus_demo::lesson::NAME);
        assert_eq!(demo.view.quality.as_deref(), Some("low"));
    }

    #[test]
    fn the_defaults_of_no_command_are_those_of_the_demo() {
        let Some(Command::Demo(parsed)) = Cli::parse_from(["sulcus-client", "demo"]).command else {
            panic!("demo")
        };
        assert_eq!(
            format!("{:?}", parsed.session),
            format!("{:?}", DemoArgs::default())
        );
    }
}
