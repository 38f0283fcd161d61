//! What the callback and the supervising thread tell each other: atomics alone.

use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};

/// Most hands of a run.
pub const HANDS: usize = 4;

/// Order of the supervising thread to the callback.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Order {
    /// Forces are displayed.
    Go = 0,
    /// The callback ends by itself as soon as no hand has had a force for a while.
    Pause = 1,
    /// The forces fall to zero and stay there.
    Stop = 2,
}

/// State of one hand, as the callback tells it.
#[derive(Debug, Default)]
pub struct HandState {
    /// Error with which the device was lost; 0 for a device in use.
    pub lost: AtomicU32,
    /// Newest error with which the driver refused force; 0 for none.
    pub refused: AtomicU32,
    /// Number of errors with which the driver refused force.
    pub refusals: AtomicU32,
    /// Newest other error; 0 for none.
    pub other: AtomicU32,
    /// Number of other errors.
    pub others: AtomicU32,
    /// State of the calibration, if it is not right; 0 for a calibrated device.
    pub uncalibrated: AtomicU32,
    /// Number of gaps between ticks in which the hardware may have cut a force off.
    pub gaps: AtomicU32,
}

/// State of a run.
#[derive(Debug, Default)]
pub struct Shared {
    order: AtomicU32,
    /// Number of ticks.
    pub ticks: AtomicU64,
    /// Number of ticks in sequence in which every hand had no force.
    pub still: AtomicU32,
    /// Whether the callback runs at this moment.
    pub is_busy: AtomicBool,
    /// Whether the callback has ended by itself.
    pub has_ended: AtomicBool,
    /// Whether the callback has panicked; all forces are zero since then.
    pub has_failed: AtomicBool,
    /// Whether the scheduler was slow for a while.
    pub is_slow: AtomicBool,
    /// States of the hands.
    pub hands: [HandState; HANDS],
}

impl Shared {
    /// Gives an order to the callback.
    pub fn give(&self, order: Order) {
        self.order.store(order as u32, Ordering::Release);
    }

    /// Newest order.
    pub fn order(&self) -> Order {
        match self.order.load(Ordering::Acquire) {
            0 => Order::Go,
            1 => Order::Pause,
            _ => Order::Stop,
        }
    }
}
