//! Gaps of the connection: ticks in which the student could not hold a tool, through no fault of the student.
//!
//! A gap of a held tool begins when the student is detached, when the tool's pose is stale, or when the clock's grid
//! has a hole. A hole is longer than a pose may be old. The gap ends when the tool is back in the hand and the graphic
//! tool has met the haptic one: the first converged tick without a limited force. Until then the graphic tool is on
//! its way, and its forces are not those of the hand. Behind a gap the wrench ramps up, and the hand feels less than
//! the tick's force: the tool is then settling.
//!
//! A tool that no hand held before the gap has no gap. A tool that a student puts down is absent by choice.

use sulcus_core::output::status;
use sulcus_core::{MAX_TOOLS, Scene, TickOutput};

/// Longest hole in the clock's grid that is no gap, seconds: the timeout of poses.
pub const HOLE_S: f64 = 0.05;
/// Longest time on the way to the hand, seconds. A tool that has not met its hand by then counts again. Chosen: four
/// times the ramp of the wrench behind a gap.
pub const LONGEST_WAY_S: f64 = 2.0;

/// Presence of a hand at its tool in a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Presence {
    /// No gap: a hand holds the tool, or the student has put the tool down.
    #[default]
    Here,
    /// Behind a gap, while the wrench ramps up. The hand feels less than the force of the tick.
    Settling,
    /// In a gap, or on the way to the hand.
    Away,
}

/// State of one tool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Hand {
    presence: Presence,
    /// Whether a hand held the tool in the last tick outside of gaps.
    held: bool,
    /// Number of that tick.
    last: u64,
    /// Tick in which the tool came back; `None` while the student is gone.
    back: Option<u64>,
    /// Length of the gap that has ended with this tick, ticks of the grid.
    returned: Option<u64>,
}

/// Gaps of all tools.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Away {
    /// Whether gaps are ignored, as for a recording that marks none.
    ignored: bool,
    detached: bool,
    hands: [Hand; MAX_TOOLS],
    /// Number of the last tick.
    last: Option<u64>,
    /// Tick in which the first tool met its hand after the gap.
    met: Option<u64>,
}

impl Away {
    /// Ignores all gaps from now on.
    pub fn ignore(&mut self) {
        self.ignored = true;
    }

    /// Sets whether the student is detached in the next ticks.
    pub fn set_detached(&mut self, detached: bool) {
        self.detached = detached;
    }

    /// Begins a gap of every held tool, as by the end of a recording that another one continues.
    pub fn cut(&mut self) {
        for hand in self.hands.iter_mut().filter(|hand| hand.held) {
            hand.presence = Presence::Away;
            hand.back = None;
        }
        self.met = None;
    }

    /// Takes in a tick.
    pub fn observe(&mut self, scene: &Scene, output: &TickOutput) {
        let (tick, tick_s) = (output.tick, scene.tick_s());
        let since = |from: u64| tick.saturating_sub(from) as f64 * tick_s;
        let hole = self
            .last
            .replace(tick)
            .is_some_and(|last| since(last) > HOLE_S + 0.5 * tick_s);
        if self.ignored {
            return;
        }
        let waited = self.met.is_some_and(|met| since(met) > LONGEST_WAY_S);
        let mut met = None;
        for (hand, tool) in self
            .hands
            .iter_mut()
            .zip(&output.tools)
            .take(scene.tools.len())
        {
            let held = tool.status & status::ABSENT == 0;
            let gone = self.detached || (held && tool.status & status::STALE != 0);
            let ramps = tool.status & status::RAMPING != 0;
            hand.returned = None;
            if hand.presence != Presence::Away {
                if hand.held && (gone || (hole && held)) {
                    hand.presence = Presence::Away;
                    hand.back = None;
                } else {
                    if !ramps || !held {
                        hand.presence = Presence::Here;
                    }
                    (hand.last, hand.held) = (tick, held);
                    continue;
                }
            }
            if gone || !held {
                hand.back = None;
                // The other tool is in use again, and this one stays down.
                if !gone && waited {
                    hand.returned = Some(tick.saturating_sub(hand.last + 1));
                    *hand = Hand {
                        presence: Presence::Here,
                        last: tick,
                        held: false,
                        ..*hand
                    };
                }
                continue;
            }
            let back = *hand.back.get_or_insert(tick);
            let on_its_way = status::SETTLING | status::EXHAUSTED;
            let there = tool.converged && tool.status & on_its_way == 0;
            if there || since(back) > LONGEST_WAY_S {
                hand.returned = Some(tick.saturating_sub(hand.last + 1));
                hand.presence = if ramps {
                    Presence::Settling
                } else {
                    Presence::Here
                };
                (hand.last, hand.back) = (tick, None);
                met = Some(tick);
            }
        }
        self.met = if self.any() { self.met.or(met) } else { None };
    }

    /// Presence at the tool in a slot in the last tick.
    pub fn of(&self, tool: usize) -> Presence {
        self.hands
            .get(tool)
            .map_or(Presence::Here, |hand| hand.presence)
    }

    /// Length of the tool's gap that has ended with the last tick, ticks of the grid; `None` in all other ticks.
    pub fn returned(&self, tool: usize) -> Option<u64> {
        self.hands.get(tool)?.returned
    }

    /// Whether any tool is away.
    pub fn any(&self) -> bool {
        self.hands
            .iter()
            .any(|hand| hand.presence == Presence::Away)
    }

    /// Whether the student is away: detached, or every held tool is away.
    pub fn is_whole(&self) -> bool {
        let detached = self.detached && !self.ignored;
        let mut hands = self.hands.iter();
        detached || (self.any() && hands.all(|hand| hand.presence == Presence::Away || !hand.held))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grade::test_help::empty_scene;
    use sulcus_core::{Pose, ToolOutput};

    /// Gaps of a scene with two tools, and the number of the last tick.
    struct Bench {
        away: Away,
        scene: Scene,
        tick: u64,
    }

    impl Bench {
        fn new() -> Self {
            let scene = empty_scene();
            assert_eq!(scene.tools.len(), 2);
            Self {
                away: Away::default(),
                scene,
                tick: 0,
            }
        }

        /// Presences after `ticks` ticks in which both tools have these bits and are converged or not.
        fn run(&mut self, ticks: u64, bits: [u16; 2], converged: bool) -> [Presence; 2] {
            for _ in 0..ticks {
                self.tick += 1;
                let tools = bits.map(|status| ToolOutput {
                    status,
                    converged,
                    ..ToolOutput::absent(Pose::identity())
                });
                let output = TickOutput {
                    tick: self.tick,
                    work: 0,
                    hash: 0,
                    tools,
                };
                self.away.observe(&self.scene, &output);
            }
            [self.away.of(0), self.away.of(1)]
        }
    }

    use Presence::{Away as Gone, Here, Settling};
    const ABSENT: u16 = status::ABSENT;
    const RAMPS: u16 = status::RAMPING;

    #[test]
    fn a_gap_lasts_until_the_graphic_tool_has_met_the_haptic_one() {
        let mut bench = Bench::new();
        assert_eq!(bench.run(10, [0, ABSENT], true), [Here; 2]);
        bench.away.set_detached(true);
        assert_eq!(bench.run(5, [ABSENT; 2], true), [Gone, Here]);
        assert!(bench.away.is_whole());
        bench.away.set_detached(false);
        // Attached, and the tool is not in the hand yet.
        assert_eq!(bench.run(7, [ABSENT; 2], true), [Gone, Here]);
        assert_eq!(bench.run(2, [RAMPS, ABSENT], false), [Gone, Here]);
        let settles = RAMPS | status::SETTLING;
        assert_eq!(bench.run(1, [settles, ABSENT], true), [Gone, Here]);
        assert!(bench.away.is_whole() && bench.away.returned(0).is_none());
        assert_eq!(bench.run(1, [RAMPS, ABSENT], true), [Settling, Here]);
        assert_eq!(bench.away.returned(0), Some(5 + 7 + 2 + 1));
        assert!(!bench.away.any() && !bench.away.is_whole());
        assert_eq!(bench.run(3, [RAMPS, ABSENT], true), [Settling, Here]);
        assert_eq!(bench.away.returned(0), None);
        assert_eq!(bench.run(1, [0, ABSENT], true), [Here; 2]);
        // A later ramp is no part of the gap, and a tool that is put down is absent by choice.
        assert_eq!(bench.run(1, [RAMPS, ABSENT], true), [Here; 2]);
        assert_eq!(bench.run(9, [ABSENT; 2], true), [Here; 2]);
    }

    #[test]
    fn a_stale_pose_and_a_hole_in_the_grid_are_gaps_and_a_late_tick_is_none() {
        let mut bench = Bench::new();
        bench.run(10, [0; 2], true);
        assert_eq!(bench.run(30, [status::STALE, 0], true), [Gone, Here]);
        assert!(!bench.away.is_whole());
        assert_eq!(bench.run(1, [0; 2], true), [Here; 2]);
        assert_eq!(bench.away.returned(0), Some(30));
        bench.tick += 49;
        assert_eq!(bench.run(1, [0; 2], false), [Here; 2]);
        bench.tick += 50;
        assert_eq!(bench.run(1, [0; 2], false), [Gone; 2]);
        assert_eq!(bench.run(1, [0; 2], true), [Here; 2]);
        assert_eq!(bench.away.returned(1), Some(51));
    }

    /// A suspended process counts at most 65,535 skipped ticks at once, and goes on counting in the next tick.
    #[test]
    fn a_suspension_of_minutes_is_one_gap_of_its_whole_length() {
        let mut bench = Bench::new();
        bench.run(10, [0; 2], true);
        let stale = [status::STALE; 2];
        for skipped in [65_535, 65_535, 48_930] {
            bench.tick += skipped;
            assert_eq!(bench.run(1, stale, true), [Gone; 2]);
        }
        assert_eq!(bench.run(1, [0; 2], true), [Here; 2]);
        assert_eq!(bench.away.returned(0), Some(180_003));
    }

    #[test]
    fn a_tool_that_stays_down_after_a_gap_or_never_converges_counts_again() {
        let mut bench = Bench::new();
        bench.run(10, [0; 2], true);
        bench.away.set_detached(true);
        bench.run(10, [ABSENT; 2], true);
        bench.away.set_detached(false);
        assert_eq!(bench.run(5000, [ABSENT; 2], true), [Gone; 2]);
        assert_eq!(bench.run(2001, [0, ABSENT], true), [Here, Gone]);
        assert_eq!(bench.run(1, [0, ABSENT], true), [Here; 2]);
        // A hand that never lets the tool catch up gains two seconds.
        bench.run(1, [status::STALE, ABSENT], true);
        assert_eq!(bench.run(2001, [0, ABSENT], false), [Gone, Here]);
        assert_eq!(bench.run(1, [0, ABSENT], false), [Here; 2]);
    }

    #[test]
    fn gaps_of_a_recording_that_marks_none_are_ignored() {
        let mut bench = Bench::new();
        bench.away.ignore();
        bench.run(10, [0; 2], true);
        bench.away.set_detached(true);
        assert_eq!(bench.run(10, [status::STALE; 2], false), [Here; 2]);
        assert!(!bench.away.is_whole() && !bench.away.any());
    }

    #[test]
    fn the_end_of_a_part_is_a_gap_of_what_was_held() {
        let mut bench = Bench::new();
        bench.run(10, [0, ABSENT], true);
        bench.away.cut();
        bench.tick = 1000;
        assert_eq!(bench.run(400, [ABSENT; 2], true), [Gone, Here]);
        assert!(bench.away.is_whole());
        assert_eq!(bench.run(1, [0, ABSENT], true), [Here; 2]);
        assert_eq!(bench.away.returned(0), Some(1390));
    }
}
