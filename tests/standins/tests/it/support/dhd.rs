//! The Force Dimension SDK as a client sees it.

use super::c_path;
use libloading::Library;
use std::ffi::c_char;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use sulcus_standins::{Rig, library};

macro_rules! functions {
    ($($field:ident $name:literal ($($arg:ty),*) $(-> $out:ty)?;)*) => {
        /// Functions of the library. Loading looks every one of them up.
        #[expect(dead_code, reason = "tests call some of the functions")]
        pub struct Dhd { $(pub $field: unsafe extern "system" fn($($arg),*) $(-> $out)?,)* }
        impl Dhd {
            /// Loads the library for the life of the process.
            pub fn load(path: &Path) -> Self {
                // SAFETY: the stand-in has these functions with these signatures.
                unsafe {
                    let library: &'static Library = Box::leak(Box::new(Library::new(path).expect("a library")));
                    Self { $($field: *library.get($name).expect($name),)* }
                }
            }
        }
    };
}

type Out = *mut f64;

functions! {
    count "dhdGetDeviceCount" () -> i32;
    available "dhdGetAvailableCount" () -> i32;
    open "dhdOpen" () -> i32;
    open_id "dhdOpenID" (c_char) -> i32;
    open_serial "dhdOpenSerial" (i32) -> i32;
    open_type "dhdOpenType" (i32) -> i32;
    close "dhdClose" (c_char) -> i32;
    stop "dhdStop" (c_char) -> i32;
    name "dhdGetSystemName" (c_char) -> *const c_char;
    kind "dhdGetSystemType" (c_char) -> i32;
    serial "dhdGetSerialNumber" (*mut u16, c_char) -> i32;
    sdk "dhdGetSDKVersion" (*mut i32, *mut i32, *mut i32, *mut i32);
    status "dhdGetStatus" (*mut [i32; 17], c_char) -> i32;
    left "dhdIsLeftHanded" (c_char) -> bool;
    base "dhdHasBase" (c_char) -> bool;
    wrist "dhdHasWrist" (c_char) -> bool;
    active_wrist "dhdHasActiveWrist" (c_char) -> bool;
    gripper "dhdHasGripper" (c_char) -> bool;
    active_gripper "dhdHasActiveGripper" (c_char) -> bool;
    position "dhdGetPosition" (Out, Out, Out, c_char) -> i32;
    frame "dhdGetPositionAndOrientationFrame" (Out, Out, Out, *mut [[f64; 3]; 3], c_char) -> i32;
    orientation "dhdGetOrientationRad" (Out, Out, Out, c_char) -> i32;
    linear_velocity "dhdGetLinearVelocity" (Out, Out, Out, c_char) -> i32;
    angular_velocity "dhdGetAngularVelocityRad" (Out, Out, Out, c_char) -> i32;
    config_velocity "dhdConfigLinearVelocity" (i32, i32, c_char) -> i32;
    set_force "dhdSetForce" (f64, f64, f64, c_char) -> i32;
    set_torque "dhdSetForceAndTorque" (f64, f64, f64, f64, f64, f64, c_char) -> i32;
    set_all "dhdSetForceAndTorqueAndGripperForce" (f64, f64, f64, f64, f64, f64, f64, c_char) -> i32;
    enable "dhdEnableForce" (u8, c_char) -> i32;
    gravity "dhdSetGravityCompensation" (i32, c_char) -> i32;
    effector_mass "dhdSetEffectorMass" (f64, c_char) -> i32;
    brakes "dhdSetBrakes" (i32, c_char) -> i32;
    button "dhdGetButton" (i32, c_char) -> i32;
    buttons "dhdGetButtonMask" (c_char) -> u32;
    emulate "dhdEmulateButton" (u8, c_char) -> i32;
    rate "dhdGetComFreq" (c_char) -> f64;
    max_force "dhdSetMaxForce" (f64, c_char) -> i32;
    error "dhdErrorGetLast" () -> i32;
    error_text "dhdErrorGetLastStr" () -> *const c_char;
    text_of "dhdErrorGetStr" (i32) -> *const c_char;
    expert "dhdEnableExpertMode" () -> i32;
    watchdog "dhdSetWatchdog" (u8, c_char) -> i32;
    threshold "dhdSetVelocityThreshold" (u32, c_char) -> i32;
    time_guard "dhdSetTimeGuard" (i32, c_char) -> i32;
    drd_open "drdOpenID" (c_char) -> i32;
    initialized "drdIsInitialized" (c_char) -> bool;
    auto_init "drdAutoInit" (c_char) -> i32;
    drd_stop "drdStop" (bool, c_char) -> i32;
    drd_close "drdClose" (c_char) -> i32;
    reset "standin_reset" (*const c_char) -> u8;
}

/// The library, fresh and connected to the rig. One test at a time has it.
pub fn fresh(rig: &Rig) -> (MutexGuard<'static, ()>, &'static Dhd) {
    static ONE: Mutex<()> = Mutex::new(());
    static DHD: OnceLock<Dhd> = OnceLock::new();
    let guard = ONE.lock().unwrap_or_else(PoisonError::into_inner);
    let dhd = DHD.get_or_init(|| Dhd::load(&library("standin_dhd").expect("the library is built")));
    let path = c_path(&rig.board());
    // SAFETY: the path is a C text.
    assert_eq!(unsafe { (dhd.reset)(path.as_ptr()) }, 1);
    (guard, dhd)
}

impl Dhd {
    /// Status of a device.
    pub fn status_of(&self, id: c_char) -> [i32; 17] {
        let mut status = [-9; 17];
        // SAFETY: the array has 17 numbers.
        assert_eq!(unsafe { (self.status)(&mut status, id) }, 0);
        status
    }

    /// Result and three numbers of a reading.
    pub fn three(
        &self,
        read: unsafe extern "system" fn(Out, Out, Out, c_char) -> i32,
        id: c_char,
    ) -> (i32, [f64; 3]) {
        let mut v = [f64::NAN; 3];
        let [x, y, z] = &mut v;
        // SAFETY: the pointers are valid.
        let result = unsafe { read(x, y, z, id) };
        (result, v)
    }
}
