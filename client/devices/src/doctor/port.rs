//! Check of the Haply service at its port.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

use super::check::{Check, part};
use super::roots::Roots;

const NAME: &str = "port";
/// Time limit of the whole exchange.
const LIMIT: Duration = Duration::from_millis(300);
/// Most bytes of an answer.
const LONGEST: usize = 65536;

/// Finding at the address.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Answer {
    /// No program has the port.
    Nobody,
    /// A program has the port and does not answer as the service does.
    Other,
    /// The service, and its version if the answer has one.
    Service(Option<String>),
}

/// Asks the service for its version. An absent service is ok unless it is installed.
pub fn check(roots: &Roots) -> Check {
    let address = roots.haply;
    match ask(address) {
        Answer::Service(version) => Check::fine(
            NAME,
            format!(
                "the Haply service at {address} answers, version {}.",
                version.map_or_else(|| "not told".into(), |version| part(&version))
            ),
        ),
        Answer::Nobody if roots.haply_config.exists() => Check::wrong(
            NAME,
            format!(
                "the Haply service is installed, but nothing answers at {address}. Run: sudo systemctl restart \
                 haply-inverse-service"
            ),
        ),
        Answer::Nobody => Check::fine(
            NAME,
            format!(
                "no Haply service at {address}. A Haply device needs the service haply-inverse-service; other devices \
                 do not."
            ),
        ),
        Answer::Other => Check::wrong(
            NAME,
            format!(
                "the program at {address} does not answer GET /version as the Haply service does. Restart \
                 haply-inverse-service, or find the other program with: sudo ss -ltnp"
            ),
        ),
    }
}

/// Sends one request over HTTP and reads the answer until its end or the time limit.
fn ask(address: SocketAddr) -> Answer {
    let start = Instant::now();
    let Ok(mut stream) = TcpStream::connect_timeout(&address, LIMIT) else {
        return Answer::Nobody;
    };
    let request = format!(
        "GET /version HTTP/1.1\r\nHost: {address}\r\nAccept: */*\r\nConnection: close\r\n\r\n"
    );
    if stream.set_write_timeout(Some(LIMIT)).is_err()
        || stream.write_all(request.as_bytes()).is_err()
    {
        return Answer::Other;
    }
    let mut bytes = Vec::new();
    let mut block = [0; 4096];
    while bytes.len() < LONGEST {
        let left = LIMIT.saturating_sub(start.elapsed());
        // A time limit of zero is an error of the call.
        if left.is_zero() || stream.set_read_timeout(Some(left)).is_err() {
            break;
        }
        match stream.read(&mut block) {
            Ok(0) | Err(_) => break,
            Ok(count) => bytes.extend_from_slice(&block[..count]),
        }
    }
    parse(&bytes)
}

/// Reads the answer: the status must be 200.
fn parse(bytes: &[u8]) -> Answer {
    let text = String::from_utf8_lossy(bytes);
    let mut words = text.split_ascii_whitespace();
    let http = words.next().is_some_and(|word| word.starts_with("HTTP/1."));
    if !http || words.next() != Some("200") {
        return Answer::Other;
    }
    // Braces find the object in a body with or without lengths of chunks around it.
    let object = text
        .find('{')
        .zip(text.rfind('}'))
        .and_then(|(from, to)| text.get(from..=to));
    let version = object
        .and_then(|object| serde_json::from_str::<serde_json::Value>(object).ok())
        .and_then(|value| Some(value.get("project_version")?.as_str()?.to_owned()));
    Answer::Service(version)
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;

    use proptest::prelude::*;

    use super::*;

    /// Places with a server that sends `answer` to one request, waits for `hold`, and closes.
    fn serve(answer: &'static str, hold: Duration) -> Roots {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let address = listener.local_addr().expect("bound");
        std::thread::spawn(move || {
            let (mut stream, _) = listener.accept().expect("one client");
            let mut request = [0; 512];
            let count = stream.read(&mut request).expect("a request");
            assert!(request[..count].starts_with(b"GET /version HTTP/1.1\r\n"));
            stream
                .write_all(answer.as_bytes())
                .expect("the client waits");
            std::thread::sleep(hold);
        });
        at(address)
    }

    fn at(haply: SocketAddr) -> Roots {
        Roots {
            haply,
            haply_config: "/no/such/folder".into(),
            ..Roots::system()
        }
    }

    const ANSWER: &str =
        "HTTP/1.1 200 OK\r\nServer: x\r\n\r\n{\"project_version\":\"3.5.2\",\"more\":{}}";

    #[test]
    fn a_service_tells_its_version() {
        let check = check(&serve(ANSWER, Duration::ZERO));
        assert!(
            check.ok && check.message.contains("version 3.5.2"),
            "{check:?}"
        );
    }

    #[test]
    fn a_service_that_keeps_the_connection_open_is_read_within_the_limit() {
        let start = Instant::now();
        let check = check(&serve(ANSWER, Duration::from_secs(5)));
        assert!(check.ok && check.message.contains("3.5.2"), "{check:?}");
        assert!(start.elapsed() < Duration::from_secs(4));
    }

    #[test]
    fn another_program_at_the_port_is_wrong() {
        for answer in ["HTTP/1.1 404 Not Found\r\n\r\n", "SSH-2.0-OpenSSH\r\n", ""] {
            let check = check(&serve(answer, Duration::ZERO));
            assert!(!check.ok && check.message.contains("ss -ltnp"), "{check:?}");
        }
    }

    #[test]
    fn an_absent_service_is_wrong_only_if_it_is_installed() {
        // The listener is closed before the question, so nobody has the port.
        let address = TcpListener::bind("127.0.0.1:0")
            .and_then(|listener| listener.local_addr())
            .expect("bound");
        let mut roots = at(address);
        assert!(check(&roots).ok);
        roots.haply_config = std::env::temp_dir();
        let check = check(&roots);
        assert!(
            !check.ok && check.message.contains("systemctl"),
            "{check:?}"
        );
    }

    #[test]
    fn a_body_in_chunks_is_read() {
        let text = b"HTTP/1.1 200 OK\r\n\r\n1c\r\n{\"project_version\": \"3.4.0\"}\r\n0\r\n\r\n";
        assert_eq!(parse(text), Answer::Service(Some("3.4.0".into())));
        assert_eq!(parse(b"HTTP/1.0 200 OK\r\n\r\n3.1"), Answer::Service(None));
    }

    proptest! {
        #[test]
        fn garbage_is_an_answer(bytes in proptest::collection::vec(any::<u8>(), 0..300), head in any::<bool>()) {
            let mut all = if head { b"HTTP/1.1 200 OK\r\n\r\n{".to_vec() } else { Vec::new() };
            all.extend(bytes);
            prop_assert_ne!(parse(&all), Answer::Nobody);
        }
    }
}
