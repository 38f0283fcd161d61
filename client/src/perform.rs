//! One session on a link, from start to goodbye, with a device on a thread of its own.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use anyhow::bail;
use sulcus_proto::SessionSummary;

use crate::device::Device;
use crate::device_loop::{self, Disturb, LoopReport};
use crate::link::{Link, LinkStats};
use crate::progress::Steps;

/// What came of performing on a link.
pub struct Performed {
    /// The server's summary; `None` when it fell silent.
    pub summary: Option<SessionSummary>,
    /// How packets fared.
    pub stats: LinkStats,
    /// How the device's loop went.
    pub report: LoopReport,
}

/// Performs on `link` with `device` on a thread of its own, showing progress.
///
/// # Errors
/// When the session cannot begin, or its end is not confirmed.
pub fn perform(
    link: Link,
    mut device: impl Device,
    periods: u64,
    disturb: Option<Disturb>,
    steps: &Steps,
) -> anyhow::Result<Performed> {
    if !link.start() {
        bail!("the link ended before the session began");
    }
    let bar = steps.bar("performing");
    let done = AtomicU64::new(0);
    let (link, report) = std::thread::scope(|scope| {
        let loop_thread = std::thread::Builder::new()
            .name("sulcus-device".into())
            .spawn_scoped(scope, || {
                let mut link = link;
                let report = device_loop::run(&mut link, &mut device, periods, disturb, &done);
                (link, report)
            })?;
        while !loop_thread.is_finished() {
            bar.set(
                "performing",
                done.load(Ordering::Relaxed) as f64 / periods as f64,
            );
            std::thread::sleep(Duration::from_millis(50));
        }
        loop_thread
            .join()
            .map_err(|_| std::io::Error::other("the device's thread panicked"))
    })?;
    bar.done();
    let stats = link.stats();
    let summary = if report.server_lost {
        None
    } else {
        Some(link.finish()?)
    };
    Ok(Performed {
        summary,
        stats,
        report,
    })
}
