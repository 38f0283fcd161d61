//! Loading of the stand-ins, and rigs.

pub mod dhd;
pub mod hd;

use std::ffi::CString;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::time::{Duration, Instant};
use sulcus_standins::Rig;
use sulcus_standins::setup::{DeviceSetup, Setup};

/// A rig with these devices.
pub fn rig(devices: Vec<DeviceSetup>) -> Rig {
    rig_of(Setup::new(devices))
}

/// A rig with these settings.
pub fn rig_of(setup: Setup) -> Rig {
    let program = Path::new(env!("CARGO_BIN_EXE_standin-controller"));
    Rig::start_at(program, setup).expect("the controller starts")
}

/// A path as C text.
pub fn c_path(path: &Path) -> CString {
    CString::new(path.as_os_str().as_bytes()).expect("no zero in the path")
}

/// Waits until the condition holds, at most five seconds; returns whether it does.
pub fn wait_until(mut condition: impl FnMut() -> bool) -> bool {
    let until = Instant::now() + Duration::from_secs(5);
    while Instant::now() < until {
        if condition() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    condition()
}

/// Sleeps for so many ms.
pub fn sleep_ms(ms: u64) {
    std::thread::sleep(Duration::from_millis(ms));
}
