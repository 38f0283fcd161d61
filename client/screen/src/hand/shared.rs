//! Hands between two threads: the window feeds them, the device loop reads them.
//!
//! The window may wait for the device loop, which holds the hands for microseconds. The device loop never waits.

use std::collections::VecDeque;
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use super::hands::Hands;
use crate::readings::Entry;

/// Largest number of entries that wait for the device loop. Chosen: six sites of 32 teeth.
const MOST_ENTRIES: usize = 192;

/// Hands and confirmed findings of a window.
#[derive(Debug)]
pub struct Shared {
    hands: Mutex<Hands>,
    entries: Mutex<VecDeque<Entry>>,
}

impl Shared {
    /// Hands without findings.
    pub fn new(hands: Hands) -> Self {
        Self {
            hands: Mutex::new(hands),
            entries: Mutex::new(VecDeque::new()),
        }
    }

    /// Feeds the hands, from the window's thread. `feed` must be short: keys, counts of a mouse, a new camera.
    pub fn feed<T>(&self, feed: impl FnOnce(&mut Hands) -> T) -> T {
        // A panic of a feeder leaves hands that are whole.
        let mut hands = self.hands.lock().unwrap_or_else(PoisonError::into_inner);
        feed(&mut hands)
    }

    /// Hands over confirmed findings, oldest first. Returns whether there was room.
    pub fn call(&self, entry: Entry) -> bool {
        let mut entries = self.entries.lock().unwrap_or_else(PoisonError::into_inner);
        let has_room = entries.len() < MOST_ENTRIES;
        if has_room {
            entries.push_back(entry);
        }
        has_room
    }

    /// Hands, if the window does not hold them.
    pub(super) fn try_hands(&self) -> Option<MutexGuard<'_, Hands>> {
        free(self.hands.try_lock())
    }

    /// Findings that wait, oldest first; none while the window holds the queue.
    pub(super) fn take_entries(&self) -> Vec<Entry> {
        let entries = free(self.entries.try_lock());
        entries.map_or_else(Vec::new, |mut entries| entries.drain(..).collect())
    }
}

fn free<'a, T>(
    tried: Result<MutexGuard<'a, T>, TryLockError<MutexGuard<'a, T>>>,
) -> Option<MutexGuard<'a, T>> {
    match tried {
        Ok(guard) => Some(guard),
        Err(TryLockError::Poisoned(error)) => Some(error.into_inner()),
        Err(TryLockError::WouldBlock) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hand::hands::Scales;
    use crate::readings::{Draft, Site, Stop};

    fn entry(depth: u8) -> Entry {
        let draft = Draft {
            depth_mm: Some(depth),
            ..Draft::default()
        };
        let site = Site::Buccal;
        draft.at(Stop { tooth: 36, site }).expect("a depth")
    }

    #[test]
    fn findings_come_once_in_their_order_and_a_full_queue_refuses() {
        let shared = Shared::new(Hands::new([None; 2], Scales::default()));
        assert!(shared.call(entry(3)) && shared.call(entry(5)));
        assert_eq!(shared.take_entries(), [entry(3), entry(5)]);
        assert_eq!(shared.take_entries(), []);
        let taken = (0..300).filter(|_| shared.call(entry(1))).count();
        assert_eq!((taken, shared.take_entries().len()), (192, 192));
        assert!(shared.call(entry(2)));
    }

    #[test]
    fn a_held_lock_is_not_waited_for_and_a_panic_does_not_spoil_it() {
        let shared = Shared::new(Hands::new([None; 2], Scales::default()));
        shared.feed(|_| assert!(shared.try_hands().is_none()));
        let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            shared.feed(|_| panic!("in the window"));
        }));
        assert!(caught.is_err() && shared.try_hands().is_some());
        shared.feed(|hands| hands.set_open(false));
        assert!(!shared.feed(|hands| hands.is_open()));
    }
}
