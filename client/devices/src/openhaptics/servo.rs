//! The callback of the scheduler, one for all devices.

use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::Ordering::{Acquire, Relaxed, Release};

use sulcus_link::clock::monotonic_ns;

use super::api::Hd;
use super::hand::{Hand, output};
use super::shared::{Order, Shared};
use super::sys;

/// Number of ticks without a force after which the callback may end.
const STILL: u32 = 20;

/// Rate of a slow scheduler, Hz, and the number of slow ticks in sequence from which the person is told.
const SLOW_HZ: i32 = 500;
const SLOW_TICKS: u32 = 50;

/// What the callback works with. The scheduler's thread alone touches the value between start and end of a service.
#[derive(Debug)]
pub struct Servo {
    /// The library.
    pub hd: Hd,
    /// The hands, in the order of the ports.
    pub hands: Vec<Hand>,
    /// State that the supervising thread reads.
    pub shared: Arc<Shared>,
    still: u32,
    slow: u32,
}

impl Servo {
    /// Servo at the beginning of a service.
    pub fn new(hd: Hd, hands: Vec<Hand>, shared: Arc<Shared>) -> Self {
        Self {
            hd,
            hands,
            shared,
            still: 0,
            slow: 0,
        }
    }

    /// Performs a tick of all hands, and returns whether the callback goes on.
    fn tick(&mut self) -> u32 {
        let order = self.shared.order();
        let mut is_live = false;
        for at in 0..self.hands.len() {
            is_live |= self.tick_of(at, order, !is_live);
        }
        let is_still = self.hands.iter().all(Hand::is_still);
        self.still = if is_still {
            self.still.saturating_add(1)
        } else {
            0
        };
        self.shared.still.store(self.still, Release);
        let is_over = !is_live || order == Order::Pause && self.still >= STILL;
        if is_over && order != Order::Stop {
            return sys::DONE;
        }
        sys::CONTINUE
    }

    /// Performs a tick of one hand. Returns whether its device is in use.
    fn tick_of(&mut self, at: usize, order: Order, watches_rate: bool) -> bool {
        let hd = self.hd;
        let now_ns = monotonic_ns();
        let Some(handle) = self.hands[at].handle else {
            self.hands[at].absent(now_ns);
            return false;
        };
        let frame = hd.frame(handle);
        self.take_errors(at);
        if self.is_lost(at) {
            drop(frame);
            hd.drain(|_| ());
            self.hands[at].absent(now_ns);
            return false;
        }
        if watches_rate {
            self.watch_rate(frame.device().integer(sys::INSTANTANEOUS_UPDATE_RATE));
        }
        self.hands[at].period(&frame, now_ns, order, &self.shared.hands[at]);
        drop(frame);
        self.take_errors(at);
        if self.is_lost(at) {
            self.hands[at].absent(now_ns);
            return false;
        }
        true
    }

    /// Takes the errors of the library. An error without a known device belongs to the device of the last frame.
    fn take_errors(&mut self, current: usize) {
        let Self {
            hd, hands, shared, ..
        } = self;
        hd.drain(|error| {
            let of = |hand: &Hand| hand.handle.is_some_and(|handle| handle.0 == error.hhd);
            let at = hands.iter().position(of).unwrap_or(current);
            hands[at].note(&error, &shared.hands[at]);
        });
    }

    fn is_lost(&self, at: usize) -> bool {
        self.shared.hands[at].lost.load(Relaxed) != 0
    }

    fn watch_rate(&mut self, hz: i32) {
        let is_slow = (1..SLOW_HZ).contains(&hz);
        self.slow = if is_slow { self.slow + 1 } else { 0 };
        if self.slow >= SLOW_TICKS {
            self.slow = 0;
            self.shared.is_slow.store(true, Relaxed);
        }
    }

    /// Sends zero to all devices, after a panic.
    fn silence(&mut self) {
        for handle in self.hands.iter().filter_map(|hand| hand.handle) {
            let frame = self.hd.frame(handle);
            frame.set_force([0.0; 3]);
            drop(frame);
        }
        self.hd.drain(|_| ());
        self.shared.still.fetch_add(1, Release);
    }
}

/// Callback of the scheduler.
///
/// # Safety
/// `user` is a [`Servo`] that no other thread touches while the callback is scheduled.
pub unsafe extern "system" fn tick(user: *mut c_void) -> u32 {
    // SAFETY: the caller's promise.
    let servo = unsafe { &mut *user.cast::<Servo>() };
    servo.shared.is_busy.store(true, Release);
    let code = if servo.shared.has_failed.load(Acquire) {
        servo.silence();
        sys::CONTINUE
    } else {
        let result = catch_unwind(AssertUnwindSafe(|| servo.tick()));
        result.unwrap_or_else(|_| {
            servo.shared.still.store(0, Release);
            servo.shared.has_failed.store(true, Release);
            sys::CONTINUE
        })
    };
    servo.shared.ticks.fetch_add(1, Release);
    // The supervising thread takes the servo back after both of these stores.
    let shared: *const Shared = Arc::as_ptr(&servo.shared);
    // SAFETY: the service holds the shared state longer than the servo.
    let shared = unsafe { &*shared };
    if code == sys::DONE {
        shared.has_ended.store(true, Release);
    }
    shared.is_busy.store(false, Release);
    code
}

/// Turns the output of force of all devices off, on the scheduler's thread at the end of a service.
///
/// # Safety
/// As for [`tick`].
pub unsafe extern "system" fn turn_off(user: *mut c_void) -> u32 {
    // SAFETY: the caller's promise.
    let servo = unsafe { &mut *user.cast::<Servo>() };
    let result = catch_unwind(AssertUnwindSafe(|| servo.turn_off()));
    debug_assert!(result.is_ok());
    sys::DONE
}

impl Servo {
    /// Turns the output of force of all devices off.
    pub fn turn_off(&mut self) {
        for hand in &mut self.hands {
            if let Some(handle) = hand.handle {
                output(&self.hd.current(handle), false);
                hand.output = false;
            }
        }
        self.hd.drain(|_| ());
    }
}
