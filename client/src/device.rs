//! Devices of this program: the simulated operator, and the interface of a device whose user calls probing depths.

use sulcus_core::{MAX_TOOLS, ToolInput};
use sulcus_haptics::{Device, Shown};
use sulcus_operator::Operator;
use sulcus_sessions::exercise::events::call::Call;

use crate::calls::calls;

/// A device whose user calls probing depths.
pub trait CallingDevice: Device {
    /// Returns the depths called since the previous call of this function. The default returns none.
    fn calls(&mut self) -> Vec<Call> {
        Vec::new()
    }
}

/// The simulated operator as a device.
pub struct Simulated {
    /// Operator that performs the exercise.
    pub operator: Operator,
    /// Whether the session ends with the operator's last task. Otherwise the time limit ends it.
    pub until_done: bool,
}

impl Device for Simulated {
    fn name(&self) -> &str {
        "simulated"
    }
    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        self.operator.step(shown)
    }
    fn is_done(&self) -> bool {
        self.until_done && self.operator.is_done()
    }
}

impl CallingDevice for Simulated {
    fn calls(&mut self) -> Vec<Call> {
        calls(&mut self.operator)
    }
}
