//! Where a hand means to be over time.

use sulcus_core::{MAX_TOOLS, Pose, Wrench};

/// A scripted intention: a function of time, and, where a script goes by what it feels, of that.
pub trait Script {
    /// Takes in, once per millisecond and before [`Script::targets`], what the hands feel (wrenches about the
    /// device points, world axes) and where they are (device poses; `None` where no hand holds the tool).
    /// Most scripts do not care.
    fn feel(&mut self, felt: &[Wrench; MAX_TOOLS], hands: &[Option<Pose>; MAX_TOOLS]) {
        let _ = (felt, hands);
    }
    /// Device poses (`world_from_tool`) that the hands mean to reach at `t` seconds; `None` where no
    /// hand holds the tool.
    fn targets(&self, t: f64) -> [Option<Pose>; MAX_TOOLS];
    /// Length, seconds.
    fn duration_s(&self) -> f64;
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

/// Two scripts at once, one for each hand: where both have a target for a tool, the first one's counts. As long as the
/// longer one.
pub struct Both<A, B>(pub A, pub B);

impl<A: Script, B: Script> Script for Both<A, B> {
    fn feel(&mut self, felt: &[Wrench; MAX_TOOLS], hands: &[Option<Pose>; MAX_TOOLS]) {
        self.0.feel(felt, hands);
        self.1.feel(felt, hands);
    }
    fn targets(&self, t: f64) -> [Option<Pose>; MAX_TOOLS] {
        let (first, second) = (self.0.targets(t), self.1.targets(t));
        std::array::from_fn(|slot| first[slot].or(second[slot]))
    }
    fn duration_s(&self) -> f64 {
        self.0.duration_s().max(self.1.duration_s())
    }
}

/// 0 below 0, 1 above 1, smooth (zero slope at both ends) between.
pub fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
