//! Counters and times of packets, shared between the link's task and its users.

use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use sulcus_link::Times;
use sulcus_proto::datagram::Echo;
use sulcus_proto::newest::ArrivalCounts;
use sulcus_proto::{NewestWins, Percentiles};

/// Longest round trip that the histograms resolve, seconds. A longer one counts as this one.
const LONGEST_S: u32 = 10;

/// Counters and times of the packets of a link so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct LinkStats {
    /// Number of poses given to the link.
    pub poses_offered: u64,
    /// Number of poses that QUIC took for sending.
    ///
    /// Of the others, most were left out at a lower rate, or replaced by a newer pose first. A pose after the end of
    /// the connection is not counted either. QUIC may still drop a counted pose: a full send buffer loses its oldest
    /// datagram. A pose with a number that is not finite is sent like any other: the tick judges it.
    pub poses_sent: u64,
    /// Counts of arrived wrenches of the session's epochs.
    pub wrenches: ArrivalCounts,
    /// Number of datagrams of another session epoch.
    pub foreign: u64,
    /// Number of datagrams that did not decode.
    pub malformed: u64,
    /// Time from the measurement of a pose to the arrival of the first wrench that answers it, microseconds. The wait
    /// for the server's next tick is included.
    pub rtt_us: Percentiles,
    /// [`LinkStats::rtt_us`] without the time that the server held the pose, microseconds.
    pub network_us: Percentiles,
    /// Time from the arrival of a pose at the server to the begin of the tick that used it first, microseconds.
    pub wait_us: Percentiles,
    /// Number of offered poses for each one that is sent: 1 at the full rate, more on a path with queues or losses.
    pub rate_divisor: u32,
    /// Number of times that the rate of the poses fell.
    pub rate_falls: u64,
    /// Number of returns to the session after a lost connection.
    pub returns: u32,
    /// Number of answered poses, which is the number of samples of both times.
    pub answered: u64,
    /// Number of ticks at the hand that the server has not computed yet; 0 if the server ticks.
    pub ticks_behind: u64,
    /// Mean length of the inputs of a tick at the hand, bytes; 0 if the server ticks.
    pub bytes_per_tick: f64,
}

/// Counters of both threads.
pub(super) struct Shared {
    offered: AtomicU64,
    closed: AtomicBool,
    /// Whether the connection is lost and the link tries to return.
    returning: AtomicBool,
    returns: AtomicU32,
    /// Number of returns to a server that had lost the session, whose ticks at the hand began again.
    restarts: AtomicU32,
    inner: Mutex<Numbers>,
}

/// Counters of the link's task.
pub(super) struct Numbers {
    pub filter: NewestWins,
    pub sent: u64,
    pub foreign: u64,
    pub malformed: u64,
    pub divisor: u32,
    pub falls: u64,
    rtt_ns: Times,
    network_ns: Times,
    wait_ns: Times,
}

impl Shared {
    pub fn new() -> Self {
        let numbers = Numbers {
            filter: NewestWins::new(),
            sent: 0,
            foreign: 0,
            malformed: 0,
            divisor: 1,
            falls: 0,
            rtt_ns: Times::up_to(LONGEST_S),
            network_ns: Times::up_to(LONGEST_S),
            wait_ns: Times::up_to(LONGEST_S),
        };
        Self {
            offered: AtomicU64::new(0),
            closed: AtomicBool::new(false),
            returning: AtomicBool::new(false),
            returns: AtomicU32::new(0),
            restarts: AtomicU32::new(0),
            inner: Mutex::new(numbers),
        }
    }

    /// Counts an offered pose. Wait-free.
    pub fn offered(&self) {
        self.offered.fetch_add(1, Ordering::Relaxed);
    }

    /// Marks the end of the link.
    pub fn close(&self) {
        self.closed.store(true, Ordering::Release);
    }

    pub fn is_closed(&self) -> bool {
        self.closed.load(Ordering::Acquire)
    }

    /// Marks a lost connection.
    pub fn leave(&self) {
        self.returning.store(true, Ordering::Release);
    }

    /// Marks and counts a return.
    pub fn come_back(&self) {
        self.returns.fetch_add(1, Ordering::Relaxed);
        self.returning.store(false, Ordering::Release);
    }

    /// Counts a begin of the ticks at the hand from the first one.
    pub fn restart(&self) {
        self.restarts.fetch_add(1, Ordering::AcqRel);
    }

    pub fn restarts(&self) -> u32 {
        self.restarts.load(Ordering::Acquire)
    }

    pub fn is_returning(&self) -> bool {
        self.returning.load(Ordering::Acquire)
    }

    /// Calls `action` with the counters under their lock.
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
            rtt_us: numbers.rtt_ns.percentiles(),
            network_us: numbers.network_ns.percentiles(),
            wait_us: numbers.wait_ns.percentiles(),
            rate_divisor: numbers.divisor,
            rate_falls: numbers.falls,
            returns: self.returns.load(Ordering::Relaxed),
            answered: numbers.rtt_ns.count(),
            ticks_behind: 0,
            bytes_per_tick: 0.0,
        })
    }
}

impl Numbers {
    /// Records the times of an answered pose: `rtt_ns` from its measurement to the first wrench, and the times at the
    /// server in its echo.
    pub fn answered(&mut self, rtt_ns: u64, echo: &Echo) {
        self.rtt_ns.record(rtt_ns);
        self.network_ns
            .record(rtt_ns.saturating_sub(u64::from(echo.hold_us) * 1000));
        self.wait_ns.record(u64::from(echo.wait_us) * 1000);
    }
}
