//! A relay of UDP packets through two paths.
//!
//! The relay behaves as a NAT: each client has a port of its own towards the server. All clients share both paths.

use std::collections::BTreeMap;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use sulcus_link::clock::monotonic_ns;
use sulcus_link::schedule::exact_timers;

use crate::{Change, Conditions, ConditionsError, Counts, Fate, Network, Path, Script, Wire};

/// Longest wait of a thread that looks for the end of the relay.
const WAIT: Duration = Duration::from_millis(20);
/// Largest number of clients. A further client takes the place of the client that has been silent for the longest time.
const CLIENTS: usize = 256;
/// Largest number of packets on their way in one direction. A further packet counts as lost at a full queue.
const ON_THEIR_WAY: usize = 65_536;

/// A packet on its way, with the socket that sends it.
#[derive(Clone)]
struct Packet {
    socket: Arc<UdpSocket>,
    to: SocketAddr,
    bytes: Vec<u8>,
}

/// A client of the relay and its socket towards the server.
struct Client {
    outer: Arc<UdpSocket>,
    /// Whether the thread of `outer` may end.
    is_over: Arc<AtomicBool>,
    /// Time of the newest packet.
    heard_ns: u64,
}

/// State that all threads share.
struct Inside {
    up: Wire<Packet>,
    down: Wire<Packet>,
    clients: BTreeMap<SocketAddr, Client>,
    /// End of an outage of the script.
    cut_until_ns: Option<u64>,
    threads: Vec<JoinHandle<()>>,
}

struct Shared {
    inner: Arc<UdpSocket>,
    server: SocketAddr,
    inside: Mutex<Inside>,
    /// Rung for a packet that is due before all others.
    changed: Condvar,
    is_over: AtomicBool,
}

/// Packets of both directions by their fate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RelayCounts {
    /// From clients to the server.
    pub up: Counts,
    /// From the server to clients.
    pub down: Counts,
}

/// A relay with threads of its own, which end with it.
pub struct Relay {
    address: SocketAddr,
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

fn locked(inside: &Mutex<Inside>) -> MutexGuard<'_, Inside> {
    inside.lock().unwrap_or_else(PoisonError::into_inner)
}

fn socket(address: SocketAddr) -> io::Result<Arc<UdpSocket>> {
    let socket = UdpSocket::bind(address)?;
    socket.set_read_timeout(Some(WAIT))?;
    Ok(Arc::new(socket))
}

/// Any port of the address family of `server`. A server on loopback is reached from loopback.
fn any_port(server: SocketAddr) -> SocketAddr {
    match server {
        SocketAddr::V4(server) if server.ip().is_loopback() => (Ipv4Addr::LOCALHOST, 0).into(),
        SocketAddr::V4(_) => (Ipv4Addr::UNSPECIFIED, 0).into(),
        SocketAddr::V6(server) if server.ip().is_loopback() => (*server.ip(), 0).into(),
        SocketAddr::V6(_) => (std::net::Ipv6Addr::UNSPECIFIED, 0).into(),
    }
}

impl Relay {
    /// A relay on a free port of loopback that carries every packet at once.
    ///
    /// # Errors
    /// The system has no socket or thread.
    pub fn to(server: SocketAddr) -> io::Result<Self> {
        let plain = Conditions::default();
        Self::start((Ipv4Addr::LOCALHOST, 0).into(), server, [plain, plain], 0)
    }

    /// A relay on a free port of loopback with the conditions of `network`.
    ///
    /// # Errors
    /// The system has no socket or thread.
    pub fn through(network: Network, server: SocketAddr, seed: u64) -> io::Result<Self> {
        let conditions = [network.up(), network.down()];
        Self::start((Ipv4Addr::LOCALHOST, 0).into(), server, conditions, seed)
    }

    /// A relay on `listen` to `server`. The conditions are those of the ways to the server and back.
    ///
    /// # Errors
    /// The conditions are invalid, the address is in use, or the system has no socket or thread.
    pub fn start(
        listen: SocketAddr,
        server: SocketAddr,
        [up, down]: [Conditions; 2],
        seed: u64,
    ) -> io::Result<Self> {
        for conditions in [&up, &down] {
            let invalid = |error| io::Error::new(io::ErrorKind::InvalidInput, error);
            conditions.check().map_err(invalid)?;
        }
        let inner = socket(listen)?;
        let address = inner.local_addr()?;
        let shared = Arc::new(Shared {
            inner,
            server,
            inside: Mutex::new(Inside {
                up: Wire::new(Path::new(up, seed)),
                // Another sequence of random numbers than that of the way up.
                down: Wire::new(Path::new(down, !seed)),
                clients: BTreeMap::new(),
                cut_until_ns: None,
                threads: Vec::new(),
            }),
            changed: Condvar::new(),
            is_over: AtomicBool::new(false),
        });
        let (of_clients, of_delivery) = (shared.clone(), shared.clone());
        let mut relay = Self {
            address,
            shared,
            threads: Vec::new(),
        };
        relay.thread(move || listen_to_clients(&of_clients))?;
        relay.thread(move || deliver(&of_delivery))?;
        Ok(relay)
    }

    fn thread(&mut self, run: impl FnOnce() + Send + 'static) -> io::Result<()> {
        let thread = std::thread::Builder::new().name("sulcus-relay".into());
        self.threads.push(thread.spawn(run)?);
        Ok(())
    }

    /// Address for clients.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Address of the server.
    pub fn server(&self) -> SocketAddr {
        self.shared.server
    }

    /// Packets so far.
    pub fn counts(&self) -> RelayCounts {
        let inside = locked(&self.shared.inside);
        RelayCounts {
            up: inside.up.counts(),
            down: inside.down.counts(),
        }
    }

    /// Cuts both directions, or joins them again. Packets on their way arrive.
    pub fn cut(&self, is_cut: bool) {
        locked(&self.shared.inside).cut(is_cut);
    }

    /// Replaces the conditions of the ways to the server and back.
    ///
    /// # Errors
    /// The conditions are invalid; those in force stay.
    pub fn change(&self, [up, down]: [Conditions; 2]) -> Result<(), ConditionsError> {
        up.check()?;
        down.check()?;
        let mut inside = locked(&self.shared.inside);
        inside.up.path().change(up);
        inside.down.path().change(down);
        Ok(())
    }

    /// Goes on from other ports towards the server, as after a NAT has forgotten its clients.
    ///
    /// # Errors
    /// The system has no socket or thread.
    pub fn rebind(&self) -> io::Result<()> {
        rebind(&self.shared)
    }

    /// Runs `script` from now on, in a thread of its own.
    ///
    /// # Errors
    /// The system has no thread.
    pub fn run(&mut self, script: Script) -> io::Result<()> {
        let shared = self.shared.clone();
        let began_ns = monotonic_ns();
        self.thread(move || perform(&shared, &script, began_ns))
    }
}

impl Drop for Relay {
    fn drop(&mut self) {
        self.shared.is_over.store(true, Ordering::Relaxed);
        self.shared.changed.notify_all();
        let of_clients = std::mem::take(&mut locked(&self.shared.inside).threads);
        for thread in self.threads.drain(..).chain(of_clients) {
            // A panic of a thread was printed; the relay ends in any case.
            let _ = thread.join();
        }
    }
}

impl Inside {
    fn cut(&mut self, is_cut: bool) {
        self.up.path().cut(is_cut);
        self.down.path().cut(is_cut);
    }
}

impl Shared {
    fn is_over(&self) -> bool {
        self.is_over.load(Ordering::Relaxed)
    }

    /// Sends a packet through a direction: at once if nothing delays it, else through the thread of the delivery.
    fn carry(&self, packet: Packet, is_up: bool) {
        let now_ns = monotonic_ns();
        let mut inside = locked(&self.inside);
        let wire = if is_up {
            &mut inside.up
        } else {
            &mut inside.down
        };
        let earliest_ns = wire.next_ns();
        let bytes = packet.bytes.len();
        let fate = if wire.waiting() < ON_THEIR_WAY {
            wire.send(now_ns, packet, bytes)
        } else {
            wire.path().overflow()
        };
        let Fate::Arrives { at_ns, .. } = fate else {
            return;
        };
        if at_ns <= now_ns {
            let due = std::iter::from_fn(|| wire.receive(now_ns));
            due.for_each(|packet| send(&packet));
        } else if earliest_ns.is_none_or(|earliest| at_ns < earliest) {
            self.changed.notify_one();
        }
    }
}

fn send(packet: &Packet) {
    // A refused packet is a lost packet, as in every network.
    let _ = packet.socket.send_to(&packet.bytes, packet.to);
}

/// Receives packets of clients until the relay ends.
fn listen_to_clients(shared: &Arc<Shared>) {
    let mut bytes = [0; 2048];
    while !shared.is_over() {
        let Ok((length, from)) = shared.inner.recv_from(&mut bytes) else {
            continue;
        };
        let Ok(outer) = outer_of(shared, from) else {
            continue;
        };
        let packet = Packet {
            socket: outer,
            to: shared.server,
            bytes: bytes[..length].to_vec(),
        };
        shared.carry(packet, true);
    }
}

/// Socket towards the server for the client at `from`.
fn outer_of(shared: &Arc<Shared>, from: SocketAddr) -> io::Result<Arc<UdpSocket>> {
    let mut inside = locked(&shared.inside);
    if let Some(client) = inside.clients.get_mut(&from) {
        client.heard_ns = monotonic_ns();
        return Ok(client.outer.clone());
    }
    if inside.clients.len() == CLIENTS {
        let silent = inside
            .clients
            .iter()
            .min_by_key(|(_, client)| client.heard_ns);
        if let Some(address) = silent.map(|(address, _)| *address)
            && let Some(client) = inside.clients.remove(&address)
        {
            client.is_over.store(true, Ordering::Relaxed);
        }
    }
    let client = client(shared, from, &mut inside.threads)?;
    let outer = client.outer.clone();
    inside.clients.insert(from, client);
    Ok(outer)
}

/// A socket for the client at `from`, with a thread that receives the server's answers.
fn client(
    shared: &Arc<Shared>,
    from: SocketAddr,
    threads: &mut Vec<JoinHandle<()>>,
) -> io::Result<Client> {
    let outer = socket(any_port(shared.server))?;
    let is_over = Arc::new(AtomicBool::new(false));
    let (of_thread, of_socket, is_client_over) = (shared.clone(), outer.clone(), is_over.clone());
    let thread = std::thread::Builder::new().name("sulcus-relay".into());
    threads.push(thread.spawn(move || {
        let mut bytes = [0; 2048];
        while !of_thread.is_over() && !is_client_over.load(Ordering::Relaxed) {
            let Ok((length, sender)) = of_socket.recv_from(&mut bytes) else {
                continue;
            };
            if sender == of_thread.server {
                let packet = Packet {
                    socket: of_thread.inner.clone(),
                    to: from,
                    bytes: bytes[..length].to_vec(),
                };
                of_thread.carry(packet, false);
            }
        }
    })?);
    // Threads of clients that are gone.
    threads.retain(|thread| !thread.is_finished());
    Ok(Client {
        outer,
        is_over,
        heard_ns: monotonic_ns(),
    })
}

fn rebind(shared: &Arc<Shared>) -> io::Result<()> {
    let mut inside = locked(&shared.inside);
    let addresses: Vec<SocketAddr> = inside.clients.keys().copied().collect();
    for from in addresses {
        let new = client(shared, from, &mut inside.threads)?;
        if let Some(old) = inside.clients.insert(from, new) {
            old.is_over.store(true, Ordering::Relaxed);
        }
    }
    Ok(())
}

/// Sends packets when they are due, until the relay ends.
fn deliver(shared: &Shared) {
    exact_timers();
    let mut inside = locked(&shared.inside);
    while !shared.is_over() {
        let now_ns = monotonic_ns();
        let mut due = Vec::new();
        for is_up in [true, false] {
            let wire = if is_up {
                &mut inside.up
            } else {
                &mut inside.down
            };
            due.extend(std::iter::from_fn(|| wire.receive(now_ns)));
        }
        if !due.is_empty() {
            drop(inside);
            due.iter().for_each(send);
            inside = locked(&shared.inside);
            continue;
        }
        let next = [inside.up.next_ns(), inside.down.next_ns()];
        let next_ns = next.into_iter().flatten().min();
        let wait = next_ns.map_or(WAIT, |next| Duration::from_nanos(next - now_ns).min(WAIT));
        inside = shared
            .changed
            .wait_timeout(inside, wait)
            .unwrap_or_else(PoisonError::into_inner)
            .0;
    }
}

/// Makes the changes of a script at their times.
fn perform(shared: &Arc<Shared>, script: &Script, began_ns: u64) {
    let mut changes = script.changes().iter().peekable();
    while !shared.is_over() {
        let now_ns = monotonic_ns();
        let since = Duration::from_nanos(now_ns - began_ns);
        while let Some((_, change)) = changes.next_if(|(at, _)| *at <= since) {
            make(shared, *change, now_ns);
        }
        let mut inside = locked(&shared.inside);
        if inside.cut_until_ns.is_some_and(|until| until <= now_ns) {
            inside.cut_until_ns = None;
            inside.cut(false);
        }
        let is_done = changes.peek().is_none() && inside.cut_until_ns.is_none();
        drop(inside);
        if is_done {
            return;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn make(shared: &Arc<Shared>, change: Change, now_ns: u64) {
    let mut inside = locked(&shared.inside);
    match change {
        Change::Network(network) => {
            inside.up.path().change(network.up());
            inside.down.path().change(network.down());
        }
        Change::Rate(rate) => {
            let Inside { up, down, .. } = &mut *inside;
            for path in [up.path(), down.path()] {
                let conditions = Conditions {
                    rate: Some(rate),
                    ..*path.conditions()
                };
                path.change(conditions);
            }
        }
        Change::Outage(length) => {
            let length_ns = u64::try_from(length.as_nanos()).unwrap_or(u64::MAX);
            inside.cut_until_ns = Some(now_ns.saturating_add(length_ns));
            inside.cut(true);
        }
        Change::Rebind => {
            drop(inside);
            // Without a socket the relay goes on as before.
            let _ = rebind(shared);
        }
    }
}
