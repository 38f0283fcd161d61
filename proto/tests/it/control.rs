//! Tests of control frames: round trips of every message, strict refusals, no panic on any bytes.

use proptest::prelude::*;
use sulcus_proto::control::{
    ButtonEdge, ClientHello, Command, EndReason, Event, Goodbye, Refused, RefusedReason,
    ServerHello, ToolInfo,
};
use sulcus_proto::datagram::WirePose;
use sulcus_proto::frame::{self, LENGTH_BYTES, body_length, decode, encode};
use sulcus_proto::limits::CONTROL_BYTES;
use sulcus_proto::{ClientMessage, CodecError, ServerMessage, SessionSummary};

fn tool() -> impl Strategy<Value = ToolInfo> {
    (".{0,30}", -1.0f32..1.0, 1.0f32..1e4).prop_map(|(name, at, stiffness)| ToolInfo {
        name,
        park: WirePose {
            position: [at; 3],
            ..WirePose::IDENTITY
        },
        tip: [at; 3],
        stiffness_n_per_m: stiffness,
        stiffness_nm_per_rad: at,
    })
}

fn client() -> impl Strategy<Value = ClientMessage> {
    prop_oneof![
        prop::array::uniform5(".{0,40}").prop_map(|[program, token, device, learner, exercise]| {
            ClientMessage::Hello(ClientHello {
                program,
                token,
                device,
                learner,
                exercise,
            })
        }),
        Just(ClientMessage::Start),
        Just(ClientMessage::Stop),
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
    ]
}

fn server() -> impl Strategy<Value = ServerMessage> {
    prop_oneof![
        (
            prop::array::uniform4(".{0,40}"),
            any::<u32>(),
            any::<[u8; 32]>(),
            prop::collection::vec(tool(), 0..3)
        )
            .prop_map(
                |([program, scene, exercise, exercise_text], epoch, scene_hash, tools)| {
                    ServerMessage::Hello(ServerHello {
                        program,
                        epoch,
                        tick_ns: 1_000_000,
                        scene,
                        scene_hash,
                        exercise,
                        exercise_text,
                        seed: u64::from(epoch) << 20,
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
    bytes[LENGTH_BYTES] = 7;
    assert_eq!(
        decode::<ClientMessage>(body(&bytes)),
        Err(CodecError::Version { found: 7 })
    );
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

proptest! {
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
