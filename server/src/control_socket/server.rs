//! Server's side of the control socket: one thread that accepts, one thread a connection.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::os::fd::AsRawFd as _;
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::place::Claimed;
use super::{Control, MOST_LINE, PATIENCE, Reply, Request};

/// Largest number of connections at once. A further one is answered with a sentence and closed.
const MOST_CONNECTIONS: usize = 8;
/// Longest time in which the end of the server is noticed.
const LOOK: Duration = Duration::from_millis(100);

/// Control socket that is served until the drop.
#[derive(Debug)]
pub struct Listening {
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// Serves the control socket on threads of its own.
///
/// # Errors
/// The system gives no thread.
pub fn serve(claimed: Claimed, control: Arc<dyn Control>) -> std::io::Result<Listening> {
    claimed.listener.set_nonblocking(true)?;
    let ended = Arc::new(AtomicBool::new(false));
    let over = ended.clone();
    let thread = std::thread::Builder::new()
        .name("sulcus-control".into())
        .spawn(move || accept(&claimed, &control, &over))?;
    Ok(Listening {
        ended,
        thread: Some(thread),
    })
}

impl Drop for Listening {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            // A panic of the thread has been printed; nothing of it is needed here.
            let _ = thread.join();
        }
    }
}

fn accept(claimed: &Claimed, control: &Arc<dyn Control>, ended: &Arc<AtomicBool>) {
    let open = Arc::new(AtomicUsize::new(0));
    while !ended.load(Ordering::Acquire) {
        let mut ready = [PollFd::new(&claimed.listener, PollFlags::IN)];
        let wait = Timespec {
            tv_sec: 0,
            tv_nsec: LOOK.as_nanos() as i64,
        };
        // An interrupted call is repeated by the loop.
        if !matches!(poll(&mut ready, Some(&wait)), Ok(1..)) {
            continue;
        }
        let Ok((stream, _)) = claimed.listener.accept() else {
            // Without a free file descriptor the socket stays ready: no busy loop.
            std::thread::sleep(LOOK);
            continue;
        };
        let (control, ended) = (control.clone(), ended.clone());
        let place = Place::take(&open);
        let spawned = std::thread::Builder::new()
            .name("sulcus-control".into())
            .spawn(move || converse(stream, control.as_ref(), &ended, place));
        if let Err(error) = spawned {
            tracing::warn!("a connection to the control socket was dropped: {error}");
        }
    }
}

/// Place of an open connection, freed by the drop.
struct Place {
    open: Arc<AtomicUsize>,
    is_free: bool,
}

impl Place {
    fn take(open: &Arc<AtomicUsize>) -> Self {
        Self {
            open: open.clone(),
            is_free: open.fetch_add(1, Ordering::AcqRel) < MOST_CONNECTIONS,
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.open.fetch_sub(1, Ordering::AcqRel);
    }
}

/// Answers the requests of a connection until its end.
fn converse(stream: UnixStream, control: &dyn Control, ended: &AtomicBool, place: Place) {
    let set = stream
        .set_nonblocking(false)
        .and_then(|()| stream.set_read_timeout(Some(LOOK)))
        .and_then(|()| stream.set_write_timeout(Some(PATIENCE)));
    let Ok(reading) = set.and_then(|()| stream.try_clone()) else {
        return;
    };
    if !place.is_free {
        let text = format!("more than {MOST_CONNECTIONS} connections to the control socket");
        write(&stream, &Reply::Error(text));
        return;
    }
    let by = author(&stream);
    let mut lines = BufReader::new(reading);
    while let Some(line) = next_line(&mut lines, ended) {
        let (reply, goes_on) = match line {
            Ok(line) => match Request::parse(&line) {
                Ok(request) => (request.answer(control, &by), true),
                Err(why) => (Reply::Error(why), true),
            },
            Err(why) => (Reply::Error(why), false),
        };
        if !write(&stream, &reply) || !goes_on {
            return;
        }
    }
}

/// Next line without its line feed, or a sentence for a line that is too long or too slow. `None`: the connection or
/// the server has ended.
fn next_line(
    lines: &mut BufReader<UnixStream>,
    ended: &AtomicBool,
) -> Option<Result<Vec<u8>, String>> {
    let mut line = Vec::new();
    let end = Instant::now() + PATIENCE;
    loop {
        let room = (MOST_LINE + 1).saturating_sub(line.len()) as u64;
        let read = lines.by_ref().take(room).read_until(b'\n', &mut line);
        if line.last() == Some(&b'\n') && line.len() <= MOST_LINE {
            line.pop();
            return Some(Ok(line));
        }
        if line.len() > MOST_LINE {
            return Some(Err(format!("the line is longer than {MOST_LINE} bytes")));
        }
        match read {
            // The other end has closed; the rest of a line is no request.
            Ok(_) => return None,
            Err(error) if is_timeout(&error) => {}
            Err(_) => return None,
        }
        if ended.load(Ordering::Acquire) {
            return None;
        }
        if Instant::now() >= end {
            let seconds = PATIENCE.as_secs();
            return Some(Err(format!("no whole line within {seconds} s")));
        }
    }
}

fn is_timeout(error: &std::io::Error) -> bool {
    use std::io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), Interrupted | TimedOut | WouldBlock)
}

/// Writes a reply. `false`: the connection cannot be used any more.
fn write(mut stream: &UnixStream, reply: &Reply) -> bool {
    let Ok(mut line) = serde_json::to_vec(reply) else {
        return false;
    };
    line.push(b'\n');
    stream.write_all(&line).is_ok()
}

/// Name of the author of a connection's requests: the user at the other end, as the kernel knows it.
fn author(stream: &UnixStream) -> String {
    let mut credentials = libc::ucred {
        pid: 0,
        uid: u32::MAX,
        gid: u32::MAX,
    };
    let mut length = size_of::<libc::ucred>() as libc::socklen_t;
    // SAFETY: the descriptor is open, and the kernel writes at most `length` bytes into a struct of that length.
    let result = unsafe {
        libc::getsockopt(
            stream.as_raw_fd(),
            libc::SOL_SOCKET,
            libc::SO_PEERCRED,
            (&raw mut credentials).cast(),
            &raw mut length,
        )
    };
    if result == 0 {
        format!("shell (uid {})", credentials.uid)
    } else {
        "shell".to_owned()
    }
}
