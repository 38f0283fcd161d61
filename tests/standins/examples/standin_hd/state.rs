//! State of the library: its link to the controller and its open devices.

use crate::errors::INVALID_HANDLE;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicU8, AtomicU32, AtomicU64, Ordering};
use sulcus_standins::board::{DEVICES, ENV, Library, Link, NO_DEVICE, Shared, Slot, State, Traits};
use sulcus_standins::clock;

/// Texts of a device that `hdGetString` shows: model, serial number, firmware, driver version, vendor, library version.
pub const TEXTS: usize = 6;

/// An open device. Its handle is its place in [`OPEN`].
pub struct Open {
    /// True while the device is open.
    pub is_open: AtomicBool,
    /// Number of the device on the board.
    pub number: AtomicU64,
    /// How often the device had been plugged in when it was opened.
    pub plugs: AtomicU32,
    /// Depth of nested frames.
    pub depth: AtomicU32,
    /// Frames ended so far.
    pub frames: AtomicU64,
    /// Tick of the last ended frame.
    pub tick: AtomicU64,
    /// Bits of the enabled capabilities.
    pub capabilities: AtomicU32,
    /// Time when the force output was enabled, ns.
    pub enabled_at: AtomicU64,
    /// Rate of the force ramp in N/s, as bits.
    pub ramp: AtomicU64,
    /// Force in N and torque in mN m that the client set in this frame, as bits.
    pub set: [AtomicU64; 6],
    /// How often the client set them in this frame.
    pub sets: AtomicU64,
    /// Force in N of the last frame, as bits.
    pub last_force: [AtomicU64; 3],
    /// State at the begin of the frame.
    pub now: Shared<State>,
    /// State at the begin of the frame before.
    pub before: Shared<State>,
    /// Properties of the model.
    pub traits: Shared<Traits>,
    /// Texts with a zero at their ends.
    pub texts: [[AtomicU8; 64]; TEXTS],
}

/// All devices that a process may open.
pub static OPEN: [Open; DEVICES] = [const {
    Open {
        is_open: AtomicBool::new(false),
        number: AtomicU64::new(NO_DEVICE),
        plugs: AtomicU32::new(0),
        depth: AtomicU32::new(0),
        frames: AtomicU64::new(0),
        tick: AtomicU64::new(0),
        capabilities: AtomicU32::new(0),
        enabled_at: AtomicU64::new(0),
        ramp: AtomicU64::new(0),
        set: [const { AtomicU64::new(0) }; 6],
        sets: AtomicU64::new(0),
        last_force: [const { AtomicU64::new(0) }; 3],
        now: Shared::new(),
        before: Shared::new(),
        traits: Shared::new(),
        texts: [const { [const { AtomicU8::new(0) }; 64] }; TEXTS],
    }
}; DEVICES];

/// Handle of the current device.
pub static CURRENT: AtomicU32 = AtomicU32::new(INVALID_HANDLE);

static LINK: AtomicPtr<Link> = AtomicPtr::new(std::ptr::null_mut());

/// Number of this loaded image; another load has another number.
static INSTANCE: AtomicU64 = AtomicU64::new(0);

/// The link, when the library has one.
pub fn link() -> Option<&'static Link> {
    // SAFETY: a link is never freed after it was stored.
    unsafe { LINK.load(Ordering::Acquire).as_ref() }
}

/// The link; opens it by the environment at the first call. None without a controller and after a second load.
pub fn connect() -> Option<&'static Link> {
    link().or_else(|| reconnect(Path::new(&std::env::var_os(ENV)?)))
}

/// Opens a link to the board at `path`, also when the library has a link.
pub fn reconnect(path: &Path) -> Option<&'static Link> {
    let _ = INSTANCE.compare_exchange(0, clock::now_ns(), Ordering::AcqRel, Ordering::Acquire);
    match Link::open(path, Library::Hd, INSTANCE.load(Ordering::Acquire)) {
        Ok(link) => {
            LINK.store(Box::leak(Box::new(link)), Ordering::Release);
            crate::open::close_at_exit();
        }
        Err(error) => eprintln!("standin_hd: {error}"),
    }
    link()
}

/// The open device with the handle.
pub fn opened(hhd: u32) -> Option<&'static Open> {
    OPEN.get(hhd as usize)
        .filter(|open| open.is_open.load(Ordering::Acquire))
}

/// The current device with its handle.
pub fn current() -> Option<(u32, &'static Open)> {
    let hhd = CURRENT.load(Ordering::Acquire);
    opened(hhd).map(|open| (hhd, open))
}

impl Open {
    /// The board's part for the device.
    pub fn slot(&self) -> Option<&'static Slot> {
        link()?.slot(self.number.load(Ordering::Relaxed))
    }

    /// True while the connection of the opening lasts.
    pub fn is_connected(&self) -> bool {
        self.slot().is_some_and(|slot| {
            slot.plugged.load(Ordering::Acquire) != 0
                && slot.plugs.load(Ordering::Acquire) == self.plugs.load(Ordering::Relaxed)
        })
    }

    /// Three of the numbers that the client set, from `first`.
    pub fn set_from(&self, first: usize) -> [f64; 3] {
        [0, 1, 2].map(|i| f64::from_bits(self.set[first + i].load(Ordering::Relaxed)))
    }
}
