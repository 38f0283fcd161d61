//! Start, control and end of a server from another thread.

use std::net::{SocketAddr, UdpSocket};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;

use sulcus_link::schedule::fifo;
use sulcus_proto::control::Command;
use sulcus_proto::station::StationStatus;
use sulcus_proto::{SessionSummary, Ticket};
use tokio::sync::mpsc::{UnboundedSender, unbounded_channel};
use tokio::sync::watch;

use crate::net;
use crate::net::identity::{Identity, fingerprint};
use crate::net::transport;
use crate::net::{Net, Stage};
use crate::session::handoff::Provoked;
use crate::session::levels::Taken;
use crate::session::realtime::PRIORITY;
use crate::station::door::{Door, ToStation};
#[cfg(feature = "console")]
use crate::station::quota::Quota;
use crate::station::shared::Shared;
use crate::{ServerConfig, ServerError};

/// Hash of the tick self-test, computed once in a process.
static SELF_TEST: OnceLock<u64> = OnceLock::new();

/// A server of stations.
pub struct Server;

/// A running server.
///
/// A drop ends the server without a goodbye to the client. The drop blocks until the recording is finished, at most
/// about 22 seconds. [`ServerHandle::shutdown`] and [`ServerHandle::join`] end the server with a goodbye.
pub struct ServerHandle {
    local_addr: SocketAddr,
    certificate_der: Vec<u8>,
    ticket: Ticket,
    doors: Vec<Door>,
    stage: watch::Sender<Stage>,
    renewals: UnboundedSender<quinn::ServerConfig>,
    #[cfg_attr(
        not(feature = "console"),
        expect(dead_code, reason = "the console alone offers clients")
    )]
    clients: Arc<OnceLock<SocketAddr>>,
    /// Quota of the folder of recordings, for the console.
    #[cfg(feature = "console")]
    quota: Option<Arc<Quota>>,
    thread: Option<JoinHandle<Result<Vec<SessionSummary>, ServerError>>>,
}

impl Server {
    /// Checks the configuration, creates the folder, opens the key, binds the socket, then serves on threads of its
    /// own.
    ///
    /// # Errors
    /// A value out of range, an unusable folder or key, a busy port, an unusable address, or a system without threads.
    pub fn start(config: ServerConfig) -> Result<ServerHandle, ServerError> {
        config.validate()?;
        std::fs::create_dir_all(&config.recordings).map_err(|source| ServerError::Recordings {
            path: config.recordings.clone(),
            source,
        })?;
        // A missing key is an error of the start, not of the first session.
        crate::outlets::opening::station_key(config.station_key.as_deref())?;
        let identity = match &config.identity {
            Some((certificate, key)) => Identity::from_der(certificate, key),
            None => Identity::generate(&config.stations[0].name)?,
        };
        let quic = transport::server_config(&identity)?;
        let socket = bind(config.listen)?;
        let local_addr = socket.local_addr()?;
        let metrics = config
            .metrics
            .map(crate::outlets::metrics::bind)
            .transpose();
        let metrics = metrics.map_err(|source| ServerError::Metrics { source })?;
        let certificate_der = identity.certificate.to_vec();
        let ticket = Ticket {
            token: config.token.clone(),
            fingerprint: fingerprint(&certificate_der)?,
        };
        let real_time = config.real_time;
        let (stage, stage_out) = watch::channel(Stage::Serve);
        let (renewals, renewed) = unbounded_channel();
        let mut stations = Vec::new();
        for station in &config.stations {
            let (door, behind) = Door::new(&station.name);
            let limit = Command::ForceLimit(station.force_limit_n);
            door.levels.station(limit);
            stations.push((station.clone(), door, behind));
        }
        let doors: Vec<Door> = stations.iter().map(|(_, door, _)| door.clone()).collect();
        config.planner.connect(&doors);
        let clients = Arc::new(OnceLock::new());
        let planner = config.planner.clone();
        let shared = Arc::new(Shared::new(config, stage_out));
        #[cfg(feature = "console")]
        let quota = shared.quota.clone();
        if let Some(quota) = shared.quota.clone() {
            planner.connect_recordings(Arc::new(move || quota.state()));
        }
        let net = Arc::new(Net {
            shared,
            doors: doors.clone(),
            self_test: *SELF_TEST.get_or_init(sulcus_core::self_test),
            clients: clients.clone(),
        });
        // One thread: more threads would only add wake-ups.
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let thread = std::thread::Builder::new()
            .name("sulcus-net".into())
            .spawn(move || {
                if real_time && let Err(error) = fifo(PRIORITY) {
                    tracing::debug!("no real-time scheduling for the network: {error}");
                }
                let served =
                    runtime.block_on(net::serve(socket, quic, renewed, metrics, net, stations));
                // Sessions have ended; a blocked call of the system does not delay the end.
                runtime.shutdown_background();
                served
            })?;
        Ok(ServerHandle {
            local_addr,
            certificate_der,
            ticket,
            doors,
            stage,
            renewals,
            clients,
            #[cfg(feature = "console")]
            quota,
            thread: Some(thread),
        })
    }
}

impl ServerHandle {
    /// Address of the socket, with the port that the system chose.
    pub fn local_addr(&self) -> SocketAddr {
        self.local_addr
    }

    /// First certificate of the server (DER), for clients that pin the whole certificate: see [`ServerHandle::renew`].
    pub fn certificate_der(&self) -> &[u8] {
        &self.certificate_der
    }

    /// Token and certificate fingerprint in one line, for a person to copy.
    pub fn ticket(&self) -> &Ticket {
        &self.ticket
    }

    /// Status of all stations, in the order of the configuration.
    pub fn status(&self) -> Vec<StationStatus> {
        self.doors.iter().map(Door::status).collect()
    }

    /// Sets the pause or the force limit of the first station's side. See [`ServerHandle::command_at`].
    pub fn command(&self, command: Command) -> bool {
        self.doors
            .first()
            .is_some_and(|door| self.set(door, command))
    }

    /// Sets the pause or the force limit of a station's side, from the next tick on. The level holds for the running
    /// session and all later ones until the next command.
    ///
    /// A student cannot lift either. A limit that is negative, infinite or not a number is ignored with a warning.
    /// `false`: the server has ended, or has no such station.
    pub fn command_at(&self, station: &str, command: Command) -> bool {
        let door = self.doors.iter().find(|door| *door.name == *station);
        door.is_some_and(|door| self.set(door, command))
    }

    fn set(&self, door: &Door, command: Command) -> bool {
        match door.levels.station(command) {
            Taken::Set => {}
            Taken::Lifted => door.lifted(),
            Taken::NoForce(newtons) => tracing::warn!(
                "force limit of station {} is {newtons} N, expected 0 (the scene's limit) or a positive force: ignored",
                door.name
            ),
        }
        !self.is_finished()
    }

    /// Serves the instructor's console on a TCP address, until the result is dropped. Tokens and recordings are those
    /// of `config`, with which the server was started; persons with passwords are those of the state folder.
    ///
    /// # Errors
    /// The address cannot be used, or the certificate does not fit its key.
    #[cfg(feature = "console")]
    pub fn console(
        &self,
        listen: SocketAddr,
        identity: &sulcus_console::Identity,
        config: &ServerConfig,
        state: Option<&crate::state::StateFolder>,
    ) -> Result<sulcus_console::Console, sulcus_console::ConsoleError> {
        let (tokens, recordings) = (config.tokens.clone(), config.recordings.clone());
        let key = config.station_key.as_deref();
        let quota = self.quota.clone();
        let doors = self.doors.clone();
        let clients = config.clients.clone();
        let offers = clients.is_some();
        let house = crate::console::Doors::new(crate::console::Parts {
            doors,
            tokens,
            recordings,
            viewers: config.viewers,
            quota,
            key,
            state,
            clients,
        });
        let console = sulcus_console::Console::start(listen, identity, Arc::new(house))?;
        if offers {
            // A second console offers the same folder.
            let _ = self.clients.set(console.local_addr());
        }
        Ok(console)
    }

    /// Provokes a fault in the running session of a station, for tests.
    #[doc(hidden)]
    pub fn provoke(&self, station: &str, fault: Provoked) -> bool {
        let door = self.doors.iter().find(|door| *door.name == *station);
        door.is_some_and(|door| door.try_tell(ToStation::Provoke(fault)))
    }

    /// Presents another certificate (DER, with its private key in PKCS#8) to all connections from now on. Open
    /// connections stay. [`ServerHandle::ticket`] and [`ServerHandle::certificate_der`] keep the first one.
    ///
    /// # Errors
    /// Certificate and key do not fit each other, or are not valid.
    pub fn renew(&self, certificate_der: &[u8], key_der: &[u8]) -> Result<(), ServerError> {
        let quic = transport::server_config(&Identity::from_der(certificate_der, key_der))?;
        // An error means that the server has ended.
        let _ = self.renewals.send(quic);
        Ok(())
    }

    /// Begins the end: running sessions end with goodbyes, and new clients are not accepted. Returns at once.
    pub fn shutdown(&self) {
        // An error means that the server has ended already.
        let _ = self.stage.send(Stage::Shutdown);
    }

    /// Whether the server has ended.
    pub fn is_finished(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Waits for the end of the server and returns the summaries of its sessions, oldest first. Without
    /// [`ServerHandle::shutdown`] before, the call may never return.
    ///
    /// # Errors
    /// The network thread could not use the socket, or panicked.
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
            let _ = self.stage.send(Stage::Halt);
            // The result is of no use here; the thread must not outlive the handle.
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
