//! Socket of the daemon, read without waiting.

use std::ffi::OsStr;
use std::io::{ErrorKind, Read};
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};

use super::record::{Event, Parser};

/// Socket without a variable.
const USUAL: &str = "/var/run/spnav.sock";
/// Largest number of bytes of one reading: 64 records.
const MOST: usize = 2048;

/// The daemon is gone.
#[derive(Debug, thiserror::Error)]
pub enum Lost {
    /// The daemon closed the connection.
    #[error("spacenavd ended")]
    Ended,
    /// The connection failed.
    #[error("the connection to spacenavd failed: {0}")]
    Failed(#[from] std::io::Error),
}

/// Path of the socket: the value of the variable `SPNAV_SOCKET` if it is set and not empty, else
/// `/var/run/spnav.sock`.
pub fn path(variable: Option<&OsStr>) -> PathBuf {
    let set = variable.filter(|path| !path.is_empty());
    PathBuf::from(set.unwrap_or(OsStr::new(USUAL)))
}

/// Connection to the daemon.
#[derive(Debug)]
pub struct Socket {
    stream: UnixStream,
    parser: Parser,
}

impl Socket {
    /// Connects to the daemon at `path`.
    ///
    /// # Errors
    /// No daemon listens there.
    pub fn connect(path: &Path) -> std::io::Result<Self> {
        let stream = UnixStream::connect(path)?;
        stream.set_nonblocking(true)?;
        Ok(Self {
            stream,
            parser: Parser::new(),
        })
    }

    /// Events since the previous call of this function, at most those of one reading. The call never waits.
    ///
    /// # Errors
    /// The daemon is gone. The caller must then release the cap: the last deflection would hold for ever.
    pub fn events(&mut self) -> Result<Vec<Event>, Lost> {
        let (mut bytes, mut events) = ([0; MOST], Vec::new());
        match self.stream.read(&mut bytes) {
            Ok(0) => return Err(Lost::Ended),
            Ok(count) => self.parser.feed(&bytes[..count], &mut events),
            Err(error)
                if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => {}
            Err(error) => return Err(error.into()),
        }
        Ok(events)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Vector;
    use crate::hand::board::Board;
    use crate::hand::hands::{Hands, Scales};
    use crate::hand::limits::Limits;
    use crate::hand::one::Hand;
    use crate::hand::pose::{HandPose, Turn};
    use crate::hand::spacenav::CapRule;
    use std::io::Write;
    use std::os::unix::net::UnixListener;

    /// Stand-in of the daemon at a path of its own, and a client.
    fn daemon(name: &str) -> (UnixStream, Socket) {
        let path = std::env::temp_dir().join(format!("sulcus-{name}-{}", std::process::id()));
        let _ = std::fs::remove_file(&path);
        let listener = UnixListener::bind(&path).expect("a free path");
        let socket = Socket::connect(&path).expect("a listener");
        let (stream, _) = listener.accept().expect("a client");
        std::fs::remove_file(&path).expect("the path");
        (stream, socket)
    }

    /// Sends numbers as the daemon does.
    fn send(stream: &mut UnixStream, numbers: [i32; 8]) {
        for number in numbers {
            stream.write_all(&number.to_ne_bytes()).expect("a reader");
        }
    }

    fn hands() -> Hands {
        let home = HandPose {
            position: Vector::zeros(),
            orientation: Turn::identity(),
        };
        let hand = Hand::new(
            home,
            Vector::zeros(),
            Limits::around([Vector::zeros()], 60.0),
        );
        Hands::new([Some(hand), None], Scales::default())
    }

    #[test]
    fn a_variable_names_the_socket() {
        assert_eq!(path(None), Path::new("/var/run/spnav.sock"));
        assert_eq!(path(Some(OsStr::new(""))), Path::new("/var/run/spnav.sock"));
        assert_eq!(path(Some(OsStr::new("/tmp/x"))), Path::new("/tmp/x"));
        assert!(Socket::connect(Path::new("/nowhere/spnav.sock")).is_err());
    }

    #[test]
    fn the_tool_follows_the_cap_and_stops_when_the_cap_is_released() {
        let (mut stream, mut socket) = daemon("cap");
        let (rule, mut board, mut hands) = (CapRule::default(), Board::new(), hands());
        let mut pass = |socket: &mut Socket, hands: &mut Hands| {
            for event in socket.events().expect("a daemon") {
                rule.act(&event, &mut board, hands);
            }
            for _ in 0..500 {
                hands.advance(1e-3);
            }
            hands.pose(0).expect("a tool").position
        };
        assert_eq!(
            pass(&mut socket, &mut hands),
            Vector::zeros(),
            "no event, no wait"
        );
        send(&mut stream, [0, 350, 0, 0, 0, 0, 0, 8]);
        assert_eq!(
            pass(&mut socket, &mut hands),
            Vector::zeros(),
            "the clutch is open"
        );
        send(&mut stream, [1, 0, 0, 0, 0, 0, 0, 0]);
        let moved = pass(&mut socket, &mut hands);
        // Right in the picture of a person before the patient: y.
        assert!(
            (moved - Vector::new(0.0, 30.0, 0.0)).norm() < 1e-6,
            "{moved}"
        );
        send(&mut stream, [2, 0, 0, 0, 0, 0, 0, 0]);
        send(&mut stream, [0, 0, 0, 0, 0, 0, 0, 8]);
        assert_eq!(pass(&mut socket, &mut hands), moved);
        send(&mut stream, [0, 0, 0, -350, 0, 0, 0, 8]);
        let nearer = pass(&mut socket, &mut hands) - moved;
        assert!(
            (nearer - Vector::new(30.0, 0.0, 0.0)).norm() < 1e-6,
            "{nearer}"
        );
    }

    #[test]
    fn half_a_record_waits_and_an_ended_daemon_is_told() {
        let (mut stream, mut socket) = daemon("half");
        let record: Vec<u8> = [1i32, 5, 0, 0, 0, 0, 0, 0]
            .iter()
            .flat_map(|k| k.to_ne_bytes())
            .collect();
        stream.write_all(&record[..13]).expect("a reader");
        assert_eq!(socket.events().expect("a daemon"), []);
        stream.write_all(&record[13..]).expect("a reader");
        assert_eq!(socket.events().expect("a daemon"), [Event::Press(5)]);
        drop(stream);
        assert!(matches!(socket.events(), Err(Lost::Ended)));
    }
}
