//! Work shared between threads. The result does not depend on the number of threads.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Returns `(0..count).map(work)`, computed on all cores, in order.
pub(crate) fn map<T: Send>(count: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    map_on(threads(), count, work)
}

/// Largest number of threads.
static MOST: AtomicUsize = AtomicUsize::new(8);

/// Sets the largest number of threads of all compilations of this process, 1 to 8. A program beside a station that runs
/// takes one.
pub fn limit_threads(most: usize) {
    MOST.store(most.clamp(1, 8), Ordering::Relaxed);
}

/// Returns the number of threads.
pub(crate) fn threads() -> usize {
    std::thread::available_parallelism()
        .map_or(1, |n| n.get())
        .min(MOST.load(Ordering::Relaxed))
}

/// Returns [`map`] on this number of threads.
pub(crate) fn map_on<T: Send>(
    threads: usize,
    count: usize,
    work: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let chunk = (count / (threads * 8)).max(1);
    if threads == 1 || count < 2 {
        return (0..count).map(work).collect();
    }
    let next = AtomicUsize::new(0);
    // Each thread takes the next chunk. The pieces are put in order afterwards.
    let run = || {
        let mut done = Vec::new();
        loop {
            let start = next.fetch_add(chunk, Ordering::Relaxed);
            if start >= count {
                return done;
            }
            done.push((
                start,
                (start..(start + chunk).min(count))
                    .map(&work)
                    .collect::<Vec<T>>(),
            ));
        }
    };
    let mut pieces = std::thread::scope(|scope| {
        let helpers: Vec<_> = (1..threads).map(|_| scope.spawn(run)).collect();
        let mut pieces = run();
        for helper in helpers {
            match helper.join() {
                Ok(more) => pieces.extend(more),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        pieces
    });
    pieces.sort_unstable_by_key(|piece| piece.0);
    pieces.into_iter().flat_map(|piece| piece.1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_number_of_threads_gives_the_same_in_the_same_order() {
        let expected: Vec<usize> = (0..1000).map(|k| k * k).collect();
        for threads in 1..9 {
            assert_eq!(map_on(threads, 1000, |k| k * k), expected);
            assert_eq!(map_on(threads, 0, |k| k), Vec::<usize>::new());
            assert_eq!(map_on(threads, 1, |k| k + 7), [7]);
        }
    }
}
