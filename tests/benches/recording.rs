//! What recording costs the thread that ticks: probe in a pocket and mirror on the tongue, at 1 kHz by the clock, with the
//! recorder in its own thread behind a queue, as the server has it, and without. What is timed is the tick and the hand-over
//! that follows it. Runs with and without alternate; each tick counts with its fastest, which leaves out what other processes do
//! to a shared machine, and nothing of the recorder's, which is there in each run.
//!
//! `cargo bench -p sulcus-tests --bench recording`; it fails where recording costs more than it may.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use rtrb::RingBuffer;
use rustix::thread::{ClockId, clock_nanosleep_absolute};
use rustix::time::{ClockId as Clock, Timespec, clock_gettime};
use sulcus_cases::mouth::{hands, mouth};
use sulcus_cases::record;
use sulcus_cases::statistics::percentiles_us;
use sulcus_cases::timing::{cpu_ns, keep_fastest};
use sulcus_core::{NoProbe, Scene, State, TickInput, TickOutput, Workspace, tick};
use sulcus_operator::HandParams;
use sulcus_sessions::{
    Recorder, Row, Sampler, SessionEnd, SessionHeader, Shapes, StationKey, Views,
};

/// When both hands are at work, seconds, and how long is measured from then on.
const BEGINS: f64 = 7.0;
const SECONDS: f64 = 10.0;
/// Time for the hands to leave afterwards, seconds: never run, but the script wants it.
const LEAVING: f64 = 8.0;
/// Runs of each kind.
const RUNS: usize = 4;
/// What recording may cost: the tick and its hand-over over the tick alone, at p50 and p99. (Behind p99 are a few ticks, and what the
/// machine did in them.)
const MOST_RATIO: f64 = 1.1;
/// Slots in the queue, and buffers for shapes: the server's.
const ROWS: usize = 4096;
const SHAPES: usize = 16;

#[expect(
    clippy::large_enum_variant,
    reason = "nearly all are ticks, and a box would be allocated in the tick's thread"
)]
enum Entry {
    Tick(Row, TickOutput, u32),
    Shapes(Box<Shapes>),
}

/// The tick's end of the queue.
struct Queue {
    entries: rtrb::Producer<Entry>,
    buffers: rtrb::Consumer<Box<Shapes>>,
    sampler: Sampler,
    dropped: u64,
}

impl Queue {
    fn push(&mut self, unix_ns: u64, input: &TickInput, out: &TickOutput, ws: &Workspace, ns: u64) {
        if self.sampler.is_due(out.tick)
            && let Ok(mut shapes) = self.buffers.pop()
        {
            self.sampler.read(out.tick, ws, &mut shapes);
            self.dropped += u64::from(self.entries.push(Entry::Shapes(shapes)).is_err());
        }
        let row = Row::new(unix_ns, input, out);
        let entry = Entry::Tick(row, *out, u32::try_from(ns).unwrap_or(u32::MAX));
        self.dropped += u64::from(self.entries.push(entry).is_err());
    }
}

/// The recorder's thread, until told to stop; returns the file's length.
fn recorder(
    scene: Arc<Scene>,
    file: std::path::PathBuf,
    stop: Arc<AtomicBool>,
) -> (Queue, std::thread::JoinHandle<u64>) {
    let (entries, mut entries_out) = RingBuffer::new(ROWS);
    let (mut buffers, buffers_out) = RingBuffer::new(SHAPES);
    let room = Shapes::new(&scene);
    while buffers.push(Box::new(room.like())).is_ok() {}
    let header = SessionHeader::new(scene.to_bytes().expect("a scene"));
    let key = StationKey::from_seed([1; 32]);
    let mut recorder = Recorder::create(&file, &header, key).expect("a file");
    let begin = State::new(&scene).to_bytes();
    recorder.snapshot(0, 0, &begin).expect("written");
    let mut views = Views::open(&scene, &mut recorder, 0).expect("written");
    let queue = Queue {
        entries,
        buffers: buffers_out,
        sampler: views.sampler(),
        dropped: 0,
    };
    let thread = std::thread::spawn(move || {
        let mut newest: Option<Box<Shapes>> = None;
        loop {
            let over = stop.load(Ordering::Acquire);
            while let Ok(entry) = entries_out.pop() {
                match entry {
                    Entry::Shapes(shapes) => newest = Some(shapes),
                    Entry::Tick(row, output, ns) => {
                        recorder.push(&row).expect("written");
                        let shapes = newest.take();
                        views
                            .tick(&mut recorder, &scene, &row, &output, ns, shapes.as_deref())
                            .expect("written");
                        if let Some(shapes) = shapes {
                            let _ = buffers.push(shapes);
                        }
                    }
                }
            }
            if over {
                return recorder
                    .finish(SessionEnd::default())
                    .expect("written")
                    .bytes;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    });
    (queue, thread)
}

fn monotonic_ns() -> u64 {
    let now = clock_gettime(Clock::Monotonic);
    now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
}

fn sleep_until(ns: u64) {
    let at = Timespec {
        tv_sec: (ns / 1_000_000_000) as i64,
        tv_nsec: (ns % 1_000_000_000) as i64,
    };
    while clock_nanosleep_absolute(ClockId::Monotonic, &at) == Err(rustix::io::Errno::INTR) {}
}

/// Runs the inputs by the clock; CPU time of each tick with its hand-over, if there is one.
fn run(scene: &Scene, inputs: &[TickInput], mut queue: Option<&mut Queue>) -> Vec<u64> {
    let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
    let mut times = Vec::with_capacity(inputs.len());
    let begin = monotonic_ns();
    for (k, input) in inputs.iter().enumerate() {
        sleep_until(begin + k as u64 * scene.params.tick_ns());
        let cpu = cpu_ns();
        let output = tick(scene, &mut state, &mut ws, input, &mut NoProbe);
        if let Some(queue) = &mut queue {
            let unix_ns = output.tick * scene.params.tick_ns();
            queue.push(unix_ns, input, &output, &ws, cpu_ns() - cpu);
        }
        times.push(cpu_ns() - cpu);
    }
    times
}

fn main() {
    // `cargo test --benches` passes --test: nothing to check there.
    if std::env::args().any(|arg| arg == "--test") {
        return;
    }
    let scene = Arc::new(mouth(1, false, 3));
    let script = hands(&scene, BEGINS + SECONDS + LEAVING);
    let ticks = scene.params.ticks_in(BEGINS + SECONDS);
    let hand = (HandParams::default(), 7);
    let inputs = record(&scene, Box::new(script), hand, ticks, |_, _| {});
    let folder = tempfile::tempdir().expect("a folder");
    let (mut without, mut with) = (Vec::new(), Vec::new());
    for k in 0..RUNS {
        keep_fastest(&mut without, &run(&scene, &inputs, None));
        let stop = Arc::new(AtomicBool::new(false));
        let file = folder.path().join(format!("{k}.mcap"));
        let (mut queue, thread) = recorder(scene.clone(), file, stop.clone());
        keep_fastest(&mut with, &run(&scene, &inputs, Some(&mut queue)));
        stop.store(true, Ordering::Release);
        let bytes = thread.join().expect("no panic");
        assert_eq!(queue.dropped, 0, "the recorder kept up");
        eprintln!("run {k}: {:.1} MB", bytes as f64 * 1e-6);
    }
    let measured = |times: &[u64]| {
        percentiles_us(
            times
                .iter()
                .skip(scene.params.ticks_in(BEGINS) as usize)
                .copied(),
        )
    };
    let (without, with) = (measured(&without), measured(&with));
    println!("thread CPU time of a tick and its hand-over, us");
    println!(
        "{:18} {:>8} {:>8} {:>8} {:>8}",
        "", "p50", "p99", "p99.9", "max"
    );
    for (name, of) in [("without recorder", without), ("with recorder", with)] {
        println!(
            "{name:18} {:8.1} {:8.1} {:8.1} {:8.1}",
            of.p50, of.p99, of.p999, of.max
        );
    }
    println!(
        "{:18} {:8.3} {:8.3} {:8.3}",
        "ratio",
        with.p50 / without.p50,
        with.p99 / without.p99,
        with.p999 / without.p999
    );
    for (name, ratio) in [
        ("p50", with.p50 / without.p50),
        ("p99", with.p99 / without.p99),
    ] {
        assert!(
            ratio <= MOST_RATIO,
            "{name} with the recorder over without is {ratio:.3}, expected at most {MOST_RATIO}"
        );
    }
}
