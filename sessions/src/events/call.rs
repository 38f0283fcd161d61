//! Depths that a student calls: what a client says, logged as it is, and read with suspicion afterwards.

use serde_json::{Value, json};
use sulcus_core::Scene;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::Site;

use crate::occurrence::Occurrence;

/// Name of the event.
pub const READING_CALLED: &str = "reading_called";
/// Deepest that can be called, mm.
const MOST_MM: u64 = 20;

/// A depth that was called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Call {
    /// FDI number.
    pub tooth: u8,
    /// Where.
    pub site: Site,
    /// Whole millimetres.
    pub depth_mm: u8,
}

/// Why data is not a call.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field} is {found}, expected {expected}")]
pub struct CallError {
    /// Key.
    pub field: &'static str,
    /// Value found.
    pub found: String,
    /// What it must be.
    pub expected: String,
}

impl Call {
    /// The event's data.
    pub fn data(&self) -> Value {
        json!({ "tooth": self.tooth, "site": self.site.name(), "depth_mm": self.depth_mm })
    }

    /// The call as it stands in a session's log.
    pub fn at(&self, tick: u64) -> Occurrence {
        Occurrence {
            kind: READING_CALLED.into(),
            tick,
            data: self.data(),
        }
    }

    /// The call in an event's data, about a tooth of the scene.
    ///
    /// # Errors
    /// Names the key, the value found and what is expected.
    pub fn read(data: &Value, scene: &Scene) -> Result<Self, CallError> {
        let wrong = |field, expected: String| {
            // What a client says may be long.
            let found: String = data[field].to_string().chars().take(80).collect();
            Err(CallError {
                field,
                found,
                expected,
            })
        };
        let has_pocket = |fdi: u8| {
            let pockets = || {
                let gingiva =
                    |o: &&sulcus_core::Object| matches!(o.tissue, TissueModel::Gingiva(_));
                scene.objects.iter().filter(gingiva)
            };
            // A gingiva without a number of its own is its tooth's.
            pockets().any(|object| object.fdi == fdi)
                || pockets().any(|object| object.fdi == 0)
                    && scene.objects.iter().any(|object| object.fdi == fdi)
        };
        let tooth = data["tooth"]
            .as_u64()
            .and_then(|fdi| u8::try_from(fdi).ok());
        let Some(tooth) = tooth.filter(|fdi| *fdi != 0 && has_pocket(*fdi)) else {
            return wrong(
                "tooth",
                "the FDI number of a tooth that has gingiva here".into(),
            );
        };
        let Some(site) = data["site"].as_str().and_then(Site::from_name) else {
            return wrong(
                "site",
                format!("one of: {}", Site::ALL.map(Site::name).join(", ")),
            );
        };
        let depth = data["depth_mm"].as_u64().filter(|mm| *mm <= MOST_MM);
        let Some(depth_mm) = depth.and_then(|mm| u8::try_from(mm).ok()) else {
            return wrong("depth_mm", format!("0 to {MOST_MM}, whole millimetres"));
        };
        Ok(Self {
            tooth,
            site,
            depth_mm,
        })
    }

    /// Depth that is prescribed there, metres.
    pub fn truth(&self, scene: &Scene) -> Option<f64> {
        let pockets = super::pocket::all(scene);
        let pocket = pockets.iter().find(|pocket| pocket.fdi == self.tooth)?;
        Some(pocket.gingiva(scene)?.prescribed(self.site).depth)
    }
}
