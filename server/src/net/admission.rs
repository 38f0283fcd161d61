//! Admission of a client: hello, version, names, token, exercise, and a free station.

use std::sync::Arc;
use std::time::Duration;

use quinn::{Connection, RecvStream, SendStream};
use sulcus_link::control::{ReadError, read, reader};
use sulcus_proto::control::{ClientHello, Refused, RefusedReason, ServerHello, ToolInfo};
use sulcus_proto::datagram::WirePose;
use sulcus_proto::limits::{HELLO, NAME_BYTES};
use sulcus_proto::{ClientMessage, CodecError, PROTOCOL_VERSION, ServerMessage, learner};

use super::control;
use super::{CLOSE_REFUSED, Shared, close_after_last_word, session};
use crate::Exercise;

/// Delay before a wrong token is refused. The delay slows guesses down.
const WRONG_TOKEN: Duration = Duration::from_millis(200);

/// Reads the hello of a connection, then runs its session or refuses the client. A connection without a hello within
/// [`HELLO`] is closed.
pub(super) async fn admit(connection: Connection, shared: Arc<Shared>) {
    let from = connection.remote_address();
    let streams = tokio::time::timeout(HELLO, async {
        let (send, mut recv) = connection
            .accept_bi()
            .await
            .map_err(|error| ReadError::Closed(error.to_string()))?;
        let message = read(&mut recv).await;
        Ok::<_, ReadError>((send, recv, message))
    });
    let mut phase = shared.phase.clone();
    let streams = tokio::select! {
        streams = streams => streams,
        // A server that ends does not wait for a hello.
        _ = phase.changed() => return connection.close(CLOSE_REFUSED, b"server stopped"),
    };
    let Ok(Ok((mut send, recv, message))) = streams else {
        tracing::info!("{from} sent no hello");
        connection.close(CLOSE_REFUSED, b"no hello");
        return;
    };
    let hello = match judge(message, &shared).await {
        Ok(hello) => hello,
        Err(refused) => return refuse(&connection, &mut send, refused).await,
    };
    let Ok(mut station) = shared.station.clone().try_lock_owned() else {
        let text = "this station is in use by another client; wait until its session ends";
        return refuse(&connection, &mut send, refused(RefusedReason::Busy, text)).await;
    };
    tracing::info!(
        "{from} joins with device `{}`, client {}",
        clean(&hello.device),
        clean(&hello.program)
    );
    welcome(connection, send, recv, hello, &shared, &mut station).await;
}

async fn welcome(
    connection: Connection,
    mut send: SendStream,
    recv: RecvStream,
    hello: ClientHello,
    shared: &Arc<Shared>,
    station: &mut super::Station,
) {
    let epoch = station.next_epoch();
    if control::write(
        &mut send,
        &ServerMessage::Hello(server_hello(shared, epoch)),
    )
    .await
    {
        let summary = session::run(connection, send, reader(recv), hello, shared, station).await;
        station.summaries.extend(summary);
    } else {
        connection.close(CLOSE_REFUSED, b"hello not taken");
    }
}

/// Checks the first message. The result is the hello, or the refusal to send.
async fn judge(
    message: Result<ClientMessage, ReadError>,
    shared: &Shared,
) -> Result<ClientHello, Refused> {
    let hello = match message {
        Ok(ClientMessage::Hello(hello)) => hello,
        Ok(_) => {
            return Err(refused(
                RefusedReason::BadHello,
                "the first message must be a hello",
            ));
        }
        Err(ReadError::Codec(CodecError::Version { found })) => {
            let text = format!(
                "this server has protocol version {PROTOCOL_VERSION}, the client {found}; \
                 install the same release on both"
            );
            return Err(refused(RefusedReason::Version, &text));
        }
        Err(error) => {
            return Err(refused(
                RefusedReason::BadHello,
                &format!("the hello cannot be read: {error}"),
            ));
        }
    };
    let names = [
        &hello.program,
        &hello.token,
        &hello.device,
        &hello.learner,
        &hello.exercise,
    ];
    if names.iter().any(|name| name.len() > NAME_BYTES) {
        let text = format!("a name in the hello is longer than {NAME_BYTES} bytes");
        return Err(refused(RefusedReason::BadHello, &text));
    }
    if let Err(expected) = learner::parse(&hello.learner) {
        let text = format!("learner `{}`: {expected}", clean(&hello.learner));
        return Err(refused(RefusedReason::BadHello, &text));
    }
    // Hashes compare in constant time; strings do not.
    if blake3::hash(hello.token.as_bytes()) != blake3::hash(shared.config.token.as_bytes()) {
        tokio::time::sleep(WRONG_TOKEN).await;
        return Err(refused(
            RefusedReason::Token,
            "the token is wrong; use the one that the server printed",
        ));
    }
    // A station with free exploration accepts every exercise.
    let offered = &shared.config.exercise.name;
    let free = *offered == Exercise::default().name;
    if !hello.exercise.is_empty() && !free && &hello.exercise != offered {
        let text = format!(
            "exercise `{}` is not offered here; this station offers `{offered}`",
            clean(&hello.exercise)
        );
        return Err(refused(RefusedReason::Exercise, &text));
    }
    Ok(hello)
}

fn refused(reason: RefusedReason, text: &str) -> Refused {
    Refused {
        reason,
        text: text.to_owned(),
    }
}

async fn refuse(connection: &Connection, send: &mut SendStream, refused: Refused) {
    tracing::info!("{} refused: {}", connection.remote_address(), refused.text);
    if control::write(send, &ServerMessage::Refused(refused)).await && send.finish().is_ok() {
        close_after_last_word(connection, CLOSE_REFUSED, b"refused").await;
    }
    connection.close(CLOSE_REFUSED, b"refused");
}

fn server_hello(shared: &Shared, epoch: u32) -> ServerHello {
    let config = &shared.config;
    let scene = &config.scene;
    let tools = scene.tools.iter().map(|tool| {
        let (p, q) = (&tool.park.position, &tool.park.orientation);
        ToolInfo {
            name: tool.name.clone(),
            park: WirePose {
                position: [p.x as f32, p.y as f32, p.z as f32],
                orientation: [q.w as f32, q.i as f32, q.j as f32, q.k as f32],
            },
            tip: [tool.tip.x as f32, tool.tip.y as f32, tool.tip.z as f32],
            stiffness_n_per_m: tool.stiffness_n_per_m as f32,
            stiffness_nm_per_rad: tool.stiffness_nm_per_rad as f32,
        }
    });
    ServerHello {
        program: env!("CARGO_PKG_VERSION").to_owned(),
        epoch,
        tick_ns: scene.params.tick_ns(),
        scene: scene.name.clone(),
        scene_hash: shared.scene_hash,
        exercise: config.exercise.name.clone(),
        exercise_text: config.exercise.text.clone(),
        seed: config.exercise.seed,
        max_force_n: scene.params.max_force as f32,
        max_torque_nm: scene.params.max_torque as f32,
        max_force_step_n: scene.params.max_force_step as f32,
        max_torque_step_nm: scene.params.max_torque_step as f32,
        tools: tools.collect(),
    }
}

/// Text of a client for a log line or a message: at most 64 characters, without control characters.
fn clean(text: &str) -> String {
    printable(text, 64)
}

/// Text that may hold words of a peer, without control characters, at most `most` characters long.
pub(super) fn printable(text: &str, most: usize) -> String {
    let plain = text.chars().filter(|c| !c.is_control());
    plain.take(most).collect()
}
