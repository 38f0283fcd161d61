//! Handshake: from a connection to the server's hello, or to an error of one sentence.

use std::sync::OnceLock;
use std::time::Duration;

use quinn::{Connection, ConnectionError, Endpoint, RecvStream, SendStream};
use sulcus_proto::control::{ClientHello, Refused, RefusedReason, ServerHello, capability};
use sulcus_proto::{ClientMessage, CodecError, Role, ServerMessage};

use super::{LinkConfig, LinkError, control, reach};
use crate::at_hand::{FAR, TickPlace};

/// Valid periods of the server's tick, nanoseconds. The device's loop runs at this period.
const TICKS_NS: std::ops::RangeInclusive<u64> = 100_000..=10_000_000;

/// A connection with the hello of its server.
pub(super) struct Welcome {
    pub endpoint: Endpoint,
    pub connection: Connection,
    pub send: SendStream,
    pub recv: RecvStream,
    pub hello: ServerHello,
}

/// Hash of the tick self-test, computed once in a process.
fn self_test() -> u64 {
    static HASH: OnceLock<u64> = OnceLock::new();
    *HASH.get_or_init(sulcus_core::self_test)
}

/// First message of a client on a path with the round trip `rtt`.
pub(crate) fn client_hello(config: &LinkConfig, rtt: Duration) -> ClientMessage {
    let tick_at_hand = match config.tick {
        _ if config.role != Role::Student => false,
        TickPlace::Server => false,
        TickPlace::Hand => true,
        TickPlace::Auto => config.scene_hash != [0; 32] && rtt > FAR,
    };
    ClientMessage::Hello(ClientHello {
        program: env!("CARGO_PKG_VERSION").to_owned(),
        token: config.token.clone(),
        role: config.role,
        station: config.station.clone(),
        devices: config.devices.clone(),
        learner: config.learner.clone(),
        exercise: config.exercise.clone(),
        epoch: config.follows,
        capabilities: capability::SHOWS_MESSAGES | capability::TICK_AT_HAND,
        self_test: self_test(),
        tick_at_hand,
        scene_hash: config.scene_hash,
    })
}

/// Connects, sends the hello and waits for the answer, at most `config.timeout`.
pub(super) async fn shake(config: &LinkConfig) -> Result<Welcome, LinkError> {
    let (endpoint, connection) = reach::reach(config).await?;
    let absent = LinkError::Absent {
        server: connection.remote_address(),
    };
    tokio::time::timeout(config.timeout, greet(config, endpoint, connection))
        .await
        .unwrap_or(Err(absent))
}

/// Sends the client's hello, then reads and checks the answer.
async fn greet(
    config: &LinkConfig,
    endpoint: Endpoint,
    connection: Connection,
) -> Result<Welcome, LinkError> {
    let lost = |error: ConnectionError| LinkError::lost(&error);
    let (mut send, mut recv) = connection.open_bi().await.map_err(lost)?;
    let mut rtt = connection.rtt();
    if config.tick == TickPlace::Auto && config.scene_hash != [0; 32] && rtt > FAR {
        rtt = super::path::least_rtt(&connection).await?;
    }
    let hello = client_hello(config, rtt);
    control::write(&mut send, &hello).await?;
    match sulcus_link::control::read(&mut recv)
        .await
        .map_err(LinkError::from)
    {
        Ok(ServerMessage::Hello(hello)) if !TICKS_NS.contains(&hello.tick_ns) => {
            Err(CodecError::NotCanonical("tick_ns of the hello is outside 0.1 to 10 ms").into())
        }
        Ok(ServerMessage::Hello(hello)) => {
            limited(&hello)?;
            Ok(Welcome {
                endpoint,
                connection,
                send,
                recv,
                hello,
            })
        }
        Ok(ServerMessage::Refused(refused)) => Err(turned_away(refused)),
        Ok(_) => {
            Err(CodecError::NotCanonical("the first message is neither hello nor refusal").into())
        }
        Err(LinkError::Protocol(CodecError::Version { found })) => Err(LinkError::Version(
            format!("the server has {found}; install the same release of client and server"),
        )),
        Err(error) => Err(error),
    }
}

/// Checks the limits of the wrench, which the device's loop applies: each must be finite and above zero.
fn limited(hello: &ServerHello) -> Result<(), LinkError> {
    let limits = [
        ("max_force_n", hello.max_force_n),
        ("max_torque_nm", hello.max_torque_nm),
        ("max_force_step_n", hello.max_force_step_n),
        ("max_torque_step_nm", hello.max_torque_step_nm),
    ];
    for (field, found) in limits {
        if !found.is_finite() || found <= 0.0 {
            return Err(LinkError::BadHello {
                field,
                found: found.to_string(),
                expected: "a finite number above 0",
            });
        }
    }
    Ok(())
}

/// Error for a refusal.
pub(crate) fn turned_away(Refused { reason, text }: Refused) -> LinkError {
    match reason {
        RefusedReason::Version => LinkError::Version(text),
        RefusedReason::Token | RefusedReason::Expired => LinkError::WrongToken(text),
        RefusedReason::Busy => LinkError::Busy(text),
        RefusedReason::Exercise
        | RefusedReason::BadHello
        | RefusedReason::Role
        | RefusedReason::Full
        | RefusedReason::Server
        | RefusedReason::Device => LinkError::Refused(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hello_without_limits_is_refused_by_field_and_value() {
        let hello = |[force, torque, force_step, torque_step]: [f32; 4]| ServerHello {
            program: String::new(),
            station: String::new(),
            epoch: 1,
            resumed: false,
            plan: Default::default(),
            capabilities: 0,
            self_test: 0,
            tick_ns: 1_000_000,
            scene: String::new(),
            scene_hash: [0; 32],
            exercise: String::new(),
            exercise_text: String::new(),
            max_force_n: force,
            max_torque_nm: torque,
            max_force_step_n: force_step,
            max_torque_step_nm: torque_step,
            tools: Vec::new(),
        };
        let good = [3.3, 0.2, 0.5, 0.03];
        assert_eq!(limited(&hello(good)), Ok(()));
        let fields = [
            "max_force_n",
            "max_torque_nm",
            "max_force_step_n",
            "max_torque_step_nm",
        ];
        for (at, field) in fields.into_iter().enumerate() {
            for (value, said) in [
                (f32::NAN, "NaN"),
                (f32::INFINITY, "inf"),
                (0.0, "0"),
                (-1.0, "-1"),
            ] {
                let mut limits = good;
                limits[at] = value;
                let error = limited(&hello(limits)).expect_err("refused");
                let expected = format!(
                    "the server's hello has {field} {said}, expected a finite number above 0"
                );
                assert_eq!(error.to_string(), expected);
            }
        }
    }
}
