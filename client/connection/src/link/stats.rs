//! How packets fare, shared between the link's thread and whoever asks.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use hdrhistogram::Histogram;
use sulcus_proto::newest::ArrivalCounts;
use sulcus_proto::{NewestWins, Percentiles};

use super::LinkError;
use crate::stats::percentiles;

/// How packets have fared so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct LinkStats {
    /// Poses given to the link.
    pub poses_offered: u64,
    /// Poses sent; the others were replaced by a newer one first.
    pub poses_sent: u64,
    /// Wrenches that arrived.
    pub wrenches: ArrivalCounts,
    /// Datagrams of another session epoch.
    pub foreign: u64,
    /// Datagrams that did not decode.
    pub malformed: u64,
    /// From reading the device to the arrival of the first wrench that answers that pose: waiting
    /// for the server's next tick included.
    pub rtt_us: Percentiles,
    /// The same without the time that the server held the pose.
    pub network_us: Percentiles,
    /// Poses answered: the samples in both.
    pub answered: u64,
}

/// What both threads count.
pub(super) struct Shared {
    offered: AtomicU64,
    closed: AtomicBool,
    inner: Mutex<Numbers>,
}

/// What the link's thread counts.
pub(super) struct Numbers {
    pub filter: NewestWins,
    pub sent: u64,
    pub foreign: u64,
    pub malformed: u64,
    rtt_ns: Histogram<u64>,
    network_ns: Histogram<u64>,
}

impl Shared {
    pub fn new() -> Result<Self, LinkError> {
        let numbers = Numbers {
            filter: NewestWins::new(),
            sent: 0,
            foreign: 0,
            malformed: 0,
            rtt_ns: histogram()?,
            network_ns: histogram()?,
        };
        Ok(Self {
            offered: AtomicU64::new(0),
            closed: AtomicBool::new(false),
            inner: Mutex::new(numbers),
        })
    }

    /// A pose was offered. Wait-free.
    pub fn offered(&self) {
        self.offered.fetch_add(1, Ordering::Relaxed);
    }

    /// No packet comes any more.
    pub fn close(&self) {
        self.closed.store(true, Ordering::Release);
    }

    pub fn is_closed(&self) -> bool {
        self.closed.load(Ordering::Acquire)
    }

    /// For the link's thread.
    pub fn count<T>(&self, action: impl FnOnce(&mut Numbers) -> T) -> T {
        action(&mut self.inner.lock().unwrap_or_else(PoisonError::into_inner))
    }

    pub fn stats(&self) -> LinkStats {
        let poses_offered = self.offered.load(Ordering::Relaxed);
        self.count(|numbers| LinkStats {
            poses_offered,
            poses_sent: numbers.sent,
            wrenches: numbers.filter.counts(),
            foreign: numbers.foreign,
            malformed: numbers.malformed,
            rtt_us: percentiles(&numbers.rtt_ns).unwrap_or_default(),
            network_us: percentiles(&numbers.network_ns).unwrap_or_default(),
            answered: numbers.rtt_ns.len(),
        })
    }
}

impl Numbers {
    /// The first wrench that answers a pose arrived `rtt_ns` after the pose was read.
    pub fn answered(&mut self, rtt_ns: u64, hold_us: u32) {
        self.rtt_ns.saturating_record(rtt_ns);
        self.network_ns
            .saturating_record(rtt_ns.saturating_sub(u64::from(hold_us) * 1000));
    }
}

/// Three significant digits from 1 ns to 10 s, all buckets there from the start.
fn histogram() -> Result<Histogram<u64>, LinkError> {
    Histogram::new_with_bounds(1, 10_000_000_000, 3)
        .map_err(|error| LinkError::System(error.to_string()))
}
