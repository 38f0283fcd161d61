//! From an address to a server's hello, or to the sentence that says why not.

use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use quinn::{Connection, ConnectionError, Endpoint, RecvStream, SendStream, TransportErrorCode};
use sulcus_proto::control::{ClientHello, Refused, RefusedReason, ServerHello};
use sulcus_proto::{ClientMessage, CodecError, ServerMessage};

use super::{LinkConfig, LinkError, control, transport};

/// TLS alert `no_application_protocol`: the server offers another ALPN.
const NO_APPLICATION_PROTOCOL: u8 = 120;

/// Periods that a device can be asked to keep, nanoseconds.
const TICKS_NS: std::ops::RangeInclusive<u64> = 100_000..=10_000_000;

/// A connection whose server has said hello.
pub(super) struct Welcome {
    pub endpoint: Endpoint,
    pub connection: Connection,
    pub send: SendStream,
    pub recv: RecvStream,
    pub hello: ServerHello,
}

/// Connects and says hello.
pub(super) async fn shake(config: &LinkConfig) -> Result<Welcome, LinkError> {
    let absent = LinkError::Absent {
        server: config.server,
    };
    tokio::time::timeout(config.timeout, shake_in_time(config))
        .await
        .unwrap_or(Err(absent))
}

async fn shake_in_time(config: &LinkConfig) -> Result<Welcome, LinkError> {
    let mismatch = Arc::new(AtomicBool::new(false));
    let from: SocketAddr = match config.server {
        SocketAddr::V4(_) => (Ipv4Addr::UNSPECIFIED, 0).into(),
        SocketAddr::V6(_) => (Ipv6Addr::UNSPECIFIED, 0).into(),
    };
    let endpoint = Endpoint::client(from)?;
    let client = transport::client_config(config.pin.clone(), mismatch.clone())?;
    let connecting = endpoint
        .connect_with(client, config.server, &config.server_name)
        .map_err(|error| LinkError::System(error.to_string()))?;
    let connection = connecting.await.map_err(|error| {
        if mismatch.load(Ordering::Acquire) {
            return LinkError::WrongCertificate {
                server: config.server,
            };
        }
        explain(error, config.server)
    })?;
    let lost = |error: ConnectionError| LinkError::lost(&error);
    let (mut send, mut recv) = connection.open_bi().await.map_err(lost)?;
    let hello = ClientMessage::Hello(ClientHello {
        program: env!("CARGO_PKG_VERSION").to_owned(),
        token: config.token.clone(),
        device: config.device.clone(),
        learner: config.learner.clone(),
        exercise: config.exercise.clone(),
    });
    control::write(&mut send, &hello).await?;
    match control::read(&mut recv).await {
        Ok(ServerMessage::Hello(hello)) if !TICKS_NS.contains(&hello.tick_ns) => {
            Err(CodecError::NotCanonical("the server's tick is not one of 0.1 to 10 ms").into())
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
        Ok(_) => Err(CodecError::NotCanonical(
            "the server's first message is neither hello nor refusal",
        )
        .into()),
        Err(LinkError::Protocol(CodecError::Version { found })) => Err(LinkError::Version(
            format!("the server speaks {found}; install the same release on both"),
        )),
        Err(error) => Err(error),
    }
}

/// Whether the hello says what will be sent at most: the device displays no more than that.
fn limited(hello: &ServerHello) -> Result<(), LinkError> {
    let limits = [
        ("max_force_n", hello.max_force_n),
        ("max_torque_nm", hello.max_torque_nm),
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

fn turned_away(Refused { reason, text }: Refused) -> LinkError {
    match reason {
        RefusedReason::Version => LinkError::Version(text),
        RefusedReason::Token => LinkError::WrongToken(text),
        RefusedReason::Busy => LinkError::Busy(text),
        RefusedReason::Exercise | RefusedReason::BadHello | RefusedReason::Server => {
            LinkError::Refused(text)
        }
    }
}

fn explain(error: ConnectionError, server: SocketAddr) -> LinkError {
    match error {
        ConnectionError::TimedOut => LinkError::Absent { server },
        ConnectionError::VersionMismatch => {
            LinkError::Version("the server speaks another version of QUIC".into())
        }
        ConnectionError::ConnectionClosed(close)
            if close.error_code == TransportErrorCode::crypto(NO_APPLICATION_PROTOCOL) =>
        {
            LinkError::Version(
                "the server speaks another one; install the same release on both".into(),
            )
        }
        other => LinkError::lost(&other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hello_without_limits_is_refused_by_field_and_value() {
        let hello = |max_force_n, max_torque_nm| ServerHello {
            program: String::new(),
            epoch: 1,
            tick_ns: 1_000_000,
            scene: String::new(),
            scene_hash: [0; 32],
            exercise: String::new(),
            exercise_text: String::new(),
            seed: 0,
            max_force_n,
            max_torque_nm,
            tools: Vec::new(),
        };
        assert_eq!(limited(&hello(3.3, 0.2)), Ok(()));
        for (force, torque, said) in [
            (f32::NAN, 0.2, "max_force_n NaN"),
            (f32::INFINITY, 0.2, "max_force_n inf"),
            (0.0, 0.2, "max_force_n 0"),
            (3.3, -1.0, "max_torque_nm -1"),
        ] {
            let error = limited(&hello(force, torque)).expect_err("refused");
            let expected =
                format!("the server's hello has {said}, expected a finite number above 0");
            assert_eq!(error.to_string(), expected);
        }
    }
}
