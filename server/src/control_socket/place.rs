//! Place of the socket: one server for a state folder.

use std::fs::File;
use std::os::fd::AsRawFd as _;
use std::os::unix::fs::PermissionsExt as _;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;

use crate::state::{Lock, StateError, StateFolder, remove_private};

/// Name of the socket in the state folder.
const SOCKET: &str = "control.sock";

/// State folder that belongs to this process until the drop, with its socket.
#[derive(Debug)]
pub struct Claimed {
    /// Socket that accepts connections.
    pub listener: UnixListener,
    path: PathBuf,
    _lock: Lock,
}

/// Claims a state folder for a server and binds its socket. The rest of a server that crashed is removed.
///
/// # Errors
/// Another server has the folder, or the socket cannot be bound.
pub fn claim(folder: &StateFolder) -> Result<Claimed, StateError> {
    let advice = "a server runs with this state folder; stop it, or give each server its own folder with --state";
    let lock = Lock::attempt(&folder.file("server.lock"), advice)?;
    let path = folder.file(SOCKET);
    // Only the holder of the lock removes the socket, so it is never that of a running server.
    remove_private(&path)?;
    let failed = StateError::io("bind the control socket", &path);
    let (_folder, short) = reachable(folder)?;
    let listener = UnixListener::bind(&short).map_err(&failed)?;
    // The folder is closed to others, so nobody connects before this line.
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600)).map_err(&failed)?;
    Ok(Claimed {
        listener,
        path,
        _lock: lock,
    })
}

impl Drop for Claimed {
    fn drop(&mut self) {
        // A socket that stays is removed by the next claim.
        let _ = remove_private(&self.path);
    }
}

/// Connects to the server of a state folder; `None` if none runs.
///
/// # Errors
/// The socket exists and cannot be used, for example by another user.
pub(super) fn connect(folder: &StateFolder) -> Result<Option<UnixStream>, StateError> {
    use std::io::ErrorKind::{ConnectionRefused, NotFound};
    let (_folder, short) = reachable(folder)?;
    match UnixStream::connect(short) {
        Ok(stream) => Ok(Some(stream)),
        Err(error) if matches!(error.kind(), NotFound | ConnectionRefused) => Ok(None),
        Err(error) => Err(StateError::io("connect to", &folder.file(SOCKET))(error)),
    }
}

/// Path of the socket by the open folder, which is valid while the file is open. A socket's path has at most 107 bytes,
/// fewer than many state folders.
fn reachable(folder: &StateFolder) -> Result<(File, PathBuf), StateError> {
    let open = File::open(folder.path()).map_err(StateError::io("open", folder.path()))?;
    let path = format!("/proc/self/fd/{}/{SOCKET}", open.as_raw_fd());
    Ok((open, path.into()))
}
