//! A session in the whole mouth with devices of two vendors, in a process of its own: a driver's library is loaded once in
//! a process.
//!
//! Usage: `mouth_session FOLDER SECONDS`. Messages to the test are lines of the output.

#[cfg(target_os = "linux")]
#[path = "../backend_client/allocations.rs"]
mod allocations;
#[cfg(target_os = "linux")]
mod messages;
#[cfg(target_os = "linux")]
mod place;
#[cfg(target_os = "linux")]
mod session;

fn main() {
    #[cfg(target_os = "linux")]
    {
        let arguments: Vec<String> = std::env::args().skip(1).collect();
        let [folder, seconds] = arguments.as_slice() else {
            panic!("usage: mouth_session FOLDER SECONDS");
        };
        session::run_in(folder.into(), seconds.parse().expect("a number of seconds"));
    }
}
