//! The table of callbacks.

use crate::errors::{INVALID_HANDLE, INVALID_OPERATION, INVALID_VALUE, SCHEDULER_FULL, raise};
use crate::scheduler;
use crate::state::link;
use std::ffi::{c_ulong, c_void};
use std::sync::atomic::{AtomicPtr, AtomicU32, AtomicU64, Ordering};
use sulcus_standins::board::{Call, Message, NO_DEVICE};
use sulcus_standins::clock::{self, US};

/// A callback: 0 done, 1 once more at the next tick.
pub type Callback = unsafe extern "system" fn(*mut c_void) -> u32;

/// Callbacks that the scheduler holds.
const SLOTS: usize = 16;

const FREE: u32 = 0;
const FILLING: u32 = 1;
const LIVE: u32 = 2;

struct Entry {
    state: AtomicU32,
    callback: AtomicPtr<c_void>,
    user: AtomicPtr<c_void>,
    priority: AtomicU32,
    handle: AtomicU64,
}

static ENTRIES: [Entry; SLOTS] = [const {
    Entry {
        state: AtomicU32::new(FREE),
        callback: AtomicPtr::new(std::ptr::null_mut()),
        user: AtomicPtr::new(std::ptr::null_mut()),
        priority: AtomicU32::new(0),
        handle: AtomicU64::new(0),
    }
}; SLOTS];

/// Next handle. Handles need more than 32 bits, so that a client with a narrow type fails.
static NEXT: AtomicU64 = AtomicU64::new(0x1_0000_0001);

/// Calls every live callback once, the highest priority first.
pub fn run() {
    let mut done = 0u32;
    loop {
        let mut best: Option<(u32, usize)> = None;
        for (i, entry) in ENTRIES.iter().enumerate() {
            if done & (1 << i) == 0 && entry.state.load(Ordering::Acquire) == LIVE {
                let priority = entry.priority.load(Ordering::Relaxed);
                if best.is_none_or(|b| b.0 < priority) {
                    best = Some((priority, i));
                }
            }
        }
        let Some((_, i)) = best else {
            return;
        };
        done |= 1 << i;
        call(&ENTRIES[i]);
    }
}

fn call(entry: &Entry) {
    let handle = entry.handle.load(Ordering::Relaxed);
    let callback = entry.callback.load(Ordering::Relaxed);
    // SAFETY: the entry is live, so `add` stored a callback in it.
    let callback = unsafe { std::mem::transmute::<*mut c_void, Callback>(callback) };
    // SAFETY: the client promised that the callback is valid with its argument until it is unscheduled.
    let again = unsafe { callback(entry.user.load(Ordering::Relaxed)) };
    if again == 0 && entry.handle.load(Ordering::Acquire) == handle {
        entry.state.store(FREE, Ordering::Release);
    }
}

fn add(callback: Callback, user: *mut c_void, priority: u16) -> Option<u64> {
    let entry = ENTRIES.iter().find(|entry| {
        entry
            .state
            .compare_exchange(FREE, FILLING, Ordering::AcqRel, Ordering::Relaxed)
            .is_ok()
    })?;
    let handle = NEXT.fetch_add(1, Ordering::Relaxed);
    entry
        .callback
        .store(callback as *mut c_void, Ordering::Relaxed);
    entry.user.store(user, Ordering::Relaxed);
    entry.priority.store(priority.into(), Ordering::Relaxed);
    entry.handle.store(handle, Ordering::Relaxed);
    entry.state.store(LIVE, Ordering::Release);
    if let Some(link) = link() {
        link.send(NO_DEVICE, Message::Call(Call::Schedule, priority.into()));
    }
    Some(handle)
}

fn alive(handle: u64) -> Option<&'static Entry> {
    ENTRIES.iter().find(|e| {
        e.state.load(Ordering::Acquire) == LIVE && e.handle.load(Ordering::Acquire) == handle
    })
}

/// Forgets every callback. The scheduler must be off.
pub fn clear() {
    for entry in &ENTRIES {
        entry.state.store(FREE, Ordering::Release);
    }
}

/// Adds a callback and returns its handle; 0 after an error.
#[unsafe(no_mangle)]
pub extern "system" fn hdScheduleAsynchronous(
    callback: Option<Callback>,
    user: *mut c_void,
    priority: u16,
) -> c_ulong {
    let Some(callback) = callback else {
        raise(INVALID_VALUE, INVALID_HANDLE);
        return 0;
    };
    add(callback, user, priority).map_or_else(
        || {
            raise(SCHEDULER_FULL, INVALID_HANDLE);
            0
        },
        |handle| handle as c_ulong,
    )
}

/// Adds a callback and waits until it is done. On the scheduler's own thread the callback runs at once.
///
/// # Safety
/// The callback is valid with its argument.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn hdScheduleSynchronous(
    callback: Option<Callback>,
    user: *mut c_void,
    priority: u16,
) {
    let Some(callback) = callback else {
        return raise(INVALID_VALUE, INVALID_HANDLE);
    };
    if scheduler::on_its_thread() {
        // SAFETY: the caller's promise.
        unsafe { callback(user) };
        return;
    }
    if !scheduler::is_running() {
        return raise(INVALID_OPERATION, INVALID_HANDLE);
    }
    let Some(handle) = add(callback, user, priority) else {
        return raise(SCHEDULER_FULL, INVALID_HANDLE);
    };
    wait_while(|| alive(handle).is_some());
}

/// Waits while the condition holds and the scheduler runs.
fn wait_while(condition: impl Fn() -> bool) {
    while condition() && scheduler::is_running() {
        clock::sleep_until(clock::now_ns() + 100 * US);
    }
}

/// Removes a callback. A callback that runs on another thread at this moment ends first.
#[unsafe(no_mangle)]
pub extern "system" fn hdUnschedule(handle: c_ulong) {
    let Some(entry) = alive(handle) else {
        return raise(INVALID_VALUE, INVALID_HANDLE);
    };
    entry.handle.store(0, Ordering::Release);
    entry.state.store(FREE, Ordering::Release);
    if !scheduler::on_its_thread() {
        let turn = scheduler::turn();
        wait_while(|| scheduler::is_in_callbacks() && scheduler::turn() == turn);
    }
    if let Some(link) = link() {
        link.send(NO_DEVICE, Message::Call(Call::Unschedule, 0.0));
    }
}

/// Tells whether the callback is alive (code 0), or waits until it is done (code 1). Returns 1 for alive, 0 for done.
#[unsafe(no_mangle)]
pub extern "system" fn hdWaitForCompletion(handle: c_ulong, code: u32) -> u8 {
    match code {
        0 => {}
        1 if scheduler::on_its_thread() => raise(INVALID_OPERATION, INVALID_HANDLE),
        1 => wait_while(|| alive(handle).is_some()),
        _ => raise(INVALID_VALUE, INVALID_HANDLE),
    }
    alive(handle).is_some().into()
}
