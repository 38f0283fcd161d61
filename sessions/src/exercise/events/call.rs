//! Calls of a student about a site: a depth, and optionally recession, bleeding and furcation. A call comes from a
//! client, so it is logged unchanged and checked when it is read.

use serde_json::{Value, json};
use sulcus_core::Scene;
use sulcus_core::tissue::TissueModel;
use sulcus_core::tissue::gingiva::Site;

use crate::record::occurrence::Occurrence;

/// Kind of the event.
pub const READING_CALLED: &str = "reading_called";
/// Largest depth of a call, mm.
const MOST_MM: u64 = 20;
/// Least and largest recession of a call, mm.
const RECESSION_MM: [i64; 2] = [-10, 20];

/// Call of a depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Call {
    /// FDI number of the tooth.
    pub tooth: u8,
    /// Site of the tooth.
    pub site: Site,
    /// Depth, whole millimetres.
    pub depth_mm: u8,
    /// Distance of the margin below the cemento-enamel junction, whole millimetres, negative above it; `None` if not
    /// called.
    pub recession_mm: Option<i8>,
    /// Whether the site bleeds; `None` if not called.
    pub bleeding: Option<bool>,
    /// Grade of the furcation, 0 to 3 by Hamp 1975, in the middle of a side; `None` if not called.
    pub furcation: Option<u8>,
}

/// Reason why data are no call.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{field} is {found}, expected {expected}")]
pub struct CallError {
    /// Key.
    pub field: &'static str,
    /// Value found.
    pub found: String,
    /// Values expected.
    pub expected: String,
}

impl Call {
    /// Data of the event.
    pub fn data(&self) -> Value {
        let mut data =
            json!({ "tooth": self.tooth, "site": self.site.name(), "depth_mm": self.depth_mm });
        // A value that was not called has no key.
        let more = [
            ("recession_mm", self.recession_mm.map(Value::from)),
            ("bleeding", self.bleeding.map(Value::from)),
            ("furcation", self.furcation.map(Value::from)),
        ];
        for (key, value) in more {
            if let Some(value) = value {
                data[key] = value;
            }
        }
        data
    }

    /// Event of the call for a session's log.
    pub fn at(&self, tick: u64) -> Occurrence {
        Occurrence {
            kind: READING_CALLED.into(),
            tick,
            data: self.data(),
        }
    }

    /// Call in the data of an event, about a tooth of the scene.
    ///
    /// # Errors
    /// A value is missing or invalid: its key, the value found and the values expected.
    pub fn read(data: &Value, scene: &Scene) -> Result<Self, CallError> {
        let wrong = |field, expected: String| {
            // A client may send a long value.
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
            // A gingiva without a number has the number of its tooth.
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
        let called = |key: &str| Some(&data[key]).filter(|value| !value.is_null());
        let recession_mm = match called("recession_mm") {
            None => None,
            Some(value) => {
                let [least, most] = RECESSION_MM;
                let whole = value.as_i64().filter(|mm| (least..=most).contains(mm));
                let Some(mm) = whole.and_then(|mm| i8::try_from(mm).ok()) else {
                    return wrong(
                        "recession_mm",
                        format!("{least} to {most}, whole millimetres, or none"),
                    );
                };
                Some(mm)
            }
        };
        let bleeding = match called("bleeding") {
            None => None,
            Some(Value::Bool(bleeds)) => Some(*bleeds),
            Some(_) => return wrong("bleeding", "true, false, or none".into()),
        };
        let furcation = match called("furcation") {
            None => None,
            Some(value) => {
                let grade = value.as_u64().filter(|grade| *grade <= 3);
                let Some(grade) = grade.filter(|_| !site.is_proximal()) else {
                    return wrong(
                        "furcation",
                        "0 to 3, in the middle of a side, or none".into(),
                    );
                };
                Some(grade as u8)
            }
        };
        Ok(Self {
            tooth,
            site,
            depth_mm,
            recession_mm,
            bleeding,
            furcation,
        })
    }

    /// Prescribed depth at the site, metres.
    pub fn truth(&self, scene: &Scene) -> Option<f64> {
        let pockets = super::pocket::all(scene);
        let pocket = pockets.iter().find(|pocket| pocket.fdi == self.tooth)?;
        Some(pocket.gingiva(scene)?.prescribed(self.site).depth)
    }
}
