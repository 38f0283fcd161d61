//! Starting, steering and ending a server from another thread.

use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::thread::JoinHandle;

use sulcus_proto::control::Command;
use sulcus_proto::{SessionSummary, Ticket};
use tokio::sync::{Mutex, watch};

use crate::net;
use crate::net::identity::{Identity, fingerprint};
use crate::net::transport;
use crate::net::{Phase, Shared, Station};
use crate::session::levels::{Levels, Taken};
use crate::{ServerConfig, ServerError};

/// A station's server.
pub struct Server;

/// A running server. Dropping it stops at once, without a goodbye (recordings are still finished);
/// [`ServerHandle::shutdown`] and [`ServerHandle::join`] end it properly.
pub struct ServerHandle {
    local_addr: SocketAddr,
    certificate_der: Vec<u8>,
    ticket: Ticket,
    levels: Levels,
    lifted: watch::Sender<u64>,
    phase: watch::Sender<Phase>,
    thread: Option<JoinHandle<Result<Vec<SessionSummary>, ServerError>>>,
}

impl Server {
    /// Binds the socket, then serves on threads of its own.
    ///
    /// # Errors
    /// A busy port, an unusable folder, or a value in the configuration that makes no sense.
    pub fn start(config: ServerConfig) -> Result<ServerHandle, ServerError> {
        config.validate()?;
        std::fs::create_dir_all(&config.recordings).map_err(|source| ServerError::Recordings {
            path: config.recordings.clone(),
            source,
        })?;
        // Found out now, not when the first student has sat down.
        crate::outlets::recording::station_key(config.station_key.as_deref())?;
        let identity = Identity::generate(&config.station)?;
        let quic = transport::server_config(&identity)?;
        let socket = bind(config.listen)?;
        let local_addr = socket.local_addr()?;
        let certificate_der = identity.certificate.to_vec();
        let ticket = Ticket {
            token: config.token.clone(),
            fingerprint: fingerprint(&certificate_der)?,
        };

        let levels = Levels::default();
        levels.station(Command::ForceLimit(config.force_limit_n));
        let (lifted, lifted_out) = watch::channel(0);
        let (phase, phase_out) = watch::channel(Phase::Serve);
        let station = Station {
            epoch: 0,
            summaries: Vec::new(),
        };
        let shared = Arc::new(Shared {
            scene_hash: *blake3::hash(&config.scene_bytes).as_bytes(),
            config,
            phase: phase_out,
            levels: levels.clone(),
            lifted: lifted_out,
            station: Arc::new(Mutex::new(station)),
        });
        // All sockets of a station on one thread: more would only add wake-ups.
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let thread = std::thread::Builder::new()
            .name("sulcus-net".into())
            .spawn(move || {
                let served = runtime.block_on(net::serve(socket, quic, shared));
                // Sessions have ended; whatever is stuck in the system is not waited for.
                runtime.shutdown_background();
                served
            })?;
        Ok(ServerHandle {
            local_addr,
            certificate_der,
            ticket,
            levels,
            lifted,
            phase,
            thread: Some(thread),
        })
    }
}

impl ServerHandle {
    /// Where the server listens.
    pub fn local_addr(&self) -> SocketAddr {
        self.local_addr
    }

    /// The server's certificate, for clients to pin.
    pub fn certificate_der(&self) -> &[u8] {
        &self.certificate_der
    }

    /// Token and certificate fingerprint in one line, for a person to copy.
    pub fn ticket(&self) -> &Ticket {
        &self.ticket
    }

    /// Sets the pause or the force limit of the station's side, at once and for every session, the running one and those
    /// that begin later, until it is set again. A student's connection cannot lift either. `false`: the server has
    /// ended. A limit that is no force (negative, infinite, not a number) changes nothing.
    pub fn command(&self, command: Command) -> bool {
        match self.levels.station(command) {
            Taken::Set => {}
            Taken::Lifted => self.lifted.send_modify(|times| *times += 1),
            Taken::NoForce(newtons) => tracing::warn!(
                "force limit {newtons} ignored: expected 0 (the scene's) or a positive force"
            ),
        }
        !self.is_finished()
    }

    /// Ends the running session with a goodbye and stops serving; returns at once.
    pub fn shutdown(&self) {
        // Nobody listens: it has ended already.
        let _ = self.phase.send(Phase::Shutdown);
    }

    /// Whether the server has ended.
    pub fn is_finished(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Waits until the server has ended (after [`ServerHandle::shutdown`]) and returns the summaries
    /// of its sessions, oldest first.
    ///
    /// # Errors
    /// If the network thread failed.
    pub fn join(mut self) -> Result<Vec<SessionSummary>, ServerError> {
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) => Err(ServerError::Crashed),
            None => Ok(Vec::new()),
        }
    }
}

impl Drop for ServerHandle {
    fn drop(&mut self) {
        if let Some(thread) = self.thread.take() {
            let _ = self.phase.send(Phase::Halt);
            // Its result has no taker; threads must not outlive the handle.
            let _ = thread.join();
        }
    }
}

fn bind(listen: SocketAddr) -> Result<UdpSocket, ServerError> {
    UdpSocket::bind(listen).map_err(|source| match source.kind() {
        std::io::ErrorKind::AddrInUse => ServerError::PortBusy { listen },
        _ => ServerError::Listen { listen, source },
    })
}
