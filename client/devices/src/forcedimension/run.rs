//! Run of the devices of a session: one thread for each device, and the supervising thread.

use std::sync::atomic::Ordering::Acquire;

use sulcus_haptics::device::{Device, DeviceError, HandInfo, Stop};
use sulcus_haptics::port::HandPort;
use sulcus_link::clock::{monotonic_ns, sleep_until};
use sulcus_link::schedule::{exact_timers, fifo};

use super::api::Dhd;
use super::report::Said;
use super::serve::Hand;
use super::shared::HandState;
use super::unit::Unit;

/// Time between two looks of the supervising thread, nanoseconds.
const LOOK_NS: u64 = 20_000_000;

/// Real-time priority of a device's thread, above that of the link.
const PRIORITY: i32 = 46;

/// Devices of one session.
#[derive(Debug)]
pub struct Session {
    dhd: Dhd,
    infos: Vec<HandInfo>,
    /// Open devices; empty after a run.
    units: Vec<Unit>,
}

/// Request to end that is made at the end of the value.
struct AskAtEnd<'a>(&'a Stop);

impl Drop for AskAtEnd<'_> {
    fn drop(&mut self) {
        self.0.ask();
    }
}

impl Session {
    /// Session of open devices.
    pub fn new(dhd: Dhd, units: Vec<Unit>) -> Self {
        Self {
            dhd,
            infos: units.iter().map(|unit| unit.info.clone()).collect(),
            units,
        }
    }

    /// Takes the open devices, and opens those again that an earlier run has closed.
    fn take(&mut self) -> Result<Vec<Unit>, DeviceError> {
        if !self.units.is_empty() {
            return Ok(std::mem::take(&mut self.units));
        }
        let open = |info: &HandInfo| {
            Unit::open(self.dhd, &info.serial).map_err(|refusal| DeviceError(refusal.text))
        };
        self.infos.iter().map(open).collect()
    }
}

impl Device for Session {
    fn info(&self) -> &[HandInfo] {
        &self.infos
    }

    fn run(&mut self, ports: Vec<HandPort>, stop: &Stop) -> Result<(), DeviceError> {
        if ports.len() != self.infos.len() {
            return Err(DeviceError(format!(
                "defect of the program: {} ports for {} devices",
                ports.len(),
                self.infos.len()
            )));
        }
        let units = self.take()?;
        let (dhd, infos) = (self.dhd, &self.infos);
        let states: Vec<HandState> = infos.iter().map(|_| HandState::default()).collect();
        let inner = Stop::new();
        std::thread::scope(|scope| {
            let _end = AskAtEnd(&inner);
            for ((unit, port), (info, state)) in
                units.into_iter().zip(ports).zip(infos.iter().zip(&states))
            {
                let mut hand = Hand {
                    dhd,
                    info,
                    port,
                    state,
                    stops: [stop, &inner],
                };
                let serve = move || {
                    exact_timers();
                    // Without the right to it the thread runs as any other.
                    let _ = fifo(PRIORITY);
                    hand.serve(unit);
                };
                // Linux shows the first 15 characters.
                std::thread::Builder::new()
                    .name(format!("dhd-{}", info.serial))
                    .spawn_scoped(scope, serve)
                    .map_err(|error| {
                        DeviceError(format!("no thread for a haptic device: {error}"))
                    })?;
            }
            supervise(&dhd, infos, &states, stop)
        })
    }
}

/// Watches the devices until a stop is asked, or a thread fails.
fn supervise(
    dhd: &Dhd,
    infos: &[HandInfo],
    states: &[HandState],
    stop: &Stop,
) -> Result<(), DeviceError> {
    let mut said = vec![Said::default(); infos.len()];
    while !stop.is_asked() {
        let now_ns = monotonic_ns();
        for ((said, info), state) in said.iter_mut().zip(infos).zip(states) {
            said.look(dhd, info, state, now_ns);
        }
        if states.iter().any(|state| state.has_failed.load(Acquire)) {
            return Err(DeviceError(
                "defect of the program in the haptic loop of a Force Dimension device: the forces are off; report the \
                 defect"
                    .into(),
            ));
        }
        sleep_until(now_ns + LOOK_NS);
    }
    Ok(())
}
