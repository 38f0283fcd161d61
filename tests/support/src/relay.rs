//! A relay of UDP packets between one client and a server: cuts the path, or comes from another port as a NAT does.

use std::net::{SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// Shared state of both directions.
struct Path {
    cut: AtomicBool,
    over: AtomicBool,
    /// Socket towards the server; replaced by [`Relay::rebind`].
    outer: Mutex<Arc<UdpSocket>>,
    client: Mutex<Option<SocketAddr>>,
}

/// A relay on loopback. Its threads end with it.
pub struct Relay {
    /// Address for clients.
    pub address: SocketAddr,
    server: SocketAddr,
    path: Arc<Path>,
    inner: Arc<UdpSocket>,
    threads: Vec<JoinHandle<()>>,
}

const WAIT: Duration = Duration::from_millis(5);

fn locked<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}

fn socket() -> Arc<UdpSocket> {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("a socket");
    let waits = socket.set_read_timeout(Some(WAIT));
    waits.expect("a timeout above zero");
    Arc::new(socket)
}

impl Relay {
    /// A relay to `server`, with an address of its own.
    ///
    /// # Panics
    /// The system has no socket left.
    pub fn to(server: SocketAddr) -> Self {
        let inner = socket();
        let path = Arc::new(Path {
            cut: AtomicBool::new(false),
            over: AtomicBool::new(false),
            outer: Mutex::new(socket()),
            client: Mutex::default(),
        });
        let mut relay = Self {
            address: inner.local_addr().expect("a bound socket"),
            server,
            path: path.clone(),
            inner: inner.clone(),
            threads: Vec::new(),
        };
        relay.threads.push(std::thread::spawn(move || {
            let mut bytes = [0; 2048];
            while !path.over.load(Ordering::Relaxed) {
                let Ok((length, from)) = inner.recv_from(&mut bytes) else {
                    continue;
                };
                *locked(&path.client) = Some(from);
                if !path.cut.load(Ordering::Relaxed) {
                    let outer = locked(&path.outer).clone();
                    let _ = outer.send_to(&bytes[..length], server);
                }
            }
        }));
        let first = locked(&relay.path.outer).clone();
        relay.listen(first);
        relay
    }

    /// Carries packets of the server back, as long as the relay lives.
    fn listen(&mut self, outer: Arc<UdpSocket>) {
        let (path, inner) = (self.path.clone(), self.inner.clone());
        self.threads.push(std::thread::spawn(move || {
            let mut bytes = [0; 2048];
            while !path.over.load(Ordering::Relaxed) {
                let Ok((length, _)) = outer.recv_from(&mut bytes) else {
                    continue;
                };
                let client = *locked(&path.client);
                if let Some(client) = client
                    && !path.cut.load(Ordering::Relaxed)
                {
                    let _ = inner.send_to(&bytes[..length], client);
                }
            }
        }));
    }

    /// Cuts the path in both directions, or joins it again.
    pub fn cut(&self, cut: bool) {
        self.path.cut.store(cut, Ordering::Relaxed);
    }

    /// Goes on from another port towards the server, as after a NAT has forgotten the client.
    ///
    /// # Panics
    /// The system has no socket left.
    pub fn rebind(&mut self) {
        let outer = socket();
        *locked(&self.path.outer) = outer.clone();
        self.listen(outer);
    }

    /// Address of the server behind the relay.
    pub fn server(&self) -> SocketAddr {
        self.server
    }
}

impl Drop for Relay {
    fn drop(&mut self) {
        self.path.over.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}
