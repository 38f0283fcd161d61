//! Live poses, which bind the inputs of their ticks before the rows arrive.
//!
//! A row that comes late could be chosen with hindsight. It is accepted if enough live poses of its second came in time
//! and agree with their rows, or if its second lies in an outage that the server saw.

use std::collections::VecDeque;
use std::hash::{DefaultHasher, Hasher};

use sulcus_core::{RawPose, TickInput};

/// Number of live poses of a second that bind late rows of the second, of 50 sent.
const BIND: u32 = 10;
/// Largest number of live poses and of outages that wait for their rows: more than half an hour of poses.
const MOST: usize = 100_000;

/// Live poses that wait for their rows.
#[derive(Debug)]
pub(super) struct LivePoses {
    /// Ticks of a second.
    second: u64,
    newest: u64,
    /// Tick and hash of the input's poses, oldest first.
    waiting: VecDeque<(u64, u64)>,
    /// Number of live poses in the seconds from `first_second` on.
    counts: VecDeque<u32>,
    first_second: u64,
    /// First and last tick of each outage, oldest first.
    outages: VecDeque<(u64, u64)>,
    /// Last tick of the ended motion.
    last: Option<u64>,
}

impl LivePoses {
    pub fn new(tick_ns: u64) -> Self {
        Self {
            second: (1_000_000_000 / tick_ns).max(1),
            newest: 0,
            waiting: VecDeque::new(),
            counts: VecDeque::new(),
            first_second: 0,
            outages: VecDeque::new(),
            last: None,
        }
    }

    /// Newest tick of a live pose.
    pub fn newest(&self) -> u64 {
        self.newest
    }

    /// Takes a live pose, if it is newer than all before.
    pub fn take(&mut self, tick: u64, input: &TickInput) {
        if tick <= self.newest {
            return;
        }
        self.newest = tick;
        if self.waiting.len() == MOST {
            self.waiting.pop_front();
        }
        self.waiting.push_back((tick, digest(input)));
        let place = (tick / self.second).saturating_sub(self.first_second);
        let place = usize::try_from(place).unwrap_or(usize::MAX);
        // The lead of the ticks bounds the number of seconds.
        if place < MOST {
            if self.counts.len() <= place {
                self.counts.resize(place + 1, 0);
            }
            self.counts[place] += 1;
        }
    }

    /// Takes an outage between two ticks.
    pub fn outage(&mut self, first: u64, last: u64) {
        if self.outages.len() == MOST {
            self.outages.pop_front();
        }
        self.outages.push_back((first, last));
    }

    /// The motion has ended with `tick`. Its last second needs live poses in proportion only.
    pub fn last(&mut self, tick: u64) {
        self.last = Some(tick);
    }

    /// Number of live poses that bind the rows of a second.
    fn needed(&self, second: u64) -> u32 {
        let ticks = self.last.map_or(self.second, |last| {
            (last + 1).saturating_sub(second * self.second)
        });
        (u64::from(BIND) * ticks.min(self.second) / self.second) as u32
    }

    /// Checks the row of a tick.
    ///
    /// # Errors
    /// The row differs from the live pose of its tick, or comes late and nothing binds it.
    pub fn row(&mut self, tick: u64, input: &TickInput, is_late: bool) -> Result<(), String> {
        while self.waiting.pop_front_if(|(of, _)| *of < tick).is_some() {}
        let live = self.waiting.pop_front_if(|(of, _)| *of == tick);
        if live.is_some_and(|(_, live)| live != digest(input)) {
            return Err("the input differs from the live pose of its tick".to_owned());
        }
        let second = tick / self.second;
        // A second of margin on both sides: the clock of the ticks is known to some milliseconds only.
        let margin = self.second;
        while self
            .outages
            .front()
            .is_some_and(|(_, last)| last + margin < tick)
        {
            self.outages.pop_front();
        }
        while self.first_second < second {
            self.counts.pop_front();
            self.first_second += 1;
            if self.counts.is_empty() {
                self.first_second = second;
            }
        }
        let bound = self.counts.front().copied().unwrap_or(0) >= self.needed(second);
        let in_outage = || {
            let mut outages = self.outages.iter();
            outages
                .any(|(first, last)| first.saturating_sub(margin) <= tick && tick <= last + margin)
        };
        if is_late && !bound && !in_outage() {
            return Err(
                "the inputs come late, and no live poses have bound them in time".to_owned(),
            );
        }
        Ok(())
    }
}

/// Hash of the poses of present tools.
fn digest(input: &TickInput) -> u64 {
    let mut hash = DefaultHasher::new();
    for tool in &input.tools {
        let RawPose {
            position: [x, y, z],
            orientation: [w, i, j, k],
        } = tool.pose;
        hash.write_u8(u8::from(tool.present));
        if tool.present {
            for x in [x, y, z, w, i, j, k] {
                hash.write_u32(x.to_bits());
            }
        }
    }
    hash.finish()
}
