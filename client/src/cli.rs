//! The command line of `sulcus-client`.

mod run;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use sulcus_demo::args::DemoArgs;
use sulcus_demo::swarm::args::SwarmArgs;

use crate::devices::choose::Named;
use crate::devices::settings::Hand;

pub use run::RunArgs;

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
  sulcus-client monitor --server 192.0.2.7:4433 --ticket TOKEN.FINGERPRINT
  sulcus-client bands --count 20
  sulcus-client lesson
  sulcus-client devices
  sulcus-client doctor --server 192.0.2.7:4433
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
    /// Show all stations of a server to an instructor in a terminal, and take instructions: pause, limit, note, end
    #[command(after_long_help = MONITOR_NOTES)]
    Monitor(MonitorArgs),
    /// Draw instants of an exercise or of a recording, or a scene at rest, into PNG files, without a display. Needs a
    /// build with `--features view`
    #[command(after_long_help = EXAMPLES)]
    Picture(PictureArgs),
    /// Lesson in reading the bands of a probe: a window shows a probe in a pocket and asks for the depth. Needs a build
    /// with `--features view`
    #[command(after_long_help = EXAMPLES)]
    Bands(BandsArgs),
    /// List the haptic devices of this station and what each can do, or measure one
    #[command(after_long_help = DEVICE_EXAMPLES)]
    Devices(DevicesArgs),
    /// Check this station: device libraries, permissions, ports, clock, real-time right, disk
    #[command(after_long_help = DEVICE_EXAMPLES)]
    Doctor(DoctorArgs),
    /// First lesson with mouse and keyboard, without an instructor: hold the probe, touch a tooth, read a band, walk
    /// along a margin. The session is recorded. Needs a build with `--features view`
    #[command(after_long_help = EXAMPLES)]
    Lesson(LessonArgs),
}

const MONITOR_NOTES: &str = "\
Lines on standard input, S is the name of a station:
  pause S            forces ramp to zero and stay zero
  resume S           forces ramp up again
  limit S NEWTONS    largest force; 0: the limit of the scene
  note S TEXT        a note in the recording
  flag S [TEXT]      a mark of this moment in the recording
  say S TEXT         a message on the student's screen
  end S              the session ends, and its recording is signed
  quit
Each instruction is answered with the first tick that obeys it. The recording holds the instruction with the id of the token.

Examples:
  sulcus-server token add --role instructor
  sulcus-client monitor --server 192.0.2.7:4433 --ticket TOKEN.FINGERPRINT
  sulcus-client monitor --server 192.0.2.7:4433 --ticket TOKEN.FINGERPRINT --once
  printf 'pause room3-1\\nquit\\n' | sulcus-client monitor --server 192.0.2.7:4433 --ticket TOKEN.FINGERPRINT --json

Exit codes: 0 Ctrl-C, quit, or the table of --once; 1 the server was lost; 2 wrong usage or bad input.";

/// Arguments of `monitor`.
#[derive(Clone, Debug, Args)]
pub struct MonitorArgs {
    /// Address of the server
    #[arg(long, value_name = "HOST:PORT")]
    pub server: String,
    /// Ticket of an instructor, an examiner or an admin. Other users of the machine see this option, but not the
    /// environment variable SULCUS_TICKET. Default: SULCUS_TICKET
    #[arg(long, value_name = "T")]
    pub ticket: Option<String>,
    /// Print the table once, then exit
    #[arg(long)]
    pub once: bool,
    /// Print one JSON object a line: `status` with `alerts`, `event`, `answer`, `error`
    #[arg(long)]
    pub json: bool,
}

const DEVICE_EXAMPLES: &str = "\
Examples:
  sulcus-client devices                            every back-end, its devices, and what is missing
  sulcus-client devices --json
  sulcus-client devices hands                      asks for a button of the left device, and stores both hands
  sulcus-client devices measure haply:049D --out model.toml
  sulcus-client devices handle haply:049D --name UNC-15 --out handle.toml
  sulcus-client doctor
  sulcus-client run --server 192.0.2.7:4433 --device haply:049D=right --device haply:04A1=left --exercise bimanual

Environment: SULCUS_HAPLY is the address of the Haply service, SULCUS_HD_LIBRARY the library of OpenHaptics, and
SULCUS_DHD_LIBRARY the library of Force Dimension, where they are in other places.";

/// Arguments of `devices`.
#[derive(Clone, Debug, Args)]
pub struct DevicesArgs {
    /// Command. Default: the list
    #[command(subcommand)]
    pub command: Option<DevicesCommand>,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub json: bool,
}

impl DevicesArgs {
    /// Whether a command below `devices` prints JSON.
    pub fn is_measuring_json(&self) -> bool {
        matches!(&self.command, Some(DevicesCommand::Measure(args)) if args.json)
    }
}

/// Commands of `devices`.
#[derive(Clone, Debug, Subcommand)]
pub enum DevicesCommand {
    /// Measure friction, delay, rate, smallest step, mass, largest stable stiffness and force of a device, and write
    /// its model file. The device pushes the hand with at most 1 N, and with up to 2 N on a scale
    Measure(MeasureArgs),
    /// Find the hands of two devices: asks for a button of the left one, and stores both
    Hands,
    /// Find the tip of the instrument that is fixed to a device: asks for four touches of one point
    Handle(HandleArgs),
}

/// Arguments of `devices measure`.
#[derive(Clone, Debug, Args)]
pub struct MeasureArgs {
    /// Device, as the list names it
    #[arg(value_name = "DEVICE")]
    pub device: Named,
    /// File for the measured model
    #[arg(long, value_name = "MODEL.toml")]
    pub out: PathBuf,
    /// Leave out the force on a scale
    #[arg(long)]
    pub no_scale: bool,
    /// Use the model file in later sessions of this station
    #[arg(long)]
    pub store: bool,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `devices handle`.
#[derive(Clone, Debug, Args)]
pub struct HandleArgs {
    /// Device, as the list names it
    #[arg(value_name = "DEVICE")]
    pub device: Named,
    /// Name of the instrument
    #[arg(long, value_name = "NAME", default_value = "probe")]
    pub name: String,
    /// Number of touches, 4 to 20
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u8).range(4..=20))]
    pub touches: u8,
    /// File for the handle
    #[arg(long, value_name = "HANDLE.toml")]
    pub out: PathBuf,
    /// Use the handle file in later sessions of this station
    #[arg(long)]
    pub store: bool,
}

/// Arguments of `doctor`.
#[derive(Clone, Debug, Args)]
pub struct DoctorArgs {
    /// Folder of recordings whose disk is checked
    #[arg(long, value_name = "DIR", default_value = "recordings")]
    pub recordings: PathBuf,
    /// Address of a server whose name and port are checked. With the ticket of this station in SULCUS_TICKET, the path
    /// to the server is measured for three seconds: round trip, losses, and the named network that it is like
    #[arg(long, value_name = "HOST:PORT")]
    pub server: Option<String>,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub json: bool,
}

/// Hand on the command line.
fn hand(name: &str) -> Result<Hand, String> {
    Hand::from_name(name).ok_or_else(|| format!("`{name}` is no hand, expected left or right"))
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
    /// turns, the wheel magnifies, Home resets, F7 hides the panel, F8 starts the force of a device without a button.
    /// F10 closes, Escape pauses, w wipes blood away, F11 is full screen. Shift and an arrow turns or tilts the
    /// patient's head. Findings: digits, b, s, r, f, u, Return
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
    /// Print each act and each new size of the window while it runs, and frame age and frame time at the end
    #[arg(long, requires = "view")]
    pub stats: bool,
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
