//! Simulation channel.

use std::io;
use std::net::TcpStream;
use std::thread;
use std::time::Duration;

use tungstenite::{Error, Message, WebSocket};

use super::tap::Tap;
use super::{Shared, http};
use crate::log::{EndReason, Violation};
use crate::world::Answer;

/// Serves a new connection: the simulation channel, or one request over HTTP.
pub(crate) fn serve(shared: &Shared, key: u64, stream: TcpStream) {
    match wants_socket(&stream) {
        Ok(true) => {
            // A failed handshake is a plain end of the connection: no simulation connection stood.
            if let Ok(socket) = tungstenite::accept(Tap::new(stream)) {
                run(shared, key, socket);
            }
        }
        Ok(false) => {
            let _ = http::serve(shared, stream);
        }
        Err(_) => {}
    }
}

/// Looks at the head of the request without taking it; true for an upgrade to a WebSocket.
fn wants_socket(stream: &TcpStream) -> io::Result<bool> {
    let mut bytes = [0; 8192];
    stream.set_read_timeout(Some(Duration::from_secs(5)))?;
    let mut before = 0;
    loop {
        let count = stream.peek(&mut bytes)?;
        let head = String::from_utf8_lossy(&bytes[..count]).to_ascii_lowercase();
        if head.contains("\r\n\r\n") || count == bytes.len() {
            stream.set_read_timeout(None)?;
            let upgrade = |line: &str| line.starts_with("upgrade:") && line.contains("websocket");
            return Ok(head.lines().any(upgrade));
        }
        if count == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        // A head in parts is rare: waiting for its rest may take its time.
        if count == before {
            thread::sleep(Duration::from_millis(1));
        }
        before = count;
    }
}

fn run(shared: &Shared, key: u64, mut socket: WebSocket<Tap>) {
    let (number, inventory) = shared.world().connect();
    let mut taken = socket.get_ref().count();
    let mut reason = send(&mut socket, inventory).err();
    while reason.is_none() {
        let message = match socket.read() {
            Ok(message) => message,
            Err(error) => {
                reason = Some(error);
                break;
            }
        };
        taken += frame_bytes(&message);
        shared.wait_for_stall();
        let answer = match message {
            Message::Text(text) => {
                let pipelined = socket.get_ref().count() > taken || socket.get_ref().bytes_wait();
                shared.world().message(number, &text, pipelined)
            }
            Message::Binary(_) => {
                shared.world().violation(number, Violation::NotText, "");
                Answer::default()
            }
            _ => Answer::default(),
        };
        reason = send(&mut socket, answer).err();
    }
    let reason = match reason {
        _ if shared.was_dropped(key) => EndReason::Fault,
        _ if shared.stopped() => EndReason::ServiceStopped,
        Some(Error::ConnectionClosed) => EndReason::ClosedByClient,
        Some(Error::Io(_)) | None => EndReason::Lost,
        Some(Error::Protocol(tungstenite::error::ProtocolError::ResetWithoutClosingHandshake)) => {
            EndReason::Lost
        }
        Some(_) => EndReason::BadFrame,
    };
    let _ = socket.get_ref().stream().shutdown(std::net::Shutdown::Both);
    shared.world().disconnect(number, reason);
}

fn send(socket: &mut WebSocket<Tap>, answer: Answer) -> Result<(), Error> {
    for text in answer.texts {
        socket.send(Message::text(text))?;
    }
    if answer.close {
        socket.close(None)?;
        socket.flush()?;
    }
    Ok(())
}

/// Bytes of the frame of a message of a client; a client splits no message into frames.
fn frame_bytes(message: &Message) -> u64 {
    let (length, control) = match message {
        Message::Close(Some(frame)) => (frame.reason.len() + 2, true),
        Message::Close(None) => (0, true),
        other => (other.len(), other.is_ping() || other.is_pong()),
    };
    let header = match length {
        _ if control => 6,
        0..=125 => 6,
        126..=65_535 => 8,
        _ => 14,
    };
    (length + header) as u64
}
