//! Counts of a feed.

/// Counts of one feed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FeedStats {
    /// Scenes received in full.
    pub scenes: u64,
    /// Scenes taken from the cache.
    pub scenes_cached: u64,
    /// Frames received, late ones included.
    pub frames: u64,
    /// Frames that came after a newer one and are not shown.
    pub late: u64,
    /// Frames that never came whole: numbers that are missing between the first and the newest frame.
    pub lost: u64,
    /// Streams that the server reset because a newer frame was there. Their frames are among the lost ones.
    pub reset: u64,
    /// Frames of another scene, or with numbers that the scene lacks.
    pub foreign: u64,
    /// Streams that hold no message of this protocol version.
    pub malformed: u64,
    /// Numbers of the first and of the newest frame.
    first: Option<u64>,
    newest: u64,
}

impl FeedStats {
    /// Counts a frame with this number. Returns whether it is newer than all before.
    pub(super) fn arrived(&mut self, sequence: u64) -> bool {
        let is_newest = self.first.is_none() || sequence > self.newest;
        let first = self.first.map_or(sequence, |first| first.min(sequence));
        self.first = Some(first);
        self.frames += 1;
        if is_newest {
            self.newest = sequence;
        } else {
            self.late += 1;
        }
        self.lost = (self.newest - first + 1).saturating_sub(self.frames);
        is_newest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_lost_until_a_late_frame_fills_them() {
        let mut stats = FeedStats::default();
        assert!(stats.arrived(100));
        assert!(stats.arrived(104));
        assert_eq!((stats.lost, stats.late), (3, 0));
        assert!(!stats.arrived(102));
        assert_eq!((stats.lost, stats.late, stats.frames), (2, 1, 3));
        assert!(!stats.arrived(99));
        assert_eq!((stats.lost, stats.late), (2, 2));
    }
}
