//! Channel of events, read only for a client.

use std::io::ErrorKind;
use std::net::TcpStream;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use tungstenite::{Error, Message, WebSocket};

use super::Shared;
use crate::log::Violation;

/// Time between two looks for a close message of the client.
const LOOK: Duration = Duration::from_millis(5);

/// Serves a connection of the channel of events until it ends.
pub(crate) fn serve(shared: &Shared, stream: TcpStream) {
    let Ok(mut socket) = tungstenite::accept(stream) else {
        return;
    };
    if socket.get_ref().set_nonblocking(true).is_err() {
        return;
    }
    let queue = shared.world().listen();
    while !shared.stopped() && step(shared, &mut socket, &queue).is_ok() {}
    shared.world().unlisten();
}

fn step(
    shared: &Shared,
    socket: &mut WebSocket<TcpStream>,
    queue: &Receiver<String>,
) -> Result<(), Error> {
    match queue.recv_timeout(LOOK) {
        Ok(text) => pass(socket.send(Message::text(text)))?,
        Err(RecvTimeoutError::Timeout) => pass(socket.flush())?,
        Err(RecvTimeoutError::Disconnected) => return Err(Error::ConnectionClosed),
    }
    match socket.read() {
        Ok(message) if message.is_text() || message.is_binary() => {
            let text = message.to_text().unwrap_or("binary").to_owned();
            shared.world().violation(0, Violation::WroteToEvents, &text);
            Ok(())
        }
        Ok(_) => Ok(()),
        Err(error) => pass(Err(error)),
    }
}

/// No error where the socket only has to wait.
fn pass(result: Result<(), Error>) -> Result<(), Error> {
    match result {
        Err(Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => Ok(()),
        other => other,
    }
}
