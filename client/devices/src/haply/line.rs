//! WebSocket to the service that never blocks after the handshake.

use std::io::{self, ErrorKind};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use sulcus_link::clock::monotonic_ns;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Error, HandshakeError, Message, Utf8Bytes, WebSocket};

use super::address::Address;

/// Largest message of the service, bytes.
const LARGEST: usize = 1 << 20;
/// Largest number of messages that one call of [`Line::newest`] takes.
const MOST_AT_ONCE: usize = 256;

/// Connection to the service.
#[derive(Debug)]
pub(super) struct Line {
    socket: WebSocket<TcpStream>,
}

impl Line {
    /// Connects within about `most`.
    ///
    /// # Errors
    /// Cause of the system or of the WebSocket, without a subject.
    pub(super) fn open(address: &Address, most: Duration) -> Result<Self, String> {
        let stream = address.connect(most).map_err(|error| error.to_string())?;
        let config = WebSocketConfig::default()
            .read_buffer_size(1 << 14)
            .write_buffer_size(0)
            .max_message_size(Some(LARGEST))
            .max_frame_size(Some(LARGEST));
        let request = format!("ws://{address}/");
        let made = tungstenite::client::client_with_config(request, stream, Some(config));
        let (socket, _) = made.map_err(|error| match error {
            HandshakeError::Interrupted(_) => "the handshake was not answered in time".into(),
            HandshakeError::Failure(error) => error.to_string(),
        })?;
        socket
            .get_ref()
            .set_nonblocking(true)
            .map_err(|error| error.to_string())?;
        Ok(Self { socket })
    }

    /// Sends `text`. A message that the system cannot take now leaves with a later call.
    pub(super) fn send(&mut self, text: String) -> Result<(), String> {
        later(self.socket.send(Message::text(text)))
    }

    /// Takes all messages that have arrived, and returns their number and the newest one.
    pub(super) fn newest(&mut self) -> Result<(usize, Option<Utf8Bytes>), String> {
        let (mut count, mut newest) = (0, None);
        while count < MOST_AT_ONCE {
            match self.socket.read() {
                Ok(Message::Text(text)) => {
                    count += 1;
                    newest = Some(text);
                }
                Ok(_) => {}
                Err(Error::Io(error)) if error.kind() == ErrorKind::WouldBlock => break,
                Err(Error::Io(error)) if error.kind() == ErrorKind::Interrupted => {}
                // Messages before the end of the connection still count.
                Err(_) if newest.is_some() => break,
                Err(error) => return Err(error.to_string()),
            }
        }
        Ok((count, newest))
    }

    /// Takes the next message that has arrived; `None` for none.
    pub(super) fn next(&mut self) -> Result<Option<Utf8Bytes>, String> {
        match self.socket.read() {
            Ok(Message::Text(text)) => Ok(Some(text)),
            Ok(_) => Ok(None),
            Err(error) => later(Err(error)).map(|()| None),
        }
    }

    /// Waits until something arrives, until the connection ends or until `until_ns` of the monotonic clock.
    pub(super) fn wait(&self, until_ns: u64) {
        let left_ns = until_ns.saturating_sub(monotonic_ns());
        let left = Timespec {
            // The types of the fields differ between systems. A wait is at most seconds long.
            tv_sec: (left_ns / 1_000_000_000) as _,
            tv_nsec: (left_ns % 1_000_000_000) as _,
        };
        let mut waited = [PollFd::new(self.socket.get_ref(), PollFlags::IN)];
        // An error, such as a signal, ends the wait early; the caller looks at the clock.
        let _ = poll(&mut waited, Some(&left));
    }

    /// Waits up to `most` for one message.
    pub(super) fn within(&mut self, most: Duration) -> Result<Utf8Bytes, String> {
        let end = Instant::now() + most;
        loop {
            if let Some(text) = self.next()? {
                return Ok(text);
            }
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err("no message in time".into());
            }
            self.wait(monotonic_ns() + left.as_nanos() as u64);
        }
    }

    /// Closes the connection, and waits up to 20 ms for the answer of the service.
    pub(super) fn close(mut self) {
        let end_ns = monotonic_ns() + 20_000_000;
        let mut open = later(self.socket.close(None)).is_ok();
        while open && monotonic_ns() < end_ns {
            open = self.next().is_ok();
            if open {
                self.wait(end_ns);
            }
        }
    }
}

/// No error for a socket that only has to wait.
fn later(result: Result<(), Error>) -> Result<(), String> {
    match result {
        Err(Error::Io(error)) if is_wait(&error) => Ok(()),
        other => other.map_err(|error| error.to_string()),
    }
}

fn is_wait(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted)
}
