//! A path for values of one process.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::{Counts, Fate, Path};

/// A value on its way. Values that arrive at the same time keep the order in which they were sent.
#[derive(Debug)]
struct OnItsWay<T> {
    at_ns: u64,
    number: u64,
    value: T,
}

impl<T> PartialEq for OnItsWay<T> {
    fn eq(&self, other: &Self) -> bool {
        (self.at_ns, self.number) == (other.at_ns, other.number)
    }
}

impl<T> Eq for OnItsWay<T> {}

impl<T> PartialOrd for OnItsWay<T> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Ord for OnItsWay<T> {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (self.at_ns, self.number).cmp(&(other.at_ns, other.number))
    }
}

/// Direction between two parts of one process. The caller states the time.
#[derive(Debug)]
pub struct Wire<T> {
    path: Path,
    on_their_way: BinaryHeap<Reverse<OnItsWay<T>>>,
    number: u64,
}

impl<T: Clone> Wire<T> {
    /// A wire through `path`.
    pub fn new(path: Path) -> Self {
        Self {
            path,
            on_their_way: BinaryHeap::new(),
            number: 0,
        }
    }

    /// Path of the wire, to cut or to change it.
    pub fn path(&mut self) -> &mut Path {
        &mut self.path
    }

    /// Values so far.
    pub fn counts(&self) -> Counts {
        self.path.counts()
    }

    /// Number of values on their way.
    pub fn waiting(&self) -> usize {
        self.on_their_way.len()
    }

    /// Sends a value of `bytes` of UDP payload at `now_ns`. Returns its fate.
    pub fn send(&mut self, now_ns: u64, value: T, bytes: usize) -> Fate {
        let fate = self.path.send(now_ns, bytes);
        if let Fate::Arrives { at_ns, again_ns } = fate {
            if let Some(again_ns) = again_ns {
                self.put(again_ns, value.clone());
            }
            self.put(at_ns, value);
        }
        fate
    }

    /// Next value that has arrived by `now_ns`.
    pub fn receive(&mut self, now_ns: u64) -> Option<T> {
        if self.next_ns()? > now_ns {
            return None;
        }
        self.on_their_way.pop().map(|Reverse(next)| next.value)
    }

    /// Time of the next arrival. `None`: nothing is on its way.
    pub fn next_ns(&self) -> Option<u64> {
        self.on_their_way.peek().map(|Reverse(next)| next.at_ns)
    }

    fn put(&mut self, at_ns: u64, value: T) {
        self.on_their_way.push(Reverse(OnItsWay {
            at_ns,
            number: self.number,
            value,
        }));
        self.number += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Conditions;
    use std::time::Duration;

    #[test]
    fn values_arrive_in_the_order_of_their_times() {
        let conditions = Conditions {
            delay: Duration::from_millis(5),
            jitter: Duration::from_millis(4),
            loss: 0.1,
            duplicate: 0.1,
            ..Conditions::default()
        };
        let mut wire = Wire::new(Path::new(conditions, 1));
        let mut came = Vec::new();
        for k in 0..1000_u64 {
            let now = k * 1_000_000;
            wire.send(now, k, 100);
            while let Some(value) = wire.receive(now) {
                assert!(now >= value * 1_000_000 + 1_000_000, "{value} at {now}");
                came.push(value);
            }
        }
        while let Some(value) = wire.receive(u64::MAX) {
            came.push(value);
        }
        let counts = wire.counts();
        assert_eq!(came.len() as u64, counts.arrived + counts.duplicated);
        assert_eq!(counts.arrived + counts.lost, 1000);
        assert_eq!(wire.next_ns(), None);
    }

    #[test]
    fn values_of_the_same_time_keep_their_order() {
        let mut wire = Wire::new(Path::new(Conditions::default(), 1));
        for k in 0..10 {
            wire.send(0, k, 1);
        }
        let came: Vec<i32> = std::iter::from_fn(|| wire.receive(0)).collect();
        assert_eq!(came, (0..10).collect::<Vec<_>>());
    }
}
