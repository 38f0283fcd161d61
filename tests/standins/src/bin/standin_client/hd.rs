//! The client of the HDAPI stand-in.

use libloading::{Error, Library};
use std::ffi::{c_char, c_ulong, c_void};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

#[repr(C)]
struct ErrorInfo {
    code: u32,
    internal: i32,
    hhd: u32,
}

/// What the callback needs.
struct Servo {
    hhd: u32,
    force: f64,
    ticks: AtomicU64,
    begin: unsafe extern "system" fn(u32),
    end: unsafe extern "system" fn(u32),
    set: unsafe extern "system" fn(u32, *const f64),
}

unsafe extern "system" fn tick(user: *mut c_void) -> u32 {
    // SAFETY: `run` schedules this function with a `Servo` that lives as long as the process.
    let servo = unsafe { &*user.cast::<Servo>() };
    let force = [servo.force, 0.0, 0.0];
    // SAFETY: the functions come from the library with these signatures.
    unsafe {
        (servo.begin)(servo.hhd);
        (servo.set)(0x2700, force.as_ptr());
        (servo.end)(servo.hhd);
    }
    servo.ticks.fetch_add(1, Ordering::Relaxed);
    1
}

/// Runs the client.
pub fn run(path: &str, force: f64, seconds: f64) -> Result<(), Error> {
    // SAFETY: the path names a stand-in, whose functions have these signatures; the library is never unloaded.
    unsafe {
        let library: &'static Library = Box::leak(Box::new(Library::new(path)?));
        let init =
            *library.get::<unsafe extern "system" fn(*const c_char) -> u32>("hdInitDevice")?;
        let error = *library.get::<unsafe extern "system" fn() -> ErrorInfo>("hdGetError")?;
        let enable = *library.get::<unsafe extern "system" fn(u32)>("hdEnable")?;
        let start = *library.get::<unsafe extern "system" fn()>("hdStartScheduler")?;
        let stop = *library.get::<unsafe extern "system" fn()>("hdStopScheduler")?;
        let disable = *library.get::<unsafe extern "system" fn(u32)>("hdDisableDevice")?;
        type Schedule = unsafe extern "system" fn(
            unsafe extern "system" fn(*mut c_void) -> u32,
            *mut c_void,
            u16,
        ) -> c_ulong;
        let schedule = *library.get::<Schedule>("hdScheduleAsynchronous")?;
        let hhd = init(std::ptr::null());
        if hhd == u32::MAX {
            let info = error();
            println!("refused {} {} {}", info.code, info.internal, info.hhd);
            return Ok(());
        }
        let servo: &'static Servo = Box::leak(Box::new(Servo {
            hhd,
            force,
            ticks: AtomicU64::new(0),
            begin: *library.get("hdBeginFrame")?,
            end: *library.get("hdEndFrame")?,
            set: *library.get("hdSetDoublev")?,
        }));
        enable(0x4000);
        schedule(tick, std::ptr::from_ref(servo).cast_mut().cast(), 65535);
        start();
        while servo.ticks.load(Ordering::Relaxed) < 20 {
            std::thread::sleep(Duration::from_millis(1));
        }
        println!("running");
        std::thread::sleep(Duration::from_secs_f64(seconds));
        stop();
        disable(hhd);
    }
    Ok(())
}
