//! Inventory: the first message of the service on a connection, with config, state and status of all devices.

use serde_json::Value;

use super::reply::{ArmStatus, Array, Reply};
use super::settings;

/// Type of an arm without a config.
const UNNAMED: &str = "inverse3";

/// Devices of the service.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Inventory {
    /// Arms in the order of the service.
    pub(super) arms: Vec<ArmEntry>,
    /// Grips in the order of the service, wireless ones first. A grip of two arrays counts once.
    pub(super) grips: Vec<GripEntry>,
}

/// Arm.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ArmEntry {
    /// Id.
    pub(super) id: String,
    /// Type, such as `inverse3`.
    pub(super) model: String,
    /// Hand: `left`, `right` or empty.
    pub(super) hand: String,
    /// Status.
    pub(super) status: ArmStatus,
    /// Reason against the arm, from its settings.
    pub(super) against: Option<String>,
}

/// Grip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct GripEntry {
    /// Id.
    pub(super) id: String,
    /// Array in which the service accepts commands to the grip.
    pub(super) array: Array,
    /// Whether the grip is awake and connected, or says nothing about it.
    pub(super) awake: bool,
}

impl Inventory {
    /// Reads an inventory. `None` for a text that is no object of JSON.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let reply = Reply::parse(text)?;
        let value: Value = serde_json::from_str(text).ok()?;
        let raw = value.get("inverse3").and_then(Value::as_array);
        let mut all = Self::default();
        for arm in reply.arms.iter().flatten() {
            if all.arm(&arm.id).is_some() {
                continue;
            }
            let of_arm =
                |raw: &&Value| raw.get("device_id").and_then(Value::as_str) == Some(&arm.id);
            let raw = raw.and_then(|raw| raw.iter().find(of_arm));
            let config = raw
                .and_then(|raw| raw.get("config"))
                .unwrap_or(&Value::Null);
            let state = raw.and_then(|raw| raw.get("state")).unwrap_or(&Value::Null);
            let text = |name: &str| config.get(name).and_then(Value::as_str);
            let hand = text("handedness").map(str::to_ascii_lowercase);
            let against = settings::against_config(&arm.id, config);
            all.arms.push(ArmEntry {
                id: arm.id.clone(),
                model: text("type").unwrap_or(UNNAMED).into(),
                hand: hand
                    .filter(|hand| hand == "left" || hand == "right")
                    .unwrap_or_default(),
                status: arm.status,
                against: against.or_else(|| settings::against_transform(&arm.id, state)),
            });
        }
        for (array, grips) in &reply.grips {
            for grip in grips {
                if all.grip(&grip.id).is_none() {
                    all.grips.push(GripEntry {
                        id: grip.id.clone(),
                        array: *array,
                        awake: grip.awake != Some(false) && grip.connected != Some(false),
                    });
                }
            }
        }
        Some(all)
    }

    /// Arm of `id`.
    pub(super) fn arm(&self, id: &str) -> Option<&ArmEntry> {
        self.arms.iter().find(|arm| arm.id == id)
    }

    /// Grip of `id`.
    pub(super) fn grip(&self, id: &str) -> Option<&GripEntry> {
        self.grips.iter().find(|grip| grip.id == id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"{"session_id":1,
        "inverse3":[{"device_id":"049D","config":{"type":"minverse","handedness":"LEFT","torque_scaling":2},
            "status":{"calibrated":false}},{"device_id":"049D"},{"device_id":"7"}],
        "verse_grip":[{"device_id":"9"},{"device_id":"61576"}],
        "wireless_verse_grip":[{"device_id":"61576","status":{"awake":false}}]}"#;

    #[test]
    fn devices_are_listed_once_with_what_is_known() {
        let all = Inventory::parse(TEXT).unwrap();
        assert_eq!(all.arms.len(), 2);
        let arm = all.arm("049D").unwrap();
        assert_eq!(
            (arm.model.as_str(), arm.hand.as_str()),
            ("minverse", "left")
        );
        assert_eq!(arm.status.calibrated, Some(false));
        assert!(arm.against.is_some());
        assert_eq!(
            (all.arms[1].model.as_str(), all.arms[1].hand.as_str()),
            ("inverse3", "")
        );
        let grips: Vec<_> = all
            .grips
            .iter()
            .map(|grip| (grip.id.as_str(), grip.array, grip.awake))
            .collect();
        assert_eq!(
            grips,
            [("61576", Array::Wireless, false), ("9", Array::Wired, true)]
        );
        assert_eq!(Inventory::parse("[]"), None);
    }
}
