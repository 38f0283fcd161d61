//! A ring of messages from the threads of one process to the controller.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

/// Words of one packet.
pub const WORDS: usize = 24;

/// Packets that fit into a ring: about two seconds of two devices at 1 kHz.
const CAPACITY: usize = 4096;

#[repr(C)]
struct Cell {
    sequence: AtomicU64,
    words: [AtomicU64; WORDS],
}

/// A bounded ring with many writers of one process and one reader, the controller. A full ring counts what it loses.
#[repr(C)]
pub struct Ring {
    /// Process that owns the ring; 0 for a free ring.
    pub owner: AtomicU32,
    /// Library of the owner.
    pub library: AtomicU32,
    /// Loaded image of the library, so that a second load is seen.
    pub instance: AtomicU64,
    /// Packets lost because the ring was full.
    pub lost: AtomicU64,
    head: AtomicU64,
    tail: AtomicU64,
    cells: [Cell; CAPACITY],
}

impl Ring {
    /// Empties the ring and frees it. The controller alone calls this, when no owner writes.
    pub fn reset(&self) {
        self.head.store(0, Ordering::Relaxed);
        self.tail.store(0, Ordering::Relaxed);
        self.lost.store(0, Ordering::Relaxed);
        for (i, cell) in self.cells.iter().enumerate() {
            cell.sequence.store(i as u64, Ordering::Relaxed);
        }
        self.library.store(0, Ordering::Relaxed);
        self.instance.store(0, Ordering::Relaxed);
        self.owner.store(0, Ordering::Release);
    }

    /// Adds a packet. A full ring loses the packet and returns false.
    pub fn push(&self, packet: &[u64; WORDS]) -> bool {
        let mut at = self.head.load(Ordering::Relaxed);
        let cell = loop {
            let cell = &self.cells[at as usize % CAPACITY];
            let ahead = cell.sequence.load(Ordering::Acquire) as i64 - at as i64;
            if ahead < 0 {
                self.lost.fetch_add(1, Ordering::Relaxed);
                return false;
            }
            if ahead > 0 {
                at = self.head.load(Ordering::Relaxed);
                continue;
            }
            match self
                .head
                .compare_exchange_weak(at, at + 1, Ordering::Relaxed, Ordering::Relaxed)
            {
                Ok(_) => break cell,
                Err(newer) => at = newer,
            }
        };
        for (word, value) in cell.words.iter().zip(packet) {
            word.store(*value, Ordering::Relaxed);
        }
        cell.sequence.store(at + 1, Ordering::Release);
        true
    }

    /// Takes the oldest packet. The controller alone calls this.
    pub fn pop(&self) -> Option<[u64; WORDS]> {
        let at = self.tail.load(Ordering::Relaxed);
        let cell = &self.cells[at as usize % CAPACITY];
        if cell.sequence.load(Ordering::Acquire) != at + 1 {
            return None;
        }
        let mut packet = [0; WORDS];
        for (value, word) in packet.iter_mut().zip(&cell.words) {
            *value = word.load(Ordering::Relaxed);
        }
        cell.sequence.store(at + CAPACITY as u64, Ordering::Release);
        self.tail.store(at + 1, Ordering::Relaxed);
        Some(packet)
    }
}
