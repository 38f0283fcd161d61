//! Signals that end a server: Ctrl-C, SIGTERM, a hang-up of the terminal.

use std::time::Duration;

use tokio::signal::unix::{Signal, SignalKind, signal};

use crate::ServerHandle;

/// Whether the process ignores hang-ups, as under `nohup`.
fn ignores_hang_ups() -> bool {
    // SAFETY: zeros are a valid `sigaction`; without a new action the call only reads the present one.
    let (result, present) = unsafe {
        let mut present: libc::sigaction = std::mem::zeroed();
        let result = libc::sigaction(libc::SIGHUP, std::ptr::null(), &mut present);
        (result, present)
    };
    result == 0 && present.sa_sigaction == libc::SIG_IGN
}

/// Returns at a hang-up of the terminal; never returns while hang-ups are ignored.
async fn hung_up(signal: &mut Option<Signal>) {
    match signal {
        Some(signal) => {
            signal.recv().await;
        }
        None => std::future::pending().await,
    }
}

/// Returns on Ctrl-C, on SIGTERM, on SIGHUP unless it is ignored, or within 500 ms after the server has ended by
/// itself. Calls `look` every 500 ms until then.
pub(super) fn wait_for_signal(server: &ServerHandle, mut look: impl FnMut()) -> anyhow::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()?;
    runtime.block_on(async {
        let mut terminate = signal(SignalKind::terminate())?;
        let mut interrupt = signal(SignalKind::interrupt())?;
        let mut hang_up = if ignores_hang_ups() {
            None
        } else {
            Some(signal(SignalKind::hangup())?)
        };
        loop {
            tokio::select! {
                _ = interrupt.recv() => return Ok(()),
                _ = terminate.recv() => return Ok(()),
                () = hung_up(&mut hang_up) => return Ok(()),
                () = tokio::time::sleep(Duration::from_millis(500)) => {
                    if server.is_finished() {
                        return Ok(());
                    }
                    look();
                }
            }
        }
    })
}
