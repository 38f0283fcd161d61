//! A function that the vendor's library does not have: it makes the library fresh between tests of one process.

use crate::state::{OPEN, connect, reconnect};
use crate::{errors, expert, open};
use std::ffi::{CStr, OsStr, c_char};
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::sync::atomic::Ordering;

/// Closes every device and connects to the board at `path`.
/// A null path keeps the link, or opens it by the environment. Returns 1 when the library has a link.
///
/// # Safety
/// `path` is null or a text with a zero at its end.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn standin_reset(path: *const c_char) -> u8 {
    for device in &OPEN {
        if device.is_open.load(Ordering::Acquire) {
            open::close(device);
        }
    }
    expert::reset();
    errors::forget();
    let link = if path.is_null() {
        connect()
    } else {
        // SAFETY: the caller's promise.
        let path = unsafe { CStr::from_ptr(path) };
        reconnect(Path::new(OsStr::from_bytes(path.to_bytes())))
    };
    link.is_some().into()
}
