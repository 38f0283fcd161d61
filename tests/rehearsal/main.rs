//! Rehearsal: a class hour in a few minutes, with the programs as a school runs them.
//!
//! The server runs from its image where the machine can build one. An IT person makes tokens from a roster, and writes
//! the file of the stations. Four students join. An instructor pauses a hand, writes a note and sends a message; a page
//! of the console follows all stations. A screen shows a station, and is drawn. A cable is pulled and put back. The
//! server is killed and started again, and the students go on with their old tickets. A fifth student feels the crown
//! with a haptic device, whose force ends with the server. A sixth student is at home, and the ticks run at the hand. The
//! certificate is rotated. At the end all recordings replay identically, and each student has one grade, also from two
//! recordings.
//!
//! Later parts of the system add their own acts here.

mod arm;
mod home;

use std::net::UdpSocket;
use std::path::PathBuf;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;
use sulcus_connection::display::{Cache, DisplayLink, Picture};
use sulcus_connection::instructor::{Heard, Instructor};
use sulcus_connection::link::{LinkConfig, LinkError, Pin};
use sulcus_proto::control::Instruction;
use sulcus_proto::display::{DisplayFrame, Kind};
use sulcus_proto::hex::from_hex32;
use sulcus_proto::station::{Phase, StationStatus};
use sulcus_proto::{Role, Ticket};
use sulcus_relay::Relay;
use sulcus_screen::gpu::{Backend, Drawing, Graphics, Mode, Renderer};
use sulcus_screen::moment::Moment;
use sulcus_screen::quality::Quality;
use sulcus_screen::stage::{Owner, Stage};
use sulcus_screen::views::View;
use sulcus_support::Resource;
use sulcus_tests::page::{self, Page};
use sulcus_tests::{Ended, Image, Place, Program, files_with, signal};

use arm::Arm;

/// Stations of the class with their exercises.
const STATIONS: [(&str, &str); 5] = [
    ("chair-1", "crown"),
    ("chair-2", "crown"),
    ("chair-3", "probing"),
    ("chair-4", "crown"),
    ("chair-5", "crown"),
];

/// Longest session of a student, seconds. The instructor ends each session after its acts.
const LONGEST_S: &str = "1200";

/// Longest wait for a state.
const PATIENCE: Duration = Duration::from_secs(120);

/// Station of the student with a haptic device, who comes after the others.
const WITH_ARM: usize = 4;
/// Station whose ticks run at the hand. They begin again when the server is started again.
const AT_HAND: usize = 3;
/// Station, learner and exercise of the student at home.
const HOME: (&str, &str, &str) = ("home", "s-6", "crown");
/// Force at the arm that shows a contact, newtons.
const TOUCHED_N: f64 = 0.1;

/// Learner of a station.
fn learner(k: usize) -> String {
    format!("s-{}", k + 1)
}

/// The class: folder, address, tickets.
struct Class {
    place: Place,
    address: String,
    tickets: Vec<String>,
}

impl Class {
    /// Makes tokens from a roster, and the file of the stations.
    fn new() -> Self {
        let image = Resource::Image.or_skip(Image::new());
        let place = image.map_or_else(Place::new, Place::with_image);
        let mut roster = String::from("Learner;Station\n");
        let mut stations =
            String::from("[class]\nname = \"rehearsal\"\n\n[defaults]\nresume_within_s = 300\n");
        for (k, (name, exercise)) in STATIONS.iter().enumerate() {
            roster += &format!("{};{name}\n", learner(k));
            stations += &format!(
                "\n[[station]]\nname = \"{name}\"\nplan = {{ exercise = \"{exercise}\" }}\n"
            );
        }
        let (home, at_home, exercise) = HOME;
        roster += &format!("{at_home};{home}\n");
        stations +=
            &format!("\n[[station]]\nname = \"{home}\"\nplan = {{ exercise = \"{exercise}\" }}\n");
        std::fs::write(place.path("roster.csv"), roster).expect("a roster");
        std::fs::write(place.path("stations.toml"), stations).expect("stations");
        let add = [
            "token",
            "add",
            "--class",
            "roster.csv",
            "--out",
            "tickets.csv",
        ];
        place.run(Program::Server, &add).ok();
        let table = std::fs::read_to_string(place.path("tickets.csv")).expect("tickets");
        let learners = (0..STATIONS.len()).map(learner);
        let tickets = learners
            .chain([at_home.to_owned()])
            .map(|id| {
                let line = table.lines().find(|line| line.contains(&id));
                let cells = line.expect("a line for each learner").rsplit(',');
                cells
                    .into_iter()
                    .next()
                    .expect("a ticket")
                    .trim_matches('"')
                    .to_owned()
            })
            .collect();
        // A free port that stays the same when the server is started again.
        let free = UdpSocket::bind("127.0.0.1:0").expect("a socket");
        let address = free.local_addr().expect("bound").to_string();
        Self {
            place,
            address,
            tickets,
        }
    }

    fn serve(&self) -> sulcus_tests::Serving {
        let serve = [
            "--config",
            "stations.toml",
            "--certificate-out",
            "server.der",
            // A measured cost refuses stations on a busy machine. The rules of admission have tests of their own.
            "--no-admission",
            "--console",
            "127.0.0.1:0",
        ];
        self.place.serve_at(&self.address, &serve)
    }

    /// A connection of the instructor.
    fn instructor(&self) -> Instructor {
        Instructor::connect(self.instructors_link()).expect("the instructor joins")
    }

    /// Link with a token of an instructor for all stations.
    fn instructors_link(&self) -> LinkConfig {
        let add = [
            "token",
            "add",
            "--role",
            "instructor",
            "--out",
            "instructor.txt",
        ];
        if !self.place.path("instructor.txt").exists() {
            self.place.run(Program::Server, &add).ok();
        }
        let ticket = self.instructors_ticket();
        let server = self.address.parse().expect("an address");
        LinkConfig {
            role: Role::Instructor,
            ..LinkConfig::new(server, &ticket, "")
        }
    }

    /// Ticket of the instructor, after the first [`Class::instructors_link`].
    fn instructors_ticket(&self) -> Ticket {
        let text = std::fs::read_to_string(self.place.path("instructor.txt")).expect("a ticket");
        text.trim().parse().expect("a ticket")
    }

    /// Starts the client of a station, over `address`, with a device where there is an `arm`.
    fn student(&self, k: usize, address: &str, arm: Option<&Arm>) -> Child {
        let (_, exercise) = STATIONS[k];
        // On a busy machine the choice of a client would be a matter of chance.
        let ticks = if k == AT_HAND { "hand" } else { "server" };
        let mut command = self.place.command(Program::Client.path());
        command
            .env("SULCUS_TICKET", &self.tickets[k])
            .args(["run", "--server", address, "--exercise", exercise])
            .args(["--duration", LONGEST_S, "--tick", ticks, "--json"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        if let Some(arm) = arm {
            arm.give(&mut command);
        }
        command.spawn().expect("the client starts")
    }

    /// Starts the client of the student at home, over `address`. The place of the ticks is its own choice.
    fn at_home(&self, address: &str) -> Child {
        let (_, _, exercise) = HOME;
        let mut command = self.place.command(Program::Client.path());
        command
            .env("SULCUS_TICKET", &self.tickets[STATIONS.len()])
            .args(["run", "--server", address, "--exercise", exercise])
            .args(["--duration", LONGEST_S, "--json"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command.spawn().expect("the client starts")
    }

    /// Screen of a station, over `address`.
    fn screen(&self, k: usize, address: &str) -> DisplayLink {
        let ticket: Ticket = self.tickets[k].parse().expect("a ticket");
        let config = LinkConfig::new(address.parse().expect("an address"), &ticket, "");
        let cache = Cache::new(self.place.path("screen-cache"));
        DisplayLink::begin(&config, Some(cache)).expect("a thread")
    }

    fn recordings(&self) -> Vec<PathBuf> {
        files_with(&self.place.path("recordings"), "mcap")
    }

    fn sessions(&self, arguments: &[&str]) -> Ended {
        self.place.run(Program::Sessions, arguments)
    }
}

/// Waits for a frame on a screen that fits.
fn shown(screen: &mut DisplayLink, fits: impl Fn(&DisplayFrame) -> bool) -> DisplayFrame {
    let patience = Instant::now() + PATIENCE;
    while Instant::now() < patience {
        let newest = screen.newest().and_then(|picture| picture.frame.clone());
        if let Some(frame) = newest.filter(|frame| fits(frame)) {
            return frame;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    panic!(
        "waited in vain for a picture: {:?} {:?}",
        screen.trouble(),
        screen.stats()
    );
}

/// Draws what a screen has received: a picture with the tooth, its gingiva and the probe.
fn drawn(graphics: Graphics, picture: Picture) {
    const SIZE: [u32; 2] = [640, 360];
    let frame = picture.frame.expect("a frame");
    let moment = Moment::of(&picture.scene, &frame);
    let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
    let camera = View::CloseUp.camera(&picture.scene, &moment, None, aspect);
    let quality = Quality::Lowest;
    let stage = Stage::new(&picture.scene, quality.looks().thinned_um);
    let mut renderer = Renderer::new(graphics, stage, quality, Mode::Identity);
    let image = renderer.picture(&Drawing::through(camera), &moment, SIZE);
    let image = image.expect("a picture");
    let share = |owner: Owner| {
        let colour = Renderer::identity(owner);
        let pixels = image.rgba.iter().filter(|pixel| **pixel == colour);
        pixels.count() as f64 / image.rgba.len() as f64
    };
    for kind in [Kind::Tooth, Kind::Gingiva] {
        let object = picture
            .scene
            .objects
            .iter()
            .position(|one| one.kind == kind);
        let number = object.expect("an object of this kind") as u16;
        assert!(share(Owner::Object(number)) > 0.01, "{kind:?}");
    }
    assert!(share(Owner::Tool(0)) > 0.002, "the probe");
}

/// Waits for a status of a station that fits.
fn until(
    instructor: &mut Instructor,
    station: &str,
    what: &str,
    fits: impl Fn(&StationStatus) -> bool,
) {
    let patience = Instant::now() + PATIENCE;
    let mut newest = None;
    while Instant::now() < patience {
        if let Some(Heard::Status(status)) = instructor.next(Duration::from_secs(1))
            && status.station == station
        {
            if fits(&status) {
                return;
            }
            newest = Some(status);
        }
    }
    panic!("waited in vain for {what}: {newest:?}");
}

/// Ends the session of a station. Gives the result of its client, which has let the hand go.
fn ended(instructor: &mut Instructor, station: &str, student: Child) -> Ended {
    let end = instructor.instruct(station, Instruction::End);
    assert!(end.expect("an answer").taken, "{station}");
    let ended = Ended::new(student.wait_with_output().expect("the client ends"));
    assert_eq!(ended.code, 0, "{station}: {ended:#?}");
    let said = ended.json();
    assert_eq!(said["session"]["end"], "instructor", "{said}");
    assert_eq!(said["device"]["last_displayed_n"], 0.0, "{said}");
    ended
}

#[test]
fn a_class_hour() {
    let began = Instant::now();
    let act = |name: &str| eprintln!("{:6.1} s  {name}", began.elapsed().as_secs_f64());
    let class = Class::new();

    act("the server starts; every recording has its folder");
    let mut server = class.serve();
    let mut instructor = class.instructor();
    let names: Vec<&str> = STATIONS.iter().map(|station| station.0).collect();
    let welcome = [names.as_slice(), &[HOME.0]].concat();
    assert_eq!(instructor.welcome().stations, welcome);
    let token = class.instructors_ticket().token;
    let page = Resource::Curl
        .or_skip(page::can())
        .map(|()| Page::follow(&class.place, &server, &token, "events.txt"));

    act("four students join, the third with a screen, over a cable that will be pulled");
    let seats = &names[..WITH_ARM];
    let relay = Relay::to(class.address.parse().expect("an address")).expect("a relay");
    let cable = relay.address().to_string();
    let addresses = [&class.address, &class.address, &cable, &class.address];
    // The screen has the student's ticket and the student's cable.
    let mut screen = class.screen(2, &cable);
    let students: Vec<Child> = addresses
        .iter()
        .enumerate()
        .map(|(k, address)| class.student(k, address, None))
        .collect();
    for name in seats {
        until(&mut instructor, name, "a running session", |at| {
            at.phase == Phase::Running && at.tick > 2000
        });
    }

    act("the instructor pauses the second hand, notes, speaks, and lets it go on");
    let paused = instructor
        .instruct("chair-2", Instruction::Pause)
        .expect("an answer");
    assert!(paused.taken && paused.tick > 0, "{paused:?}");
    until(&mut instructor, "chair-2", "a hand without force", |at| {
        at.paused && at.tools[0].force_n == 0.0 && at.tick > paused.tick + 500
    });
    let note = Instruction::Note("holds the probe too steeply".into());
    assert!(
        instructor
            .instruct("chair-2", note)
            .expect("an answer")
            .taken
    );
    let say = Instruction::Say("A little flatter, please.".into());
    assert!(
        instructor
            .instruct("chair-2", say)
            .expect("an answer")
            .taken
    );
    let resumed = instructor
        .instruct("chair-2", Instruction::Resume)
        .expect("an answer");
    assert!(resumed.taken && resumed.tick > paused.tick, "{resumed:?}");

    if let Some(page) = page {
        act("the page has shown each station, and the pause");
        let events = page.close(&class.place);
        for name in seats {
            let running = |(kind, data): &(String, Value)| {
                kind == "status"
                    && data["station"] == **name
                    && data["status"]["phase"] == "running"
            };
            assert!(
                events.iter().any(running),
                "{name}: {} events",
                events.len()
            );
        }
        let paused = |(kind, data): &(String, Value)| {
            kind == "status" && data["station"] == "chair-2" && data["status"]["paused"] == true
        };
        assert!(events.iter().any(paused), "{} events", events.len());
    }

    act("the cable of the third student is pulled, and put back");
    let scene = shown(&mut screen, |frame| frame.tick > 1000);
    relay.cut(true);
    until(&mut instructor, "chair-3", "a gap", |at| {
        at.phase == Phase::Waiting
    });
    relay.cut(false);
    until(&mut instructor, "chair-3", "a return", |at| {
        at.phase == Phase::Running && at.gaps > 0
    });
    // The screen returns by itself, with the scene of its cache.
    let cut = shown(&mut screen, |_| true).tick;
    let again = shown(&mut screen, |frame| frame.tick > cut + 500);
    assert_eq!(again.scene, scene.scene);
    // Drawn after the class: a picture takes seconds of all cores.
    let picture = screen.newest().expect("a picture").clone();

    act("the server is killed, and started again with the same tickets");
    server.process.kill().expect("SIGKILL");
    server.process.wait().expect("it is gone");
    assert_eq!(class.recordings().len(), seats.len());
    drop(instructor);
    let mut server = class.serve();
    let mut instructor = class.instructor();
    for name in seats {
        until(&mut instructor, name, "a session after the restart", |at| {
            at.phase == Phase::Running && at.tick > 1000
        });
    }

    let after = shown(&mut screen, |frame| {
        frame.tick < again.tick && frame.tick > 1000
    });
    assert_eq!(after.scene, scene.scene, "the same patient");
    drop(screen);

    act("the instructor ends the sessions");
    for (k, (name, student)) in seats.iter().zip(students).enumerate() {
        let ended = ended(&mut instructor, name, student);
        let said = ended.json();
        // The kill, and the pulled cable of the third student. A busy machine can lose a connection once more.
        let returns = said["link"]["returns"].as_u64();
        assert!(returns >= Some(if k == 2 { 2 } else { 1 }), "{said}");
        let heard = ended.stderr.contains("A little flatter");
        assert_eq!(heard, k == 1, "{ended:#?}");
    }

    act("a fifth student presses the button of a haptic device and feels the crown");
    let arm = Arm::new();
    let student = class.student(WITH_ARM, &class.address, Some(&arm));
    let seat = names[WITH_ARM];
    until(&mut instructor, seat, "a running session", |at| {
        at.phase == Phase::Running && at.tick > 1000
    });
    arm.press(true);
    assert_eq!(arm.displayed(), 0.0, "no force before the button");
    arm.feel(TOUCHED_N);
    until(&mut instructor, seat, "the device's whole force", |at| {
        at.tools.iter().any(|tool| tool.device_stage == "live")
    });

    act("the server is killed in the contact, and the force ends");
    server.process.kill().expect("SIGKILL");
    server.process.wait().expect("it is gone");
    let killed_ns = sulcus_standin_haply::now_ns();
    std::thread::sleep(Duration::from_secs(1));
    assert_eq!(arm.displayed(), 0.0, "no force without a server");
    let again_ns = sulcus_standin_haply::now_ns();
    drop(instructor);
    let mut server = class.serve();
    let mut instructor = class.instructor();
    until(&mut instructor, seat, "a session after the restart", |at| {
        at.phase == Phase::Running && at.tick > 1000
    });
    arm.feel(TOUCHED_N);
    ended(&mut instructor, seat, student);
    let log = arm.stop();
    let felt = |from: u64, to: u64| {
        let forces = log.forces(arm::ARM).into_iter();
        let between = forces.filter(|sent| (from..to).contains(&sent.t_ns));
        between.map(|sent| sent.norm()).fold(0.0, f64::max)
    };
    // A force of the last 20 ms may still be on its way, and threads of a busy machine wait.
    let silent = felt(killed_ns + 300_000_000, again_ns);
    assert_eq!(silent, 0.0, "a force without a server");
    assert!(log.largest_displayed(arm::ARM) <= 3.3);

    act("a sixth student practises at home, where the ticks run at the hand");
    home::perform(&class, &mut instructor);

    if Resource::Curl.or_skip(page::can()).is_some() {
        act("the table of results has a row for each session");
        let patience = Instant::now() + PATIENCE;
        loop {
            let table = page::asked(&class.place, &server, &token, "/results");
            let rows = table.matches("data-label=\"State\"").count();
            if rows == STATIONS.len() + 1 {
                break;
            }
            assert!(Instant::now() < patience, "{rows} rows");
            std::thread::sleep(Duration::from_millis(500));
        }
    }

    act("the certificate is rotated: open connections stay, tickets of the former one are refused");
    let rotate = ["certificate", "rotate", "--out", "new.der", "--json"];
    let rotated = class.place.run(Program::Server, &rotate).json();
    let patience = Instant::now() + PATIENCE;
    let refused = loop {
        match Instructor::connect(class.instructors_link()) {
            Err(error) => break error,
            Ok(_) => assert!(Instant::now() < patience, "the former certificate stays"),
        }
    };
    assert!(
        matches!(refused, LinkError::WrongCertificate { .. }),
        "{refused}"
    );
    until(&mut instructor, names[0], "a status", |_| true);
    let digits = rotated["certificate_sha256"].as_str().expect("digits");
    let renewed = LinkConfig {
        pin: Pin::Fingerprint(from_hex32(digits).expect("32 bytes")),
        ..class.instructors_link()
    };
    Instructor::connect(renewed).expect("the same token with the new fingerprint");
    let read = |name: &str| std::fs::read(class.place.path(name)).expect("a certificate");
    assert_eq!(read("server.der"), read("new.der"));

    signal("-TERM", &server.process);
    assert!(server.process.wait().expect("it ends").success());

    let graphics = Graphics::headless(Backend::Any).map_err(|error| error.to_string());
    if let Some(graphics) = Resource::Adapter.or_skip(graphics) {
        act("the third student's screen is drawn");
        drawn(graphics, picture);
    }

    act("every recording replays identically");
    let recordings = class.recordings();
    assert_eq!(recordings.len(), 2 * STATIONS.len() + 1, "{recordings:?}");
    let mut pairs: Vec<Vec<PathBuf>> = vec![Vec::new(); STATIONS.len()];
    for file in recordings {
        let name = file.to_str().expect("plain");
        let info = class.sessions(&["info", name, "--json"]).json();
        if info["station"] == HOME.0 {
            home::check(&class, &file);
            continue;
        }
        let at = names.iter().position(|one| info["station"] == **one);
        let at = at.unwrap_or_else(|| panic!("{info}"));
        pairs[at].push(file.clone());
        let devices = info["devices"].as_array().expect("a list");
        let serials: Vec<&Value> = devices.iter().map(|device| &device["serial"]).collect();
        assert_eq!(serials.contains(&&Value::from(arm::ARM)), at == WITH_ARM);
        // A recording that the kill has cut off replays as far as it goes, and says so by its exit code.
        let replay = class.sessions(&["replay", name, "--json"]).json();
        assert_eq!(replay["identical"], true, "{replay}");
    }

    act("each student has one grade from both recordings");
    for (k, pair) in pairs.iter().enumerate() {
        let [first, second] = pair.as_slice() else {
            panic!("two recordings, found {pair:?}")
        };
        let files = [
            first.to_str().expect("plain"),
            second.to_str().expect("plain"),
        ];
        let grade = class.sessions(&["grade", files[0], files[1], "--json"]);
        let grade: Value = grade.json();
        assert_eq!(grade["learner_id"], Value::from(learner(k)), "{grade}");
        assert!(grade["score"].is_f64(), "{grade}");
    }
    act("the class is over");
}
