//! Controller of the stand-in devices: boxes, motors and hands, in a process of its own.
//!
//! Usage: `standin-controller BOARD LOG`. Requests come as lines of JSON on the standard input.
//! The program ends with its input.

#[cfg(target_os = "linux")]
mod clients;
#[cfg(target_os = "linux")]
mod device;
#[cfg(target_os = "linux")]
mod faults;
#[cfg(target_os = "linux")]
mod handle;
#[cfg(target_os = "linux")]
mod heat;
#[cfg(target_os = "linux")]
mod journal;
#[cfg(target_os = "linux")]
mod messages;
#[cfg(target_os = "linux")]
mod modes;
#[cfg(target_os = "linux")]
mod motion;
#[cfg(target_os = "linux")]
mod motors;
#[cfg(target_os = "linux")]
mod sensors;
#[cfg(target_os = "linux")]
mod server;
#[cfg(target_os = "linux")]
mod show;

#[cfg(target_os = "linux")]
fn main() -> std::process::ExitCode {
    let mut arguments = std::env::args_os().skip(1);
    let (Some(board), Some(log)) = (arguments.next(), arguments.next()) else {
        eprintln!("usage: standin-controller BOARD LOG");
        return std::process::ExitCode::from(2);
    };
    match server::run(board.as_ref(), log.as_ref()) {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("standin-controller: {error}");
            std::process::ExitCode::FAILURE
        }
    }
}

#[cfg(not(target_os = "linux"))]
fn main() {}
