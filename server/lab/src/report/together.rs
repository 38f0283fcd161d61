//! Work that is not timed, on all cores.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::channel;

/// `work` of every one of `items`, in their order; `done` gets the share of it that is done.
pub(super) fn on_all_cores<T: Sync, R: Send>(
    items: &[T],
    done: &dyn Fn(f64),
    work: impl Fn(&T) -> R + Sync,
) -> Vec<R> {
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let next = AtomicUsize::new(0);
    let mut found: Vec<Option<R>> = items.iter().map(|_| None).collect();
    std::thread::scope(|scope| {
        let (send, receive) = channel();
        for _ in 0..cores.min(items.len()) {
            let (send, next, work) = (send.clone(), &next, &work);
            scope.spawn(move || {
                while let Some((k, item)) = {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    items.get(k).map(|item| (k, item))
                } {
                    // (Nobody hears only where this function has panicked.)
                    let _ = send.send((k, work(item)));
                }
            });
        }
        drop(send);
        for (count, (k, result)) in receive.into_iter().enumerate() {
            found[k] = Some(result);
            done((count + 1) as f64 / items.len() as f64);
        }
    });
    // (A panic in `work` has come out of the scope.)
    found.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_items() {
        let items: Vec<u64> = (0..100).collect();
        let last = std::cell::Cell::new(0.0);
        let found = on_all_cores(&items, &|share| last.set(share), |x| x * x);
        assert_eq!(found, items.iter().map(|x| x * x).collect::<Vec<_>>());
        assert_eq!(last.get(), 1.0);
        assert!(on_all_cores(&[] as &[u64], &|_| (), |x| *x).is_empty());
    }
}
