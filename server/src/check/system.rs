//! Port and rights of the system.

use std::io::ErrorKind;
use std::net::UdpSocket;

use sulcus_link::schedule::{fifo, raise};

use super::Finding;
use crate::net::addresses::resolve;
use crate::session::realtime::PRIORITY;

/// Whether the address can be used and its port is free.
pub(super) fn port(listen: &str) -> Finding {
    let addresses = match resolve(listen) {
        Ok(addresses) => addresses,
        Err(error) => {
            let text = sulcus_sessions::sentence(&error);
            return Finding::problem("port", text, "Correct the address of --listen.");
        }
    };
    let mut refused = Vec::new();
    for address in addresses {
        match UdpSocket::bind(address) {
            Ok(_) => return Finding::ok("port", format!("UDP {address} is free.")),
            Err(error) if error.kind() == ErrorKind::AddrInUse => {
                return Finding::problem(
                    "port",
                    format!("Another program uses UDP {address}."),
                    "Stop that program, or choose another port with --listen.",
                );
            }
            Err(error) => refused.push(format!("{address}: {error}")),
        }
    }
    Finding::problem(
        "port",
        format!("The system refuses {}.", refused.join("; ")),
        "Choose an address of this machine and a permitted port with --listen.",
    )
}

/// Whether a thread of this process may have real-time scheduling.
pub(super) fn real_time() -> Finding {
    let asked = std::thread::Builder::new().spawn(|| fifo(PRIORITY));
    let result = asked.map(|thread| {
        let panicked = |_| Err(std::io::Error::other("the thread panicked"));
        thread.join().unwrap_or_else(panicked)
    });
    match result.and_then(|result| result) {
        Ok(()) => Finding::ok("real time", "Simulation threads may use SCHED_FIFO."),
        Err(error) => Finding::warning(
            "real time",
            format!("No real-time scheduling ({error}): more ticks are missed under load."),
            format!(
                "Grant CAP_SYS_NICE, or set `ulimit -r {PRIORITY}` (systemd: LimitRTPRIO={PRIORITY})."
            ),
        ),
    }
}

/// Whether this process may lock its memory.
pub(super) fn locked_memory() -> Finding {
    use rustix::mm::{MlockAllFlags, mlockall, munlockall};
    raise();
    match mlockall(MlockAllFlags::CURRENT) {
        Ok(()) => {
            // A failure leaves memory locked until the end of this short process.
            let _ = munlockall();
            Finding::ok("memory", "Memory can be locked.")
        }
        Err(error) => Finding::warning(
            "memory",
            format!("Memory cannot be locked ({error}): paging may delay ticks."),
            "Grant CAP_IPC_LOCK, or set `ulimit -l unlimited` (systemd: LimitMEMLOCK=infinity).",
        ),
    }
}
