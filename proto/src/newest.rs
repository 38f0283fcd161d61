//! Newest wins: of packets that may be lost, doubled and reordered, only one newer than all before
//! is used. The rest is counted.

/// What becomes of one packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// Newer than all before: use it.
    Newest,
    /// Older than the newest, not seen before: drop it.
    Late,
    /// Seen before: drop it.
    Duplicate,
}

/// Filter over sequence numbers that wrap at 2^32.
///
/// A number up to 2^31 - 1 ahead of the newest is newer, all others are older. Duplicates are told
/// from late packets among the newest 128 (what QUIC itself deduplicates); older ones count as late.
#[derive(Clone, Debug, Default)]
pub struct NewestWins {
    /// Newest sequence, and which of the 127 before it were seen (bit k: newest - k).
    newest: Option<(u32, u128)>,
    /// From the first packet to the newest: what is older than the first was never missed.
    span: u64,
    counts: ArrivalCounts,
}

/// How packets fared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct ArrivalCounts {
    /// Used.
    pub accepted: u64,
    /// Arrived after a newer one and dropped.
    pub late: u64,
    /// Arrived again and dropped.
    pub duplicate: u64,
    /// Never arrived (as far as is known now: a late one is taken off again).
    pub lost: u64,
}

impl NewestWins {
    /// Nothing has arrived.
    pub fn new() -> Self {
        Self::default()
    }

    /// Judges one packet and counts it.
    pub fn judge(&mut self, sequence: u32) -> Arrival {
        let Some((newest, seen)) = self.newest else {
            self.newest = Some((sequence, 1));
            self.counts.accepted += 1;
            return Arrival::Newest;
        };
        let ahead = sequence.wrapping_sub(newest);
        if ahead == 0 {
            self.counts.duplicate += 1;
            return Arrival::Duplicate;
        }
        if ahead < 1 << 31 {
            let shifted = seen.checked_shl(ahead).unwrap_or(0);
            self.newest = Some((sequence, shifted | 1));
            self.counts.accepted += 1;
            self.counts.lost += u64::from(ahead - 1);
            self.span += u64::from(ahead);
            return Arrival::Newest;
        }
        let behind = newest.wrapping_sub(sequence);
        match 1u128.checked_shl(behind) {
            Some(bit) if seen & bit != 0 => {
                self.counts.duplicate += 1;
                return Arrival::Duplicate;
            }
            Some(bit) => self.newest = Some((newest, seen | bit)),
            None => {}
        }
        self.counts.late += 1;
        if u64::from(behind) < self.span {
            self.counts.lost = self.counts.lost.saturating_sub(1);
        }
        Arrival::Late
    }

    /// Forgets the newest (a new session epoch); keeps the counts.
    pub fn restart(&mut self) {
        self.newest = None;
        self.span = 0;
    }

    /// How packets have fared so far.
    pub fn counts(&self) -> ArrivalCounts {
        self.counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn each_kind_is_counted_once() {
        let mut filter = NewestWins::new();
        let fates: Vec<_> = [10, 11, 11, 14, 12, 12, 10, 15]
            .map(|s| filter.judge(s))
            .into();
        use Arrival::{Duplicate, Late, Newest};
        assert_eq!(
            fates,
            [
                Newest, Newest, Duplicate, Newest, Late, Duplicate, Duplicate, Newest
            ]
        );
        assert_eq!(
            filter.judge(9),
            Late,
            "from before the first: never counted as lost"
        );
        assert_eq!(
            filter.counts(),
            ArrivalCounts {
                accepted: 4,
                late: 2,
                duplicate: 3,
                lost: 1
            }
        );
    }

    #[test]
    fn order_survives_the_wrap() {
        let mut filter = NewestWins::new();
        for sequence in [u32::MAX - 1, u32::MAX, 0, 1] {
            assert_eq!(filter.judge(sequence), Arrival::Newest);
        }
        assert_eq!(filter.judge(u32::MAX), Arrival::Duplicate);
        assert_eq!(filter.counts().lost, 0);
    }

    #[test]
    fn a_restart_takes_any_sequence() {
        let mut filter = NewestWins::new();
        filter.judge(1000);
        filter.restart();
        assert_eq!(filter.judge(3), Arrival::Newest);
        assert_eq!(filter.counts().lost, 0);
    }

    proptest! {
        /// Any shuffle with doubles of a run of packets: used packets rise, and every packet is
        /// accounted for.
        #[test]
        fn every_packet_is_accounted_for(
            start in any::<u32>(),
            offsets in proptest::collection::vec(0u32..120, 1..200),
        ) {
            let mut filter = NewestWins::new();
            let mut last = None;
            for offset in &offsets {
                if filter.judge(start.wrapping_add(*offset)) == Arrival::Newest {
                    prop_assert!(last.is_none_or(|last| offset > last));
                    last = Some(offset);
                }
            }
            let counts = filter.counts();
            prop_assert_eq!(counts.accepted + counts.late + counts.duplicate, offsets.len() as u64);
            let mut distinct = offsets.clone();
            distinct.sort_unstable();
            distinct.dedup();
            prop_assert_eq!(counts.accepted + counts.late, distinct.len() as u64);
            let known = distinct.iter().filter(|offset| **offset >= offsets[0]).count() as u64;
            prop_assert_eq!(counts.lost + known, u64::from(distinct[distinct.len() - 1] - offsets[0]) + 1);
        }

        #[test]
        fn no_sequence_panics(sequences in proptest::collection::vec(any::<u32>(), 0..100)) {
            let mut filter = NewestWins::new();
            for sequence in sequences {
                filter.judge(sequence);
            }
        }
    }
}
