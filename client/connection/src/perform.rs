//! A session on a link, from the start to the goodbye, with the device's loop on a thread of its own.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use anyhow::bail;
use sulcus_proto::control::Goodbye;

use crate::device::EventDevice;
use crate::device_loop::{self, Disturb, LoopReport};
use crate::link::{Link, LinkError, LinkStats};
use crate::progress::Steps;

/// Result of a session on a link.
pub struct Performed {
    /// Goodbye of the server, or the error that took its place.
    pub goodbye: Result<Goodbye, LinkError>,
    /// Counters and times of packets at the end of the device's loop.
    pub stats: LinkStats,
    /// Report of the device's loop.
    pub report: LoopReport,
}

/// Starts the session on `link` and runs `device` on a thread of its own, with a progress bar.
///
/// The session ends after `periods` periods of the server's tick, at the device's end, at an interrupt, or when the
/// server ends it. The function then waits for the goodbye, unless the server is silent.
///
/// # Errors
/// The start cannot be sent, or the thread of the device cannot start or panics.
pub fn perform(
    link: Link,
    mut device: impl EventDevice,
    periods: u64,
    disturb: Option<Disturb>,
    steps: &Steps,
) -> anyhow::Result<Performed> {
    if !link.start() {
        bail!("the link to the server ended before the session began");
    }
    let bar = steps.bar("performing");
    let done = AtomicU64::new(0);
    let performed = std::thread::scope(|scope| {
        let loop_thread = std::thread::Builder::new()
            .name("sulcus-device".into())
            .spawn_scoped(scope, || run(link, &mut device, periods, disturb, &done))?;
        while !loop_thread.is_finished() {
            let share = done.load(Ordering::Relaxed) as f64 / periods as f64;
            bar.set("performing", share);
            std::thread::sleep(Duration::from_millis(50));
        }
        loop_thread
            .join()
            .map_err(|_| std::io::Error::other("the device's thread panicked"))
    })?;
    bar.done();
    Ok(performed)
}

/// Starts the session on `link` and runs `device` on the calling thread, without a progress bar. `done` receives the
/// number of periods completed so far.
pub fn carry(
    link: Link,
    device: &mut dyn EventDevice,
    periods: u64,
    disturb: Option<Disturb>,
    done: &AtomicU64,
) -> Performed {
    // A link that has ended holds its error, which the end of the run returns.
    link.start();
    run(link, device, periods, disturb, done)
}

fn run(
    mut link: Link,
    device: &mut dyn EventDevice,
    periods: u64,
    disturb: Option<Disturb>,
    done: &AtomicU64,
) -> Performed {
    let report = device_loop::run(&mut link, device, periods, disturb, done);
    let stats = link.stats();
    // The stop is sent here and at once, because the server records until it arrives. A silent server sends no goodbye.
    // After a close by the server, the link already holds the goodbye.
    let goodbye = if report.server_silent && link.is_open() {
        Err(LinkError::Lost("no wrench for ten seconds".into()))
    } else {
        link.finish_with_text()
    };
    Performed {
        goodbye,
        stats,
        report,
    }
}
