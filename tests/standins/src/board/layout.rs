//! Layout of the board's file, its creation by the controller and its opening by a library.

use super::{Ring, Shared, State, Text, Traits};
use rustix::mm::{MapFlags, ProtFlags, mmap};
use std::fs::File;
use std::path::Path;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

/// Most device boxes of a controller.
pub const DEVICES: usize = 4;

/// Most rings: loaded libraries at the same time.
pub const RINGS: usize = 6;

const MAGIC: u64 = u64::from_be_bytes(*b"SULCSTD1");

/// Settings of the driver libraries that the controller changes at any time.
#[repr(C)]
pub struct Driver {
    /// Scheduler rates that `hdSetSchedulerRate` accepts, in Hz; 0 for no rate.
    pub rates: [AtomicU32; 4],
    /// Real rate of the scheduler in Hz; 0 for the rate that the client set.
    pub real_rate: AtomicU32,
    /// Largest random delay of a tick in us.
    pub jitter: AtomicU32,
    /// Length of the next stall in ms.
    pub stall: AtomicU32,
    /// Number of stalls asked for so far.
    pub stalls: AtomicU32,
    /// 1: `hdDisableDevice` ends in a memory fault.
    pub crash_on_disable: AtomicU32,
    /// 1: the scheduler's thread asks for the real-time class.
    pub realtime: AtomicU32,
    /// Version of the Force Dimension SDK.
    pub dhd_version: [AtomicU32; 4],
    /// Version of HDAPI.
    pub hd_version: Text,
}

/// Part of the board for one device box.
#[repr(C)]
pub struct Slot {
    /// 0 no device, 1 HD, 2 DHD.
    pub family: AtomicU32,
    /// Process that has the device open; 0 for none.
    pub owner: AtomicU32,
    /// 1 after an owner died without closing, until the device is plugged in again.
    pub locked: AtomicU32,
    /// 1 while the device is plugged in.
    pub plugged: AtomicU32,
    /// Number of times that the device was plugged in.
    pub plugs: AtomicU32,
    /// Error code that the library reports once, then sets to 0.
    pub error: AtomicU32,
    /// Error code that every opening of the device reports; 0 for none.
    pub open_error: AtomicU32,
    /// Messages about the device that a library waits for.
    pub asked: AtomicU64,
    /// Messages of `asked` that the controller handled.
    pub handled: AtomicU64,
    /// State of the box.
    pub state: Shared<State>,
    /// Properties of the model.
    pub traits: Shared<Traits>,
    /// Name of the device in the driver's configuration.
    pub name: Text,
    /// Name of the model.
    pub model: Text,
    /// Serial number.
    pub serial: Text,
    /// Version of the firmware.
    pub firmware: Text,
    /// Version of the device driver.
    pub driver_version: Text,
    /// Name of the vendor.
    pub vendor: Text,
}

/// The board.
#[repr(C)]
pub struct Board {
    magic: AtomicU64,
    /// Settings of the driver libraries.
    pub driver: Driver,
    /// Device boxes.
    pub slots: [Slot; DEVICES],
    /// Rings of messages.
    pub rings: [Ring; RINGS],
}

/// Why a board could not be opened.
#[derive(Debug)]
pub enum BoardError {
    /// The file cannot be opened or mapped.
    Io(std::io::Error),
    /// The file is not a board of this version.
    NotABoard,
}

impl std::fmt::Display for BoardError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Io(error) => write!(f, "the board cannot be opened: {error}"),
            Self::NotABoard => f.write_str("the file is not a board of this version"),
        }
    }
}

impl std::error::Error for BoardError {}

impl From<std::io::Error> for BoardError {
    fn from(error: std::io::Error) -> Self {
        Self::Io(error)
    }
}

impl Board {
    /// Creates the board at `path`. The mapping stays until the process ends.
    pub fn create(path: &Path) -> Result<&'static Self, BoardError> {
        let file = File::options()
            .read(true)
            .write(true)
            .create(true)
            .truncate(true)
            .open(path)?;
        file.set_len(size_of::<Self>() as u64)?;
        let board = Self::map(&file)?;
        for ring in &board.rings {
            ring.reset();
        }
        board.magic.store(MAGIC, Ordering::Release);
        Ok(board)
    }

    /// Opens the board at `path`. The mapping stays until the process ends.
    pub fn open(path: &Path) -> Result<&'static Self, BoardError> {
        let file = File::options().read(true).write(true).open(path)?;
        if file.metadata()?.len() != size_of::<Self>() as u64 {
            return Err(BoardError::NotABoard);
        }
        let board = Self::map(&file)?;
        if board.magic.load(Ordering::Acquire) != MAGIC {
            return Err(BoardError::NotABoard);
        }
        Ok(board)
    }

    fn map(file: &File) -> Result<&'static Self, BoardError> {
        // SAFETY: a new shared mapping of the whole file; every field is an atomic, and zeros are valid values.
        // No code unmaps it, so the reference stays valid.
        unsafe {
            let at = mmap(
                std::ptr::null_mut(),
                size_of::<Self>(),
                ProtFlags::READ | ProtFlags::WRITE,
                MapFlags::SHARED | MapFlags::POPULATE,
                file,
                0,
            )
            .map_err(std::io::Error::from)?;
            Ok(&*at.cast::<Self>())
        }
    }
}
