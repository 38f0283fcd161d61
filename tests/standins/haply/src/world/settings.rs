//! Settings over HTTP.

use serde_json::{Value, json};

use super::World;
use super::pending::take;
use crate::clock::now_ns;
use crate::device::Config;
use crate::log::What;

impl World {
    /// Answers a request: status and body.
    pub(crate) fn request(&mut self, method: &str, path: &str, body: &str) -> (u16, String) {
        self.advance();
        let (status, value) = if take(&mut self.pending.http_error) {
            (500, json!({ "error": "fault" }))
        } else {
            self.route(method, path, body)
        };
        self.log.add(
            now_ns(),
            What::Http {
                method: method.into(),
                path: path.into(),
                status,
            },
        );
        (status, value.to_string())
    }

    fn route(&mut self, method: &str, path: &str, body: &str) -> (u16, Value) {
        let path = path.split('?').next().unwrap_or_default();
        let parts: Vec<&str> = path.split('/').filter(|part| !part.is_empty()).collect();
        let value: Option<Value> = match method {
            "GET" => None,
            "POST" | "PUT" => match serde_json::from_str(body) {
                Ok(value) => Some(value),
                Err(error) => return (400, json!({ "error": error.to_string() })),
            },
            _ => return (405, json!({ "error": "method not allowed" })),
        };
        match (parts.as_slice(), value) {
            (["version"], None) => (200, json!({ "project_version": self.version.to_string() })),
            (["settings", "devices", "force_scale"], None) => {
                (200, self.setting("force_scale", json!(self.forces.scale)))
            }
            (["settings", "devices", "force_scale"], Some(value)) => {
                let number = value
                    .as_f64()
                    .or_else(|| value.get("force_scale").and_then(Value::as_f64));
                let Some(number) = number else {
                    return (400, json!({ "error": "no number" }));
                };
                self.forces.scale = number;
                (200, self.setting("force_scale", json!(number)))
            }
            ([_, id, "config", name], value) => self.config(id, name, value),
            _ => (404, json!({ "error": "not found" })),
        }
    }

    fn config(&mut self, id: &str, name: &str, value: Option<Value>) -> (u16, Value) {
        let Some(config) = self.config_of(id) else {
            return (404, json!({ "error": format!("no device {id}") }));
        };
        if let Some(value) = value
            && !config.set(name, value)
        {
            return (400, json!({ "error": format!("{name} can not be set") }));
        }
        match config.get(name) {
            Some(value) => (200, value.clone()),
            None => (404, json!({ "error": format!("no setting {name}") })),
        }
    }

    fn config_of(&mut self, id: &str) -> Option<&mut Config> {
        let arms = self
            .arms
            .iter_mut()
            .filter(|arm| arm.id == id && arm.connected)
            .map(|arm| &mut arm.config);
        let grips = self
            .grips
            .iter_mut()
            .filter(|grip| grip.id == id && grip.connected)
            .map(|grip| &mut grip.config);
        arms.chain(grips).next()
    }

    fn setting(&self, name: &str, value: Value) -> Value {
        if self.bare_settings {
            value
        } else {
            json!({ name: value })
        }
    }
}
