//! `devices hands`: which device is in which hand, found by a button of the left one.
//!
//! The devices run behind closed doors: no order reaches them, so that no force is displayed.

use std::time::{Duration, Instant};

use anyhow::bail;
use sulcus_connection::interrupt;
use sulcus_core::{Pose, Quat, Vec3};
use sulcus_devices::{Found, State, backends};
use sulcus_haptics::continuous::ContinuousLimit;
use sulcus_haptics::device::{Device, Stop};
use sulcus_haptics::door::Guard;
use sulcus_haptics::freshness::Silence;
use sulcus_haptics::{DoorRules, HandEnd, Limits, Mapping, PassivityParams, SlewLimits, port};
use sulcus_program::{say, tell};

use super::settings::Hand;
use super::{opened, stored};

/// Time for the press of a button.
const PATIENCE: Duration = Duration::from_secs(60);

/// Device that waits for a press.
struct Asked {
    library: &'static str,
    serial: String,
    end: HandEnd,
}

/// Asks for a button of the left device, and stores the hands of both.
///
/// # Errors
/// There are not two usable devices, nobody presses a button, or the settings cannot be written.
pub fn run() -> anyhow::Result<u8> {
    let (mut settings, file) = stored()?;
    let Some(file) = file else {
        bail!("no folder for the settings: set SULCUS_STATE_DIR, XDG_STATE_HOME or HOME");
    };
    let found = opened::found(&settings);
    let usable = |f: &&Found| !f.serial.is_empty() && f.state == State::Ready;
    let usable: Vec<&Found> = found.iter().filter(usable).collect();
    if usable.len() != 2 {
        bail!(
            "{} devices are ready, expected two; `sulcus-client devices` says what each lacks",
            usable.len()
        );
    }
    let stop = Stop::new();
    let left = std::thread::scope(|scope| {
        let _ends = Ending(&stop);
        let mut asked = Vec::new();
        for backend in backends() {
            let of_backend = usable.iter().filter(|f| f.library == backend.name());
            let serials: Vec<String> = of_backend.map(|f| f.serial.clone()).collect();
            if serials.is_empty() {
                continue;
            }
            let mut device = backend.open(&serials)?;
            let mut ports = Vec::new();
            for serial in serials {
                let (port, end) = port::door(closed(&*device));
                ports.push(port);
                asked.push(Asked {
                    library: backend.name(),
                    serial,
                    end,
                });
            }
            let stop = &stop;
            scope.spawn(move || {
                if let Err(error) = device.run(ports, stop) {
                    tell!("error: {error}");
                }
            });
        }
        tell!("press a button of the device in your LEFT hand");
        let pressed = wait(&mut asked)?;
        anyhow::Ok(asked.swap_remove(pressed).serial)
    })?;
    for found in usable {
        let hand = if found.serial == left {
            Hand::Left
        } else {
            Hand::Right
        };
        let mut device = settings.of(found.library, &found.serial);
        device.hand = Some(hand);
        say!("{} hand: {}:{}", hand.name(), found.library, found.serial);
        settings.store(device);
    }
    settings.write(&file)?;
    Ok(0)
}

/// Asks the devices to end when the search ends, whatever its result.
struct Ending<'a>(&'a Stop);

impl Drop for Ending<'_> {
    fn drop(&mut self) {
        self.0.ask();
    }
}

/// Index of the first device with a button pressed.
fn wait(asked: &mut [Asked]) -> anyhow::Result<usize> {
    let begin = Instant::now();
    // Buttons that are held from the beginning on count after a release alone.
    let mut released = vec![false; asked.len()];
    while begin.elapsed() < PATIENCE && !interrupt::asked() {
        for (k, device) in asked.iter_mut().enumerate() {
            let pressed = device.end.buttons() != 0;
            if pressed && released[k] {
                return Ok(k);
            }
            released[k] |= !pressed && begin.elapsed() > Duration::from_millis(300);
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let names: Vec<String> = asked
        .iter()
        .map(|d| format!("{}:{}", d.library, d.serial))
        .collect();
    bail!(
        "no button was pressed within {} s on {}",
        PATIENCE.as_secs(),
        names.join(" and ")
    )
}

/// Rules of a door that displays at most 0.1 N, and without an order nothing. Poses are those of the handle in base
/// axes.
pub fn closed(device: &dyn Device) -> DoorRules {
    let least = ContinuousLimit {
        lasting: 0.1,
        peak: 0.1,
        time_s: 1.0,
    };
    let guard = Guard {
        mapping: Mapping {
            world_from_base: Quat::identity(),
            origin: Vec3::zeros(),
            scale: 1.0,
            gimbal_from_tool: Pose::identity(),
        },
        has_torque: false,
        silence: Silence::DEVICE,
        blend_ns: 0,
        force: least,
        torque: least,
        clutch: 0,
    };
    let period_ns = device
        .info()
        .first()
        .map_or(1_000_000, |info| info.period_ns);
    let limits = Limits {
        force_n: 0.1,
        torque_nm: 0.0,
    };
    let slew = SlewLimits {
        force_n_per_ms: 0.1,
        torque_nm_per_ms: 0.01,
    };
    let passivity = PassivityParams {
        period_s: period_ns as f64 / 1e9,
        ..PassivityParams::default()
    };
    DoorRules::guarded(limits, slew, passivity, guard)
}
