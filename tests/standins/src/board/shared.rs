//! Values that one process writes and other processes read without locks.

use std::marker::PhantomData;
use std::sync::atomic::{AtomicU64, Ordering, fence};

/// A plain value of 8-byte fields alone, so that words of 8 bytes carry it.
///
/// # Safety
/// The type must be `repr(C)`, must consist of `f64`, `u64` and `i64` alone, and must not be larger than 64 words.
pub unsafe trait Words: Copy {}

/// Most words of a shared value.
const MOST: usize = 64;

/// A value with one writer and any number of readers. A reader sees a whole value of one moment.
#[repr(C)]
pub struct Shared<T> {
    sequence: AtomicU64,
    words: [AtomicU64; MOST],
    of: PhantomData<T>,
}

impl<T: Words> Default for Shared<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Words> Shared<T> {
    const COUNT: usize = size_of::<T>() / 8;

    /// A value of zeros.
    pub const fn new() -> Self {
        Self {
            sequence: AtomicU64::new(0),
            words: [const { AtomicU64::new(0) }; MOST],
            of: PhantomData,
        }
    }

    /// Stores `value`. One thread of one process may call this for a value.
    pub fn store(&self, value: T) {
        const { assert!(size_of::<T>() / 8 <= MOST && size_of::<T>().is_multiple_of(8)) };
        let from = (&raw const value).cast::<u64>();
        let sequence = self.sequence.load(Ordering::Relaxed);
        self.sequence.store(sequence + 1, Ordering::Relaxed);
        fence(Ordering::Release);
        for (i, word) in self.words.iter().take(Self::COUNT).enumerate() {
            // SAFETY: `Words` promises fields of 8 bytes alone, and `i` is below their count.
            word.store(unsafe { from.add(i).read() }, Ordering::Relaxed);
        }
        self.sequence.store(sequence + 2, Ordering::Release);
    }

    /// The newest whole value. A writer that stops in the middle makes the reader return the torn value after a while.
    pub fn load(&self) -> T {
        let mut words = [0u64; MOST];
        for attempt in 0..100_000u32 {
            let before = self.sequence.load(Ordering::Acquire);
            for (to, word) in words.iter_mut().zip(&self.words).take(Self::COUNT) {
                *to = word.load(Ordering::Relaxed);
            }
            fence(Ordering::Acquire);
            if before.is_multiple_of(2) && self.sequence.load(Ordering::Relaxed) == before {
                break;
            }
            if attempt > 100 {
                std::thread::yield_now();
            }
            std::hint::spin_loop();
        }
        // SAFETY: `Words` promises that any words are a value and that the size is at most `MOST` words.
        unsafe { words.as_ptr().cast::<T>().read() }
    }
}

/// A short text of at most 63 bytes that ends with a zero.
#[repr(C)]
pub struct Text {
    words: [AtomicU64; 8],
}

impl Text {
    /// Stores the first 63 bytes of `text`.
    pub fn set(&self, text: &str) {
        let mut bytes = [0u8; 64];
        for (to, from) in bytes.iter_mut().zip(text.bytes().take(63)) {
            *to = from;
        }
        for (word, part) in self.words.iter().zip(bytes.chunks_exact(8)) {
            let mut eight = [0u8; 8];
            eight.copy_from_slice(part);
            word.store(u64::from_ne_bytes(eight), Ordering::Relaxed);
        }
    }

    /// The bytes of the text with zeros behind it.
    pub fn bytes(&self) -> [u8; 64] {
        let mut bytes = [0u8; 64];
        for (word, part) in self.words.iter().zip(bytes.chunks_exact_mut(8)) {
            part.copy_from_slice(&word.load(Ordering::Relaxed).to_ne_bytes());
        }
        bytes
    }

    /// True when the text equals `other`.
    pub fn is(&self, other: &[u8]) -> bool {
        let bytes = self.bytes();
        let length = bytes.iter().position(|b| *b == 0).unwrap_or(64);
        &bytes[..length] == other
    }
}
