//! Service inside of the process of a test.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

use tempfile::TempDir;

use crate::Vector;
use crate::device::{ArmStatus, ArmView, Buttons, Motion, Turn};
use crate::fault::Fault;
use crate::log::Log;
use crate::net::{Door, Shared, bind, spawn};
use crate::options::Options;
use crate::request::{Ready, Request, RequestError};
use crate::world::World;

/// Priority in the real-time class of Linux, above that of a client's device thread.
#[cfg(target_os = "linux")]
const PRIORITY: i32 = 47;

/// Time between two steps of the thread that watches the arms.
const WATCH: Duration = Duration::from_millis(1);

/// Looks for the end of the connections when the service ends; one look each 2 ms.
const LOOKS_AT_END: u32 = 500;

/// Running service; its end is the end of the value.
#[derive(Debug)]
pub struct Service {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
    ready: Ready,
    _folder: Option<TempDir>,
}

impl Service {
    /// Starts a service on both ports.
    pub fn start(options: Options) -> io::Result<Self> {
        let (folder, log) = match &options.log {
            Some(path) => (None, path.clone()),
            None => {
                let folder = tempfile::tempdir()?;
                let path = folder.path().join("haply.log");
                (Some(folder), path)
            }
        };
        let simulation = bind(options.port)?;
        let events = bind(options.events_port)?;
        let ready = Ready {
            port: simulation.local_addr()?.port(),
            events_port: events.local_addr()?.port(),
            log: log.clone(),
        };
        let mut world = World::new(&options, &log)?;
        world.started(ready.port, ready.events_port);
        let shared = Arc::new(Shared::new(world));
        let begin = || {
            // Threads inherit the class, those of later connections too.
            #[cfg(target_os = "linux")]
            if options.realtime {
                // Refused without the right: the threads stay as they are.
                let _ = sulcus_standins::clock::make_realtime(PRIORITY);
            }
            Ok::<_, io::Error>(vec![
                spawn(&shared, Door::Simulation, simulation)?,
                spawn(&shared, Door::Events, events)?,
                watch(&shared)?,
            ])
        };
        let begun = thread::scope(|scope| scope.spawn(begin).join());
        let threads = begun.map_err(|_| io::Error::other("the threads of the service"))??;
        Ok(Self {
            shared,
            threads,
            ready,
            _folder: folder,
        })
    }

    /// Ports and file of the log.
    #[must_use]
    pub fn ready(&self) -> &Ready {
        &self.ready
    }

    /// Port of the simulation channel and of HTTP.
    #[must_use]
    pub fn port(&self) -> u16 {
        self.ready.port
    }

    /// Port of the channel of events.
    #[must_use]
    pub fn events_port(&self) -> u16 {
        self.ready.events_port
    }

    /// Address of the simulation channel.
    #[must_use]
    pub fn url(&self) -> String {
        format!("ws://127.0.0.1:{}", self.ready.port)
    }

    /// Address of the channel of events.
    #[must_use]
    pub fn events_url(&self) -> String {
        format!("ws://127.0.0.1:{}", self.ready.events_port)
    }

    /// Carries a request out.
    pub fn apply(&self, request: &Request) -> Result<(), RequestError> {
        // A stall begins before its entry in the log: no message comes between.
        if let Request::Fault(fault) = request {
            match fault {
                Fault::Stall { ms } => self.shared.stall(*ms),
                Fault::RefuseConnections { on } => self.shared.refuse(*on),
                _ => {}
            }
        }
        self.shared.world().apply(request)?;
        if let Request::Fault(fault) = request {
            match fault {
                Fault::DropConnections => self.shared.drop_all(Door::Simulation),
                Fault::DropEvents => self.shared.drop_all(Door::Events),
                _ => {}
            }
        }
        Ok(())
    }

    /// Begins or ends a fault.
    pub fn fault(&self, fault: Fault) -> Result<(), RequestError> {
        self.apply(&Request::Fault(fault))
    }

    /// Sets the motion of the hand at an arm.
    pub fn set_hand(&self, device: &str, motion: Motion) -> Result<(), RequestError> {
        self.apply(&Request::Hand {
            device: device.into(),
            motion,
        })
    }

    /// Sets the rotation of a grip.
    pub fn set_turn(&self, device: &str, turn: Turn) -> Result<(), RequestError> {
        self.apply(&Request::Turn {
            device: device.into(),
            turn,
        })
    }

    /// Sets the buttons of a grip.
    pub fn set_buttons(&self, device: &str, buttons: Buttons) -> Result<(), RequestError> {
        self.apply(&Request::Buttons {
            device: device.into(),
            buttons,
        })
    }

    /// Sets the status of an arm.
    pub fn set_status(&self, device: &str, status: ArmStatus) -> Result<(), RequestError> {
        self.apply(&Request::Status {
            device: device.into(),
            status,
        })
    }

    /// Sets the force of a second source at an arm, in N.
    pub fn set_second_source(&self, device: &str, force: Vector) -> Result<(), RequestError> {
        self.apply(&Request::SecondSource {
            device: device.into(),
            force,
        })
    }

    /// An arm as it is now; none where no arm has the id.
    #[must_use]
    pub fn arm(&self, device: &str) -> Option<ArmView> {
        self.shared.world().view(device)
    }

    /// Number of messages of every connection up to now; cheaper than the log.
    #[must_use]
    pub fn messages(&self) -> u64 {
        self.shared.world().messages()
    }

    /// File of the log.
    #[must_use]
    pub fn log_path(&self) -> &Path {
        &self.ready.log
    }

    /// Log up to now.
    pub fn log(&self) -> io::Result<Log> {
        {
            let mut world = self.shared.world();
            world.advance();
            world.flush();
        }
        Log::read(&self.ready.log)
    }

    /// Ends the service and reads its whole log.
    pub fn stop(mut self) -> io::Result<Log> {
        self.end();
        Log::read(&PathBuf::from(&self.ready.log))
    }

    fn end(&mut self) {
        if self.threads.is_empty() {
            return;
        }
        self.shared.stop();
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
        for _ in 0..LOOKS_AT_END {
            if self.shared.open() == 0 {
                break;
            }
            thread::sleep(Duration::from_millis(2));
        }
        self.shared.world().stopped();
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        self.end();
    }
}

fn watch(shared: &Arc<Shared>) -> io::Result<JoinHandle<()>> {
    let shared = Arc::clone(shared);
    thread::Builder::new()
        .name("haply-watch".into())
        .spawn(move || {
            while !shared.stopped() {
                shared.world().watch();
                thread::sleep(WATCH);
            }
        })
}
