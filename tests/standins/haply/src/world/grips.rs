//! Grips and unknown devices in the inventory and in replies.

use super::World;
use super::json::Json;
use super::reply::{Parts, WXYZ};
use crate::device::{Grip, GripArray};
use crate::fault::Place;
use crate::options::Omit;

impl World {
    /// One array of grips.
    pub(super) fn write_grips(
        &self,
        json: &mut Json<'_>,
        number: u64,
        parts: Parts,
        array: GripArray,
        full: bool,
    ) {
        let mut listed = self
            .grips
            .iter()
            .filter(|grip| grip.arrays.contains(&array))
            .peekable();
        if json.omits(&Omit::Array(array.name().into())) || (listed.peek().is_none() && !full) {
            return;
        }
        json.array(array.name(), |json| {
            for grip in listed.filter(|grip| grip.connected) {
                let config = parts.config || self.is_new(number, &grip.id, grip.generation);
                if json.omits(&Omit::Device(grip.id.clone())) {
                    continue;
                }
                for _ in 0..if self.pending.twice_device > 0 { 2 } else { 1 } {
                    json.braces(|json| {
                        self.write_grip(json, grip, array, Parts { config, ..parts })
                    });
                }
            }
        });
    }

    fn write_grip(&self, json: &mut Json<'_>, grip: &Grip, array: GripArray, parts: Parts) {
        let wireless = array == GripArray::Wireless;
        json.text("device_id", &grip.id);
        if parts.config {
            json.raw("config", &grip.config.text());
        }
        if parts.state {
            json.object("state", |json| {
                let buttons = grip.shown_buttons;
                if wireless {
                    json.number("battery_level", grip.battery());
                    json.number("battery_voltage", 3.0 + grip.battery());
                    json.object("buttons", |json| {
                        json.flag("a", buttons.a);
                        json.flag("b", buttons.b);
                        json.flag("c", buttons.c);
                    });
                } else {
                    json.flag("button", buttons.a);
                }
                json.number("hall", f64::from(buttons.hall));
                self.write_vector(
                    json,
                    "orientation",
                    &WXYZ,
                    &grip.orientation,
                    (&grip.id, Place::Orientation),
                );
            });
        }
        if parts.status {
            json.object("status", |json| {
                json.flag("ready", grip.awake);
                json.flag("connected", grip.connected);
                if wireless {
                    json.flag("awake", grip.awake);
                }
            });
        }
    }

    /// One array of a type that no client knows.
    pub(super) fn write_unknown(&self, json: &mut Json<'_>, name: &str) {
        if json.omits(&Omit::Array(name.into())) {
            return;
        }
        json.array(name, |json| {
            json.braces(|json| {
                json.text("device_id", "F00D");
                json.object("state", |json| {
                    json.raw("shape", r#"[1,"two",null,{"three":3}]"#);
                    json.text("mood", "new");
                });
            });
        });
    }
}
