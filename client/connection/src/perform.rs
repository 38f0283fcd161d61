//! Sessions on links, from the start to the goodbye.

use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use anyhow::bail;
use sulcus_link::clock::sleep_until;
use sulcus_proto::control::Goodbye;

use crate::at_hand::HandTicker;
use crate::device::EventDevice;
use crate::device_loop::{self, DeviceLoop, Disturb};
use crate::link::{Link, LinkError, LinkStats, now_ns};
use crate::progress::Steps;
use crate::report::LoopReport;

/// Result of a session on a link.
pub struct Performed {
    /// Goodbye of the server, or the error that took its place.
    pub goodbye: Result<Goodbye, LinkError>,
    /// Counters and times of packets at the end of the device's loop.
    pub stats: LinkStats,
    /// Report of the device's loop.
    pub report: LoopReport,
    /// Ticks at the hand; `None`: the server ticked.
    pub hand: Option<HandTicker>,
}

/// Starts the session on `link` and runs `device` on a thread of its own, with a progress bar. `hand` computes the
/// ticks if they run at the hand: [`HandTicker::on`].
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
    hand: Option<HandTicker>,
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
            .spawn_scoped(scope, || {
                run(link, &mut device, (periods, disturb), hand, &done)
            })?;
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

/// A session for [`carry_all`]: link, device, and number of periods.
pub struct Part<D> {
    /// Link whose session was started by [`Link::start`].
    pub link: Link,
    /// Device.
    pub device: D,
    /// Number of periods of the server's tick.
    pub periods: u64,
}

/// Runs the devices of started sessions on the calling thread, without a progress bar. The thread gets a SCHED_FIFO
/// priority. `done` receives the progress of the slowest session, per mille. The results have the order of the parts.
///
/// # Errors
/// The system has no thread for the end of a session, or that thread panics.
pub fn carry_all<D: EventDevice>(
    parts: Vec<Part<D>>,
    priority: i32,
    done: &AtomicU64,
) -> anyhow::Result<Vec<Performed>> {
    device_loop::punctual(priority);
    // One grid for all: the thread wakes once per period.
    let begin_ns = now_ns();
    let carried = |part: Part<D>| {
        let device_loop = DeviceLoop::new(&part.link, begin_ns, part.periods, None);
        Some((part, device_loop))
    };
    let mut running: Vec<Option<(Part<D>, DeviceLoop)>> = parts.into_iter().map(carried).collect();
    let mut ending: Vec<Option<JoinHandle<Performed>>> = running.iter().map(|_| None).collect();
    let next_of = |(_, device_loop): &(Part<D>, DeviceLoop)| device_loop.next_ns();
    while let Some(next) = running.iter().flatten().map(next_of).min() {
        sleep_until(next);
        let mut slowest = 1000;
        for (place, ending) in running.iter_mut().zip(&mut ending) {
            let Some((part, device_loop)) = place else {
                continue;
            };
            slowest = slowest.min(device_loop.periods_done() * 1000 / part.periods.max(1));
            if device_loop.goes_on(&part.device) {
                let now = now_ns();
                if device_loop.next_ns() <= now {
                    device_loop.pass(&mut part.link, &mut part.device, now);
                }
            } else if let Some((mut part, device_loop)) = place.take() {
                // On this thread: a thread without real-time priority could keep the lock from the network's.
                let stats = part.link.stats();
                let ran = device_loop.end(&mut part.link, &mut part.device);
                // The goodbye takes as long as the server needs to sign a recording.
                let end = move || finish(part.link, stats, ran);
                let thread = std::thread::Builder::new().name("sulcus-end".into());
                *ending = Some(thread.spawn(end)?);
            }
        }
        done.store(slowest, Ordering::Relaxed);
    }
    let joined = ending.into_iter().flatten().map(JoinHandle::join);
    joined
        .map(|ended| ended.map_err(|_| anyhow::anyhow!("the thread of a session's end panicked")))
        .collect()
}

fn run(
    mut link: Link,
    device: &mut dyn EventDevice,
    (periods, disturb): (u64, Option<Disturb>),
    hand: Option<HandTicker>,
    done: &AtomicU64,
) -> Performed {
    let ran = device_loop::run_with_ticks(&mut link, device, (periods, disturb), hand, done);
    let stats = link.stats();
    finish(link, stats, ran)
}

fn finish(
    link: Link,
    stats: LinkStats,
    (report, hand): (LoopReport, Option<HandTicker>),
) -> Performed {
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
        hand,
    }
}
