//! Files of a rig, and the places of the stand-ins' programs and libraries.

use std::io::{Error, Result};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Free memory in bytes that a board in memory needs; several rigs may start at once.
const ROOM: u64 = 32 << 20;

/// Files of a running controller. The directory of the board is in memory where the system has one.
pub struct Files {
    board: TempDir,
    log: TempDir,
}

impl Files {
    /// Makes the directories.
    pub fn new() -> Result<Self> {
        let named = || {
            let mut builder = tempfile::Builder::new();
            builder.prefix("sulcus-standin-");
            builder
        };
        let shm = Path::new("/dev/shm");
        let room = rustix::fs::statvfs(shm).map_or(0, |fs| fs.f_bavail * fs.f_frsize);
        let in_memory = if room > ROOM {
            named().tempdir_in(shm).ok()
        } else {
            None
        };
        let board = in_memory.map_or_else(|| named().tempdir(), Ok)?;
        Ok(Self {
            board,
            log: named().tempdir()?,
        })
    }

    /// Path of the board.
    pub fn board(&self) -> PathBuf {
        self.board.path().join("board")
    }

    /// Path of the log.
    pub fn log(&self) -> PathBuf {
        self.log.path().join("log.jsonl")
    }
}

/// Directory of the build: the parent of `deps` for a test, or of `examples`, or of the program itself.
fn build() -> Result<PathBuf> {
    let program = std::env::current_exe()?;
    let directory = program
        .parent()
        .ok_or_else(|| Error::other("the program has no directory"))?;
    let inner = directory.ends_with("deps") || directory.ends_with("examples");
    let directory = if inner {
        directory.parent().unwrap_or(directory)
    } else {
        directory
    };
    Ok(directory.to_path_buf())
}

/// Path of a program of the stand-ins beside the running test.
pub(super) fn program(name: &str) -> Result<PathBuf> {
    existing(build()?.join(name))
}

/// Path of a stand-in library beside the running test:
/// `standin_hd`, `standin_hd_missing`, `standin_dhd` or `standin_empty`.
pub fn library(name: &str) -> Result<PathBuf> {
    existing(build()?.join("examples").join(format!("lib{name}.so")))
}

/// Path of a program of a session beside the running test: `backend_client` or `mouth_session`.
pub fn example(name: &str) -> Result<PathBuf> {
    existing(build()?.join("examples").join(name))
}

fn existing(path: PathBuf) -> Result<PathBuf> {
    if path.exists() {
        return Ok(path);
    }
    Err(Error::other(format!(
        "{} does not exist; `cargo build -p sulcus-standins --bins --examples` makes it",
        path.display()
    )))
}
