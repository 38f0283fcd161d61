//! First message of a connection: version, names, token, role, station. Each role has its own connection from there.

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use quinn::{Connection, SendStream};
use sulcus_link::control::{ReadError, read, reader};
use sulcus_proto::control::{ClientHello, DeviceInfo, Refused, RefusedReason};
use sulcus_proto::limits::{HELLO, NAME_BYTES};
use sulcus_proto::station::Phase;
use sulcus_proto::{ClientMessage, CodecError, Role, ServerMessage, frame, learner};

use super::codes::Coming;
use super::tokens::{Denied, Grant, Place};
use super::{CLOSE_REFUSED, Net, close_after_last_word, codes, control, instructor, student};
use crate::station::at_hand::Wish;
use crate::station::door::{Door, Student, other_version};

/// Delay before a wrong token is refused. The delay slows guesses down.
const WRONG_TOKEN: Duration = Duration::from_millis(200);

/// A connection that may go on.
struct Admitted {
    hello: ClientHello,
    grant: Grant,
    /// Station of a student or a display; `None` for an instructor.
    door: Option<Door>,
}

/// Reads the hello of a connection, then serves its role or refuses the client. A connection without a hello within
/// [`HELLO`] is closed.
pub(super) async fn admit(connection: Connection, net: Arc<Net>) {
    let from = connection.remote_address();
    let streams = tokio::time::timeout(HELLO, async {
        let (send, mut recv) = connection
            .accept_bi()
            .await
            .map_err(|error| ReadError::Closed(error.to_string()))?;
        let message = read(&mut recv).await;
        Ok::<_, ReadError>((send, recv, message))
    });
    let mut stage = net.shared.stage.clone();
    let streams = tokio::select! {
        streams = streams => streams,
        // A server that ends does not wait for a hello.
        _ = stage.changed() => return connection.close(CLOSE_REFUSED, b"server stopped"),
    };
    let Ok(Ok((mut send, recv, message))) = streams else {
        tracing::info!("{from} sent no hello");
        connection.close(CLOSE_REFUSED, b"no hello");
        return;
    };
    if let Err(ReadError::Codec(CodecError::Version { found })) = &message {
        return refuse_version(&connection, &mut send, *found, &net).await;
    }
    let Admitted { hello, grant, door } = match judge(message, &net, from.ip()).await {
        Ok(admitted) => admitted,
        Err(refused) => return refuse(&connection, &mut send, refused).await,
    };
    tracing::info!(
        "{from} joins as {} with token {}, device `{}`, client {}",
        hello.role,
        clean(&grant.id),
        clean(&names_of(&hello.devices)),
        clean(&hello.program)
    );
    if hello.self_test != 0 && hello.self_test != net.self_test {
        tracing::warn!(
            "{from}: the tick of this client gives other bits than that of the server; it cannot tick at the hand"
        );
    }
    match door {
        Some(door) if hello.role == Role::Display => {
            super::display::serve(connection, send, reader(recv), grant, door, net).await;
        }
        Some(door) => {
            let wish = Wish::of(&hello, net.self_test);
            let student = Student {
                learner: if hello.learner.is_empty() {
                    grant.learner.clone()
                } else {
                    hello.learner
                },
                grant,
                program: hello.program,
                devices: hello.devices,
                exercise: hello.exercise,
                follows: hello.epoch,
                wish,
            };
            student::serve(connection, send, reader(recv), student, door, net).await;
        }
        None => instructor::serve(connection, send, reader(recv), hello.role, grant, net).await,
    }
}

/// Checks the first message. The error is the refusal to send.
async fn judge(
    message: Result<ClientMessage, ReadError>,
    net: &Net,
    from: IpAddr,
) -> Result<Admitted, Refused> {
    let mut hello = match message {
        Ok(ClientMessage::Hello(hello)) => hello,
        Ok(_) => {
            let text = "the first message must be a hello";
            return refused(RefusedReason::BadHello, text);
        }
        Err(error) => {
            let text = format!("the hello cannot be read: {error}");
            return refused(RefusedReason::BadHello, &text);
        }
    };
    let names = [
        &hello.program,
        &hello.token,
        &hello.learner,
        &hello.exercise,
        &hello.station,
    ];
    if names.iter().any(|name| name.len() > NAME_BYTES) {
        let text = format!("a name in the hello is longer than {NAME_BYTES} bytes");
        return refused(RefusedReason::BadHello, &text);
    }
    if let Err(expected) = learner::parse(&hello.learner) {
        let text = format!("learner `{}`: {expected}", clean(&hello.learner));
        return refused(RefusedReason::BadHello, &text);
    }
    for (slot, device) in hello.devices.iter().enumerate() {
        if let Err(text) = device.validate() {
            let text = format!("device of tool {slot}: {text}");
            return refused(RefusedReason::BadHello, &text);
        }
    }
    let grant = match net.shared.grant(&hello.token) {
        Ok(grant) => grant,
        Err(denied) => {
            tokio::time::sleep(WRONG_TOKEN).await;
            let reason = match denied {
                Denied::Unknown => RefusedReason::Token,
                Denied::Revoked { .. } | Denied::Expired { .. } => RefusedReason::Expired,
                Denied::Unreadable => RefusedReason::Server,
            };
            return refused(reason, &denied.to_string());
        }
    };
    if !grant.role.may_act_as(hello.role) {
        let text = format!(
            "this token has the role {}, the connection asks for {}",
            grant.role, hello.role
        );
        return refused(RefusedReason::Role, &text);
    }
    // A code stands in the place of the id. A client that returns to its session needs none: its token is enough.
    let code = learner::code_of(&hello.learner).map(str::to_owned);
    if code.is_some() {
        hello.learner.clear();
    }
    if !grant.learner.is_empty() && !hello.learner.is_empty() && grant.learner != hello.learner {
        let text = format!(
            "this token belongs to learner {}, the client names {}",
            clean(&grant.learner),
            clean(&hello.learner)
        );
        return refused(RefusedReason::Role, &text);
    }
    let door = match hello.role {
        Role::Student | Role::Display => Some(station(&hello, &grant, net)?),
        Role::Instructor | Role::Examiner | Role::Admin => None,
    };
    if let (Some(code), Some(door), Role::Student) = (&code, &door, hello.role)
        && (hello.epoch == 0 || door.status().phase == Phase::Free)
    {
        let coming = Coming {
            code,
            from,
            own: &grant.learner,
        };
        let shared = &net.shared;
        let seated = codes::seat(coming, &shared.config.codes, &shared.wrong_codes, door);
        hello.learner = seated.await?;
    }
    Ok(Admitted { hello, grant, door })
}

/// Station that a hello names, or that the token names.
fn station(hello: &ClientHello, grant: &Grant, net: &Net) -> Result<Door, Refused> {
    let asked = match &grant.station {
        _ if !hello.station.is_empty() => Some(hello.station.as_str()),
        Place::Station(name) => Some(name.as_str()),
        Place::Any => None,
    };
    let found = match asked {
        Some(name) if !grant.station.includes(name) => {
            let text = format!("this token is not valid at station `{}`", clean(name));
            return refused(RefusedReason::Role, &text);
        }
        Some(name) => net.doors.iter().find(|door| &*door.name == name),
        // A token for every station, and a server with one.
        None => net.doors.first().filter(|_| net.doors.len() == 1),
    };
    match found {
        Some(door) => Ok(door.clone()),
        None => {
            let names: Vec<&str> = net.doors.iter().map(|door| &*door.name).collect();
            let text = format!(
                "station `{}` does not exist; this server has {}",
                clean(asked.unwrap_or_default()),
                names.join(", ")
            );
            refused(RefusedReason::Role, &text)
        }
    }
}

fn refused<T>(reason: RefusedReason, text: &str) -> Result<T, Refused> {
    Err(Refused {
        reason,
        text: text.to_owned(),
    })
}

/// Sends a refusal and closes the connection.
pub(super) async fn refuse(connection: &Connection, send: &mut SendStream, refused: Refused) {
    tracing::info!("{} refused: {}", connection.remote_address(), refused.text);
    let frame = frame::encode(&ServerMessage::Refused(refused));
    last(connection, send, frame).await;
}

/// Refuses a client of another release, in the version that the client reads, and says where the right one lies.
async fn refuse_version(connection: &Connection, send: &mut SendStream, found: u8, net: &Net) {
    let clients = net.clients.get().map(|console| {
        // A console on every address is reached by the address that the client has found.
        let own = Some(console.ip()).filter(|ip| !ip.is_unspecified());
        let own = own.or(connection.local_ip().map(|ip| ip.to_canonical()));
        SocketAddr::new(own.unwrap_or(console.ip()), console.port())
    });
    let refused = Refused {
        reason: RefusedReason::Version,
        text: other_version(found, clients),
    };
    tracing::info!("{} refused: {}", connection.remote_address(), refused.text);
    last(connection, send, frame::refusal(found, &refused)).await;
}

/// Sends the last message of a refused client and closes the connection.
async fn last(connection: &Connection, send: &mut SendStream, frame: Result<Vec<u8>, CodecError>) {
    if control::write_frame(send, frame).await && send.finish().is_ok() {
        close_after_last_word(connection, CLOSE_REFUSED, b"refused").await;
    }
    connection.close(CLOSE_REFUSED, b"refused");
}

/// Names of a client's devices, for log lines and recordings: each name once.
pub(crate) fn names_of(devices: &[DeviceInfo]) -> String {
    let mut names: Vec<&str> = devices.iter().map(|device| &*device.name).collect();
    names.dedup();
    names.join(" and ")
}

/// Text of a client for a log line or a message: at most 64 characters, without control characters.
pub(crate) fn clean(text: &str) -> String {
    printable(text, 64)
}

/// Text that may hold words of a peer, without control characters, at most `most` characters long.
pub(super) fn printable(text: &str, most: usize) -> String {
    let plain = text.chars().filter(|c| !c.is_control());
    plain.take(most).collect()
}
