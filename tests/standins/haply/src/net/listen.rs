//! Listeners of both ports.

use std::io;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use super::{Shared, channel, events};

/// Ports that no system hands out to outgoing connections by itself.
const PORTS: std::ops::Range<u16> = 20_000..32_000;

/// Time between two looks at a listener.
const LOOK: Duration = Duration::from_millis(2);

/// A port of the service.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Door {
    /// Simulation channel and HTTP.
    Simulation,
    /// Channel of events.
    Events,
}

/// Listens on a port of this machine; on a free one where none is given.
///
/// The free port lies below those of outgoing connections: a refused port can so be taken again later.
pub(crate) fn bind(port: Option<u16>) -> io::Result<TcpListener> {
    if let Some(port) = port {
        return TcpListener::bind((Ipv4Addr::LOCALHOST, port));
    }
    let count = PORTS.len() as u64;
    let start = crate::clock::now_ns() / 1_000 + u64::from(std::process::id()) * 613;
    for attempt in 0..count {
        let offset = (start + attempt * 7) % count;
        let port = PORTS.start + u16::try_from(offset).unwrap_or(0);
        if let Ok(listener) = TcpListener::bind((Ipv4Addr::LOCALHOST, port)) {
            return Ok(listener);
        }
    }
    TcpListener::bind((Ipv4Addr::LOCALHOST, 0))
}

/// Starts the thread of a listener.
pub(crate) fn spawn(
    shared: &Arc<Shared>,
    door: Door,
    listener: TcpListener,
) -> io::Result<JoinHandle<()>> {
    let port = listener.local_addr()?.port();
    listener.set_nonblocking(true)?;
    let shared = Arc::clone(shared);
    thread::Builder::new()
        .name(format!("haply-{port}"))
        .spawn(move || run(&shared, door, listener, port))
}

fn run(shared: &Arc<Shared>, door: Door, listener: TcpListener, port: u16) {
    let mut listener = Some(listener);
    while !shared.stopped() {
        if shared.refuses() {
            if listener.take().is_some() {
                shared.door_closed(true);
            }
        } else if listener.is_none() {
            listener = open_again(port);
            if listener.is_some() {
                shared.door_closed(false);
            }
        }
        match listener.as_ref().map(TcpListener::accept) {
            Some(Ok((stream, _))) => start(shared, door, stream),
            _ => thread::sleep(LOOK),
        }
    }
}

fn open_again(port: u16) -> Option<TcpListener> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).ok()?;
    listener.set_nonblocking(true).ok()?;
    Some(listener)
}

fn start(shared: &Arc<Shared>, door: Door, stream: TcpStream) {
    let ready = stream
        .set_nonblocking(false)
        .and_then(|()| stream.set_nodelay(true));
    let Ok(copy) = ready.and_then(|()| stream.try_clone()) else {
        return;
    };
    let key = shared.keep(door, copy);
    let owned = Arc::clone(shared);
    let name = format!("haply-client-{key}");
    let spawned = thread::Builder::new().name(name).spawn(move || {
        match door {
            Door::Simulation => channel::serve(&owned, key, stream),
            Door::Events => events::serve(&owned, stream),
        }
        owned.forget(key);
    });
    if let Err(error) = spawned {
        eprintln!("no thread for a client: {error}");
        shared.forget(key);
    }
}
