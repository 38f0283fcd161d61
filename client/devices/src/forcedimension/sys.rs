//! Functions, types and constants of the library, as `notes/devices.md` section 2 states them. `libdrd` exports every
//! function of `libdhd` too.

use std::ffi::c_char;

use crate::library::{LoadError, Opened, Wanted};

/// The library and its places.
pub const LIBRARY: Wanted = Wanted {
    name: "Force Dimension SDK (libdrd)",
    variable: "SULCUS_DHD_LIBRARY",
    candidates: CANDIDATES,
    kit: (
        "FDSDK",
        &[
            "lib/release/lin-x86_64-gcc",
            "lib/release/lin-aarch64-gcc",
            "lib/release/mac-x86_64-clang",
            "lib",
            "bin",
        ],
    ),
    remedy: "install the Force Dimension SDK 3.17 or newer",
};

#[cfg(target_os = "windows")]
const CANDIDATES: &[&str] = &["drd64.dll"];
#[cfg(target_os = "macos")]
const CANDIDATES: &[&str] = &[
    "libdrd.3.dylib",
    "libdrd.dylib",
    "/usr/local/lib/libdrd.dylib",
];
#[cfg(not(any(target_os = "windows", target_os = "macos")))]
const CANDIDATES: &[&str] = &[
    "libdrd.so.3",
    "libdrd.so",
    "/usr/local/lib/libdrd.so.3",
    "/usr/local/lib/libdrd.so",
];

/// The call came sooner than the time guard allows: the data are those of the call before.
pub const TIMEGUARD: i32 = 1;
/// The motors cannot follow the command.
pub const MOTOR_SATURATED: i32 = 2;

/// Number of values of a status.
pub const STATUS: usize = 17;
/// Places in a status: power supply.
pub const STATUS_POWER: usize = 0;
/// Connection to the computer.
pub const STATUS_CONNECTED: usize = 1;
/// Calibration missing.
pub const STATUS_RESET: usize = 3;
/// Force on.
pub const STATUS_FORCE: usize = 5;
/// Brakes on.
pub const STATUS_BRAKE: usize = 6;
/// Cause of a force that is off.
pub const STATUS_FORCE_OFF_CAUSE: usize = 14;

/// Functions of the library. The last argument is the device, and C `bool` is read as a byte.
#[derive(Clone, Copy, Debug)]
pub struct Functions {
    pub sdk_version: unsafe extern "system" fn(*mut i32, *mut i32, *mut i32, *mut i32),
    pub device_count: unsafe extern "system" fn() -> i32,
    pub open_id: unsafe extern "system" fn(c_char) -> i32,
    pub close: unsafe extern "system" fn(c_char) -> i32,
    pub regulation_stop: unsafe extern "system" fn(u8, c_char) -> i32,
    pub is_initialized: unsafe extern "system" fn(c_char) -> u8,
    pub auto_init: unsafe extern "system" fn(c_char) -> i32,
    pub system_name: unsafe extern "system" fn(c_char) -> *const c_char,
    pub system_type: unsafe extern "system" fn(c_char) -> i32,
    pub serial_number: unsafe extern "system" fn(*mut u16, c_char) -> i32,
    pub has_wrist: unsafe extern "system" fn(c_char) -> u8,
    pub has_active_wrist: unsafe extern "system" fn(c_char) -> u8,
    pub has_gripper: unsafe extern "system" fn(c_char) -> u8,
    pub status: unsafe extern "system" fn(*mut i32, c_char) -> i32,
    pub position: unsafe extern "system" fn(*mut f64, *mut f64, *mut f64, c_char) -> i32,
    pub position_and_frame:
        unsafe extern "system" fn(*mut f64, *mut f64, *mut f64, *mut [[f64; 3]; 3], c_char) -> i32,
    pub set_force: unsafe extern "system" fn(f64, f64, f64, c_char) -> i32,
    pub set_force_torque_grip:
        unsafe extern "system" fn(f64, f64, f64, f64, f64, f64, f64, c_char) -> i32,
    pub enable_force: unsafe extern "system" fn(u8, c_char) -> i32,
    pub set_gravity_compensation: unsafe extern "system" fn(i32, c_char) -> i32,
    pub button_mask: unsafe extern "system" fn(c_char) -> u32,
    pub emulate_button: unsafe extern "system" fn(u8, c_char) -> i32,
    pub stop: unsafe extern "system" fn(c_char) -> i32,
    pub enable_expert_mode: unsafe extern "system" fn() -> i32,
    pub set_watchdog: unsafe extern "system" fn(u8, c_char) -> i32,
    pub set_time_guard: unsafe extern "system" fn(i32, c_char) -> i32,
    pub error_last: unsafe extern "system" fn() -> i32,
    pub error_text: unsafe extern "system" fn(i32) -> *const c_char,
}

impl Functions {
    /// Looks the functions up.
    ///
    /// # Errors
    /// The first function that the library does not have.
    pub fn of(library: &Opened) -> Result<Self, LoadError> {
        // SAFETY: the signatures are those of the library on all systems: `system` is the convention of the library on
        // Windows, and C elsewhere.
        unsafe {
            Ok(Self {
                sdk_version: library.function("dhdGetSDKVersion")?,
                device_count: library.function("dhdGetDeviceCount")?,
                open_id: library.function("drdOpenID")?,
                close: library.function("drdClose")?,
                regulation_stop: library.function("drdStop")?,
                is_initialized: library.function("drdIsInitialized")?,
                auto_init: library.function("drdAutoInit")?,
                system_name: library.function("dhdGetSystemName")?,
                system_type: library.function("dhdGetSystemType")?,
                serial_number: library.function("dhdGetSerialNumber")?,
                has_wrist: library.function("dhdHasWrist")?,
                has_active_wrist: library.function("dhdHasActiveWrist")?,
                has_gripper: library.function("dhdHasGripper")?,
                status: library.function("dhdGetStatus")?,
                position: library.function("dhdGetPosition")?,
                position_and_frame: library.function("dhdGetPositionAndOrientationFrame")?,
                set_force: library.function("dhdSetForce")?,
                set_force_torque_grip: library.function("dhdSetForceAndTorqueAndGripperForce")?,
                enable_force: library.function("dhdEnableForce")?,
                set_gravity_compensation: library.function("dhdSetGravityCompensation")?,
                button_mask: library.function("dhdGetButtonMask")?,
                emulate_button: library.function("dhdEmulateButton")?,
                stop: library.function("dhdStop")?,
                enable_expert_mode: library.function("dhdEnableExpertMode")?,
                set_watchdog: library.function("dhdSetWatchdog")?,
                set_time_guard: library.function("dhdSetTimeGuard")?,
                error_last: library.function("dhdErrorGetLast")?,
                error_text: library.function("dhdErrorGetStr")?,
            })
        }
    }
}
