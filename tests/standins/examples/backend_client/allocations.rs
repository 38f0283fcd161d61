//! Allocator that counts the allocations of chosen threads.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicI32, AtomicU64, Ordering::Relaxed};

struct Counting;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Threads whose allocations count; 0 for none.
static WATCHED: [AtomicI32; 4] = [const { AtomicI32::new(0) }; 4];
static COUNT: AtomicU64 = AtomicU64::new(0);

thread_local! {
    static ID: Cell<i32> = const { Cell::new(0) };
}

fn count() {
    let id = ID.get();
    let id = if id == 0 {
        // SAFETY: the call has no precondition.
        let id = unsafe { libc::gettid() };
        ID.set(id);
        id
    } else {
        id
    };
    if WATCHED.iter().any(|watched| watched.load(Relaxed) == id) {
        COUNT.fetch_add(1, Relaxed);
    }
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        count();
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(at, layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: the caller's promise.
        unsafe { System.realloc(at, layout, size) }
    }
}

/// Watches the threads whose name begins with one of `names`, from now on. Returns their number.
pub fn watch(names: &[&str]) -> usize {
    COUNT.store(0, Relaxed);
    let tasks = std::fs::read_dir("/proc/self/task").expect("threads");
    let of = |task: std::fs::DirEntry| {
        let text = std::fs::read_to_string(task.path().join("comm")).ok()?;
        let id = task.file_name().to_str()?.parse().ok()?;
        let is_named = names.iter().any(|name| text.starts_with(name));
        is_named.then_some(id)
    };
    let ids: Vec<i32> = tasks.flatten().filter_map(of).collect();
    for (at, watched) in WATCHED.iter().enumerate() {
        watched.store(ids.get(at).copied().unwrap_or(0), Relaxed);
    }
    ids.len()
}

/// Number of allocations of the watched threads, releases included.
pub fn counted() -> u64 {
    COUNT.load(Relaxed)
}
