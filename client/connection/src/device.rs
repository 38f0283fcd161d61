//! Device whose user makes events for the recording.

use sulcus_haptics::Device;

/// Event of a device's user, for the recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceEvent {
    /// Kind, as in [`sulcus_proto::control::Event::kind`].
    pub kind: &'static str,
    /// Content as JSON.
    pub json: String,
}

/// Device whose user makes events, for example calls of probing depths.
pub trait EventDevice: Device {
    /// Returns the events since the previous call of this function. The default returns none.
    fn events(&mut self) -> Vec<DeviceEvent> {
        Vec::new()
    }
}
