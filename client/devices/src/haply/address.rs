//! Address of the service.

use std::fmt;
use std::io;
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

/// Port of the simulation channel without a setting.
const PORT: u16 = 10_001;
/// Distance from the port of the simulation channel to that of the events.
const TO_EVENTS: u16 = 19;

/// Host and port of the simulation channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Address {
    host: String,
    port: u16,
}

impl Address {
    /// Reads `host:port`, with or without `ws://` or `http://`. Without a port the port is 10001.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let wrong = || {
            format!(
                "the address of the Haply service is \"{text}\", expected host and port such as 127.0.0.1:10001"
            )
        };
        let bare = text.trim();
        let bare = ["ws://", "http://"]
            .iter()
            .find_map(|scheme| bare.strip_prefix(scheme))
            .unwrap_or(bare)
            .trim_end_matches('/');
        let (host, port) = match bare.rsplit_once(':') {
            Some((host, port)) => (host, port.parse().map_err(|_| wrong())?),
            None => (bare, PORT),
        };
        let known = |c: char| c.is_ascii_alphanumeric() || "-._:[]".contains(c);
        if host.is_empty() || port == 0 || !host.chars().all(known) {
            return Err(wrong());
        }
        Ok(Self {
            host: host.into(),
            port,
        })
    }

    /// The same host with the port of the channel of events.
    pub(super) fn events(&self) -> Option<Self> {
        Some(Self {
            host: self.host.clone(),
            port: self.port.checked_add(TO_EVENTS)?,
        })
    }

    /// Connects with no delay of small messages. Reads and writes have the time limit `most`.
    pub(super) fn connect(&self, most: Duration) -> io::Result<TcpStream> {
        let end = Instant::now() + most;
        let host = self.host.trim_start_matches('[').trim_end_matches(']');
        let mut last = io::Error::from(io::ErrorKind::NotFound);
        for address in (host, self.port).to_socket_addrs()? {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(io::ErrorKind::TimedOut.into());
            }
            match TcpStream::connect_timeout(&address, left) {
                Ok(stream) => {
                    stream.set_nodelay(true)?;
                    stream.set_read_timeout(Some(most))?;
                    stream.set_write_timeout(Some(most))?;
                    return Ok(stream);
                }
                Err(error) => last = error,
            }
        }
        Err(last)
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.host, self.port)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hosts_and_ports_are_read() {
        let read = |text: &str| Address::parse(text).map(|address| address.to_string());
        assert_eq!(read("127.0.0.1:10001").as_deref(), Ok("127.0.0.1:10001"));
        assert_eq!(
            read(" ws://localhost:9000/ ").as_deref(),
            Ok("localhost:9000")
        );
        assert_eq!(read("localhost").as_deref(), Ok("localhost:10001"));
        assert_eq!(read("[::1]:10001").as_deref(), Ok("[::1]:10001"));
        for wrong in [
            "",
            ":10001",
            "host:0",
            "host:70000",
            "host:x",
            "a b:1",
            "host\r\nX:1",
        ] {
            let sentence = read(wrong).unwrap_err();
            assert!(
                sentence.contains("expected host and port"),
                "{wrong} {sentence}"
            );
        }
    }

    #[test]
    fn events_have_the_next_port_but_eighteen() {
        let events = |text: &str| Address::parse(text).unwrap().events();
        assert_eq!(
            events("127.0.0.1:10001").unwrap().to_string(),
            "127.0.0.1:10020"
        );
        assert_eq!(events("127.0.0.1:65530"), None);
    }
}
