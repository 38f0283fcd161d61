//! Findings that the simulated operator calls, as events for the recording.

use sulcus_connection::device::DeviceEvent;
use sulcus_core::Scene;
use sulcus_operator::Operator;
use sulcus_sessions::exercise::events::call::{Call, READING_CALLED};

/// Calls of the operator since the previous use of this function, none with a furcation.
pub fn calls(operator: &mut Operator) -> Vec<Call> {
    let call = |said: sulcus_operator::Call| Call {
        tooth: said.tooth,
        site: said.site,
        depth_mm: said.depth_mm,
        recession_mm: Some(said.recession_mm),
        bleeding: Some(said.bleeding),
        furcation: None,
    };
    operator.calls().into_iter().map(call).collect()
}

/// Event of a device for a call, with the kind [`READING_CALLED`].
pub fn event(call: &Call) -> DeviceEvent {
    DeviceEvent {
        kind: READING_CALLED,
        json: call.data().to_string(),
    }
}

/// Called depth beside the prescribed depth of the scene.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Called {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Name of the site.
    pub site: &'static str,
    /// Called depth, whole millimetres.
    pub depth_mm: u8,
    /// Prescribed depth, millimetres.
    pub truth_mm: f64,
}

impl Called {
    /// Depth of `call` and the depth that `scene` prescribes; `None` if the tooth has no pocket in the scene.
    pub fn of(call: &Call, scene: &Scene) -> Option<Self> {
        Some(Self {
            tooth: call.tooth,
            site: call.site.name(),
            depth_mm: call.depth_mm,
            truth_mm: call.truth(scene)? * 1e3,
        })
    }
}
