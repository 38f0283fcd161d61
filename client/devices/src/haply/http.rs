//! Question over HTTP with a time limit, to read version and settings of the service.

use std::io::{ErrorKind, Read, Write};
use std::time::{Duration, Instant};

use super::address::Address;

/// Largest answer, bytes.
const LARGEST: usize = 1 << 16;

/// Answer of the service.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Answer {
    /// Status, 200 for success.
    pub(super) status: u16,
    /// Text.
    pub(super) body: String,
}

/// Question without an answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum NoAnswer {
    /// No program listens at the address; cause of the system.
    Refused(String),
    /// The answer did not come in time.
    Late,
    /// The answer is no HTTP.
    Garbled,
}

/// Asks for `path` within `most`.
pub(super) fn get(address: &Address, path: &str, most: Duration) -> Result<Answer, NoAnswer> {
    let end = Instant::now() + most;
    let refused = |error: std::io::Error| match error.kind() {
        ErrorKind::TimedOut | ErrorKind::WouldBlock => NoAnswer::Late,
        _ => NoAnswer::Refused(error.to_string()),
    };
    let mut stream = address.connect(most).map_err(refused)?;
    let question = format!("GET {path} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n");
    stream
        .write_all(question.as_bytes())
        .map_err(|_| NoAnswer::Late)?;
    let mut bytes = Vec::new();
    let mut part = [0; 4096];
    loop {
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() || stream.set_read_timeout(Some(left)).is_err() {
            return Err(NoAnswer::Late);
        }
        let ended = match stream.read(&mut part) {
            Ok(0) => true,
            Ok(count) => {
                bytes.extend_from_slice(&part[..count]);
                false
            }
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(error) if matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock) => {
                return Err(NoAnswer::Late);
            }
            Err(_) => true,
        };
        match parse(&bytes, ended) {
            Some(answer) => return Ok(answer),
            None if ended || bytes.len() > LARGEST => return Err(NoAnswer::Garbled),
            None => {}
        }
    }
}

/// Reads an answer. `None` for a part of one, or for no answer at all; `ended` states that no byte follows.
fn parse(bytes: &[u8], ended: bool) -> Option<Answer> {
    let split = bytes.windows(4).position(|four| four == b"\r\n\r\n")?;
    let head = std::str::from_utf8(&bytes[..split]).ok()?;
    let body = &bytes[split + 4..];
    let mut lines = head.lines();
    let mut words = lines.next()?.split_whitespace();
    words.next().filter(|word| word.starts_with("HTTP/"))?;
    let status = words.next()?.parse().ok()?;
    let (mut length, mut chunked) = (None, false);
    for (name, value) in lines.filter_map(|line| line.split_once(':')) {
        let value = value.trim();
        if name.eq_ignore_ascii_case("content-length") {
            length = Some(value.parse::<usize>().ok()?);
        } else if name.eq_ignore_ascii_case("transfer-encoding") {
            chunked = value.eq_ignore_ascii_case("chunked");
        }
    }
    let body = match length {
        _ if chunked => joined(body)?,
        Some(length) => body.get(..length)?.to_vec(),
        None if ended => body.to_vec(),
        None => return None,
    };
    let body = String::from_utf8(body).ok()?;
    Some(Answer { status, body })
}

/// Joins the chunks of a body. `None` before the last chunk.
fn joined(mut body: &[u8]) -> Option<Vec<u8>> {
    let mut all = Vec::new();
    loop {
        let line = body.windows(2).position(|two| two == b"\r\n")?;
        let size = std::str::from_utf8(&body[..line]).ok()?;
        let size = size.split(';').next().unwrap_or_default().trim();
        let size = usize::from_str_radix(size, 16).ok()?;
        body = &body[line + 2..];
        if size == 0 {
            return Some(all);
        }
        all.extend_from_slice(body.get(..size)?);
        body = body.get(size.checked_add(2)?..)?;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn answer(status: u16, body: &str) -> Option<Answer> {
        let body = body.into();
        Some(Answer { status, body })
    }

    #[test]
    fn an_answer_ends_at_its_length_its_last_chunk_or_its_end() {
        let sized = b"HTTP/1.1 200 OK\r\ncontent-length: 2\r\n\r\n{}";
        assert_eq!(parse(sized, false), answer(200, "{}"));
        assert_eq!(parse(&sized[..sized.len() - 1], false), None);
        let chunked = b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n3\r\nabc\r\n2;x\r\nde\r\n0\r\n\r\n";
        assert_eq!(parse(chunked, false), answer(200, "abcde"));
        assert_eq!(parse(&chunked[..chunked.len() - 5], false), None);
        let open = b"HTTP/1.0 404 Not Found\r\n\r\nno";
        assert_eq!(parse(open, false), None);
        assert_eq!(parse(open, true), answer(404, "no"));
        assert_eq!(parse(b"SSH-2.0\r\n\r\n", true), None);
    }

    proptest! {
        #[test]
        fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..200), ended: bool) {
            let _ = parse(&bytes, ended);
            let head = b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n";
            let _ = parse(&[head.as_slice(), &bytes].concat(), ended);
        }
    }
}
