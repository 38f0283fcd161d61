//! One session on a link, from start to goodbye, with a device on a thread of its own.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use anyhow::bail;
use sulcus_proto::control::Goodbye;

use crate::device::CallingDevice;
use crate::device_loop::{self, Disturb, LoopReport};
use crate::link::{Link, LinkError, LinkStats};
use crate::progress::Steps;

/// What came of performing on a link.
pub struct Performed {
    /// The server's last word and summary, or why there is none.
    pub goodbye: Result<Goodbye, LinkError>,
    /// How packets fared.
    pub stats: LinkStats,
    /// How the device's loop went.
    pub report: LoopReport,
}

/// Performs on `link` with `device` on a thread of its own, showing progress, to the end, to an
/// interruption, or until the server ends it.
///
/// # Errors
/// When the session cannot begin.
pub fn perform(
    link: Link,
    mut device: impl CallingDevice,
    periods: u64,
    disturb: Option<Disturb>,
    steps: &Steps,
) -> anyhow::Result<Performed> {
    if !link.start() {
        bail!("the link ended before the session began");
    }
    let bar = steps.bar("performing");
    let done = AtomicU64::new(0);
    let performed = std::thread::scope(|scope| {
        let loop_thread = std::thread::Builder::new()
            .name("sulcus-device".into())
            .spawn_scoped(scope, || {
                let mut link = link;
                let report = device_loop::run(&mut link, &mut device, periods, disturb, &done);
                let stats = link.stats();
                // At once, from here: every millisecond more would be recorded with nobody there. A
                // silent server has no last word; one that closed the link has said it already.
                let goodbye = if report.server_silent && link.is_open() {
                    Err(LinkError::Lost("the server fell silent".into()))
                } else {
                    link.finish_with_text()
                };
                Performed {
                    goodbye,
                    stats,
                    report,
                }
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
