//! Connection of a display: scene and frames of one station. A display moves nothing and says nothing.

use std::sync::Arc;
use std::time::Duration;

use quinn::{Connection, SendStream};
use sulcus_link::control::ReadError;
use sulcus_proto::control::{Refused, RefusedReason, Welcome};
use sulcus_proto::limits::HELLO;
use sulcus_proto::permission::{self, Kind, may};
use sulcus_proto::{ClientMessage, Role, ServerMessage};
use tokio::sync::mpsc::Receiver;

use super::feed::serve_feed;
use super::{CLOSE_OK, CLOSE_REFUSED, Net, close_after_last_word, control};
use crate::state::Grant;
use crate::station::door::Door;

/// Largest number of scenes in a display's cache that the server looks at.
const KNOWN: usize = 64;
/// Time for the last frames at the end of the server.
const LAST: Duration = Duration::from_millis(200);

type Messages = Receiver<Result<ClientMessage, ReadError>>;

/// Serves the connection until its end, or the end of the server.
pub(super) async fn serve(
    connection: Connection,
    mut send: SendStream,
    mut messages: Messages,
    grant: Grant,
    door: Door,
    net: Arc<Net>,
) {
    let id = grant.id;
    let welcome = ServerMessage::Welcome(Welcome {
        program: env!("CARGO_PKG_VERSION").to_owned(),
        role: Role::Display,
        id: id.clone(),
        stations: vec![door.name.to_string()],
    });
    if !control::write(&mut send, &welcome).await {
        return connection.close(CLOSE_REFUSED, b"welcome not taken");
    }
    let mut stage = net.shared.stage.clone();
    let show = tokio::select! {
        first = tokio::time::timeout(HELLO, messages.recv()) => first.ok().flatten(),
        _ = stage.changed() => return connection.close(CLOSE_OK, b"server stopped"),
    };
    let mut known = match show {
        Some(Ok(ClientMessage::Show(show))) => show.known,
        Some(Ok(message)) => return drop_with(&connection, send, &refusal(&message)).await,
        Some(Err(_)) | None => return connection.close(CLOSE_REFUSED, b"no subscription"),
    };
    known.truncate(KNOWN);
    let feed = serve_feed(connection.clone(), &known, door.feed());
    tokio::pin!(feed);
    let why = tokio::select! {
        report = &mut feed => {
            tracing::info!("station {}: a display has left: {report:?}", door.name);
            return connection.close(CLOSE_OK, b"end of the feed");
        }
        message = messages.recv() => match message {
            Some(Ok(message)) => refusal(&message),
            Some(Err(ReadError::Codec(error))) => format!("a message cannot be read: {error}"),
            Some(Err(ReadError::Closed(_))) | None => return connection.close(CLOSE_OK, b"bye"),
        },
        datagram = connection.read_datagram() => match datagram {
            Ok(_) => "the role display may not send datagrams".to_owned(),
            Err(_) => return,
        },
        why = net.shared.revoked(&id) => why,
        _ = stage.changed() => {
            tokio::time::sleep(LAST).await;
            return connection.close(CLOSE_OK, b"server stopped");
        }
    };
    drop_with(&connection, send, &why).await;
}

/// Sentence about a message that a display may not send, or not now.
fn refusal(message: &ClientMessage) -> String {
    match permission::kind(message) {
        Some(kind) if !may(Role::Display, kind, true) => {
            format!("the role display may not send a message of kind {kind:?}")
        }
        Some(Kind::Show) => "a second subscription".to_owned(),
        _ => "a second hello".to_owned(),
    }
}

/// Drops the connection with a sentence.
async fn drop_with(connection: &Connection, mut send: SendStream, why: &str) {
    tracing::info!("a display's connection ends: {why}");
    let text = ServerMessage::Refused(Refused {
        reason: RefusedReason::Role,
        text: why.to_owned(),
    });
    if control::write(&mut send, &text).await && send.finish().is_ok() {
        close_after_last_word(connection, CLOSE_REFUSED, b"dropped").await;
    }
    connection.close(CLOSE_REFUSED, b"dropped");
}
