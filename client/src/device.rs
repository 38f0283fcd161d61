//! What a haptic device is to the client: once per millisecond it takes what the simulation shows and gives poses.

use sulcus_core::{MAX_TOOLS, ToolInput};
use sulcus_operator::{Operator, Shown};
use sulcus_sessions::exercise::events::call::Call;

use crate::calls::calls;

/// A device for up to two hands. Poses are `world_from_tool` at the device points; wrenches are about
/// those points in world axes.
pub trait Device: Send {
    /// Name, for the server's log and the recording.
    fn name(&self) -> &str;
    /// Displays the wrenches for one millisecond, then reads where the hands are. (The graphic poses are what the person at
    /// the device sees.)
    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS];
    /// Depths that were called since this was asked last. Most devices hear nothing.
    fn calls(&mut self) -> Vec<Call> {
        Vec::new()
    }
    /// Whether the person at the device has nothing left to do. Most devices never know.
    fn is_done(&self) -> bool {
        false
    }
}

/// The simulated operator as a device.
pub struct Simulated {
    /// Who performs.
    pub operator: Operator,
    /// Whether it ends when there is nothing left to do, or when its time is up.
    pub until_done: bool,
}

impl Device for Simulated {
    fn name(&self) -> &str {
        "simulated"
    }
    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        self.operator.step(shown)
    }
    fn calls(&mut self) -> Vec<Call> {
        calls(&mut self.operator)
    }
    fn is_done(&self) -> bool {
        self.until_done && self.operator.is_done()
    }
}
