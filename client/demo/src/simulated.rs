//! Simulated operator as a device.

use sulcus_connection::device::{DeviceEvent, EventDevice};
use sulcus_core::{MAX_TOOLS, ToolInput};
use sulcus_haptics::{HandSource, Shown};
use sulcus_operator::Operator;

use crate::calls::{calls, event};

/// Name of the device.
pub const NAME: &str = "simulated";

/// Device whose hands are those of a simulated operator.
pub struct Simulated {
    /// Operator that performs the exercise.
    pub operator: Operator,
    /// Whether the session ends with the operator's last task. Otherwise the time limit ends it.
    pub until_done: bool,
}

impl HandSource for Simulated {
    fn name(&self) -> &str {
        NAME
    }
    fn exchange(&mut self, shown: &Shown) -> [ToolInput; MAX_TOOLS] {
        self.operator.step(shown)
    }
    fn is_done(&self) -> bool {
        self.until_done && self.operator.is_done()
    }
}

impl EventDevice for Simulated {
    fn events(&mut self) -> Vec<DeviceEvent> {
        calls(&mut self.operator).iter().map(event).collect()
    }
}
