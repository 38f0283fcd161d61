//! Readings that the operator calls, on their way into the record.

use sulcus_core::Scene;
use sulcus_operator::Operator;
use sulcus_proto::control::Event;
use sulcus_sessions::exercise::events::call::{Call, READING_CALLED};

/// What the operator has called since it was asked last.
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

/// A call as a client's message; `tick` is that of the newest wrench.
pub fn event(call: &Call, tick: u64) -> Event {
    Event {
        tick,
        kind: READING_CALLED.into(),
        json: call.data().to_string(),
    }
}

/// A call against the chart of the scene.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Called {
    /// FDI number.
    pub tooth: u8,
    /// Name of the zone.
    pub site: &'static str,
    /// What was called.
    pub depth_mm: u8,
    /// What is prescribed there.
    pub truth_mm: f64,
}

impl Called {
    /// Of a call; none where the scene prescribes nothing.
    pub fn of(call: &Call, scene: &Scene) -> Option<Self> {
        Some(Self {
            tooth: call.tooth,
            site: call.site.name(),
            depth_mm: call.depth_mm,
            truth_mm: call.truth(scene)? * 1e3,
        })
    }
}
