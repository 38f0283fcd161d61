//! Inventory and replies.

use super::World;
use super::json::Json;
use crate::device::{Arm, GripArray};
use crate::fault::Place;
use crate::options::Omit;

/// Letters of a vector.
const XYZ: [&str; 3] = ["x", "y", "z"];
/// Letters of a quaternion.
pub(super) const WXYZ: [&str; 4] = ["w", "x", "y", "z"];
/// Names of the joints.
const JOINTS: [&str; 3] = ["a0", "a1", "a2"];
/// Transform of an arm that no client has set one for.
const STILL: &str = r#"{"position":{"x":0,"y":0,"z":0},"rotation":{"w":1,"x":0,"y":0,"z":0},"scale":{"x":1,"y":1,"z":1}}"#;

/// Parts that a device tells in a reply.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parts {
    pub(super) config: bool,
    pub(super) state: bool,
    pub(super) status: bool,
}

impl World {
    /// Text of the inventory or of a reply.
    pub(super) fn reply(&mut self, number: u64, full: bool) -> String {
        let Some(link) = self.links.get(&number) else {
            return String::new();
        };
        let reply = link.messages;
        let every = |count: u64| full || (count > 0 && reply.is_multiple_of(count));
        let listed = self.replies.omissions.iter();
        let mut omit: Vec<&Omit> = listed
            .filter(|o| (o.first..=o.last).contains(&reply))
            .map(|o| &o.what)
            .collect();
        omit.extend(self.pending.omit.iter().map(|(omit, _)| omit));
        let mut json = Json::new(omit);
        let parts = Parts {
            config: every(self.replies.config_every) && !json.omits(&Omit::Config),
            state: !json.omits(&Omit::State),
            status: every(self.replies.status_every) && !json.omits(&Omit::Status),
        };
        json.braces(|json| {
            if full {
                json.number("session_id", number as f64);
            }
            self.write_arms(json, number, parts);
            for array in GripArray::ALL {
                self.write_grips(json, number, parts, array, full);
            }
            for name in &self.unknown_arrays {
                self.write_unknown(json, name);
            }
        });
        let text = json.finish();
        let arms = self
            .arms
            .iter()
            .filter(|arm| arm.connected)
            .map(|arm| (&arm.id, arm.generation));
        let grips = self
            .grips
            .iter()
            .filter(|grip| grip.connected)
            .map(|grip| (&grip.id, grip.generation));
        if let Some(link) = self.links.get_mut(&number) {
            for (id, generation) in arms.chain(grips) {
                if link.known.get(id) != Some(&generation) {
                    link.known.insert(id.clone(), generation);
                }
            }
        }
        text
    }

    /// True where the client of the connection does not know the config of a device yet.
    pub(super) fn is_new(&self, number: u64, id: &str, generation: u64) -> bool {
        self.links
            .get(&number)
            .is_some_and(|link| link.known.get(id).is_some_and(|known| *known != generation))
    }

    fn write_arms(&self, json: &mut Json<'_>, number: u64, parts: Parts) {
        if json.omits(&Omit::Array("inverse3".into())) {
            return;
        }
        json.array("inverse3", |json| {
            for arm in self.arms.iter().filter(|arm| arm.connected) {
                let config = parts.config || self.is_new(number, &arm.id, arm.generation);
                if json.omits(&Omit::Device(arm.id.clone())) {
                    continue;
                }
                for _ in 0..if self.pending.twice_device > 0 { 2 } else { 1 } {
                    json.braces(|json| self.write_arm(json, arm, Parts { config, ..parts }));
                }
            }
        });
    }

    fn write_arm(&self, json: &mut Json<'_>, arm: &Arm, parts: Parts) {
        json.text("device_id", &arm.id);
        if parts.config {
            json.raw("config", &arm.config.text());
        }
        if parts.state {
            json.object("state", |json| self.write_arm_state(json, arm));
        }
        if parts.status {
            json.object("status", |json| {
                json.flag("calibrated", arm.status.calibrated);
                json.flag("in_use", arm.status.in_use);
                json.flag("power_supply", arm.status.power_supply);
                json.flag("ready", arm.status.ready);
                json.flag("started", arm.status.started);
            });
        }
    }

    fn write_arm_state(&self, json: &mut Json<'_>, arm: &Arm) {
        let (position, velocity) = arm.pose();
        self.write_vector(
            json,
            "cursor_position",
            &XYZ,
            &position,
            (&arm.id, Place::Position),
        );
        self.write_vector(
            json,
            "cursor_velocity",
            &XYZ,
            &velocity,
            (&arm.id, Place::Velocity),
        );
        // The geometry of the linkage is not known: the angles only move with the position.
        let angles = [
            position[0] * 500.0,
            90.0 - position[2] * 300.0,
            45.0 + position[1] * 300.0,
        ];
        json.vector("angular_position", &JOINTS, &angles, None);
        let rates = [
            velocity[0] * 500.0,
            velocity[2] * -300.0,
            velocity[1] * 300.0,
        ];
        json.vector("angular_velocity", &JOINTS, &rates, None);
        json.vector("body_orientation", &WXYZ, &[1.0, 0.0, 0.0, 0.0], None);
        json.vector("current_cursor_force", &XYZ, &arm.force(self.forces), None);
        if self.version.has_mode() {
            json.text("mode", arm.mode());
        } else {
            json.text("control_domain", "cartesian");
            json.text("control_mode", arm.mode());
        }
        json.raw("transform", arm.transform.as_deref().unwrap_or(STILL));
    }

    /// A vector, with a bad number in place of x where one is in wait.
    pub(super) fn write_vector(
        &self,
        json: &mut Json<'_>,
        name: &str,
        letters: &[&str],
        values: &[f64],
        at: (&str, Place),
    ) {
        let bad = self
            .pending
            .bad
            .iter()
            .find(|bad| bad.device == at.0 && bad.place == at.1);
        let text = bad.map(|bad| bad.value.text());
        json.vector(name, letters, values, text.as_ref().map(Option::as_deref));
    }
}
