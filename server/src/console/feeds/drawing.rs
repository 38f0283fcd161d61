//! A child process that draws a station live: state of the tools in, parts of a stream out.
//!
//! Two threads serve the child, so that a pipe that blocks holds up nothing else. One writes the newest state ten times
//! a second, and never an older one. The other one reads parts and hands each of them to all viewers. A viewer lags
//! behind by [`QUEUE`] parts at most; older parts are dropped.

use std::io::{BufReader, ErrorKind, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use rustix::fs::OFlags;
use sulcus_console::house::{Live, QUEUE, Segment};
use sulcus_proto::live::{self, Hands, Kind};
use tokio::sync::{broadcast, watch};

use super::PROGRAM;

/// Interval between two states for the child.
const EVERY: Duration = Duration::from_millis(100);
/// Time without a viewer after which the child ends. A page that is loaded again finds the same child.
const UNWATCHED: Duration = Duration::from_secs(15);
/// Time in which the child must take a message.
const STALL: Duration = Duration::from_secs(10);
/// Time of the child for its own end.
const LAST: Duration = Duration::from_secs(1);
/// Pause between two looks at a full pipe, and at a child that ends.
const LOOK: Duration = Duration::from_millis(5);
/// Niceness of the child: every other thread comes first.
const NICE: i32 = 19;

/// Content that a child draws.
pub(super) struct Source {
    /// Number of the session.
    pub begun: u64,
    /// Scene, encoded.
    pub scene: Arc<[u8]>,
    /// Newest state of the tools; the outer `None`: the session has ended.
    pub newest: Box<dyn FnMut() -> Option<Option<Hands>> + Send>,
}

/// A child that draws.
pub(super) struct Drawing {
    begun: u64,
    ends: Arc<Ends>,
}

/// Viewers' ends of a stream; `None` after its end.
struct Ends(Mutex<Option<Senders>>);

struct Senders {
    begin: watch::Sender<Option<Segment>>,
    further: broadcast::Sender<Segment>,
}

impl Ends {
    fn with<T>(&self, act: impl FnOnce(&mut Option<Senders>) -> T) -> T {
        act(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Ends the stream of all viewers.
    fn end(&self) {
        self.with(|ends| *ends = None);
    }

    fn is_over(&self) -> bool {
        self.with(|ends| ends.is_none())
    }

    fn is_unwatched(&self) -> bool {
        self.with(|ends| {
            ends.as_ref()
                .is_none_or(|ends| ends.further.receiver_count() == 0)
        })
    }

    /// Ends the stream unless a viewer has come in the meantime.
    fn end_unwatched(&self) -> bool {
        self.with(|ends| {
            let is_unwatched = ends
                .as_ref()
                .is_none_or(|ends| ends.further.receiver_count() == 0);
            if is_unwatched {
                *ends = None;
            }
            is_unwatched
        })
    }
}

impl Drawing {
    /// Starts the program for a station.
    ///
    /// # Errors
    /// The program cannot be started: one sentence.
    pub fn start(program: &Path, station: Arc<str>, source: Source) -> Result<Self, String> {
        Self::start_with(program, station, source, UNWATCHED)
    }

    fn start_with(
        program: &Path,
        station: Arc<str>,
        source: Source,
        unwatched: Duration,
    ) -> Result<Self, String> {
        let failed = |error: std::io::Error| format!("{PROGRAM} cannot be started: {error}");
        let mut child = Command::new(program)
            .arg("live")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(failed)?;
        idle(&child);
        let ends = Arc::new(Ends(Mutex::new(Some(Senders {
            begin: watch::Sender::new(None),
            further: broadcast::Sender::new(QUEUE),
        }))));
        let drawing = Self {
            begun: source.begun,
            ends: ends.clone(),
        };
        let (Some(to), Some(from)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(format!("{PROGRAM} has no pipes"));
        };
        let reader = {
            let (ends, station) = (ends.clone(), station.clone());
            move || {
                if let Err(why) = hand_on(&mut BufReader::new(from), &ends) {
                    tracing::warn!("station {station}: {PROGRAM}: {why}");
                }
                ends.end();
            }
        };
        let writer = move || {
            let pipe = Pipe { to };
            let fed = feed(pipe, source, &ends, unwatched);
            ends.end();
            let ended = reap(&mut child);
            match fed {
                Ok(why) => tracing::info!("station {station}: the live view ends: {why}; {ended}"),
                Err(why) => {
                    tracing::warn!("station {station}: the live view ends: {why}; {ended}")
                }
            }
        };
        for (name, run) in [
            (
                "sulcus-draw-out",
                Box::new(reader) as Box<dyn FnOnce() + Send>,
            ),
            ("sulcus-draw-in", Box::new(writer)),
        ] {
            let thread = std::thread::Builder::new().name(name.into());
            thread.spawn(run).map_err(failed)?;
        }
        Ok(drawing)
    }

    /// Number of the session.
    pub fn begun(&self) -> u64 {
        self.begun
    }

    /// Whether the stream has ended.
    pub fn is_over(&self) -> bool {
        self.ends.is_over()
    }

    /// A further viewer; `None` after the end.
    pub fn watch(&self) -> Option<Live> {
        self.ends.with(|ends| {
            let ends = ends.as_ref()?;
            Some(Live {
                begin: ends.begin.subscribe(),
                further: ends.further.subscribe(),
            })
        })
    }
}

/// Lets a child run only when nothing else wants to.
pub(super) fn idle(child: &Child) {
    let id = i32::try_from(child.id())
        .ok()
        .and_then(rustix::process::Pid::from_raw);
    // An error leaves the child at the console's own niceness.
    if let Some(id) = id
        && let Err(error) = rustix::process::setpriority_process(Some(id), NICE)
    {
        tracing::debug!("{PROGRAM}: niceness stays: {error}");
    }
}

/// Hands the parts of the child to all viewers until the child's end.
fn hand_on(from: &mut impl std::io::Read, ends: &Ends) -> Result<(), String> {
    let mut has_begun = false;
    while let Some((kind, body)) = live::read(from).map_err(|error| error.to_string())? {
        let part: Segment = body.into();
        let is_taken = ends.with(|ends| {
            let Some(ends) = ends else { return true };
            match kind {
                Kind::Begin if !has_begun => {
                    ends.begin.send_replace(Some(part));
                    has_begun = true;
                }
                // An error means that nobody watches.
                Kind::Further if has_begun => drop(ends.further.send(part)),
                _ => return false,
            }
            true
        });
        if !is_taken {
            return Err(format!("a message of kind {kind:?} at the wrong place"));
        }
    }
    Ok(())
}

/// Writes scene and states to the child. Returns the reason of a regular end.
fn feed(
    mut pipe: Pipe,
    mut source: Source,
    ends: &Ends,
    unwatched: Duration,
) -> Result<&'static str, String> {
    let failed = |error: live::PipeError| error.to_string();
    pipe.set_nonblocking().map_err(|error| error.to_string())?;
    live::write(&mut pipe, Kind::Scene, &source.scene).map_err(failed)?;
    let mut last = None;
    let mut watched = Instant::now();
    loop {
        if ends.is_over() {
            return Err("the program has ended".into());
        }
        if !ends.is_unwatched() {
            watched = Instant::now();
        } else if watched.elapsed() >= unwatched && ends.end_unwatched() {
            return Ok("nobody watches");
        }
        let Some(newest) = (source.newest)() else {
            return Ok("the session has ended");
        };
        if let Some(hands) = newest.filter(|hands| last != Some(hands.tick)) {
            last = Some(hands.tick);
            let bytes = hands.to_bytes().map_err(|error| error.to_string())?;
            live::write(&mut pipe, Kind::Hands, &bytes).map_err(failed)?;
        }
        std::thread::sleep(EVERY);
    }
}

/// Pipe to a child. A write that the child does not take for [`STALL`] is an error.
struct Pipe {
    to: ChildStdin,
}

impl Pipe {
    fn set_nonblocking(&self) -> std::io::Result<()> {
        let flags = rustix::fs::fcntl_getfl(&self.to)?;
        Ok(rustix::fs::fcntl_setfl(&self.to, flags | OFlags::NONBLOCK)?)
    }
}

impl Write for Pipe {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let begin = Instant::now();
        loop {
            match self.to.write(bytes) {
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    if begin.elapsed() >= STALL {
                        return Err(ErrorKind::TimedOut.into());
                    }
                    std::thread::sleep(LOOK);
                }
                other => return other,
            }
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.to.flush()
    }
}

/// Waits for the child's end, and ends the child after [`LAST`]. Returns a text about the end.
fn reap(child: &mut Child) -> String {
    let begin = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(end)) => return format!("{PROGRAM}: {end}"),
            Ok(None) if begin.elapsed() < LAST => std::thread::sleep(LOOK),
            Ok(None) => {
                let killed = child.kill().and_then(|()| child.wait());
                return match killed {
                    Ok(end) => format!("{PROGRAM} had to be ended: {end}"),
                    Err(error) => format!("{PROGRAM} cannot be ended: {error}"),
                };
            }
            Err(error) => return format!("{PROGRAM} cannot be waited for: {error}"),
        }
    }
}

#[cfg(test)]
mod tests;
