//! Socket that counts the bytes that were read from it.

use std::io::{self, Read, Write};
use std::net::TcpStream;

/// Socket with a count of its read bytes.
#[derive(Debug)]
pub(crate) struct Tap {
    stream: TcpStream,
    read: u64,
}

impl Tap {
    /// Socket without a read byte.
    pub(crate) fn new(stream: TcpStream) -> Self {
        Self { stream, read: 0 }
    }

    /// Number of bytes read.
    pub(crate) fn count(&self) -> u64 {
        self.read
    }

    /// True where bytes of the client wait in the system.
    pub(crate) fn bytes_wait(&self) -> bool {
        let mut byte = [0];
        if self.stream.set_nonblocking(true).is_err() {
            return false;
        }
        let wait = matches!(self.stream.peek(&mut byte), Ok(count) if count > 0);
        let _ = self.stream.set_nonblocking(false);
        wait
    }

    /// The socket.
    pub(crate) fn stream(&self) -> &TcpStream {
        &self.stream
    }
}

impl Read for Tap {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.stream.read(bytes)?;
        self.read += count as u64;
        Ok(count)
    }
}

impl Write for Tap {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}
