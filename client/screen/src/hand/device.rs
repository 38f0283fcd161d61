//! Device without force: poses of both tools for each period of a device loop.
//!
//! Order within a period: motion of the hands, targets that stick, smoothing within the guide's bound. The device reads
//! no clock: a period has a fixed length.

use std::sync::Arc;

use sulcus_proto::TOOLS;
use sulcus_proto::datagram::WirePose;

use super::guide::Guide;
use super::hands::Hands;
use super::pose::HandPose;
use super::shared::Shared;
use super::smooth::{Smoother, SmootherRule};
use crate::camera::Vector;
use crate::readings::Entry;

/// Longest motion made up for after periods without the hands, seconds.
const MADE_UP_S: f64 = 0.05;

/// Picture and force of a tool, as a device shows them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Felt {
    /// Newest pose of the graphic tool; `None` before the first picture.
    pub graphic: Option<WirePose>,
    /// Force that a device would display, newtons.
    pub force_n: f64,
}

impl Felt {
    /// Before the first picture.
    pub const NOTHING: Self = Self {
        graphic: None,
        force_n: 0.0,
    };
}

/// Tool of a hand in a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Pose of the device point, `world_from_tool`: metres, quaternion `[w, x, y, z]`.
    pub pose: WirePose,
    /// Whether the hand holds the tool.
    pub present: bool,
}

/// Device of a person with a mouse, keys or a 3D mouse.
///
/// The home of a hand should be the resting place of its tool. A hand away from its graphic tool is carried to it at
/// the speed of the hand.
#[derive(Debug)]
pub struct HandsOnScreen {
    shared: Arc<Shared>,
    period_s: f64,
    slots: [Option<Slot>; TOOLS],
    /// Time without the hands, seconds.
    missed_s: f64,
}

/// Tool of a slot.
#[derive(Clone, Copy, Debug)]
struct Slot {
    guide: Guide,
    pivot: Vector,
    smoother: Smoother,
    /// Pose that the hand asked for last.
    target: HandPose,
    is_held: bool,
}

impl HandsOnScreen {
    /// Device of shared hands for a loop with a period in seconds. A slot without a hand stays empty.
    pub fn new(shared: Arc<Shared>, guides: [Guide; TOOLS], period_s: f64) -> Self {
        let slots = shared.feed(|hands| {
            std::array::from_fn(|k| {
                let hand = hands.hand(k)?;
                let limits = hand.limits();
                let rule = SmootherRule::mouse(limits.speed_mm_s, limits.spin_rad_s);
                Some(Slot {
                    guide: guides[k],
                    pivot: hand.pivot(),
                    smoother: Smoother::new(rule, hand.pivot(), hand.pose()),
                    target: hand.pose(),
                    is_held: hands.is_held(k),
                })
            })
        });
        Self {
            shared,
            period_s,
            slots,
            missed_s: 0.0,
        }
    }

    /// Performs a period, and returns the tools of both hands.
    pub fn period(&mut self, felt: &[Felt; TOOLS]) -> [Held; TOOLS] {
        let graphics = felt.map(|felt| felt.graphic.and_then(|pose| HandPose::of(&pose)));
        self.missed_s = (self.missed_s + self.period_s).min(MADE_UP_S);
        if let Some(mut hands) = self.shared.try_hands() {
            hands.advance(std::mem::take(&mut self.missed_s));
            for (k, slot) in self.slots.iter_mut().enumerate() {
                let Some(slot) = slot else {
                    continue;
                };
                if let Some(graphic) = &graphics[k] {
                    let lead = slot.guide.lead(felt[k].force_n);
                    hands.stick(k, &lead, &slot.smoother.pose(), graphic);
                }
                slot.read(&hands, k);
            }
        }
        std::array::from_fn(|k| {
            let absent = Held {
                pose: WirePose::IDENTITY,
                present: false,
            };
            let slot = self.slots[k].as_mut();
            slot.map_or(absent, |slot| {
                slot.next(graphics[k], felt[k].force_n, self.period_s)
            })
        })
    }

    /// Confirmed findings since the previous call of this function, events of the recording. The call never waits.
    pub fn entries(&mut self) -> Vec<Entry> {
        self.shared.take_entries()
    }
}

impl Slot {
    fn read(&mut self, hands: &Hands, number: usize) {
        self.target = hands.pose(number).unwrap_or(self.target);
        self.is_held = hands.is_held(number);
    }

    fn next(&mut self, graphic: Option<HandPose>, force_n: f64, period_s: f64) -> Held {
        let (lead, pivot) = (self.guide.lead(force_n), self.pivot);
        let allowed =
            |pose: &HandPose| graphic.map_or(*pose, |graphic| lead.limited(pose, &graphic, &pivot));
        let pose = self.smoother.next_within(&self.target, period_s, allowed);
        Held {
            pose: pose.wire(),
            present: self.is_held,
        }
    }
}
