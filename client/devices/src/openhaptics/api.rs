//! Safe calls of the library. Those that concern one device are in [`super::frame`].

use std::ffi::{CStr, CString, c_ulong, c_void};

use super::frame::{Current, Frame};
use super::sys::{self, Callback, ErrorInfo, Functions};
use crate::library::{self, LoadError, Opened};

/// Largest number of errors that one call takes from the stack.
const MOST_ERRORS: usize = 64;

/// The library.
#[derive(Clone, Copy, Debug)]
pub struct Hd {
    functions: Functions,
    library: &'static Opened,
}

/// Device that the library has opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Handle(pub u32);

impl Hd {
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

    /// Opens the device of the configuration `name`; `None` for the default device.
    pub fn init(&self, name: Option<&str>) -> Result<Handle, ErrorInfo> {
        use_decimal_points();
        self.drain(|_| ());
        let name = name.map(|name| CString::new(name).unwrap_or_default());
        let text = name.as_ref().map_or(std::ptr::null(), |name| name.as_ptr());
        // SAFETY: null, or a text that ends with a zero and outlives the call.
        let handle = unsafe { (self.functions.init_device)(text) };
        let mut first = None;
        self.drain(|error| first = Some(error).filter(|_| !error.is_mild()).or(first));
        match first {
            None if handle != sys::INVALID_HANDLE => Ok(Handle(handle)),
            Some(error) => Err(error),
            None => Err(ErrorInfo {
                code: 0x300,
                internal: 0,
                hhd: handle,
            }),
        }
    }

    /// Closes the device. Some drivers end the process in this call.
    pub fn close(&self, handle: Handle) {
        // SAFETY: the handle came from the library.
        unsafe { (self.functions.disable_device)(handle.0) };
        self.drain(|_| ());
    }

    /// Makes the device current, outside of a frame.
    pub fn current(&self, handle: Handle) -> Current<'_> {
        // SAFETY: the handle came from the library.
        unsafe { (self.functions.make_current_device)(handle.0) };
        Current::new(&self.functions)
    }

    /// Begins a frame of the device, which makes the device current.
    pub fn frame(&self, handle: Handle) -> Frame<'_> {
        Frame::begin(&self.functions, handle)
    }

    /// Takes all errors from the stack, the newest first.
    pub fn drain(&self, mut each: impl FnMut(ErrorInfo)) {
        for _ in 0..MOST_ERRORS {
            // SAFETY: the function has no precondition.
            let error = unsafe { (self.functions.get_error)() };
            if error.code == 0 {
                return;
            }
            each(error);
        }
    }

    /// The library's own text for an error code.
    pub fn error_text(&self, code: u32) -> String {
        // SAFETY: the function has no precondition; its text is static.
        unsafe { text((self.functions.get_error_string)(code)) }
    }

    /// Version of the library; empty if the library tells none before a device is open.
    pub fn version(&self) -> String {
        // SAFETY: the function has no precondition; its text is copied at once.
        let version = unsafe { text((self.functions.get_string)(sys::VERSION)) };
        self.drain(|_| ());
        version
    }

    /// Calls `callback` with `user` once per tick from now on, until the callback returns [`sys::DONE`].
    ///
    /// # Safety
    /// `user` is what `callback` expects, until the callback has ended or [`Hd::unschedule`] has returned.
    pub unsafe fn schedule(
        &self,
        callback: Callback,
        user: *mut c_void,
    ) -> Result<c_ulong, ErrorInfo> {
        self.drain(|_| ());
        // SAFETY: the caller's promise.
        let handle =
            unsafe { (self.functions.schedule_asynchronous)(callback, user, sys::PRIORITY) };
        let mut first = None;
        self.drain(|error| first = Some(error));
        first.map_or(Ok(handle), Err)
    }

    /// Calls `callback` once on the scheduler's thread, and waits for its end. The scheduler must run.
    ///
    /// # Safety
    /// `user` is what `callback` expects.
    pub unsafe fn call_on_scheduler(&self, callback: Callback, user: *mut c_void) {
        // SAFETY: the caller's promise.
        unsafe { (self.functions.schedule_synchronous)(callback, user, sys::PRIORITY) };
    }

    /// Starts the scheduler at 1000 Hz. The result tells whether the library accepts this rate.
    pub fn start_scheduler(&self) -> Result<bool, ErrorInfo> {
        self.drain(|_| ());
        // SAFETY: the function has no precondition.
        unsafe { (self.functions.set_scheduler_rate)(sys::RATE_HZ) };
        let mut is_refused = false;
        self.drain(|_| is_refused = true);
        // SAFETY: the function has no precondition.
        unsafe { (self.functions.start_scheduler)() };
        let mut first = None;
        self.drain(|error| first = Some(error).filter(|_| !error.is_mild()).or(first));
        first.map_or(Ok(!is_refused), Err)
    }

    /// Stops the scheduler.
    pub fn stop_scheduler(&self) {
        // SAFETY: the function has no precondition.
        unsafe { (self.functions.stop_scheduler)() };
        self.drain(|_| ());
    }

    /// Removes a callback.
    pub fn unschedule(&self, handle: c_ulong) {
        // SAFETY: the handle came from the library.
        unsafe { (self.functions.unschedule)(handle) };
        self.drain(|_| ());
    }

    /// Whether a callback is alive.
    pub fn is_scheduled(&self, handle: c_ulong) -> bool {
        // SAFETY: the handle came from the library; code 0 does not wait.
        unsafe { (self.functions.wait_for_completion)(handle, 0) != 0 }
    }
}

/// Copies a text of the library.
///
/// # Safety
/// Null, or a text that ends with a zero.
pub(super) unsafe fn text(text: *const std::ffi::c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: the caller's promise.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_string_lossy().trim().to_owned()
}

/// Makes numbers in configuration files readable for the library: a comma as decimal sign breaks their parsing.
fn use_decimal_points() {
    // SAFETY: the text ends with a zero. Rust's own formatting of numbers does not use the locale.
    unsafe { libc::setlocale(libc::LC_NUMERIC, c"C".as_ptr()) };
}
