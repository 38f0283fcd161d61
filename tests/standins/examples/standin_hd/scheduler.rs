//! The scheduler: one thread for all devices.

use crate::callbacks;
use crate::errors::{INVALID_HANDLE, INVALID_OPERATION, INVALID_VALUE, raise};
use crate::state::{connect, link};
use std::cell::Cell;
use std::ffi::c_ulong;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};
use std::thread::JoinHandle;
use sulcus_standins::board::{Call, Driver, Message, NO_DEVICE};
use sulcus_standins::clock::{self, MS, US};

/// Real-time priority of the scheduler's thread, below the controller's.
const PRIORITY: i32 = 70;

static RATE: AtomicU32 = AtomicU32::new(1000);
static RUNNING: AtomicBool = AtomicBool::new(false);
static STOP: AtomicBool = AtomicBool::new(false);
static IN_CALLBACKS: AtomicBool = AtomicBool::new(false);
/// Number of the tick, from 1. It goes on over stops.
static TICK: AtomicU64 = AtomicU64::new(0);
static TICK_BEGAN: AtomicU64 = AtomicU64::new(0);
static TICK_LENGTH: AtomicU64 = AtomicU64::new(0);
static THREAD: Mutex<Option<JoinHandle<()>>> = Mutex::new(None);

thread_local! {
    static ON_IT: Cell<bool> = const { Cell::new(false) };
}

/// True on the scheduler's thread.
pub fn on_its_thread() -> bool {
    ON_IT.get()
}

/// True while the scheduler runs.
pub fn is_running() -> bool {
    RUNNING.load(Ordering::Acquire)
}

/// True while callbacks run.
pub fn is_in_callbacks() -> bool {
    IN_CALLBACKS.load(Ordering::Acquire)
}

/// Number of the tick; 0 while the scheduler is off.
pub fn tick() -> u64 {
    if is_running() {
        TICK.load(Ordering::Acquire)
    } else {
        0
    }
}

/// Number of the last tick.
pub fn turn() -> u64 {
    TICK.load(Ordering::Acquire)
}

/// Rate that the client set, in Hz.
pub fn rate() -> u32 {
    RATE.load(Ordering::Relaxed)
}

/// Rate from the length of the last tick, in Hz.
pub fn instantaneous_rate() -> u64 {
    1_000_000_000u64
        .checked_div(TICK_LENGTH.load(Ordering::Relaxed))
        .unwrap_or(0)
}

/// Lets the thread end after its tick.
pub fn ask_to_stop() {
    STOP.store(true, Ordering::Release);
}

fn note(call: Call, value: f64) {
    if let Some(link) = link() {
        link.send(NO_DEVICE, Message::Call(call, value));
    }
}

/// Starts the scheduler.
#[unsafe(no_mangle)]
pub extern "system" fn hdStartScheduler() {
    let Some(link) = connect() else {
        return raise(INVALID_OPERATION, INVALID_HANDLE);
    };
    let Ok(mut thread) = THREAD.lock() else {
        return;
    };
    if on_its_thread() || thread.is_some() {
        return raise(INVALID_OPERATION, INVALID_HANDLE);
    }
    STOP.store(false, Ordering::Release);
    RUNNING.store(true, Ordering::Release);
    note(Call::StartScheduler, f64::from(rate()));
    let driver = &link.board.driver;
    let named = std::thread::Builder::new().name("standin-hd".into());
    match named.spawn(move || serve(driver)) {
        Ok(handle) => *thread = Some(handle),
        Err(_) => RUNNING.store(false, Ordering::Release),
    }
}

/// Stops the scheduler after its tick.
#[unsafe(no_mangle)]
pub extern "system" fn hdStopScheduler() {
    if on_its_thread() || !stop() {
        return raise(INVALID_OPERATION, INVALID_HANDLE);
    }
    note(Call::StopScheduler, 0.0);
}

/// Stops the scheduler. Returns false when it was off.
pub fn stop() -> bool {
    ask_to_stop();
    let thread = THREAD.lock().ok().and_then(|mut thread| thread.take());
    thread.is_some_and(|thread| thread.join().is_ok())
}

/// Sets the rate of the scheduler in Hz, one of the rates of the driver.
#[unsafe(no_mangle)]
pub extern "system" fn hdSetSchedulerRate(hz: c_ulong) {
    let known = connect().is_some_and(|link| {
        let rates = &link.board.driver.rates;
        hz != 0
            && rates
                .iter()
                .any(|rate| c_ulong::from(rate.load(Ordering::Relaxed)) == hz)
    });
    if !known {
        return raise(INVALID_VALUE, INVALID_HANDLE);
    }
    RATE.store(hz as u32, Ordering::Relaxed);
    note(Call::SchedulerRate, hz as f64);
}

/// Time since the begin of this tick in s.
#[unsafe(no_mangle)]
pub extern "system" fn hdGetSchedulerTimeStamp() -> f64 {
    let began = TICK_BEGAN.load(Ordering::Acquire);
    clock::now_ns().saturating_sub(began) as f64 * 1e-9
}

/// The rate after a reset.
pub fn reset_rate() {
    RATE.store(1000, Ordering::Relaxed);
}

fn serve(driver: &Driver) {
    ON_IT.set(true);
    if driver.realtime.load(Ordering::Relaxed) != 0 {
        clock::make_realtime(PRIORITY);
    }
    let mut stalls = driver.stalls.load(Ordering::Acquire);
    let mut random = clock::now_ns() | 1;
    let mut next = clock::now_ns();
    while !STOP.load(Ordering::Acquire) {
        let real = match driver.real_rate.load(Ordering::Relaxed) {
            0 => rate(),
            hz => hz,
        };
        let period = 1_000_000_000 / u64::from(real.max(1));
        // A late scheduler leaves ticks out instead of catching up.
        next = (next + period).max(clock::now_ns().saturating_sub(period));
        let jitter = u64::from(driver.jitter.load(Ordering::Relaxed)) * US;
        clock::sleep_until(next + draw(&mut random) % (jitter + 1));
        let asked = driver.stalls.load(Ordering::Acquire);
        if asked != stalls {
            stalls = asked;
            let ms = driver.stall.load(Ordering::Relaxed);
            clock::sleep_until(clock::now_ns() + u64::from(ms) * MS);
            note(Call::Stall, f64::from(ms));
        }
        let began = clock::now_ns();
        let length = began.saturating_sub(TICK_BEGAN.swap(began, Ordering::AcqRel));
        TICK_LENGTH.store(length, Ordering::Relaxed);
        TICK.fetch_add(1, Ordering::AcqRel);
        IN_CALLBACKS.store(true, Ordering::Release);
        callbacks::run();
        IN_CALLBACKS.store(false, Ordering::Release);
    }
    RUNNING.store(false, Ordering::Release);
}

/// A random number of the xorshift generator.
fn draw(state: &mut u64) -> u64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    *state
}
