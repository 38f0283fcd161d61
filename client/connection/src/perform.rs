//! Sessions on links, from the start to the goodbye.

use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use anyhow::bail;
use sulcus_link::clock::sleep_until;
use sulcus_proto::control::Goodbye;

use crate::device::EventDevice;
use crate::device_loop::{self, DeviceLoop, Disturb, LoopReport};
use crate::link::{Link, LinkError, LinkStats, now_ns};
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

/// A started session of [`carry_all`].
struct Carried<D> {
    link: Link,
    device: D,
    device_loop: DeviceLoop,
}

/// Starts the sessions on all links and runs their devices on the calling thread, without a progress bar. The thread
/// gets a SCHED_FIFO priority. `done` receives the smallest number of periods completed so far. The results have the order of the links.
///
/// # Errors
/// The system has no thread for the end of a session, or that thread panics.
pub fn carry_all<D: EventDevice>(
    links: Vec<(Link, D)>,
    periods: u64,
    priority: i32,
    done: &AtomicU64,
) -> anyhow::Result<Vec<Performed>> {
    device_loop::punctual(priority);
    // One grid for all: the thread wakes once per period.
    let begin_ns = now_ns();
    let start = |(link, device): (Link, D)| {
        // A link that has ended holds its error, which the end of the run returns.
        link.start();
        let device_loop = DeviceLoop::new(&link, begin_ns, periods, None);
        Some(Carried {
            link,
            device,
            device_loop,
        })
    };
    let mut running: Vec<Option<Carried<D>>> = links.into_iter().map(start).collect();
    let mut ending: Vec<Option<JoinHandle<Performed>>> = running.iter().map(|_| None).collect();
    while let Some(next) = running
        .iter()
        .flatten()
        .map(|c| c.device_loop.next_ns())
        .min()
    {
        sleep_until(next);
        for (place, ending) in running.iter_mut().zip(&mut ending) {
            let Some(carried) = place else { continue };
            if carried.device_loop.goes_on(&carried.device) {
                let now = now_ns();
                if carried.device_loop.next_ns() <= now {
                    let (link, device) = (&mut carried.link, &mut carried.device);
                    carried.device_loop.pass(link, device, now);
                }
            } else if let Some(Carried {
                link, device_loop, ..
            }) = place.take()
            {
                // The goodbye takes as long as the server needs to sign a recording.
                let end = move || finish(link, device_loop.end());
                *ending = Some(
                    std::thread::Builder::new()
                        .name("sulcus-end".into())
                        .spawn(end)?,
                );
            }
        }
        let least = running
            .iter()
            .flatten()
            .map(|c| c.device_loop.periods_done())
            .min();
        done.store(least.unwrap_or(periods), Ordering::Relaxed);
    }
    let joined = ending.into_iter().flatten().map(JoinHandle::join);
    joined
        .map(|performed| {
            performed.map_err(|_| anyhow::anyhow!("the thread of a session's end panicked"))
        })
        .collect()
}

fn run(
    mut link: Link,
    device: &mut dyn EventDevice,
    periods: u64,
    disturb: Option<Disturb>,
    done: &AtomicU64,
) -> Performed {
    let report = device_loop::run(&mut link, device, periods, disturb, done);
    finish(link, report)
}

fn finish(link: Link, report: LoopReport) -> Performed {
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
