//! One service of the scheduler: start, and the stop sequence of the note, whatever the way of the end.

use std::ffi::c_ulong;
use std::sync::Arc;
use std::sync::atomic::Ordering::{Acquire, Release};
use std::time::Duration;

use sulcus_haptics::device::DeviceError;
use sulcus_link::clock::{monotonic_ns, sleep_until};

use super::api::Hd;
use super::hand::Hand;
use super::servo::{self, Servo};
use super::shared::{Order, Shared};

/// Number of ticks without a force before the output of force is turned off.
const ZERO_TICKS: u32 = 30;

/// Longest wait for those ticks. A scheduler that stands still ticks no more.
const LONGEST_FALL: Duration = Duration::from_millis(300);

/// Longest wait for the end of a callback that runs.
const LONGEST_TICK: Duration = Duration::from_secs(1);

/// Running callback. The end of the value stops the scheduler.
#[derive(Debug)]
pub struct Service {
    hd: Hd,
    shared: Arc<Shared>,
    servo: Option<*mut Servo>,
    callback: c_ulong,
}

impl Service {
    /// Schedules the callback for `hands` and starts the scheduler.
    ///
    /// # Errors
    /// The library refuses the callback or the scheduler.
    pub fn start(
        hd: Hd,
        hands: Vec<Hand>,
        shared: Arc<Shared>,
    ) -> Result<Self, (Vec<Hand>, DeviceError)> {
        shared.give(Order::Go);
        shared.has_ended.store(false, Release);
        shared.still.store(0, Release);
        let servo = Box::into_raw(Box::new(Servo::new(hd, hands, shared.clone())));
        let refused = |code: u32| {
            DeviceError(format!(
                "OpenHaptics does not start its haptic loop: {} (0x{code:X}); start the program anew",
                hd.error_text(code)
            ))
        };
        // SAFETY: no other code touches the servo before the end of the service.
        let callback = match unsafe { hd.schedule(servo::tick, servo.cast()) } {
            Ok(callback) => callback,
            Err(error) => {
                // SAFETY: the library took no callback.
                let servo = unsafe { Box::from_raw(servo) };
                return Err((servo.hands, refused(error.code)));
            }
        };
        let mut service = Self {
            hd,
            shared,
            servo: Some(servo),
            callback,
        };
        match hd.start_scheduler() {
            Ok(true) => {}
            Ok(false) => tracing::warn!(
                "OpenHaptics refuses a rate of 1000 Hz and keeps its own: contact may feel soft or rough"
            ),
            Err(error) => {
                let hands = service.stop();
                return Err((hands.unwrap_or_default(), refused(error.code)));
            }
        }
        Ok(service)
    }

    /// Whether the callback has ended by itself, or the library has removed it.
    pub fn has_ended(&self) -> bool {
        self.shared.has_ended.load(Acquire) || !self.hd.is_scheduled(self.callback)
    }

    /// Ends the service: forces fall to zero and stay there for 30 ticks, then the output of force is turned off, the
    /// scheduler stops, and the callback is removed.
    ///
    /// Returns the hands, or `None` if the callback hangs.
    pub fn stop(&mut self) -> Option<Vec<Hand>> {
        let at = self.servo.take()?;
        let mut is_off = false;
        if !self.has_ended() {
            self.shared.give(Order::Stop);
            let is_still = || self.shared.still.load(Acquire) >= ZERO_TICKS;
            self.shared.still.store(0, Release);
            if wait(LONGEST_FALL, is_still) {
                // SAFETY: the call runs on the scheduler's thread, between two ticks of the servo.
                unsafe { self.hd.call_on_scheduler(servo::turn_off, at.cast()) };
                is_off = true;
            }
        }
        self.hd.stop_scheduler();
        if self.hd.is_scheduled(self.callback) {
            self.hd.unschedule(self.callback);
        }
        if !wait(LONGEST_TICK, || !self.shared.is_busy.load(Acquire)) {
            tracing::error!("the haptic loop of OpenHaptics hangs: start the program anew");
            return None;
        }
        // SAFETY: the scheduler has stopped, the callback is removed and does not run.
        let mut servo = unsafe { Box::from_raw(at) };
        if !is_off {
            servo.turn_off();
        }
        Some(servo.hands)
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Waits until `is_so`, at most for `time`. Returns whether it is so.
fn wait(time: Duration, is_so: impl Fn() -> bool) -> bool {
    let until_ns = monotonic_ns() + time.as_nanos() as u64;
    loop {
        if is_so() {
            return true;
        }
        let now_ns = monotonic_ns();
        if now_ns >= until_ns {
            return false;
        }
        sleep_until(now_ns + 1_000_000);
    }
}
