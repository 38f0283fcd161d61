//! Config of a device: what the inventory tells and what a client sets over HTTP.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::options::ArmOptions;

/// Config of a device by the name of its parts.
#[derive(Debug, Clone)]
pub(crate) struct Config {
    parts: BTreeMap<String, Value>,
}

/// Parts that a client may set over HTTP.
const SETTABLE: [&str; 6] = [
    "gravity_compensation",
    "torque_scaling",
    "handedness",
    "basis",
    "mount",
    "preset",
];

impl Config {
    /// Config of an arm.
    pub(crate) fn of_arm(arm: &ArmOptions) -> Self {
        let value = json!({
            "type": arm.kind.name(),
            "handedness": arm.handedness,
            "device_info": {
                "major_version": 1, "minor_version": 0, "device_type": arm.kind.number(), "uuid": uuid(&arm.id),
            },
            "gravity_compensation": { "enabled": true, "scaling_factor": 1.0 },
            "torque_scaling": { "enabled": false, "scaling_factor": 1.0 },
            "preset": "arm_front_centered",
            "basis": { "permutation": "XYZ" },
            "mount": Value::Null,
            "filters": { "force_gate": { "gain": 0.3 }, "damping": { "scalar": 0.0 } },
        });
        Self::of(value)
    }

    /// Config of a grip.
    pub(crate) fn of_grip(id: &str) -> Self {
        Self::of(
            json!({ "device_info": { "major_version": 1, "minor_version": 0, "uuid": uuid(id) } }),
        )
    }

    fn of(value: Value) -> Self {
        let parts = match value {
            Value::Object(map) => map.into_iter().collect(),
            _ => BTreeMap::new(),
        };
        Self { parts }
    }

    /// One part.
    pub(crate) fn get(&self, name: &str) -> Option<&Value> {
        self.parts.get(name)
    }

    /// Sets a part; an object replaces the fields that it names. False where a client may not set the part.
    pub(crate) fn set(&mut self, name: &str, value: Value) -> bool {
        if !SETTABLE.contains(&name) {
            return false;
        }
        match (self.parts.get_mut(name), value) {
            (Some(Value::Object(old)), Value::Object(new)) => old.extend(new),
            (_, value) => {
                self.parts.insert(name.into(), value);
            }
        }
        true
    }

    /// Factor of `torque_scaling` on every force.
    pub(crate) fn torque_factor(&self) -> f64 {
        let Some(part) = self.get("torque_scaling") else {
            return 1.0;
        };
        let enabled = part.get("enabled").and_then(Value::as_bool).unwrap_or(true);
        let factor = part
            .as_f64()
            .or_else(|| part.get("scaling_factor").and_then(Value::as_f64));
        if enabled { factor.unwrap_or(1.0) } else { 1.0 }
    }

    /// Config as JSON.
    pub(crate) fn text(&self) -> String {
        serde_json::to_string(&self.parts).unwrap_or_default()
    }
}

/// A stable text in the form of a UUID.
fn uuid(id: &str) -> String {
    let sum = id.bytes().fold(7u64, |sum, byte| {
        sum.wrapping_mul(131).wrapping_add(u64::from(byte))
    });
    format!(
        "{:08x}-0000-4000-8000-{:012x}",
        sum & 0xffff_ffff,
        sum & 0xffff_ffff_ffff
    )
}
