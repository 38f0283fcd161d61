//! The client of the Force Dimension stand-in.

use libloading::{Error, Library};
use std::ffi::c_char;
use std::time::{Duration, Instant};

/// Runs the client.
pub fn run(path: &str, force: f64, seconds: f64) -> Result<(), Error> {
    // SAFETY: the path names a stand-in, whose functions have these signatures; the library is never unloaded.
    unsafe {
        let library: &'static Library = Box::leak(Box::new(Library::new(path)?));
        let open = *library.get::<unsafe extern "system" fn(c_char) -> i32>("drdOpenID")?;
        let error = *library.get::<unsafe extern "system" fn() -> i32>("dhdErrorGetLast")?;
        let enable =
            *library.get::<unsafe extern "system" fn(u8, c_char) -> i32>("dhdEnableForce")?;
        let set = *library
            .get::<unsafe extern "system" fn(f64, f64, f64, c_char) -> i32>("dhdSetForce")?;
        let close = *library.get::<unsafe extern "system" fn(c_char) -> i32>("drdClose")?;
        let id = open(0) as c_char;
        if id as i8 == -1 {
            println!("refused {}", error());
            return Ok(());
        }
        enable(1, id);
        let start = Instant::now();
        let mut count = 0;
        while start.elapsed().as_secs_f64() < seconds {
            set(force, 0.0, 0.0, id);
            count += 1;
            if count == 20 {
                println!("running");
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        close(id);
    }
    Ok(())
}
