//! The station's machine of a session: plan, key, clock.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use sulcus_core::Scene;
use sulcus_link::clock::{Clock, SetClock};
use sulcus_server::SessionPlan;
use sulcus_server::stepped::SteppedSession;

/// Content of the key file: its title, and a seed that is the same in every run.
const KEY: &str =
    "sulcus station key 1\n0707070707070707070707070707070707070707070707070707070707070707\n";

/// Session of a scene at the present time of `clock`, whose recording is a new file in `folder`.
///
/// # Errors
/// The scene has no bytes, or a file cannot be written: one sentence.
pub fn begin(
    scene: &Scene,
    folder: &Path,
    epoch: u32,
    clock: Arc<SetClock>,
) -> Result<SteppedSession, String> {
    let bytes = scene.to_bytes().map_err(|error| error.to_string())?;
    let plan = SessionPlan::new(Arc::new(scene.clone()), Arc::new(bytes));
    let key = key(folder).map_err(|error| error.to_string())?;
    SteppedSession::begin(plan, folder, &key, epoch, Clock::Set(clock))
}

/// Writes the key file, which its owner alone may read.
fn key(folder: &Path) -> std::io::Result<PathBuf> {
    let path = folder.join("station.key");
    let mut options = std::fs::OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt as _;
        options.mode(0o600);
    }
    options.open(&path)?.write_all(KEY.as_bytes())?;
    Ok(path)
}
