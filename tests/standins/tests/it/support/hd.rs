//! HDAPI as a client sees it.

use super::c_path;
use libloading::Library;
use std::ffi::{CStr, CString, c_char, c_long, c_ulong, c_void};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use sulcus_standins::{Rig, library};

pub const NONE: u32 = 0xFFFF_FFFF;
pub const FORCE: u32 = 0x2700;
pub const TORQUE: u32 = 0x2701;
pub const OUTPUT: u32 = 0x4000;

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ErrorInfo {
    pub code: u32,
    pub internal: i32,
    pub hhd: u32,
}

pub type Callback = unsafe extern "system" fn(*mut c_void) -> u32;

macro_rules! functions {
    ($($field:ident $name:literal ($($arg:ty),*) $(-> $out:ty)?;)*) => {
        /// Functions of the library. Loading looks every one of them up.
        #[expect(dead_code, reason = "tests call some of the functions")]
        pub struct Hd { $(pub $field: unsafe extern "system" fn($($arg),*) $(-> $out)?,)* }
        impl Hd {
            /// Loads the library for the life of the process.
            pub fn load(path: &Path) -> Self {
                // SAFETY: the stand-in has these functions with these signatures.
                unsafe {
                    let library: &'static Library = Box::leak(Box::new(Library::new(path).expect("a library")));
                    Self { $($field: *library.get($name).expect($name),)* }
                }
            }
        }
        /// Names of the functions.
        pub const NAMES: &[&str] = &[$($name),*];
    };
}

functions! {
    init "hdInitDevice" (*const c_char) -> u32;
    disable_device "hdDisableDevice" (u32);
    make_current "hdMakeCurrentDevice" (u32);
    current "hdGetCurrentDevice" () -> u32;
    begin "hdBeginFrame" (u32);
    end "hdEndFrame" (u32);
    error "hdGetError" () -> ErrorInfo;
    error_string "hdGetErrorString" (u32) -> *const c_char;
    enable "hdEnable" (u32);
    disable "hdDisable" (u32);
    is_enabled "hdIsEnabled" (u32) -> u8;
    get_boolean "hdGetBooleanv" (u32, *mut u8);
    get_integer "hdGetIntegerv" (u32, *mut i32);
    get_float "hdGetFloatv" (u32, *mut f32);
    get_double "hdGetDoublev" (u32, *mut f64);
    get_long "hdGetLongv" (u32, *mut c_long);
    get_string "hdGetString" (u32) -> *const c_char;
    set_boolean "hdSetBooleanv" (u32, *const u8);
    set_integer "hdSetIntegerv" (u32, *const i32);
    set_float "hdSetFloatv" (u32, *const f32);
    set_double "hdSetDoublev" (u32, *const f64);
    set_long "hdSetLongv" (u32, *const c_long);
    check_calibration "hdCheckCalibration" () -> u32;
    calibration_style "hdCheckCalibrationStyle" () -> u32;
    update_calibration "hdUpdateCalibration" (u32);
    start "hdStartScheduler" ();
    stop "hdStopScheduler" ();
    rate "hdSetSchedulerRate" (c_ulong);
    time_stamp "hdGetSchedulerTimeStamp" () -> f64;
    schedule "hdScheduleAsynchronous" (Callback, *mut c_void, u16) -> c_ulong;
    schedule_and_wait "hdScheduleSynchronous" (Callback, *mut c_void, u16);
    unschedule "hdUnschedule" (c_ulong);
    wait "hdWaitForCompletion" (c_ulong, u32) -> u8;
    license "hdDeploymentLicense" (*const c_char, *const c_char, *const c_char) -> u8;
    scale_gimbal "hdScaleGimbalAngles" ();
    calibration_message "hdUpdateCalibrationMessage" ();
    reset "standin_reset" (*const c_char) -> u8;
}

/// The library, fresh and connected to the rig. One test at a time has it.
pub fn fresh(rig: &Rig) -> (MutexGuard<'static, ()>, &'static Hd) {
    static ONE: Mutex<()> = Mutex::new(());
    static HD: OnceLock<Hd> = OnceLock::new();
    let guard = ONE.lock().unwrap_or_else(PoisonError::into_inner);
    let hd = HD.get_or_init(|| Hd::load(&library("standin_hd").expect("the library is built")));
    let path = c_path(&rig.board());
    // SAFETY: the path is a C text.
    assert_eq!(unsafe { (hd.reset)(path.as_ptr()) }, 1);
    (guard, hd)
}

impl Hd {
    /// Opens a device by name.
    pub fn open(&self, name: &str) -> u32 {
        let name = CString::new(name).expect("no zero in the name");
        // SAFETY: the name is a C text.
        unsafe { (self.init)(name.as_ptr()) }
    }

    /// All errors, newest first.
    pub fn errors(&self) -> Vec<(u32, u32)> {
        // SAFETY: the function has no precondition.
        std::iter::from_fn(|| Some(unsafe { (self.error)() }))
            .take_while(|e| e.code != 0)
            .map(|e| (e.code, e.hhd))
            .collect()
    }

    /// Doubles of a parameter of the current device.
    pub fn doubles<const N: usize>(&self, parameter: u32) -> [f64; N] {
        let mut out = [f64::NAN; N];
        // SAFETY: the caller gives the count of the parameter.
        unsafe { (self.get_double)(parameter, out.as_mut_ptr()) };
        out
    }

    /// A text of the current device.
    pub fn text(&self, parameter: u32) -> String {
        // SAFETY: a text of the library ends with a zero.
        unsafe {
            let text = (self.get_string)(parameter);
            assert!(!text.is_null());
            CStr::from_ptr(text).to_string_lossy().into_owned()
        }
    }

    /// Sets three doubles of the current device.
    pub fn set(&self, parameter: u32, value: [f64; 3]) {
        // SAFETY: the value has three numbers.
        unsafe { (self.set_double)(parameter, value.as_ptr()) };
    }

    /// A frame of a device with a force in N.
    pub fn frame(&self, hhd: u32, force: [f64; 3]) {
        // SAFETY: any handle is an argument without precondition.
        unsafe {
            (self.begin)(hhd);
            self.set(FORCE, force);
            (self.end)(hhd);
        }
    }

    /// Calls `tick` at every tick until the returned guard is dropped.
    pub fn run<'a, F: FnMut() + Send + 'a>(&'a self, tick: F) -> Running<'a, F> {
        let tick = Box::into_raw(Box::new(tick));
        // SAFETY: the guard keeps the closure until the scheduler stopped.
        unsafe {
            (self.schedule)(call::<F>, tick.cast(), 65535);
            (self.start)();
        }
        Running { hd: self, tick }
    }
}

unsafe extern "system" fn call<F: FnMut()>(user: *mut c_void) -> u32 {
    // SAFETY: `run` passes a closure of this type.
    unsafe { (*user.cast::<F>())() };
    1
}

/// A running scheduler.
pub struct Running<'a, F> {
    hd: &'a Hd,
    tick: *mut F,
}

impl<F> Drop for Running<'_, F> {
    fn drop(&mut self) {
        // SAFETY: after the stop nothing calls the closure.
        unsafe {
            (self.hd.stop)();
            drop(Box::from_raw(self.tick));
        }
    }
}
