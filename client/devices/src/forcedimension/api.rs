//! Safe calls of the library. Every call names its device: the default device of the library is never used.

use std::ffi::{CStr, c_char};

use super::sys::{self, Functions};
use crate::library::{self, LoadError, Opened};

/// The library.
#[derive(Clone, Copy, Debug)]
pub struct Dhd {
    functions: Functions,
    library: &'static Opened,
}

/// Device that the library has opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Id(c_char);

/// Code of an error of the library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Code(pub i32);

/// Position in metres, and rotation by rows; axes of the library.
pub type Measured = ([f64; 3], [[f64; 3]; 3]);

/// Result of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// A new measurement.
    New(Measured),
    /// The call came too soon for a new measurement.
    TooSoon,
    /// The measurement failed.
    Failed(Code),
}

impl Dhd {
    /// Opens the library, once in a process.
    ///
    /// # Errors
    /// The library is absent, does not load, or lacks a function.
    pub fn load() -> Result<Self, LoadError> {
        let library = library::open(&sys::LIBRARY)?;
        Functions::of(library).map(|functions| Self { functions, library })
    }

    /// Path of the library.
    pub fn path(&self) -> String {
        self.library.path().display().to_string()
    }

    /// Version of the library.
    pub fn version(&self) -> [i32; 4] {
        let [mut a, mut b, mut c, mut d] = [0; 4];
        // SAFETY: four places for one number each.
        unsafe { (self.functions.sdk_version)(&mut a, &mut b, &mut c, &mut d) };
        [a, b, c, d]
    }

    /// Number of connected devices.
    pub fn count(&self) -> i32 {
        // SAFETY: the function has no precondition.
        unsafe { (self.functions.device_count)() }
    }

    /// Opens the device at a place of the library's list.
    pub fn open(&self, index: i32) -> Result<Id, Code> {
        let index = c_char::try_from(index).map_err(|_| Code(15))?;
        // SAFETY: the function has no precondition.
        let id = unsafe { (self.functions.open_id)(index) };
        if id < 0 {
            return Err(self.last_error());
        }
        c_char::try_from(id).map(Id).map_err(|_| Code(15))
    }

    /// Closes the device.
    pub fn close(&self, id: Id) {
        // SAFETY: the device is open; an error has no consequence at the end of its use.
        unsafe { (self.functions.close)(id.0) };
    }

    /// Newest error of the calling thread.
    pub fn last_error(&self) -> Code {
        // SAFETY: the function has no precondition.
        Code(unsafe { (self.functions.error_last)() })
    }

    /// The library's own text for an error.
    pub fn error_text(&self, code: Code) -> String {
        // SAFETY: the function has no precondition; its text is static.
        unsafe { text((self.functions.error_text)(code.0)) }
    }

    /// Name of the model.
    pub fn name(&self, id: Id) -> String {
        // SAFETY: the device is open; the text is copied at once.
        unsafe { text((self.functions.system_name)(id.0)) }
    }

    /// Number of the model.
    pub fn kind(&self, id: Id) -> i32 {
        // SAFETY: the device is open.
        unsafe { (self.functions.system_type)(id.0) }
    }

    /// Serial number.
    pub fn serial(&self, id: Id) -> Result<u16, Code> {
        let mut serial = 0;
        // SAFETY: the device is open, and the place holds the number.
        self.checked(unsafe { (self.functions.serial_number)(&mut serial, id.0) })?;
        Ok(serial)
    }

    /// Whether the device has a wrist, a wrist with motors, a gripper.
    pub fn parts(&self, id: Id) -> [bool; 3] {
        let Functions {
            has_wrist,
            has_active_wrist,
            has_gripper,
            ..
        } = self.functions;
        // SAFETY: the device is open.
        [has_wrist, has_active_wrist, has_gripper].map(|has| unsafe { has(id.0) } != 0)
    }

    /// Status of the device.
    pub fn status(&self, id: Id) -> Result<[i32; sys::STATUS], Code> {
        // Longer than the status, for versions with more values.
        let mut status = [0; 64];
        // SAFETY: the device is open, and the array is longer than the status.
        self.checked(unsafe { (self.functions.status)(status.as_mut_ptr(), id.0) })?;
        let mut first = [0; sys::STATUS];
        first.copy_from_slice(&status[..sys::STATUS]);
        Ok(first)
    }

    /// Measures position, and with `has_wrist` the rotation of the handle.
    pub fn measure(&self, id: Id, has_wrist: bool) -> Reading {
        let [mut x, mut y, mut z] = [f64::NAN; 3];
        let mut frame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let Functions {
            position,
            position_and_frame,
            ..
        } = self.functions;
        let result = if has_wrist {
            // SAFETY: the device is open, and the places hold the numbers.
            unsafe { position_and_frame(&mut x, &mut y, &mut z, &mut frame, id.0) }
        } else {
            // SAFETY: the device is open, and the places hold the numbers.
            unsafe { position(&mut x, &mut y, &mut z, id.0) }
        };
        match result {
            sys::TIMEGUARD => Reading::TooSoon,
            0.. => Reading::New(([x, y, z], frame)),
            _ => Reading::Failed(self.last_error()),
        }
    }

    /// Buttons that are held, one bit each.
    pub fn buttons(&self, id: Id) -> u16 {
        // SAFETY: the device is open.
        unsafe { (self.functions.button_mask)(id.0) as u16 }
    }

    /// Displays a force in newtons, and a torque in newton-metres on a device with such motors. Axes of the library.
    /// Returns whether the motors cannot follow.
    pub fn display(&self, id: Id, force: [f64; 3], torque: Option<[f64; 3]>) -> Result<bool, Code> {
        let [x, y, z] = force;
        let Functions {
            set_force,
            set_force_torque_grip,
            ..
        } = self.functions;
        let result = match torque {
            // SAFETY: the device is open.
            None => unsafe { set_force(x, y, z, id.0) },
            Some([tx, ty, tz]) => {
                // SAFETY: the device is open.
                unsafe { set_force_torque_grip(x, y, z, tx, ty, tz, 0.0, id.0) }
            }
        };
        self.checked(result)
            .map(|code| code == sys::MOTOR_SATURATED)
    }

    /// Turns the force on or off.
    pub fn enable_force(&self, id: Id, on: bool) -> Result<i32, Code> {
        // SAFETY: the device is open.
        self.checked(unsafe { (self.functions.enable_force)(u8::from(on), id.0) })
    }

    /// Turns the compensation of the handle's weight on.
    pub fn compensate_gravity(&self, id: Id) -> Result<i32, Code> {
        // SAFETY: the device is open.
        self.checked(unsafe { (self.functions.set_gravity_compensation)(1, id.0) })
    }

    /// Makes a button of the gripper.
    pub fn use_gripper_as_button(&self, id: Id) -> Result<i32, Code> {
        // SAFETY: the device is open.
        self.checked(unsafe { (self.functions.emulate_button)(1, id.0) })
    }

    /// Makes the controller take the force off by itself after `steps` times 125 microseconds without a command.
    pub fn watch(&self, id: Id, steps: u8) -> Result<i32, Code> {
        // SAFETY: the function has no precondition.
        self.checked(unsafe { (self.functions.enable_expert_mode)() })?;
        // SAFETY: the device is open.
        self.checked(unsafe { (self.functions.set_watchdog)(steps, id.0) })
    }

    /// Sets the shortest time between two measurements, microseconds.
    pub fn guard_time(&self, id: Id, us: i32) -> Result<i32, Code> {
        // SAFETY: the device is open.
        self.checked(unsafe { (self.functions.set_time_guard)(us, id.0) })
    }

    /// Whether the device is calibrated.
    pub fn is_calibrated(&self, id: Id) -> bool {
        // SAFETY: the device is open.
        unsafe { (self.functions.is_initialized)(id.0) != 0 }
    }

    /// Moves the device and calibrates it. The call waits for the end.
    pub fn calibrate(&self, id: Id) -> Result<i32, Code> {
        // SAFETY: the device is open.
        let result = self.checked(unsafe { (self.functions.auto_init)(id.0) });
        // SAFETY: the device is open. The force stays on, and an error means that no regulation runs.
        unsafe { (self.functions.regulation_stop)(1, id.0) };
        result
    }

    /// Takes the force off and turns the brakes on.
    pub fn stop(&self, id: Id) -> Result<i32, Code> {
        // SAFETY: the device is open.
        self.checked(unsafe { (self.functions.stop)(id.0) })
    }

    /// Positive results are no errors.
    fn checked(&self, result: i32) -> Result<i32, Code> {
        if result >= 0 {
            Ok(result)
        } else {
            Err(self.last_error())
        }
    }
}

/// Copies a text of the library.
///
/// # Safety
/// Null, or a text that ends with a zero.
unsafe fn text(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: the caller's promise.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_string_lossy().trim().to_owned()
}
