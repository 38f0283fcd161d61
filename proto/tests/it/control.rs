//! Tests of control frames: round trips of every message, strict refusals, no panic on any bytes.

use proptest::prelude::*;
use sulcus_proto::control::{
    Answer, ButtonEdge, ClientHello, Command, DeviceCoupling, DeviceInfo, EndReason, Event,
    Goodbye, InputBatch, Instruct, Instruction, LastTick, PlanInfo, Refused, RefusedReason, Say,
    ServerHello, Show, ToolInfo, Welcome,
};
use sulcus_proto::datagram::WirePose;
use sulcus_proto::display::SceneHash;
use sulcus_proto::frame::{self, LENGTH_BYTES, body_length, decode, encode};
use sulcus_proto::ghost;
use sulcus_proto::limits::CONTROL_BYTES;
use sulcus_proto::station::{Phase, StationEvent, StationStatus};
use sulcus_proto::{ClientMessage, CodecError, Role, ServerMessage, SessionSummary};

fn tool() -> impl Strategy<Value = ToolInfo> {
    (".{0,30}", -1.0f32..1.0, 1.0f64..1e4).prop_map(|(name, at, stiffness)| ToolInfo {
        name,
        park: WirePose {
            position: [at; 3],
            ..WirePose::IDENTITY
        },
        tip: [at; 3],
        stiffness_n_per_m: stiffness,
        stiffness_nm_per_rad: f64::from(at),
    })
}

fn device() -> impl Strategy<Value = DeviceInfo> {
    (
        prop::array::uniform3(".{0,20}"),
        any::<(u64, u32)>(),
        0.1f32..10.0,
        0u8..4,
        prop::sample::select(vec!["", "measured", "vendor", "guess"]),
        prop::option::of((1.0f32..1e5, 1e-4f32..1e3)),
    )
        .prop_map(
            |([name, library, serial], times, scale, axes, figures, coupling)| DeviceInfo {
                name,
                library,
                serial,
                model_hash: if axes == 0 {
                    String::new()
                } else {
                    "0f".repeat(32)
                },
                figures: figures.into(),
                period_ns: times.0,
                delay_us: times.1,
                workspace_scale: scale,
                max_force_n: scale * 2.0,
                max_torque_nm: 0.0,
                friction_n: scale * 0.1,
                motion_axes: axes + 3,
                force_axes: axes,
                torque_axes: 3 - axes,
                coupling: coupling.map(|(n_per_m, nm_per_rad)| DeviceCoupling {
                    n_per_m,
                    nm_per_rad,
                }),
            },
        )
}

fn role() -> impl Strategy<Value = Role> {
    prop::sample::select(Role::ALL.to_vec())
}

fn instruction() -> impl Strategy<Value = Instruction> {
    prop_oneof![
        Just(Instruction::Pause),
        Just(Instruction::Resume),
        (-1e3f32..1e3).prop_map(Instruction::ForceLimit),
        ".{0,40}".prop_map(Instruction::Note),
        ".{0,40}".prop_map(Instruction::Flag),
        ".{0,40}".prop_map(Instruction::Say),
        Just(Instruction::End),
        ".{0,40}".prop_map(Instruction::Plan),
        ".{0,40}".prop_map(Instruction::Ghost),
    ]
}

fn client() -> impl Strategy<Value = ClientMessage> {
    prop_oneof![
        (
            prop::array::uniform5(".{0,40}"),
            role(),
            prop::collection::vec(device(), 0..3),
            any::<(u32, u64, u64)>()
        )
            .prop_map(
                |([program, token, station, learner, exercise], role, devices, numbers)| {
                    let (epoch, capabilities, self_test) = numbers;
                    ClientMessage::Hello(ClientHello {
                        program,
                        token,
                        role,
                        station,
                        devices,
                        learner,
                        exercise,
                        epoch,
                        capabilities,
                        self_test,
                        tick_at_hand: epoch % 2 == 0,
                        scene_hash: [epoch as u8; 32],
                    })
                }
            ),
        Just(ClientMessage::Start),
        Just(ClientMessage::Stop),
        Just(ClientMessage::Watch),
        Just(ClientMessage::Command(Command::Pause)),
        Just(ClientMessage::Command(Command::Resume)),
        (-1e3f32..1e3).prop_map(|force| ClientMessage::Command(Command::ForceLimit(force))),
        (any::<u8>(), any::<u8>(), any::<bool>(), any::<u64>()).prop_map(
            |(tool, button, pressed, device_time_ns)| {
                ClientMessage::Button(ButtonEdge {
                    tool,
                    button,
                    pressed,
                    device_time_ns,
                })
            }
        ),
        (any::<u64>(), ".{0,20}", ".{0,200}")
            .prop_map(|(tick, kind, json)| ClientMessage::Event(Event { tick, kind, json })),
        (
            any::<u64>(),
            any::<u64>(),
            prop::collection::vec(any::<u8>(), 0..200)
        )
            .prop_map(
                |(first_tick, hash, rows)| ClientMessage::Inputs(InputBatch {
                    first_tick,
                    hash,
                    commands: hash as u32,
                    rows
                })
            ),
        (any::<u64>(), any::<u64>())
            .prop_map(|(tick, hash)| ClientMessage::LastTick(LastTick { tick, hash })),
        any::<[u8; 32]>().prop_map(|hash| {
            let known = vec![SceneHash(hash)];
            ClientMessage::Show(Show { known })
        }),
        (any::<u64>(), ".{0,20}", instruction()).prop_map(|(number, station, instruction)| {
            ClientMessage::Instruct(Instruct {
                number,
                station,
                instruction,
            })
        }),
    ]
}

fn status() -> impl Strategy<Value = StationStatus> {
    (
        prop::array::uniform4(".{0,20}"),
        any::<(u32, u64, bool)>(),
        0.0f32..9.0,
    )
        .prop_map(|([station, learner, recording, site], numbers, force)| {
            let mut status = StationStatus {
                station,
                phase: Phase::Waiting,
                learner,
                recording,
                gaps: numbers.0,
                tick: numbers.1,
                paused: numbers.2,
                force_limit_n: force,
                ..StationStatus::default()
            };
            status.tools[1].site = site;
            status.tools[0].peak_force_n = force;
            status
        })
}

fn server() -> impl Strategy<Value = ServerMessage> {
    prop_oneof![
        (
            prop::array::uniform5(".{0,40}"),
            any::<(u32, u64, bool)>(),
            any::<[u8; 32]>(),
            prop::collection::vec(tool(), 0..3)
        )
            .prop_map(
                |(
                    [program, station, scene, exercise, exercise_text],
                    numbers,
                    scene_hash,
                    tools,
                )| {
                    let (epoch, self_test, resumed) = numbers;
                    ServerMessage::Hello(ServerHello {
                        program,
                        station,
                        epoch,
                        resumed,
                        plan: PlanInfo {
                            revision: epoch,
                            mode: "exam".into(),
                            resume_within_ms: 30_000,
                            ..PlanInfo::default()
                        },
                        capabilities: 0,
                        self_test,
                        tick_ns: 1_000_000,
                        scene,
                        scene_hash,
                        exercise,
                        exercise_text,
                        max_force_n: 3.3,
                        max_torque_nm: 0.2,
                        max_force_step_n: 0.5,
                        max_torque_step_nm: 0.03,
                        tools,
                    })
                }
            ),
        ".{0,80}".prop_map(|text| ServerMessage::Refused(Refused {
            reason: RefusedReason::Busy,
            text
        })),
        any::<u32>().prop_map(ServerMessage::Epoch),
        (".{0,80}", any::<u64>()).prop_map(|(text, ticks)| {
            let summary = SessionSummary {
                ticks,
                ..SessionSummary::empty(EndReason::Stopped)
            };
            ServerMessage::Goodbye(Goodbye { text, summary })
        }),
        (
            ".{0,20}",
            ".{0,20}",
            role(),
            prop::collection::vec(".{0,9}", 0..5)
        )
            .prop_map(
                |(program, id, role, stations)| ServerMessage::Welcome(Welcome {
                    program,
                    role,
                    id,
                    stations
                })
            ),
        (".{0,20}", ".{0,80}").prop_map(|(by, text)| ServerMessage::Say(Say { by, text })),
        (any::<(u64, bool, u64)>(), ".{0,40}").prop_map(|((number, taken, tick), text)| {
            ServerMessage::Answer(Answer {
                number,
                taken,
                tick,
                text,
            })
        }),
        status().prop_map(ServerMessage::Status),
        (".{0,20}", any::<u64>(), ".{0,80}").prop_map(|(station, tick, text)| {
            ServerMessage::Event(StationEvent {
                station,
                tick,
                text,
            })
        }),
        (0usize..40, any::<bool>(), -1.0f32..1.0).prop_map(|(count, has_second, at)| {
            let pose = Some(WirePose {
                position: [at; 3],
                ..WirePose::IDENTITY
            });
            let moment = [pose, pose.filter(|_| has_second)];
            ServerMessage::Ghost(ghost::parts(&vec![moment; count], [[at; 3]; 2]).remove(0))
        }),
    ]
}

fn body(bytes: &[u8]) -> &[u8] {
    let length: [u8; LENGTH_BYTES] = bytes[..LENGTH_BYTES].try_into().expect("four bytes");
    let body = &bytes[LENGTH_BYTES..];
    assert_eq!(body_length(length), Ok(body.len()));
    body
}

#[test]
fn another_version_is_named() {
    let mut bytes = encode(&ClientMessage::Start).expect("encodes");
    let found = sulcus_proto::PROTOCOL_VERSION + 1;
    bytes[LENGTH_BYTES] = found;
    assert_eq!(
        decode::<ClientMessage>(body(&bytes)),
        Err(CodecError::Version { found })
    );
}

/// Bytes of a refusal since protocol version 6. A change of them would hide the sentence from older clients.
#[test]
fn a_refusal_of_another_version_has_the_same_bytes_in_every_release() {
    let refused = Refused {
        reason: RefusedReason::Version,
        text: "no".into(),
    };
    let found = frame::refusal(6, &refused).expect("encodes");
    let mut expected = vec![19, 0, 0, 0, 6];
    // Kind of the message, reason, length of the text, text.
    expected.extend([1, 0, 0, 0]);
    expected.extend([0, 0, 0, 0]);
    expected.extend([2, 0, 0, 0, 0, 0, 0, 0]);
    expected.extend(b"no");
    assert_eq!(found, expected);
}

#[test]
fn lengths_are_checked_before_anything_is_read() {
    assert!(matches!(
        body_length([0; 4]),
        Err(CodecError::Length { .. })
    ));
    assert!(matches!(
        body_length([255; 4]),
        Err(CodecError::TooLong {
            limit: CONTROL_BYTES,
            ..
        })
    ));
    let event = Event {
        tick: 0,
        kind: String::new(),
        json: "x".repeat(CONTROL_BYTES),
    };
    assert!(matches!(
        encode(&ClientMessage::Event(event)),
        Err(CodecError::TooLong { .. })
    ));
    assert!(matches!(
        decode::<ClientMessage>(&[]),
        Err(CodecError::Length { .. })
    ));
}

#[test]
fn a_message_of_the_other_side_or_with_a_tail_is_refused() {
    let mut bytes = encode(&ClientMessage::Stop).expect("encodes");
    assert!(decode::<ServerMessage>(body(&bytes)).is_err());
    bytes.push(0);
    assert!(matches!(
        decode::<ClientMessage>(&bytes[LENGTH_BYTES..]),
        Err(CodecError::Malformed(_))
    ));
}

/// Hello with these devices.
fn hello(devices: Vec<DeviceInfo>) -> ClientMessage {
    ClientMessage::Hello(ClientHello {
        program: "0".into(),
        token: String::new(),
        role: Role::Student,
        station: String::new(),
        devices,
        learner: String::new(),
        exercise: String::new(),
        epoch: 0,
        capabilities: 0,
        self_test: 0,
        tick_at_hand: false,
        scene_hash: [0; 32],
    })
}

#[test]
fn a_third_device_is_neither_written_nor_read() {
    let device = DeviceInfo::named("d");
    let error = encode(&hello(vec![device.clone(); 3])).expect_err("refused");
    assert!(error.to_string().contains("list has 3 entries"), "{error}");
    // The same hello by a program that writes three: one entry is put in, and the count is raised.
    let two = encode(&hello(vec![device.clone(); 2])).expect("encodes");
    let one = encode(&hello(vec![device])).expect("encodes");
    let entry = two.len() - one.len();
    let differs = |k: &usize| two[LENGTH_BYTES + *k] != one[LENGTH_BYTES + *k];
    let count = (0..one.len() - LENGTH_BYTES)
        .find(differs)
        .expect("a count");
    let mut bytes = body(&two).to_vec();
    assert_eq!(bytes[count], 2);
    let first = count + 8;
    let added = bytes[first..first + entry].to_vec();
    bytes.splice(first..first, added);
    bytes[count] = 3;
    let error = decode::<ClientMessage>(&bytes).expect_err("refused");
    assert!(error.to_string().contains("at most 2 entries"), "{error}");
    // A count beyond the bytes is refused for the same reason, before any entry is read.
    bytes[count..first].copy_from_slice(&u64::MAX.to_le_bytes());
    assert!(decode::<ClientMessage>(&bytes).is_err());
}

proptest! {
    #[test]
    fn devices_of_the_strategy_are_valid(device in device()) {
        prop_assert_eq!(device.validate(), Ok(()));
    }

    #[test]
    fn client_messages_survive(message in client()) {
        prop_assert_eq!(decode::<ClientMessage>(body(&encode(&message).expect("encodes"))), Ok(message));
    }

    #[test]
    fn server_messages_survive(message in server()) {
        prop_assert_eq!(decode::<ServerMessage>(body(&encode(&message).expect("encodes"))), Ok(message));
    }

    #[test]
    fn any_bytes_are_a_message_or_an_error(mut bytes in prop::collection::vec(any::<u8>(), 0..300), small in 0u8..8) {
        let _ = decode::<ClientMessage>(&bytes);
        // Most random bytes fail at the version or the variant: set both to valid values.
        if bytes.len() > 5 {
            bytes[..5].copy_from_slice(&[sulcus_proto::PROTOCOL_VERSION, small, 0, 0, 0]);
        }
        if let Ok(message) = decode::<ClientMessage>(&bytes) {
            let again = frame::encode(&message).expect("encodes");
            prop_assert_eq!(body(&again), &bytes[..]);
        }
        let _ = decode::<ServerMessage>(&bytes);
    }
}
