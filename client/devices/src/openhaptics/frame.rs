//! Calls that concern one device.
//!
//! Enable, parameters and calibration concern the current device of the library. [`Frame`] and [`Current`] make the
//! device of a handle current; no other code makes these calls.

use std::marker::PhantomData;

use super::api::{Handle, text};
use super::sys::{self, Functions};

/// Calls that concern one device, outside of a frame.
pub struct Current<'a> {
    functions: &'a Functions,
}

/// Open frame of one device. The frame ends with the value.
pub struct Frame<'a> {
    current: Current<'a>,
    handle: Handle,
    /// A frame stays on its thread.
    thread: PhantomData<*const ()>,
}

impl<'a> Current<'a> {
    /// Calls for the device that was made current just now.
    pub fn new(functions: &'a Functions) -> Self {
        Self { functions }
    }

    /// Turns a capability on.
    pub fn enable(&self, capability: u32) {
        // SAFETY: the function has no precondition.
        unsafe { (self.functions.enable)(capability) };
    }

    /// Turns a capability off.
    pub fn disable(&self, capability: u32) {
        // SAFETY: the function has no precondition.
        unsafe { (self.functions.disable)(capability) };
    }

    /// Integer of a parameter; 0 if the library writes none.
    pub fn integer(&self, parameter: u32) -> i32 {
        // Longer than every parameter of this type.
        let mut values = [0; 16];
        // SAFETY: the array is longer than the values of the parameter.
        unsafe { (self.functions.get_integer)(parameter, values.as_mut_ptr()) };
        values[0]
    }

    /// Doubles of a parameter; NaN for those that the library does not write.
    pub fn doubles(&self, parameter: u32) -> [f64; 16] {
        let mut values = [f64::NAN; 16];
        // SAFETY: no parameter has more than sixteen values.
        unsafe { (self.functions.get_double)(parameter, values.as_mut_ptr()) };
        values
    }

    /// Text of a parameter; empty if the library has none.
    pub fn string(&self, parameter: u32) -> String {
        // SAFETY: the function has no precondition; its text is copied at once.
        unsafe { text((self.functions.get_string)(parameter)) }
    }

    /// State of the calibration.
    pub fn calibration(&self) -> u32 {
        // SAFETY: the function has no precondition.
        unsafe { (self.functions.check_calibration)() }
    }

    /// Advances the calibration by one step.
    pub fn update_calibration(&self, style: u32) {
        // SAFETY: the function has no precondition.
        unsafe { (self.functions.update_calibration)(style) };
    }
}

impl<'a> Frame<'a> {
    /// Begins a frame of the device, which makes the device current.
    pub fn begin(functions: &'a Functions, handle: Handle) -> Self {
        // SAFETY: the handle came from the library.
        unsafe { (functions.begin_frame)(handle.0) };
        Self {
            current: Current::new(functions),
            handle,
            thread: PhantomData,
        }
    }

    /// Calls that concern the device of the frame.
    pub fn device(&self) -> &Current<'a> {
        &self.current
    }

    /// Sets the force of the frame, newtons.
    pub fn set_force(&self, force: [f64; 3]) {
        // SAFETY: the parameter has three values.
        unsafe { (self.current.functions.set_double)(sys::CURRENT_FORCE, force.as_ptr()) };
    }

    /// Sets the torque of the frame, newton-metres.
    pub fn set_torque(&self, torque: [f64; 3]) {
        let torque_mnm = torque.map(|t| t * 1e3);
        // SAFETY: the parameter has three values.
        unsafe { (self.current.functions.set_double)(sys::CURRENT_TORQUE, torque_mnm.as_ptr()) };
    }
}

impl Drop for Frame<'_> {
    fn drop(&mut self) {
        // SAFETY: the frame of this device is open.
        unsafe { (self.current.functions.end_frame)(self.handle.0) };
    }
}
