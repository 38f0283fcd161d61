//! Loss of the display's server, after which Xlib would end the process.
//!
//! Xlib calls a handler when its connection breaks, and ends the process when the handler returns. The handler of this
//! module does not return: the thread of the call waits, and all other threads go on.

use std::ffi::c_int;
use std::sync::{Mutex, PoisonError};

use x11_dl::xlib::{Display, Xlib};

/// Last act after the loss.
type Last = Box<dyn FnOnce() + Send>;

static LAST: Mutex<Option<Last>> = Mutex::new(None);

/// Sets the act after a loss of the display's server. The act runs once, on the thread that met the loss. The act may
/// end the process; otherwise the thread stays where it is for ever. Without libX11 nothing is done.
pub(crate) fn on_loss(last: Last) {
    let Ok(xlib) = Xlib::open() else { return };
    *LAST.lock().unwrap_or_else(PoisonError::into_inner) = Some(last);
    // SAFETY: the handler has the signature that Xlib expects, and lives as long as the process.
    unsafe { (xlib.XSetIOErrorHandler)(Some(lost)) };
}

/// Handler of Xlib. A return would end the process.
unsafe extern "C" fn lost(_: *mut Display) -> c_int {
    let last = LAST.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(last) = last {
        last();
    }
    loop {
        std::thread::park();
    }
}
