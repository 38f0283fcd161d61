//! A library's side of the board.

use super::{Board, BoardError, Message, NO_DEVICE, Packet, Ring, Slot};
use crate::clock;
use std::path::Path;
use std::sync::atomic::Ordering;

/// Library that writes to a ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Library {
    /// `standin_hd`.
    Hd = 1,
    /// `standin_dhd`.
    Dhd = 2,
}

/// Why a library cannot use the board.
#[derive(Debug)]
pub enum LinkError {
    /// The board cannot be opened.
    Board(BoardError),
    /// This process loaded the same library before.
    SecondLoad,
    /// Every ring has an owner.
    NoRing,
}

impl std::fmt::Display for LinkError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Board(error) => error.fmt(f),
            Self::SecondLoad => f.write_str("the process loaded the library before"),
            Self::NoRing => f.write_str("the board has no free ring"),
        }
    }
}

impl std::error::Error for LinkError {}

/// A library's connection to the controller. No call of it locks or allocates, except [`Link::open`].
#[derive(Clone, Copy)]
pub struct Link {
    /// The board.
    pub board: &'static Board,
    ring: &'static Ring,
    pid: u32,
}

impl Link {
    /// Connects the loaded image `instance` of `library` to the board at `path`.
    pub fn open(path: &Path, library: Library, instance: u64) -> Result<Self, LinkError> {
        let board = Board::open(path).map_err(LinkError::Board)?;
        let pid = std::process::id();
        let same = board.rings.iter().find(|ring| {
            ring.owner.load(Ordering::Acquire) == pid
                && ring.library.load(Ordering::Acquire) == library as u32
        });
        if let Some(ring) = same {
            return if ring.instance.load(Ordering::Acquire) == instance {
                Ok(Self { board, ring, pid })
            } else {
                Err(LinkError::SecondLoad)
            };
        }
        for ring in &board.rings {
            let claimed = ring
                .owner
                .compare_exchange(0, pid, Ordering::AcqRel, Ordering::Relaxed);
            if claimed.is_ok() {
                ring.instance.store(instance, Ordering::Release);
                ring.library.store(library as u32, Ordering::Release);
                return Ok(Self { board, ring, pid });
            }
        }
        Err(LinkError::NoRing)
    }

    /// Sends a message about `device`, a number on the board or [`NO_DEVICE`]. Returns false when the ring was full.
    pub fn send(&self, device: u64, message: Message) -> bool {
        self.push(device, message, false)
    }

    fn push(&self, device: u64, message: Message, waits: bool) -> bool {
        let packet = Packet {
            device,
            pid: self.pid,
            sent: clock::now_ns(),
            waits,
            message,
        };
        self.ring.push(&packet.words())
    }

    /// Sends a message about the device of `slot` and waits until the controller handled it, at most 200 ms.
    pub fn ask(&self, device: u64, message: Message) -> bool {
        let Some(slot) = self.slot(device) else {
            return false;
        };
        let ticket = slot.asked.fetch_add(1, Ordering::AcqRel) + 1;
        if !self.push(device, message, true) {
            return false;
        }
        let until = clock::now_ns() + 200 * clock::MS;
        while slot.handled.load(Ordering::Acquire) < ticket {
            let now = clock::now_ns();
            if now > until {
                return false;
            }
            clock::sleep_until(now + 100 * clock::US);
        }
        true
    }

    /// The board's part for `device`.
    pub fn slot(&self, device: u64) -> Option<&'static Slot> {
        if device == NO_DEVICE {
            return None;
        }
        self.board.slots.get(device as usize)
    }

    /// Takes the device for this process. Returns the process that has it already, if any.
    pub fn take(&self, slot: &Slot) -> Result<(), u32> {
        slot.owner
            .compare_exchange(0, self.pid, Ordering::AcqRel, Ordering::Acquire)
            .map(|_| ())
    }

    /// Gives the device back.
    pub fn release(&self, slot: &Slot) {
        let _ = slot
            .owner
            .compare_exchange(self.pid, 0, Ordering::AcqRel, Ordering::Acquire);
    }
}
