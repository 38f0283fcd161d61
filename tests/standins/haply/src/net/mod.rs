//! Sockets of the service.

mod channel;
mod events;
mod http;
mod listen;
mod tap;

use std::collections::BTreeMap;
use std::net::{Shutdown, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use crate::clock::now_ns;
use crate::world::World;

pub(crate) use listen::{Door, bind, spawn};

/// Number of ports.
const DOORS: usize = 2;

/// What every thread of the service shares.
#[derive(Debug)]
pub(crate) struct Shared {
    world: Mutex<World>,
    sockets: Mutex<Sockets>,
    stop: AtomicBool,
    refuse: AtomicBool,
    /// Number of ports that do not listen.
    closed: AtomicUsize,
    stall_until_ns: AtomicU64,
}

/// Open sockets of clients.
#[derive(Debug, Default)]
struct Sockets {
    last: u64,
    open: BTreeMap<u64, (Door, TcpStream)>,
    /// Sockets that a fault shut down.
    dropped: Vec<u64>,
}

impl Shared {
    /// Shared state around a world.
    pub(crate) fn new(world: World) -> Self {
        Self {
            world: Mutex::new(world),
            sockets: Mutex::default(),
            stop: AtomicBool::new(false),
            refuse: AtomicBool::new(false),
            closed: AtomicUsize::new(0),
            stall_until_ns: AtomicU64::new(0),
        }
    }

    /// The world; a panic of another thread does not take it away.
    pub(crate) fn world(&self) -> MutexGuard<'_, World> {
        self.world.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn sockets(&self) -> MutexGuard<'_, Sockets> {
        self.sockets.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// True from the end of the service on.
    pub(crate) fn stopped(&self) -> bool {
        self.stop.load(Ordering::Acquire)
    }

    /// Ends the service: no new connection, and every connection breaks.
    pub(crate) fn stop(&self) {
        self.stop.store(true, Ordering::Release);
        for (_, socket) in self.sockets().open.values() {
            let _ = socket.shutdown(Shutdown::Both);
        }
    }

    /// True while no new connection is taken.
    pub(crate) fn refuses(&self) -> bool {
        self.refuse.load(Ordering::Acquire)
    }

    /// Takes new connections or not, and waits up to 2 s until both ports do so.
    pub(crate) fn refuse(&self, on: bool) {
        self.refuse.store(on, Ordering::Release);
        let wanted = if on { DOORS } else { 0 };
        for _ in 0..2000 {
            if self.stopped() || self.closed.load(Ordering::Acquire) == wanted {
                return;
            }
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// A port stopped to listen, or listens again.
    pub(crate) fn door_closed(&self, closed: bool) {
        if closed {
            self.closed.fetch_add(1, Ordering::AcqRel);
        } else {
            self.closed.fetch_sub(1, Ordering::AcqRel);
        }
    }

    /// No message is handled for this time.
    pub(crate) fn stall(&self, ms: u64) {
        self.stall_until_ns
            .store(now_ns() + ms * 1_000_000, Ordering::Release);
    }

    /// Waits for the end of a stall.
    pub(crate) fn wait_for_stall(&self) {
        while !self.stopped() {
            let left = self
                .stall_until_ns
                .load(Ordering::Acquire)
                .saturating_sub(now_ns());
            if left == 0 {
                return;
            }
            thread::sleep(Duration::from_nanos(left.min(5_000_000)));
        }
    }

    /// Breaks every connection of a door.
    pub(crate) fn drop_all(&self, wanted: Door) {
        let mut sockets = self.sockets();
        let hit: Vec<u64> = sockets
            .open
            .iter()
            .filter(|(_, (door, _))| *door == wanted)
            .map(|(key, _)| *key)
            .collect();
        for key in &hit {
            if let Some((_, socket)) = sockets.open.get(key) {
                let _ = socket.shutdown(Shutdown::Both);
            }
        }
        sockets.dropped.extend(hit);
    }

    /// Number of open connections.
    pub(crate) fn open(&self) -> usize {
        self.sockets().open.len()
    }

    /// Keeps a socket to break it later; its key.
    fn keep(&self, door: Door, socket: TcpStream) -> u64 {
        let mut sockets = self.sockets();
        sockets.last += 1;
        let key = sockets.last;
        sockets.open.insert(key, (door, socket));
        key
    }

    /// True where a fault broke the socket.
    fn was_dropped(&self, key: u64) -> bool {
        self.sockets().dropped.contains(&key)
    }

    /// Forgets a socket.
    fn forget(&self, key: u64) {
        let mut sockets = self.sockets();
        sockets.open.remove(&key);
        sockets.dropped.retain(|other| *other != key);
    }
}
