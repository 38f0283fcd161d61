//! Scripts: target poses of the hands over time.

use sulcus_core::tissue::gingiva::Site;
use sulcus_core::{MAX_TOOLS, Pose};
use sulcus_haptics::Shown;

/// Findings that the operator calls for a site.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Call {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Site of the tooth.
    pub site: Site,
    /// Probing depth, whole millimetres.
    pub depth_mm: u8,
    /// Distance of the margin below the cemento-enamel junction, whole millimetres; negative above the junction.
    pub recession_mm: i8,
    /// Whether the site bleeds.
    pub bleeding: bool,
}

/// Perception of an operator in one period of the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Felt {
    /// Wrenches and graphic poses of the simulation.
    pub shown: Shown,
    /// Device poses of the hands (`world_from_tool`); `None` for a tool without a hand.
    pub hands: [Option<Pose>; MAX_TOOLS],
}

/// A script: target poses as a function of time and, for some scripts, of the perception.
pub trait Script {
    /// Takes the perception, once per period of the device and before [`Script::targets`]. The default ignores it.
    fn feel(&mut self, felt: &Felt) {
        let _ = felt;
    }
    /// Target device poses (`world_from_tool`) at `t` seconds; `None` for a tool without a hand.
    fn targets(&self, t: f64) -> [Option<Pose>; MAX_TOOLS];
    /// Length, seconds; for a script that depends on the perception, the largest length.
    fn duration_s(&self) -> f64;
    /// Calls since the previous call of this function. The default returns none.
    fn calls(&mut self) -> Vec<Call> {
        Vec::new()
    }
    /// Whether all tasks are finished before [`Script::duration_s`]. The default is `false`.
    fn is_done(&self) -> bool {
        false
    }
}

/// A script from a closure for the first tool, for tests and hard cases.
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

/// Cubic step from 0 at `x <= 0` to 1 at `x >= 1`, with zero slope at both ends.
pub fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
