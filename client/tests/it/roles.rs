//! Roles, message by message: every message of every role at its own station and at another one.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::common::raw::Raw;
use crate::common::{Station, force_up, press, press_on, status_of};
use sulcus_connection::instructor::{Heard, Instructor};
use sulcus_connection::link::{Link, LinkConfig, LinkError};
use sulcus_proto::control::{
    ButtonEdge, Command, EndReason, Event, InputBatch, Instruct, Instruction, LastTick, Show,
};
use sulcus_proto::permission::{self, Kind, may};
use sulcus_proto::station::Phase;
use sulcus_proto::{ClientMessage, PoseDatagram, Role, ServerMessage, status};
use sulcus_server::StationConfig;
use sulcus_server::net::tokens::{Denied, Fixed, Grant, Tokens};
use sulcus_sessions::{Message, Occurrence, Recording};

/// Token of each role at station `a`; the admin's is valid at every station.
fn tokens() -> Fixed {
    let mut tokens = Fixed::default();
    for role in Role::ALL {
        let station = (role != Role::Admin).then_some("a");
        tokens = tokens.with(role.name(), &format!("t-{role}"), role, station);
    }
    tokens
}

/// A server with the stations `a` and `b`.
fn server() -> Station {
    Station::with(|config| {
        let first = config.stations.remove(0);
        for name in ["a", "b"] {
            config.stations.push(StationConfig {
                name: name.into(),
                ..first.clone()
            });
        }
        config.tokens = Arc::new(tokens());
    })
}

fn config_of(station: &Station, role: Role, token: &str) -> LinkConfig {
    LinkConfig {
        role,
        token: token.into(),
        ..station.config()
    }
}

fn watcher(station: &Station, role: Role) -> Instructor {
    Instructor::connect(config_of(station, role, role.name())).unwrap()
}

/// Number of the instruction behind each message of the walk.
const LAST: u64 = 99;

/// Message with a known answer behind a message that may have none. The server takes messages in order, so that this
/// answer alone means silence. A stop and an instruction have answers of their own, or end the connection.
fn last(role: Role, station: &str, message: &ClientMessage) -> Option<ClientMessage> {
    match message {
        ClientMessage::Stop | ClientMessage::Instruct(_) => None,
        _ if role == Role::Student => Some(ClientMessage::Stop),
        _ => Some(ClientMessage::Instruct(Instruct {
            number: LAST,
            station: station.into(),
            instruction: Instruction::Flag("last".into()),
        })),
    }
}

/// First outcome on a connection. The end of the session counts as silence where `last` asks for it.
async fn outcome(raw: &mut Raw, last: Option<&ClientMessage>) -> Outcome {
    let heard = async {
        while let Some(message) = raw.hear().await {
            match message {
                ServerMessage::Refused(refused) => return Outcome::Dropped(refused.text),
                ServerMessage::Answer(answer) if answer.number == LAST => return Outcome::Quiet,
                ServerMessage::Answer(answer) if !answer.taken => {
                    return Outcome::Denied(answer.text);
                }
                ServerMessage::Answer(_) => return Outcome::Taken,
                ServerMessage::Goodbye(goodbye)
                    if last == Some(&ClientMessage::Stop)
                        && goodbye.summary.end == EndReason::Stopped =>
                {
                    return Outcome::Quiet;
                }
                ServerMessage::Goodbye(_) => return Outcome::Ended,
                _ => {}
            }
        }
        Outcome::Dropped(String::new())
    };
    let outcome = tokio::time::timeout(Duration::from_secs(120), heard).await;
    outcome.expect("an outcome")
}

#[derive(Debug, PartialEq)]
enum Outcome {
    /// The connection goes on without an answer.
    Quiet,
    /// The instruction is in force.
    Taken,
    /// The instruction is refused; the connection goes on.
    Denied(String),
    /// The connection is dropped with a sentence.
    Dropped(String),
    /// The session has ended.
    Ended,
}

/// A message of every kind; instructions are for `station`.
fn every_message(station: &str) -> Vec<ClientMessage> {
    let instruct = |instruction| {
        ClientMessage::Instruct(Instruct {
            number: 7,
            station: station.into(),
            instruction,
        })
    };
    vec![
        ClientMessage::Start,
        ClientMessage::Command(Command::Pause),
        ClientMessage::Command(Command::Resume),
        ClientMessage::Command(Command::ForceLimit(0.5)),
        ClientMessage::Button(ButtonEdge {
            tool: 0,
            button: 1,
            pressed: true,
            device_time_ns: 0,
        }),
        ClientMessage::Event(Event {
            tick: 1,
            kind: "reading_called".into(),
            json: "{}".into(),
        }),
        ClientMessage::Inputs(InputBatch {
            first_tick: 1,
            hash: 0,
            commands: 0,
            rows: vec![1, 2, 3],
        }),
        ClientMessage::LastTick(LastTick { tick: 1, hash: 0 }),
        ClientMessage::Show(Show::default()),
        ClientMessage::Watch,
        instruct(Instruction::Pause),
        instruct(Instruction::Resume),
        instruct(Instruction::ForceLimit(0.0)),
        instruct(Instruction::Note("a note".into())),
        instruct(Instruction::Flag(String::new())),
        instruct(Instruction::Say("slowly".into())),
        instruct(Instruction::Ghost(String::new())),
        instruct(Instruction::Plan("exercise = \"free\"".into())),
        instruct(Instruction::End),
        ClientMessage::Stop,
    ]
}

/// The list above has a message of every kind of the table, so that the walk below is complete.
#[test]
fn the_walk_has_every_kind() {
    let messages = every_message("a");
    let sent: Vec<Kind> = messages.iter().filter_map(permission::kind).collect();
    for (kind, _) in permission::TABLE {
        // Poses are datagrams; a plan of an exam is a plan whose text says so.
        let apart = matches!(kind, Kind::Pose | Kind::ExamPlan);
        assert!(apart || sent.contains(&kind), "{kind:?}");
    }
}

#[test]
fn every_message_of_every_role_does_what_the_table_says_and_nothing_else() {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .unwrap();
    let roles = [Role::Student, Role::Instructor, Role::Examiner, Role::Admin];
    for own in [true, false] {
        let station = if own { "a" } else { "b" };
        for role in roles {
            for message in every_message(station) {
                let kind = permission::kind(&message).unwrap();
                // Only an instruction names a station; all other messages concern that of the connection.
                if !own && !matches!(message, ClientMessage::Instruct(_)) {
                    continue;
                }
                let server = server();
                // A session at the station, so that instructions have an object.
                let mut link = (role != Role::Student && own).then(|| {
                    let mut link =
                        Link::connect(config_of(&server, Role::Student, "student")).unwrap();
                    link.start();
                    press(&mut link, |link, _| link.latest_wrench().is_some());
                    link
                });
                let outcome = runtime.block_on(async {
                    let mut raw = Raw::connect(&server, role, role.name()).await;
                    assert!(
                        matches!(
                            raw.hear().await,
                            Some(ServerMessage::Hello(_) | ServerMessage::Welcome(_))
                        ),
                        "{role}"
                    );
                    raw.say(&message).await;
                    let last = last(role, station, &message);
                    if let Some(last) = &last {
                        raw.say(last).await;
                    }
                    outcome(&mut raw, last.as_ref()).await
                });
                let permitted = may(role, kind, own);
                let said = format!("{role}, {station}, {message:?}: {outcome:?}");
                match (&message, permitted) {
                    (ClientMessage::Inputs(_), _) => {
                        assert!(matches!(outcome, Outcome::Dropped(_)), "{said}");
                    }
                    (ClientMessage::Stop, true) => assert_eq!(outcome, Outcome::Ended, "{said}"),
                    // Plans of this server are fixed.
                    (
                        ClientMessage::Instruct(Instruct {
                            instruction: Instruction::Plan(_),
                            ..
                        }),
                        true,
                    ) => {
                        assert!(
                            matches!(&outcome, Outcome::Denied(text) if text.contains("fixed")),
                            "{said}"
                        );
                    }
                    (ClientMessage::Instruct(_), true) if own => {
                        assert_eq!(outcome, Outcome::Taken, "{said}");
                    }
                    (ClientMessage::Instruct(i), true) => {
                        // The admin at a station without a session.
                        let level = matches!(
                            i.instruction,
                            Instruction::Pause | Instruction::Resume | Instruction::ForceLimit(_)
                        );
                        assert_eq!(outcome == Outcome::Taken, level, "{said}");
                    }
                    (_, true) => assert_eq!(outcome, Outcome::Quiet, "{said}"),
                    (ClientMessage::Instruct(_), false) if role != Role::Student => {
                        assert!(
                            matches!(&outcome, Outcome::Denied(text) if text.contains("no station")),
                            "{said}"
                        );
                    }
                    (_, false) => assert!(matches!(outcome, Outcome::Dropped(_)), "{said}"),
                }
                // Only a permitted level moves a station's level.
                let moved = kind == Kind::Levels && permitted;
                for at in server.server().status() {
                    let levels = at.paused || at.force_limit_n != 0.0;
                    assert!(!levels || moved && at.station == station, "{said} {at:?}");
                }
                if let Some(link) = link.take() {
                    let _ = link.finish();
                }
            }
        }
    }
}

#[test]
fn a_pose_of_any_other_role_ends_its_connection_and_moves_nothing() {
    let server = server();
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .unwrap();
    for role in [Role::Instructor, Role::Examiner, Role::Admin] {
        let outcome = runtime.block_on(async {
            let mut raw = Raw::connect(&server, role, role.name()).await;
            raw.hear().await;
            let pose = PoseDatagram::default().to_bytes().unwrap();
            raw.connection.send_datagram(pose.to_vec().into()).unwrap();
            outcome(&mut raw, None).await
        });
        assert!(
            matches!(&outcome, Outcome::Dropped(text) if text.contains("datagrams")),
            "{role}: {outcome:?}"
        );
    }
}

#[test]
fn a_token_opens_its_own_role_at_its_own_station_only() {
    let server = server();
    for token in Role::ALL {
        for asked in [Role::Instructor, Role::Examiner, Role::Admin] {
            let joined = Instructor::connect(config_of(&server, asked, token.name()));
            let error = joined.as_ref().err().map(ToString::to_string);
            assert_eq!(
                joined.is_ok(),
                token == asked,
                "{token} as {asked}: {error:?}"
            );
        }
    }
    let mut elsewhere = config_of(&server, Role::Student, "student");
    elsewhere.station = "b".into();
    let error = Link::connect(elsewhere).err().unwrap();
    assert!(
        matches!(&error, LinkError::Refused(text) if text.contains("not valid at station `b`")),
        "{error}"
    );
    let mut nowhere = config_of(&server, Role::Student, "student");
    nowhere.station = "z".into();
    assert!(matches!(Link::connect(nowhere), Err(LinkError::Refused(_))));
}

/// Tokens of which one is revoked after a while.
struct Later(AtomicBool);

impl Tokens for Later {
    fn find(&self, secret: &str) -> Result<Grant, Denied> {
        tokens().find(secret)
    }

    fn still(&self, id: &str) -> Result<(), Denied> {
        match self.0.load(Ordering::Relaxed) {
            true => Err(Denied::Revoked {
                id: id.into(),
                on: "2026-11-26".into(),
            }),
            false => Ok(()),
        }
    }
}

#[test]
fn a_revoked_token_ends_open_connections_too() {
    let later = Arc::new(Later(AtomicBool::new(false)));
    let kept = later.clone();
    let server = Station::with(|config| {
        config.stations[0].name = "a".into();
        config.tokens = kept;
    });
    let mut instructor = watcher(&server, Role::Instructor);
    let mut link = Link::connect(config_of(&server, Role::Student, "student")).unwrap();
    link.start();
    press(&mut link, |link, _| force_up(link) > 0.4);
    later.0.store(true, Ordering::Relaxed);
    press_on(&mut link, |link| !link.is_open());
    let error = link.finish().err().unwrap();
    assert!(
        error.to_string().contains("revoked on 2026-11-26"),
        "{error}"
    );
    let error = instructor.instruct("a", Instruction::Pause).err().unwrap();
    assert!(
        error.to_string().contains("revoked on 2026-11-26"),
        "{error}"
    );
}

/// A token that is over, with its sentence.
struct Over;

impl Tokens for Over {
    fn find(&self, secret: &str) -> Result<Grant, Denied> {
        match secret {
            "old" => Err(Denied::Revoked {
                id: "t-1".into(),
                on: "2026-11-26".into(),
            }),
            _ => Err(Denied::Unknown),
        }
    }
}

#[test]
fn a_revoked_token_is_told_apart_from_a_wrong_one() {
    let station = Station::with(|config| config.tokens = Arc::new(Over));
    for (token, told) in [("old", "revoked on"), ("none", "does not know the token")] {
        let error = Link::connect(config_of(&station, Role::Student, token));
        let error = error.err().unwrap();
        assert!(
            matches!(&error, LinkError::WrongToken(text) if text.contains(told)),
            "{error}"
        );
    }
}

#[test]
fn an_instructor_sees_and_steers_and_every_act_is_recorded_with_its_tick() {
    let server = server();
    let mut instructor = watcher(&server, Role::Instructor);
    assert_eq!(instructor.welcome().stations, ["a"]);
    // Before the session: the level waits for the first tick.
    let answer = instructor
        .instruct("a", Instruction::ForceLimit(0.3))
        .unwrap();
    assert!(answer.taken && answer.tick == 0, "{answer:?}");
    let nothing = instructor
        .instruct("a", Instruction::Note("early".into()))
        .unwrap();
    assert!(
        !nothing.taken && nothing.text.contains("no session"),
        "{nothing:?}"
    );
    let mut link = Link::connect(config_of(&server, Role::Student, "student")).unwrap();
    link.start();
    press(&mut link, |link, _| force_up(link) > 0.25);
    let paused = instructor.instruct("a", Instruction::Pause).unwrap();
    assert!(paused.taken && paused.tick > 0);
    press_on(&mut link, |link| {
        force_up(link) == 0.0 && status_of(link) & status::PAUSED != 0
    });
    let levels = link.latest_wrench().unwrap().datagram.levels;
    assert!(levels.paused_by_station && !levels.paused_by_student);
    assert_eq!(levels.force_limit_n, 0.3);
    // The student's own resume lifts nothing.
    link.command(Command::Resume);
    for _ in 0..200 {
        press_on(&mut link, |link| force_up(link) == 0.0);
    }
    let other = watcher(&server, Role::Examiner).instruct("a", Instruction::Resume);
    let resumed = other.unwrap();
    assert!(resumed.taken && resumed.tick > paused.tick);
    press_on(&mut link, |link| force_up(link) > 0.25);
    for instruction in [
        Instruction::Note("holds the probe like a pen".into()),
        Instruction::Flag("look here".into()),
        Instruction::Say("more slowly".into()),
    ] {
        assert!(instructor.instruct("a", instruction).unwrap().taken);
    }
    let no = instructor
        .instruct("a", Instruction::ForceLimit(-1.0))
        .unwrap();
    assert!(!no.taken && no.text.contains("-1"), "{no:?}");
    let long = instructor
        .instruct("a", Instruction::Note("x".repeat(20_000)))
        .unwrap();
    assert!(!long.taken && long.text.contains("20000 bytes"), "{long:?}");
    assert!(!instructor.instruct("b", Instruction::Pause).unwrap().taken);
    // Status: who set the level, what the hand feels.
    let (mut seen, mut heard) = (false, Vec::new());
    press_on(&mut link, |_| {
        while let Some(one) = instructor.next(Duration::ZERO) {
            match one {
                Heard::Status(status) => {
                    seen |= status.phase == Phase::Running
                        && status.set_by == "t-examiner"
                        && status.tools[0].peak_force_n > 0.2
                        && status.recording.ends_with(".mcap");
                }
                Heard::Event(event) => heard.push(event.text),
            }
        }
        seen
    });
    assert!(instructor.instruct("a", Instruction::End).unwrap().taken);
    let goodbye = link.finish_with_text().unwrap();
    assert!(
        goodbye.text.contains("instructor ended"),
        "{}",
        goodbye.text
    );
    let recording = Recording::open(&server.recording(&goodbye.summary.recording)).unwrap();
    let mut said = Vec::new();
    let mut first_paused = 0;
    for message in recording.messages() {
        match message.unwrap() {
            Message::Event(event) => said.extend(Occurrence::parse(&event.text)),
            Message::Row(row) if row.input.paused && first_paused == 0 => first_paused = row.tick,
            _ => {}
        }
    }
    assert_eq!(
        first_paused, paused.tick,
        "the answer names the tick that obeyed"
    );
    for (kind, by) in [
        ("instructed", "t-instructor"),
        ("instructed", "t-examiner"),
        ("note", "t-instructor"),
        ("flag", "t-instructor"),
        ("message", "t-instructor"),
        ("ended", "t-instructor"),
    ] {
        let found = said
            .iter()
            .any(|event| event.kind == kind && event.data["by"] == by);
        assert!(found, "{kind} by {by}: {said:?}");
    }
    // The instructor has heard the same events live.
    while let Some(one) = instructor.next(Duration::from_secs(5)) {
        if let Heard::Event(event) = one {
            heard.push(event.text);
        }
        if heard.iter().any(|text| text.starts_with("ended")) {
            break;
        }
    }
    assert!(
        heard.iter().any(|text| text.starts_with("note at tick")),
        "{heard:?}"
    );
}
