//! Thread of one device: start, periods, loss and return, end.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering::{Relaxed, Release};

use sulcus_haptics::Unready;
use sulcus_haptics::device::{HandInfo, Stop};
use sulcus_haptics::port::HandPort;
use sulcus_link::clock::{monotonic_ns, sleep_until};

use super::api::Dhd;
use super::pace::Pace;
use super::servo::Servo;
use super::shared::HandState;
use super::unit::{Unit, title};
use crate::openhaptics::backoff::Backoff;

/// Environment variable that allows a device to calibrate itself by moving.
pub const AUTO_INIT: &str = "SULCUS_DHD_AUTO_INIT";

/// Time without a command after which the controller takes the force off: 18 ms, in steps of 125 microseconds.
const WATCHDOG: u8 = 144;

/// Time of zero force before the device stops, nanoseconds.
const ZERO_NS: u64 = 40_000_000;

/// Longest time of the fall and the zero force, nanoseconds.
const LONGEST_END_NS: u64 = 300_000_000;

/// Reason of the end of the periods at an open device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ended {
    Stopped,
    Lost,
    Panicked,
}

/// Hand of one device, on its thread.
pub struct Hand<'a> {
    /// The library.
    pub dhd: Dhd,
    /// Properties of the device.
    pub info: &'a HandInfo,
    /// End of the door.
    pub port: HandPort,
    /// State for the supervising thread.
    pub state: &'a HandState,
    /// Ends of the run: asked from outside, and by a failure inside.
    pub stops: [&'a Stop; 2],
}

impl Hand<'_> {
    /// Serves the hand until the end of the run. `unit` is the open device.
    pub fn serve(&mut self, unit: Unit) {
        let mut unit = Some(unit);
        let mut backoff = Backoff::default();
        while !self.is_over() {
            match unit.take() {
                Some(open) => {
                    self.state.is_open.store(true, Relaxed);
                    let ended = self.device(&open);
                    self.state.is_open.store(false, Relaxed);
                    drop(open);
                    if ended == Ended::Panicked {
                        self.state.has_failed.store(true, Release);
                        return;
                    }
                }
                None => unit = self.absent(&mut backoff),
            }
        }
    }

    fn is_over(&self) -> bool {
        self.stops.iter().any(|stop| stop.is_asked())
    }

    /// Serves an open device until its loss or the end of the run. The force is zero at the end.
    fn device(&mut self, unit: &Unit) -> Ended {
        let result = catch_unwind(AssertUnwindSafe(|| {
            prepare(unit);
            self.periods(unit)
        }));
        let ended = result.unwrap_or(Ended::Panicked);
        if ended == Ended::Panicked {
            silence(unit);
        }
        if ended != Ended::Lost {
            // An error at the end changes nothing: the controller's watchdog takes the force off.
            let _ = unit.dhd.stop(unit.id);
        }
        ended
    }

    fn periods(&mut self, unit: &Unit) -> Ended {
        let stops = self.stops;
        let mut now_ns = monotonic_ns();
        let mut pace = Pace::new(unit.model.period_ns, now_ns);
        let mut servo = Servo::new(unit, &mut self.port, self.state, now_ns);
        // Time at which the end began, and time of the last force since then.
        let mut end: Option<(u64, u64)> = None;
        loop {
            if end.is_none() && stops.iter().any(|stop| stop.is_asked()) {
                end = Some((now_ns, now_ns));
            }
            if !servo.period(now_ns, end.is_some()) {
                return Ended::Lost;
            }
            if let Some((began, last)) = &mut end {
                if !servo.is_still() {
                    *last = now_ns;
                }
                if now_ns - *last >= ZERO_NS || now_ns - *began >= LONGEST_END_NS {
                    return Ended::Stopped;
                }
            }
            sleep_until(pace.next(monotonic_ns()));
            now_ns = monotonic_ns();
        }
    }

    /// Performs periods without a device, until the device is open again or the run ends.
    fn absent(&mut self, backoff: &mut Backoff) -> Option<Unit> {
        let name = title(self.info);
        let mut now_ns = monotonic_ns();
        if backoff.lost(now_ns) {
            tracing::warn!(
                "{name}: the connection is lost: plug the device in again and switch it on"
            );
        }
        while !self.is_over() {
            self.port.exchange(now_ns, Err(Unready::Absent), 0);
            self.state.periods.fetch_add(1, Relaxed);
            if backoff.is_due(now_ns) {
                match Unit::open(self.dhd, &self.info.serial) {
                    Ok(unit) => {
                        tracing::info!("{name} has returned: press a button");
                        backoff.opened(monotonic_ns());
                        return Some(unit);
                    }
                    Err(refusal) => tracing::debug!("{}", refusal.text),
                }
                backoff.failed(monotonic_ns());
            }
            sleep_until(now_ns + self.info.period_ns);
            now_ns = monotonic_ns();
        }
        None
    }
}

/// Settings of a device before its first period.
fn prepare(unit: &Unit) {
    let Unit { dhd, id, model, .. } = unit;
    let name = unit.title();
    let warn = |what: &str, result: Result<i32, super::api::Code>| {
        if let Err(code) = result {
            tracing::warn!(
                "{name}: {what}: {} (error {})",
                dhd.error_text(code),
                code.0
            );
        }
    };
    if !dhd.is_calibrated(*id) && std::env::var_os(AUTO_INIT).is_some_and(|value| value == "1") {
        tracing::warn!("{name} moves by itself to calibrate: let go of the handle");
        warn(
            "the device does not calibrate itself, use the calibration pole",
            dhd.calibrate(*id),
        );
    }
    warn(
        "the weight of the handle is not compensated",
        dhd.compensate_gravity(*id),
    );
    if model.has_gripper {
        warn("the gripper is no button", dhd.use_gripper_as_button(*id));
    }
    let guard_us = i32::try_from(model.period_ns / 2000).unwrap_or(0);
    warn(
        "the measurements keep their own shortest period",
        dhd.guard_time(*id, guard_us),
    );
    warn(
        "the controller has no watchdog: do not use the device without a hand at the handle",
        dhd.watch(*id, WATCHDOG),
    );
}

/// Sends zero for a while, after a panic.
fn silence(unit: &Unit) {
    let torque = (unit.model.torque_axes > 0).then_some([0.0; 3]);
    let mut now_ns = monotonic_ns();
    let until_ns = now_ns + ZERO_NS;
    while now_ns < until_ns {
        let _ = unit.dhd.display(unit.id, [0.0; 3], torque);
        sleep_until(now_ns + unit.model.period_ns);
        now_ns = monotonic_ns();
    }
}
