//! Where a hand means to be over time.

use sulcus_core::tissue::gingiva::Site;
use sulcus_core::{MAX_TOOLS, Pose};
use sulcus_haptics::Shown;

/// What the operator says aloud of a site.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Call {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Which of its sites.
    pub site: Site,
    /// Depth, whole millimetres.
    pub depth_mm: u8,
    /// How far the margin is seen below the cemento-enamel junction, whole millimetres; negative above it.
    pub recession_mm: i8,
    /// Whether it is seen to bleed.
    pub bleeding: bool,
}

/// What an operator perceives in one millisecond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Felt {
    /// What the simulation shows.
    pub shown: Shown,
    /// Where the hands are (device poses); `None` where no hand holds the tool.
    pub hands: [Option<Pose>; MAX_TOOLS],
}

/// A scripted intention: a function of time, and, where a script goes by what it feels, of that.
pub trait Script {
    /// Takes in, once per millisecond and before [`Script::targets`], what the operator perceives. Most scripts do not
    /// care.
    fn feel(&mut self, felt: &Felt) {
        let _ = felt;
    }
    /// Device poses (`world_from_tool`) that the hands mean to reach at `t` seconds; `None` where no
    /// hand holds the tool.
    fn targets(&self, t: f64) -> [Option<Pose>; MAX_TOOLS];
    /// Length, seconds; for a script that goes by what it feels the most that it takes.
    fn duration_s(&self) -> f64;
    /// The depths called since this was last asked.
    fn calls(&mut self) -> Vec<Call> {
        Vec::new()
    }
    /// Whether there is nothing left to do before [`Script::duration_s`].
    fn is_done(&self) -> bool {
        false
    }
}

/// A script from a closure for the first tool: what tests and hard cases want.
pub struct OneTool<F> {
    /// Pose at `t` seconds.
    pub pose: F,
    /// Length, seconds.
    pub duration_s: f64,
}

impl<F: Fn(f64) -> Pose> Script for OneTool<F> {
    fn targets(&self, t: f64) -> [Option<Pose>; MAX_TOOLS] {
        [Some((self.pose)(t)), None]
    }
    fn duration_s(&self) -> f64 {
        self.duration_s
    }
}

/// A script from a closure for both tools.
pub struct TwoTools<F> {
    /// Poses at `t` seconds.
    pub poses: F,
    /// Length, seconds.
    pub duration_s: f64,
}

impl<F: Fn(f64) -> [Option<Pose>; MAX_TOOLS]> Script for TwoTools<F> {
    fn targets(&self, t: f64) -> [Option<Pose>; MAX_TOOLS] {
        (self.poses)(t)
    }
    fn duration_s(&self) -> f64 {
        self.duration_s
    }
}

/// 0 below 0, 1 above 1, smooth (zero slope at both ends) between.
pub fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
