//! A ghost that an instructor shows, and a message for the screen: seen, never felt, and recorded.
#![allow(clippy::unwrap_used)]

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use sulcus_connection::device::{EventDevice, Glance};
use sulcus_connection::device_loop;
use sulcus_connection::instructor::Instructor;
use sulcus_connection::link::Link;
use sulcus_core::{MAX_TOOLS, Pose, RawPose, ToolInput};
use sulcus_haptics::{HandSource, Shown};
use sulcus_proto::Role;
use sulcus_proto::control::{Answer, Instruction};
use sulcus_sessions::{Mode, Recording};

use crate::common::{Station, press, rows_and_events};
use sulcus_connection::link::LinkConfig;
use sulcus_server::net::tokens::Fixed;

/// State that a screen would show.
#[derive(Default)]
struct Screen {
    ghost: Mutex<Option<Pose>>,
    texts: Mutex<Vec<String>>,
    is_over: AtomicBool,
}

/// Hand that rests at the end of the recorded path, without a contact.
struct Resting(Arc<Screen>);

impl HandSource for Resting {
    fn name(&self) -> &str {
        "resting"
    }
    fn exchange(&mut self, _: &Shown) -> [ToolInput; MAX_TOOLS] {
        let mut tools = [ToolInput::ABSENT; MAX_TOOLS];
        tools[0].present = true;
        tools[0].pose = RawPose {
            position: [0.0, 0.0, 0.012],
            orientation: [1.0, 0.0, 0.0, 0.0],
        };
        tools
    }
    fn is_done(&self) -> bool {
        self.0.is_over.load(Ordering::Acquire)
    }
}

impl EventDevice for Resting {
    fn glance(&mut self, glance: &Glance) {
        *self.0.ghost.lock().unwrap() = glance.ghost[0];
    }
    fn hear(&mut self, text: &str) {
        self.0.texts.lock().unwrap().push(text.to_owned());
    }
}

fn until(what: &str, mut is: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !is() {
        assert!(begin.elapsed() < Duration::from_secs(30), "no {what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn server(mode: Mode) -> Station {
    Station::with(|config| {
        config.stations[0].plan.mode = mode;
        config.tokens = Arc::new(Fixed::default().with("i", "t-i", Role::Instructor, None));
    })
}

fn instructor(server: &Station) -> Instructor {
    let config = LinkConfig {
        role: Role::Instructor,
        token: "i".into(),
        ..server.config()
    };
    Instructor::connect(config).unwrap()
}

/// Name of a session's recording in which the hand comes down from 12 mm.
fn recorded(server: &Station) -> String {
    let mut link = server.connect().unwrap();
    link.start();
    press(&mut link, |_, k| k >= 700);
    link.finish().unwrap().recording
}

#[test]
fn a_ghost_and_a_message_reach_the_screen_and_never_the_hand() {
    let server = server(Mode::Practice);
    let file = recorded(&server);
    let other = Station::planned(|plan| {
        let mut scene = (*plan.scene).clone();
        scene.name = "another".into();
        plan.scene_bytes = Arc::new(scene.to_bytes().unwrap());
        plan.scene = Arc::new(scene);
    });
    let foreign = recorded(&other);
    std::fs::copy(other.recording(&foreign), server.recording("foreign.mcap")).unwrap();

    let mut instructor = instructor(&server);
    let mut ask = |instruction: Instruction| -> Answer {
        instructor.instruct("station", instruction).unwrap()
    };
    let early = ask(Instruction::Ghost(file.clone()));
    assert!(
        !early.taken && early.text.contains("no session runs"),
        "{early:?}"
    );
    let mut link: Link = server.connect().unwrap();
    link.start();
    let screen = Arc::new(Screen::default());
    let hand = screen.clone();
    let runs = std::thread::spawn(move || {
        let report = device_loop::run(
            &mut link,
            &mut Resting(hand),
            u64::MAX,
            None,
            &AtomicU64::new(0),
        );
        (report, link.finish().unwrap())
    });
    let height = || screen.ghost.lock().unwrap().map(|pose| pose.position.z);
    until("session", || ask(Instruction::Flag(String::new())).taken);
    assert_eq!(height(), None);
    for (name, why) in [
        ("../x.mcap", "expected the name of a file"),
        ("foreign.mcap", "another scene"),
        ("none.mcap", "`none.mcap`"),
    ] {
        let answer = ask(Instruction::Ghost(name.into()));
        assert!(!answer.taken && answer.text.contains(why), "{answer:?}");
    }
    let shown = ask(Instruction::Ghost(file.clone()));
    assert!(shown.taken && shown.tick > 0, "{shown:?}");
    // The path begins at 12 mm, and its motion leads downwards until the hand is too far away.
    until("ghost", || height().is_some());
    let first = height().unwrap();
    until("motion of the ghost", || height().unwrap() < first - 2e-3);
    assert!(ask(Instruction::Say("rest the\u{7} finger".into())).taken);
    until("message", || !screen.texts.lock().unwrap().is_empty());
    assert_eq!(*screen.texts.lock().unwrap(), ["rest the finger"]);
    let hidden = ask(Instruction::Ghost(String::new()));
    assert!(hidden.taken, "{hidden:?}");
    until("end of the ghost", || height().is_none());
    screen.is_over.store(true, Ordering::Release);
    let (report, summary) = runs.join().unwrap();
    assert_eq!(report.max_displayed_n, 0.0, "a ghost is never felt");
    let recording = Recording::open(&server.recording(&summary.recording)).unwrap();
    let (_, events) = rows_and_events(&recording);
    for (kind, tick, of) in [
        ("ghost_shown", shown.tick, file.as_str()),
        ("ghost_hidden", hidden.tick, ""),
    ] {
        let found = events.iter().find(|event| event.kind == kind).unwrap();
        assert_eq!((found.tick, &found.data["by"]), (tick, &"t-i".into()));
        assert_eq!(found.data["recording"], of);
    }
}

#[test]
fn an_exam_has_no_ghost_and_is_none() {
    let exams = server(Mode::Exam);
    let file = recorded(&exams);
    let mut teacher = instructor(&exams);
    let mut link = exams.connect().unwrap();
    link.start();
    press(&mut link, |link, _| link.latest_wrench().is_some());
    let answer = teacher
        .instruct("station", Instruction::Ghost(file.clone()))
        .unwrap();
    assert!(
        !answer.taken && answer.text.contains("an exam runs"),
        "{answer:?}"
    );
    link.finish().unwrap();

    let practice = server(Mode::Practice);
    std::fs::create_dir_all(practice.recording("")).unwrap();
    std::fs::copy(exams.recording(&file), practice.recording(&file)).unwrap();
    let mut teacher = instructor(&practice);
    let mut link = practice.connect().unwrap();
    link.start();
    press(&mut link, |link, _| link.latest_wrench().is_some());
    let answer = teacher
        .instruct("station", Instruction::Ghost(file))
        .unwrap();
    assert!(
        !answer.taken && answer.text.contains("was an exam"),
        "{answer:?}"
    );
    link.finish().unwrap();
}
