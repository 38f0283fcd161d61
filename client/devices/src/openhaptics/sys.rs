//! Functions, types and constants of the library, as `notes/devices.md` section 1 states them.

use std::ffi::{c_char, c_ulong, c_void};

use crate::library::{LoadError, Opened, Wanted};

/// The library and its places.
pub const LIBRARY: Wanted = Wanted {
    name: "OpenHaptics (libHD)",
    variable: "SULCUS_HD_LIBRARY",
    candidates: CANDIDATES,
    kit: ("OH_SDK_BASE", &["lib64", "lib", "usr/lib", "lib/x64"]),
    remedy: "install OpenHaptics 3.4 and the device driver of 3D Systems",
};

#[cfg(target_os = "windows")]
const CANDIDATES: &[&str] = &["HD.dll"];
#[cfg(target_os = "macos")]
const CANDIDATES: &[&str] = &["libHD.dylib"];
#[cfg(not(any(target_os = "windows", target_os = "macos")))]
const CANDIDATES: &[&str] = &[
    "libHD.so",
    "libHD.so.3.4",
    "libHD.so.3.0",
    "/usr/lib/libHD.so",
    "/usr/lib/libHD.so.3.4",
    "/usr/lib/libHD.so.3.0",
    "/opt/OpenHaptics/Developer/3.4-0/lib64/libHD.so",
    "/opt/OpenHaptics/Developer/3.4-0/usr/lib/libHD.so",
];

/// Handle of no device.
pub const INVALID_HANDLE: u32 = 0xFFFF_FFFF;

/// Buttons of the stylus, `i32`, one bit each.
pub const CURRENT_BUTTONS: u32 = 0x2000;
/// Pose of the stylus, sixteen `f64` by columns, millimetres.
pub const CURRENT_TRANSFORM: u32 = 0x2052;
/// Version of the library, text.
pub const VERSION: u32 = 0x2500;
/// Model of the device, text.
pub const DEVICE_MODEL_TYPE: u32 = 0x2501;
/// Serial number, text.
pub const DEVICE_SERIAL_NUMBER: u32 = 0x2504;
/// Number of measured axes, `i32`.
pub const INPUT_DOF: u32 = 0x2553;
/// Number of axes with force or torque, `i32`.
pub const OUTPUT_DOF: u32 = 0x2554;
/// Ways of calibration, `i32`, one bit each.
pub const CALIBRATION_STYLE: u32 = 0x2555;
/// Rate of the last tick, `i32`, Hz.
pub const INSTANTANEOUS_UPDATE_RATE: u32 = 0x2601;
/// Largest stiffness, `f64`, N/mm.
pub const NOMINAL_MAX_STIFFNESS: u32 = 0x2602;
/// Largest force, `f64`, N.
pub const NOMINAL_MAX_FORCE: u32 = 0x2603;
/// Force at which the device may stay, `f64`, N.
pub const NOMINAL_MAX_CONTINUOUS_FORCE: u32 = 0x2604;
/// Force to display, three `f64`, N.
pub const CURRENT_FORCE: u32 = 0x2700;
/// Torque to display, three `f64`, mN m.
pub const CURRENT_TORQUE: u32 = 0x2701;
/// Capability: output of force, of the current device.
pub const FORCE_OUTPUT: u32 = 0x4000;
/// Capability: rise of the force after its output was turned on, of the current device.
pub const FORCE_RAMPING: u32 = 0x4002;

/// The calibration is right.
pub const CALIBRATION_OK: u32 = 0x5000;
/// The calibration needs calls of `hdUpdateCalibration`.
pub const CALIBRATION_NEEDS_UPDATE: u32 = 0x5001;
/// The calibration needs an act of the person.
pub const CALIBRATION_NEEDS_MANUAL_INPUT: u32 = 0x5002;

/// Result of a callback that has ended.
pub const DONE: u32 = 0;
/// Result of a callback that goes on with the next tick.
pub const CONTINUE: u32 = 1;
/// Priority of the callback, the largest.
pub const PRIORITY: u16 = 65535;
/// Rate of the scheduler, Hz.
pub const RATE_HZ: c_ulong = 1000;

/// Error, as the library returns it by value.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ErrorInfo {
    /// Code; 0 for an empty stack.
    pub code: u32,
    /// Code inside of the driver.
    pub internal: i32,
    /// Handle of the device.
    pub hhd: u32,
}

/// Callback of the scheduler.
pub type Callback = unsafe extern "system" fn(*mut c_void) -> u32;

/// Functions of the library.
#[derive(Clone, Copy, Debug)]
pub struct Functions {
    pub init_device: unsafe extern "system" fn(*const c_char) -> u32,
    pub disable_device: unsafe extern "system" fn(u32),
    pub make_current_device: unsafe extern "system" fn(u32),
    pub begin_frame: unsafe extern "system" fn(u32),
    pub end_frame: unsafe extern "system" fn(u32),
    pub get_error: unsafe extern "system" fn() -> ErrorInfo,
    pub get_error_string: unsafe extern "system" fn(u32) -> *const c_char,
    pub enable: unsafe extern "system" fn(u32),
    pub disable: unsafe extern "system" fn(u32),
    pub get_integer: unsafe extern "system" fn(u32, *mut i32),
    pub get_double: unsafe extern "system" fn(u32, *mut f64),
    pub get_string: unsafe extern "system" fn(u32) -> *const c_char,
    pub set_double: unsafe extern "system" fn(u32, *const f64),
    pub check_calibration: unsafe extern "system" fn() -> u32,
    pub update_calibration: unsafe extern "system" fn(u32),
    pub start_scheduler: unsafe extern "system" fn(),
    pub stop_scheduler: unsafe extern "system" fn(),
    pub set_scheduler_rate: unsafe extern "system" fn(c_ulong),
    pub schedule_asynchronous: unsafe extern "system" fn(Callback, *mut c_void, u16) -> c_ulong,
    pub schedule_synchronous: unsafe extern "system" fn(Callback, *mut c_void, u16),
    pub unschedule: unsafe extern "system" fn(c_ulong),
    pub wait_for_completion: unsafe extern "system" fn(c_ulong, u32) -> u8,
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
                init_device: library.function("hdInitDevice")?,
                disable_device: library.function("hdDisableDevice")?,
                make_current_device: library.function("hdMakeCurrentDevice")?,
                begin_frame: library.function("hdBeginFrame")?,
                end_frame: library.function("hdEndFrame")?,
                get_error: library.function("hdGetError")?,
                get_error_string: library.function("hdGetErrorString")?,
                enable: library.function("hdEnable")?,
                disable: library.function("hdDisable")?,
                get_integer: library.function("hdGetIntegerv")?,
                get_double: library.function("hdGetDoublev")?,
                get_string: library.function("hdGetString")?,
                set_double: library.function("hdSetDoublev")?,
                check_calibration: library.function("hdCheckCalibration")?,
                update_calibration: library.function("hdUpdateCalibration")?,
                start_scheduler: library.function("hdStartScheduler")?,
                stop_scheduler: library.function("hdStopScheduler")?,
                set_scheduler_rate: library.function("hdSetSchedulerRate")?,
                schedule_asynchronous: library.function("hdScheduleAsynchronous")?,
                schedule_synchronous: library.function("hdScheduleSynchronous")?,
                unschedule: library.function("hdUnschedule")?,
                wait_for_completion: library.function("hdWaitForCompletion")?,
            })
        }
    }
}

const _: () = assert!(size_of::<ErrorInfo>() == 12);
