//! Newest-wins filter for packets that may be lost, duplicated and reordered.
//!
//! Only a packet newer than all earlier packets is used. The filter counts all others.

/// Classification of a packet on arrival.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// Newer than all earlier packets: use the packet.
    Newest,
    /// Older than the newest, not seen before: drop the packet.
    Late,
    /// Seen before: drop the packet.
    Duplicate,
}

/// Filter over sequence numbers that wrap at 2^32.
///
/// A number up to 2^31 - 1 ahead of the newest is newer, all others are older. Duplicates are recognised among the
/// newest 128 sequence numbers, the window of QUIC's own deduplication. An older packet counts as late.
#[derive(Clone, Debug, Default)]
pub struct NewestWins {
    /// Newest sequence number, and a bit mask of the seen ones: bit k stands for newest - k, k from 0 to 127.
    newest: Option<(u32, u128)>,
    /// Distance from the first packet to the newest. Packets older than the first were never counted as lost.
    span: u64,
    counts: ArrivalCounts,
}

/// Numbers of packets by classification.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct ArrivalCounts {
    /// Packets used.
    pub accepted: u64,
    /// Packets dropped because a newer packet had arrived.
    pub late: u64,
    /// Packets dropped because they had already arrived.
    pub duplicate: u64,
    /// Packets missing so far. A late packet is subtracted again.
    pub lost: u64,
}

impl NewestWins {
    /// Creates a filter without any arrival.
    pub fn new() -> Self {
        Self::default()
    }

    /// Classifies and counts a packet by its sequence number.
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

    /// Forgets the newest sequence number, for a new session epoch. The counts remain.
    pub fn restart(&mut self) {
        self.newest = None;
        self.span = 0;
    }

    /// Returns the counts so far.
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
        /// Property for packets in any order, with duplicates and losses.
        ///
        /// Used packets are in ascending order. Used, late and duplicate packets add up to all packets. The number lost
        /// is right.
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
