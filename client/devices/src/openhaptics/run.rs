//! Run of the devices of a session: service of the scheduler, loss and return of devices, end.

use std::sync::Arc;
use std::sync::atomic::Ordering::{Acquire, Relaxed};

use sulcus_haptics::device::{Device, DeviceError, HandInfo, Stop};
use sulcus_haptics::port::HandPort;
use sulcus_link::clock::{monotonic_ns, sleep_until};

use super::api::Hd;
use super::backoff::Backoff;
use super::hand::{self, Hand};
use super::report::Reporter;
use super::service::Service;
use super::shared::{Order, Shared};
use super::unit::{self, Unit};

/// Time between two looks of the supervising thread, nanoseconds.
const LOOK_NS: u64 = 5_000_000;

/// Period of hands without a device, nanoseconds.
const PERIOD_NS: u64 = 1_000_000;

/// Devices of one session.
#[derive(Debug)]
pub struct Session {
    hd: Hd,
    infos: Vec<HandInfo>,
    units: Vec<Unit>,
    /// Devices that are lost, and the times of the trials to open them, in the order of the hands.
    lost: Vec<Loss>,
    shared: Arc<Shared>,
    reporter: Reporter,
}

/// Loss of a device.
#[derive(Clone, Copy, Debug, Default)]
struct Loss {
    is_lost: bool,
    backoff: Backoff,
}

impl Loss {
    fn is_due(&self, now_ns: u64) -> bool {
        self.is_lost && self.backoff.is_due(now_ns)
    }
}

impl Session {
    /// Session of open devices.
    pub fn new(hd: Hd, units: Vec<Unit>) -> Self {
        Self {
            hd,
            infos: units.iter().map(|unit| unit.info.clone()).collect(),
            lost: vec![Loss::default(); units.len()],
            shared: Arc::new(Shared::default()),
            reporter: Reporter::new(units.len()),
            units,
        }
    }

    /// Serves the hands until the end of the run.
    fn serve(&mut self, mut hands: Vec<Hand>, stop: &Stop) -> Result<(), DeviceError> {
        while !stop.is_asked() {
            self.retry(&mut hands);
            if self.units.iter().all(|unit| unit.handle.is_none()) {
                self.idle(&mut hands, stop);
                continue;
            }
            self.take(&mut hands);
            let service = Service::start(self.hd, hands, self.shared.clone());
            let mut service = service.map_err(|(_, error)| error)?;
            self.supervise(&service, stop)?;
            let Some(returned) = service.stop() else {
                // The library still works with the devices of a callback that hangs.
                self.units.iter_mut().for_each(|unit| unit.handle = None);
                return Err(DeviceError(
                    "OpenHaptics hangs: start the program anew".into(),
                ));
            };
            hands = returned;
        }
        Ok(())
    }

    /// Gives the open devices to their hands.
    fn take(&mut self, hands: &mut [Hand]) {
        self.hd.drain(|_| ());
        for ((hand, unit), state) in hands.iter_mut().zip(&self.units).zip(&self.shared.hands) {
            let Some(handle) = unit.handle else {
                continue;
            };
            state.lost.store(0, Relaxed);
            if unit.is_calibrated {
                hand::output(&self.hd.current(handle), true);
            }
            hand.take(handle, unit.styles, unit.is_calibrated);
        }
        self.hd.drain(|_| ());
    }

    /// Watches a service until its end, or until a stop is asked.
    fn supervise(&mut self, service: &Service, stop: &Stop) -> Result<(), DeviceError> {
        self.reporter.begin(monotonic_ns());
        loop {
            let now_ns = monotonic_ns();
            self.reporter
                .look(&self.hd, &self.units, &self.shared, now_ns);
            self.note_losses(now_ns);
            if self.shared.has_failed.load(Acquire) {
                return Err(DeviceError(
                    "defect of the program in the haptic loop of OpenHaptics: the forces are off; report the defect"
                        .into(),
                ));
            }
            if stop.is_asked() || service.has_ended() {
                return Ok(());
            }
            let is_due = self.lost.iter().any(|loss| loss.is_due(now_ns));
            if is_due && !unit::is_kept() {
                // The callback ends as soon as no other hand has a force.
                self.shared.give(Order::Pause);
            }
            sleep_until(now_ns + LOOK_NS);
        }
    }

    /// Notes the devices that the callback has lost.
    fn note_losses(&mut self, now_ns: u64) {
        for at in 0..self.units.len() {
            let code = self.shared.hands[at].lost.load(Relaxed);
            if code == 0 || self.lost[at].is_lost || self.units[at].handle.is_none() {
                continue;
            }
            let (title, text) = (self.units[at].title(), self.hd.error_text(code));
            self.lost[at].is_lost = true;
            if !self.lost[at].backoff.lost(now_ns) {
                continue;
            }
            tracing::warn!("{}", super::errors::remark(&title, code, &text));
            if unit::is_kept() {
                tracing::warn!(
                    "{title}: {} is set, so the device returns only in a new start of the program",
                    unit::KEEP
                );
            }
        }
    }

    /// Tries to open lost devices again, between two services.
    fn retry(&mut self, hands: &mut [Hand]) {
        self.note_losses(monotonic_ns());
        for (at, hand) in hands.iter_mut().enumerate() {
            let is_due = self.lost[at].is_due(monotonic_ns());
            if !self.lost[at].is_lost {
                continue;
            }
            if self.shared.hands[at].lost.load(Relaxed) != 0 && self.units[at].handle.is_some() {
                self.units[at].close();
            }
            if !is_due || unit::is_kept() {
                continue;
            }
            hand.absent(monotonic_ns());
            match self.units[at].reopen() {
                Ok(()) => {
                    tracing::info!("{} has returned: press a button", self.units[at].title());
                    self.shared.hands[at].lost.store(0, Relaxed);
                    self.lost[at].is_lost = false;
                    self.lost[at].backoff.opened(monotonic_ns());
                }
                Err(refusal) => {
                    tracing::debug!("{}", refusal.text);
                    self.lost[at].backoff.failed(monotonic_ns());
                }
            }
        }
    }

    /// Performs periods without a device, until a trial is due.
    fn idle(&mut self, hands: &mut [Hand], stop: &Stop) {
        let mut now_ns = monotonic_ns();
        let is_due = |now_ns| self.lost.iter().any(|loss| loss.is_due(now_ns));
        while !stop.is_asked() {
            hands.iter_mut().for_each(|hand| hand.absent(now_ns));
            if is_due(now_ns) && !unit::is_kept() {
                return;
            }
            sleep_until(now_ns + PERIOD_NS);
            now_ns = monotonic_ns();
        }
    }

    /// Opens the devices again that an earlier run has closed.
    fn open_again(&mut self) -> Result<(), DeviceError> {
        for unit in self.units.iter_mut().filter(|unit| unit.handle.is_none()) {
            unit.reopen().map_err(|refusal| DeviceError(refusal.text))?;
        }
        self.lost.fill(Loss::default());
        Ok(())
    }
}

impl Device for Session {
    fn info(&self) -> &[HandInfo] {
        &self.infos
    }

    fn run(&mut self, ports: Vec<HandPort>, stop: &Stop) -> Result<(), DeviceError> {
        if ports.len() != self.units.len() {
            return Err(DeviceError(format!(
                "defect of the program: {} ports for {} devices",
                ports.len(),
                self.units.len()
            )));
        }
        self.open_again()?;
        self.shared = Arc::new(Shared::default());
        let with_info = ports.into_iter().zip(&self.infos);
        let hands = with_info
            .map(|(port, info)| Hand::new(port, info.torque_axes > 0))
            .collect();
        let result = self.serve(hands, stop);
        self.units.iter_mut().for_each(Unit::close);
        result
    }
}
