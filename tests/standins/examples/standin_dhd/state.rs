//! State of the library: its link to the controller and its open devices.

use crate::errors::{self, fail, fail_alone};
use std::ffi::c_char;
use std::path::Path;
use std::sync::atomic::{
    AtomicBool, AtomicI32, AtomicPtr, AtomicU8, AtomicU32, AtomicU64, Ordering,
};
use sulcus_standins::board::{
    DEVICES, ENV, Library, Link, Message, NO_DEVICE, Shared, Slot, State, Traits,
};
use sulcus_standins::clock;

/// An open device. Its id is its place in [`OPEN`].
pub struct Open {
    /// True while the device is open.
    pub is_open: AtomicBool,
    /// Number of the device on the board.
    pub number: AtomicU64,
    /// How often the device had been plugged in when it was opened.
    pub plugs: AtomicU32,
    /// Force commands so far.
    pub commands: AtomicU64,
    /// Time of the last fresh reading of the pose, ns.
    pub read_at: AtomicU64,
    /// Last fresh reading.
    pub reading: Shared<State>,
    /// Calls for the linear velocity so far.
    pub linear: AtomicU32,
    /// Calls for the angular velocity so far.
    pub angular: AtomicU32,
    /// Time guard in ns.
    pub guard: AtomicU64,
    /// Largest force of the client's own in N, as bits.
    pub limit: AtomicU64,
    /// Properties of the model.
    pub traits: Shared<Traits>,
    /// Name of the model with a zero at its end.
    pub name: [AtomicU8; 64],
}

/// All devices that a process may open.
pub static OPEN: [Open; DEVICES] = [const {
    Open {
        is_open: AtomicBool::new(false),
        number: AtomicU64::new(NO_DEVICE),
        plugs: AtomicU32::new(0),
        commands: AtomicU64::new(0),
        read_at: AtomicU64::new(0),
        reading: Shared::new(),
        linear: AtomicU32::new(0),
        angular: AtomicU32::new(0),
        guard: AtomicU64::new(0),
        limit: AtomicU64::new(0),
        traits: Shared::new(),
        name: [const { AtomicU8::new(0) }; 64],
    }
}; DEVICES];

/// Id of the default device: the device opened last; -1 for none.
pub static DEFAULT: AtomicI32 = AtomicI32::new(-1);

static LINK: AtomicPtr<Link> = AtomicPtr::new(std::ptr::null_mut());
static INSTANCE: AtomicU64 = AtomicU64::new(0);

/// The link, when the library has one.
pub fn link() -> Option<&'static Link> {
    // SAFETY: a link is never freed after it was stored.
    unsafe { LINK.load(Ordering::Acquire).as_ref() }
}

/// The link; opens it by the environment at the first call. None without a controller.
pub fn connect() -> Option<&'static Link> {
    link().or_else(|| reconnect(Path::new(&std::env::var_os(ENV)?)))
}

/// Opens a link to the board at `path`, also when the library has a link.
pub fn reconnect(path: &Path) -> Option<&'static Link> {
    let _ = INSTANCE.compare_exchange(0, clock::now_ns(), Ordering::AcqRel, Ordering::Acquire);
    match Link::open(path, Library::Dhd, INSTANCE.load(Ordering::Acquire)) {
        Ok(link) => LINK.store(Box::leak(Box::new(link)), Ordering::Release),
        Err(error) => eprintln!("standin_dhd: {error}"),
    }
    link()
}

/// A C character as a number with a sign, also on processors whose `c_char` has none.
#[allow(
    clippy::unnecessary_cast,
    reason = "the type of c_char depends on the processor"
)]
pub fn signed(character: c_char) -> i32 {
    i32::from(character as i8)
}

/// The open device with the id, or the default device for -1. An unknown id is an error of this thread.
pub fn opened(id: c_char) -> Result<&'static Open, i32> {
    let id = match signed(id) {
        -1 => DEFAULT.load(Ordering::Acquire),
        id => id,
    };
    usize::try_from(id)
        .ok()
        .and_then(|id| OPEN.get(id))
        .filter(|open| open.is_open.load(Ordering::Acquire))
        .ok_or_else(|| fail_alone(errors::NOT_AVAILABLE))
}

/// The open device with the id and the board's part for it, while its connection lasts.
pub fn connected(id: c_char) -> Result<(&'static Open, &'static Slot), i32> {
    let open = opened(id)?;
    match open.slot() {
        Some(slot) if open.is_connected() => Ok((open, slot)),
        _ => Err(open.fail(errors::COMMUNICATION)),
    }
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

    /// Notes an error about the device and returns -1.
    pub fn fail(&self, code: i32) -> i32 {
        fail(code, self.number.load(Ordering::Relaxed))
    }

    /// Sends a message about the device.
    pub fn send(&self, message: Message) {
        if let Some(link) = link() {
            link.send(self.number.load(Ordering::Relaxed), message);
        }
    }

    /// Sends a message about the device, waits for the controller and returns 0, or -1 without an answer.
    pub fn ask(&self, message: Message) -> i32 {
        let answered =
            link().is_some_and(|link| link.ask(self.number.load(Ordering::Relaxed), message));
        if answered {
            0
        } else {
            self.fail(errors::COMMUNICATION)
        }
    }
}

/// The number of a result: an error is -1 already.
pub fn code(result: Result<i32, i32>) -> i32 {
    result.unwrap_or_else(|error| error)
}
