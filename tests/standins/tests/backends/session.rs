//! A rig with a client: the tests' side of the example `backend_client`.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command as Process, ExitStatus, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use sulcus_standins::board::Family;
use sulcus_standins::setup::Setup;
use sulcus_standins::{Rig, example, library};
use tempfile::TempDir;

use crate::commands::{Answer, Command, Hand, Item, MARK, Opened};

/// Sessions run one after another: their threads need the processors.
static ALONE: Mutex<()> = Mutex::new(());

/// Longest wait for a state.
const LONG: Duration = Duration::from_secs(20);

/// Time after which a press without an effect is repeated.
const AGAIN: Duration = Duration::from_millis(300);

/// A controller and a client.
pub struct Session {
    pub rig: Rig,
    client: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    _home: TempDir,
    _alone: Option<MutexGuard<'static, ()>>,
}

/// Settings of a client.
#[derive(Clone, Default)]
pub struct Options {
    /// Stand-in library, if not that of the back-end.
    pub library: Option<String>,
    /// Further variables.
    pub variables: Vec<(&'static str, String)>,
    /// Configuration files that do not exist.
    pub has_no_files: bool,
}

pub fn rig(setup: Setup) -> Rig {
    let program = Path::new(env!("CARGO_BIN_EXE_standin-controller"));
    Rig::start_at(program, setup).expect("the controller starts")
}

impl Session {
    /// Starts the controller of `setup`, and a client with the back-end `name`.
    pub fn new(name: &str, setup: Setup) -> Self {
        Self::with(name, setup, &Options::default())
    }

    pub fn with(name: &str, setup: Setup, options: &Options) -> Self {
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let mut session = Self::at(rig(setup), name, options);
        session._alone = Some(alone);
        session
    }

    /// Starts another client at the rig of this session, after the end of the first.
    pub fn again(&mut self, name: &str, options: &Options) {
        let _ = self.client.kill();
        let _ = self.client.wait();
        let (client, home) = spawn(&self.rig, name, options);
        self.take(client, home);
    }

    /// Starts a client at a rig.
    fn at(rig: Rig, name: &str, options: &Options) -> Self {
        let (mut client, home) = spawn(&rig, name, options);
        Self {
            rig,
            input: client.stdin.take().expect("a pipe"),
            output: BufReader::new(client.stdout.take().expect("a pipe")),
            client,
            _home: home,
            _alone: None,
        }
    }

    fn take(&mut self, mut client: Child, home: TempDir) {
        self.input = client.stdin.take().expect("a pipe");
        self.output = BufReader::new(client.stdout.take().expect("a pipe"));
        self.client = client;
        self._home = home;
    }

    /// Gives a command. `None` if the client has died.
    pub fn try_ask(&mut self, command: &Command) -> Option<Answer> {
        let line = serde_json::to_string(command).expect("JSON");
        writeln!(self.input, "{line}").ok()?;
        loop {
            let mut line = String::new();
            if self.output.read_line(&mut line).ok()? == 0 {
                return None;
            }
            if let Some(answer) = line.strip_prefix(MARK) {
                return Some(serde_json::from_str(answer).expect("an answer"));
            }
        }
    }

    pub fn ask(&mut self, command: &Command) -> Answer {
        self.try_ask(command).expect("the client lives")
    }

    pub fn list(&mut self) -> Vec<Item> {
        match self.ask(&Command::List) {
            Answer::List(items) => items,
            other => panic!("{other:?}"),
        }
    }

    pub fn open(&mut self, serials: &[&str]) -> Result<Vec<Opened>, String> {
        let serials = serials.iter().map(|serial| (*serial).into()).collect();
        match self.ask(&Command::Open(serials)) {
            Answer::Open(opened) => Ok(opened),
            Answer::Error(text) => Err(text),
            other => panic!("{other:?}"),
        }
    }

    /// Opens and starts the devices.
    pub fn start(&mut self, serials: &[&str]) -> Vec<Opened> {
        let opened = self.open(serials).expect("the devices open");
        self.ask(&Command::Start);
        opened
    }

    /// Starts the devices, presses the keys and waits until each hand has its whole force.
    pub fn live(&mut self, serials: &[&str]) {
        self.start(serials);
        for at in 0..serials.len() {
            self.press(at);
        }
        for at in 0..serials.len() {
            self.wait(at, "Live");
        }
    }

    /// Presses the key of a hand that waits for a button until the force rises.
    ///
    /// The door ignores a press in a period without a fresh order, and a loaded machine has such periods. A person then
    /// presses again.
    pub fn press(&mut self, at: usize) {
        let began = Instant::now();
        loop {
            self.press_once(at);
            let pressed = Instant::now();
            while pressed.elapsed() < AGAIN {
                if matches!(self.hands()[at].stage.as_str(), "Rising" | "Live") {
                    return;
                }
                std::thread::sleep(Duration::from_millis(2));
            }
            assert!(
                began.elapsed() < LONG,
                "{:?}\n{}",
                self.hands(),
                self.said()
            );
        }
    }

    /// Waits until the hand waits for a button, and presses the key once.
    pub fn press_once(&mut self, at: usize) {
        let hands = self.until(|hands| waits(&hands[at]));
        assert!(hands[at].present, "{hands:?}");
        self.ask(&Command::Press(at));
    }

    pub fn force(&mut self, at: usize, force: [f64; 3], ripple: f64) {
        self.ask(&Command::Force(at, force, ripple));
    }

    pub fn hands(&mut self) -> Vec<Hand> {
        match self.ask(&Command::State) {
            Answer::State(hands) => hands,
            other => panic!("{other:?}"),
        }
    }

    pub fn number(&mut self, command: &Command) -> u64 {
        match self.ask(command) {
            Answer::Number(number) => number,
            other => panic!("{other:?}"),
        }
    }

    /// Waits for a stage of a hand.
    pub fn wait(&mut self, at: usize, stage: &str) -> Vec<Hand> {
        self.until(|hands| hands[at].stage.contains(stage))
    }

    /// Waits until the hands satisfy `wanted`.
    pub fn until(&mut self, wanted: impl Fn(&[Hand]) -> bool) -> Vec<Hand> {
        let began = Instant::now();
        loop {
            let hands = self.hands();
            if wanted(&hands) {
                return hands;
            }
            assert!(began.elapsed() < LONG, "{hands:?}\n{}", self.said());
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    /// Sentences of the client so far.
    pub fn said(&mut self) -> String {
        match self.ask(&Command::Said) {
            Answer::Said(text) => text,
            other => panic!("{other:?}"),
        }
    }

    /// Waits for a sentence.
    pub fn wait_said(&mut self, text: &str) -> String {
        let began = Instant::now();
        loop {
            let said = self.said();
            if said.contains(text) {
                return said;
            }
            assert!(began.elapsed() < LONG, "no {text:?} in:\n{said}");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Ends the run in order.
    pub fn stop(&mut self) -> Result<(), String> {
        match self.ask(&Command::Stop) {
            Answer::Done => Ok(()),
            Answer::Error(text) => Err(text),
            other => panic!("{other:?}"),
        }
    }

    pub fn kill(&mut self) {
        self.client.kill().expect("killed");
        self.client.wait().expect("ended");
    }

    /// Waits for the end of a process that ends by itself.
    pub fn ended(&mut self) -> ExitStatus {
        self.client.wait().expect("ended")
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        let _ = self.client.kill();
        let _ = self.client.wait();
    }
}

/// Whether the force of a hand waits for a button.
fn waits(hand: &Hand) -> bool {
    hand.stage == "Waiting" || hand.stage.starts_with("Tripped")
}

/// Starts a client of a rig, with the setup program's files.
fn spawn(rig: &Rig, name: &str, options: &Options) -> (Child, TempDir) {
    let home = tempfile::tempdir().expect("a directory");
    let config = home.path().join("config");
    std::fs::create_dir(&config).expect("a directory");
    let is_hd = |family| family == Family::Hd && !options.has_no_files;
    for device in rig
        .setup()
        .devices
        .iter()
        .filter(|device| is_hd(device.family))
    {
        let text = format!("ModelType=OMNI\nDeviceSerialNumber={}\n", device.serial);
        std::fs::write(config.join(format!("{}.config", device.name)), text).expect("a file");
    }
    let (key, board) = rig.environment();
    let standin = |default: &str| {
        let name = options.library.as_deref().unwrap_or(default);
        if name.contains('/') {
            name.into()
        } else {
            library(name).expect("built")
        }
    };
    let mut process = Process::new(example("backend_client").expect("built"));
    process
        .arg(name)
        .env(key, board)
        .env("GTDD_HOME", home.path())
        .env("SULCUS_HD_LIBRARY", standin("standin_hd"))
        .env("SULCUS_DHD_LIBRARY", standin("standin_dhd"))
        .env_remove("SULCUS_HD_KEEP_DEVICE")
        .env_remove("SULCUS_DHD_AUTO_INIT")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped());
    for (name, value) in &options.variables {
        process.env(name, value);
    }
    (process.spawn().expect("the client starts"), home)
}

/// Sleeps for so many ms.
pub fn sleep_ms(ms: u64) {
    std::thread::sleep(Duration::from_millis(ms));
}
