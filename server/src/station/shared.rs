//! Data that all stations and connections of a server share.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use sulcus_proto::SessionSummary;
use tokio::sync::watch;

use crate::ServerConfig;
use crate::capacity::{Capacity, Cost, Load, Machine, Model};
use crate::net::Stage;
use crate::net::codes::WrongCodes;
use crate::session::precedence::Places;
use crate::state::{Denied, Grant, Place};
use crate::station::quota::Quota;

/// Interval between two queries of the free space on the disk.
const DISK: Duration = Duration::from_secs(5);

/// Interval between two looks at the token of an open connection.
const TOKEN: Duration = Duration::from_secs(1);

/// Shared data of a server.
pub(crate) struct Shared {
    pub config: ServerConfig,
    pub stage: watch::Receiver<Stage>,
    /// Summaries of the sessions so far, in the order of their ends.
    summaries: Mutex<Vec<SessionSummary>>,
    /// Hash of the secret of the first station's student, and its holder.
    first: (blake3::Hash, Grant),
    /// Sessions on the cores of this machine.
    capacity: Mutex<Capacity>,
    /// Wrong codes of learners.
    pub wrong_codes: WrongCodes,
    /// Places of stations with long ticks behind the others.
    pub places: Arc<Places>,
    /// Quota of the folder of recordings; `None`: the disk is the only limit.
    pub quota: Option<Arc<Quota>>,
    disk_free_mib: AtomicU64,
    disk_asked: Mutex<Option<Instant>>,
}

impl Shared {
    /// Shared data of a new server.
    pub fn new(config: ServerConfig, stage: watch::Receiver<Stage>) -> Self {
        let station = config.stations.first().map(|station| station.name.clone());
        let first = Grant {
            id: "ticket".into(),
            role: sulcus_proto::Role::Student,
            station: station.map_or(Place::Any, Place::Station),
            learner: String::new(),
            class: String::new(),
        };
        Self {
            first: (blake3::hash(config.token.as_bytes()), first),
            places: Arc::new(Places::of(config.stations.len())),
            quota: config
                .recordings_quota
                .map(|most| Arc::new(Quota::new(&config.recordings, most))),
            config,
            stage,
            wrong_codes: WrongCodes::default(),
            summaries: Mutex::default(),
            capacity: Mutex::new(Capacity::new(Machine::here(), Model::default())),
            disk_free_mib: AtomicU64::new(0),
            disk_asked: Mutex::default(),
        }
    }

    /// Holder of a secret.
    ///
    /// # Errors
    /// No token has the secret, or the token is no longer valid.
    pub fn grant(&self, secret: &str) -> Result<Grant, Denied> {
        // Hashes compare in constant time.
        if blake3::hash(secret.as_bytes()) == self.first.0 {
            return Ok(self.first.1.clone());
        }
        self.config.tokens.find(secret)
    }

    /// Waits until the token `id` is no longer valid, and returns the sentence about it.
    pub async fn revoked(&self, id: &str) -> String {
        let mut look = tokio::time::interval(TOKEN);
        loop {
            look.tick().await;
            if id == self.first.1.id {
                std::future::pending::<()>().await;
            }
            if let Err(denied) = self.config.tokens.still(id) {
                return denied.to_string();
            }
        }
    }

    /// Core for a session at a station, by the measured cost of its ticks. `None`: the cost is unknown, and the session
    /// runs on any core.
    ///
    /// # Errors
    /// The machine has no room: one sentence.
    pub fn admit(
        &self,
        station: usize,
        cost: Option<Cost>,
        rate_hz: u16,
    ) -> Result<Option<usize>, String> {
        let Some(cost) = cost else { return Ok(None) };
        let load = Load { cost, rate_hz };
        let admitted = self.capacity().admit(station as u64, load);
        admitted.map(Some).map_err(|no_room| no_room.to_string())
    }

    /// Corrects the cost of a running session.
    pub fn correct(&self, station: usize, cost: Cost) {
        self.capacity().update(station as u64, cost);
    }

    /// Frees the place of a session, and the room that its recording did not take.
    pub fn release(&self, station: usize) {
        self.capacity().release(station as u64);
        if let Some(quota) = &self.quota {
            quota.release(station);
        }
    }

    /// Reserves room for the recording of a session.
    ///
    /// # Errors
    /// The folder of recordings has none left by its quota: one sentence.
    pub fn reserve(&self, station: usize, forecast: u64) -> Result<(), String> {
        match &self.quota {
            Some(quota) => quota.admit(station, forecast),
            None => Ok(()),
        }
    }

    fn capacity(&self) -> std::sync::MutexGuard<'_, Capacity> {
        self.capacity.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps the summary of a session.
    pub fn ended(&self, summary: SessionSummary) {
        let mut summaries = self
            .summaries
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        summaries.push(summary);
    }

    /// Takes all summaries.
    pub fn take_summaries(&self) -> Vec<SessionSummary> {
        let mut summaries = self
            .summaries
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        std::mem::take(&mut summaries)
    }

    /// Free space for recordings, mebibytes, at most [`DISK`] old: of the disk, or of the quota where that is less. The
    /// query is one system call.
    pub fn disk_free_mib(&self) -> u64 {
        let mut asked = self
            .disk_asked
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let now = Instant::now();
        if asked.is_none_or(|asked| now.saturating_duration_since(asked) >= DISK) {
            *asked = Some(now);
            let free = rustix::fs::statvfs(&self.config.recordings)
                .map(|disk| disk.f_bavail * disk.f_frsize / (1 << 20));
            self.disk_free_mib
                .store(free.unwrap_or(0), Ordering::Relaxed);
        }
        let of_disk = self.disk_free_mib.load(Ordering::Relaxed);
        let of_quota = self.quota.as_ref().map(|quota| quota.left() / (1 << 20));
        of_quota.map_or(of_disk, |left| of_disk.min(left))
    }
}
