//! Client of a session with a back-end, in a process of its own: a driver's library is loaded once in a process. It
//! obeys the commands of its input and answers on its output.

#[cfg(target_os = "linux")]
mod allocations;
#[cfg(target_os = "linux")]
mod client;
#[cfg(target_os = "linux")]
mod commands;

fn main() {
    #[cfg(target_os = "linux")]
    client::run();
}
