//! Gaps of the connection as events of a recording: the first tick without the student, and the first one with the
//! student again.

use std::sync::atomic::Ordering;

use sulcus_sessions::Occurrence;

use crate::session::handoff::Attachment;

/// Finds the ends of gaps from tick to tick.
#[derive(Debug, Default)]
pub(crate) struct Gaps {
    /// First tick of the open gap.
    from: Option<u64>,
}

impl Gaps {
    /// Event of a tick; `None` in nearly all ticks. `gone`: the tick ran without the student.
    pub fn take(&mut self, tick: u64, gone: bool, attachment: &Attachment) -> Option<Occurrence> {
        match (self.from, gone) {
            (None, true) => {
                self.from = Some(tick);
                Some(Occurrence::detached(tick, attachment.reason()))
            }
            (Some(from), false) => {
                self.from = None;
                let epoch = attachment.epoch.load(Ordering::Acquire);
                let ticks = tick.saturating_sub(from);
                Some(Occurrence::attached(tick, epoch, ticks))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use sulcus_sessions::Detached;

    use super::*;

    #[test]
    fn a_gap_has_two_events_with_its_length() {
        let attachment = Attachment::default();
        let mut gaps = Gaps::default();
        assert_eq!(gaps.take(1, false, &attachment), None);
        attachment.gone(Detached::Closed);
        let event = gaps.take(5, true, &attachment).expect("gone");
        assert_eq!((event.kind.as_str(), event.tick), ("detached", 5));
        assert_eq!(event.data["reason"], "closed");
        assert_eq!(gaps.take(6, true, &attachment), None);
        attachment.epoch.store(7, Ordering::Release);
        let event = gaps.take(105, false, &attachment).expect("back");
        assert_eq!((event.kind.as_str(), event.tick), ("attached", 105));
        assert_eq!(
            (&event.data["epoch"], &event.data["gap_ticks"]),
            (&7.into(), &100.into())
        );
    }
}
