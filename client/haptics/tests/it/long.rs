//! A million random sequences.

use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

use crate::judge::Seen;
use crate::sequences::{add, is_worth, run};

/// Number of sequences of one proof.
const SEQUENCES: u64 = 500_000;

/// Runs the sequences of `half`, 0 or 1, of a million.
fn sequences(half: u64) {
    let next = AtomicU64::new(0);
    let threads = thread::available_parallelism().map_or(1, |number| number.get());
    let all = thread::scope(|scope| {
        let workers: Vec<_> = (0..threads)
            .map(|_| {
                scope.spawn(|| {
                    let mut seen = Seen::default();
                    loop {
                        let seed = next.fetch_add(1, Ordering::Relaxed);
                        if seed >= SEQUENCES {
                            return seen;
                        }
                        if seed.is_multiple_of(100_000) {
                            println!("sequence {seed}");
                        }
                        // The default run has other seeds.
                        add(&mut seen, &run((1 << 32) + half * SEQUENCES + seed));
                    }
                })
            })
            .collect();
        let mut all = Seen::default();
        for worker in workers {
            add(&mut all, &worker.join().expect("a worker"));
        }
        all
    });
    println!("{SEQUENCES} sequences: {all:?}");
    is_worth(&all, SEQUENCES);
}

#[test]
fn half_a_million_random_sequences() {
    if sulcus_support::long::selected("door-first-half") {
        sequences(0);
    }
}

#[test]
fn another_half_a_million_random_sequences() {
    if sulcus_support::long::selected("door-second-half") {
        sequences(1);
    }
}
