//! A small client of a stand-in library, in a process of its own, that a test may kill.
//!
//! Usage: `standin-client hd|dhd LIBRARY NEWTON SECONDS`.
//! The client opens the first device, sends a steady force and prints `running` after 20 commands.
//! It closes the device at the end of its time.
//! After a refused opening it prints `refused` with the vendor's code and ends.

#[cfg(target_os = "linux")]
mod dhd;
#[cfg(target_os = "linux")]
mod hd;

#[cfg(target_os = "linux")]
fn main() -> std::process::ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [family, library, newton, seconds] = arguments.as_slice() else {
        eprintln!("usage: standin-client hd|dhd LIBRARY NEWTON SECONDS");
        return std::process::ExitCode::from(2);
    };
    let (Ok(newton), Ok(seconds)) = (newton.parse(), seconds.parse()) else {
        eprintln!("standin-client: force and time are numbers");
        return std::process::ExitCode::from(2);
    };
    let run = if family == "hd" { hd::run } else { dhd::run };
    match run(library, newton, seconds) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("standin-client: {error}");
            std::process::ExitCode::FAILURE
        }
    }
}

#[cfg(not(target_os = "linux"))]
fn main() {}
