//! Message of a client, taken apart.

use serde_json::{Map, Value};

/// Message of a client.
#[derive(Debug, Default)]
pub(crate) struct ClientMessage {
    /// `session.configure.profile.name`.
    pub(crate) profile: Option<String>,
    /// The client wants the inventory again.
    pub(crate) full_state: bool,
    /// Commands in the order of the message.
    pub(crate) orders: Vec<Order>,
}

/// One command to one device.
#[derive(Debug)]
pub(crate) struct Order {
    /// Array of the device.
    pub(crate) array: String,
    /// Id of the device.
    pub(crate) device: String,
    /// Name of the command.
    pub(crate) name: String,
    /// Fields of the command.
    pub(crate) fields: Map<String, Value>,
}

impl Order {
    /// False where the command says that it is not to be carried out.
    pub(crate) fn execute(&self) -> bool {
        self.fields
            .get("execute")
            .and_then(Value::as_bool)
            .unwrap_or(true)
    }

    /// Vector x, y, z of a field; none where a part is absent or no number.
    pub(crate) fn vector(&self, field: &str) -> Option<[f64; 3]> {
        let value = self.fields.get(field)?;
        Some([
            value.get("x")?.as_f64()?,
            value.get("y")?.as_f64()?,
            value.get("z")?.as_f64()?,
        ])
    }
}

/// Takes a message apart; an error tells why it is no message.
pub(crate) fn parse(text: &str) -> Result<ClientMessage, String> {
    let value: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let Value::Object(root) = value else {
        return Err("the message is no object".into());
    };
    let mut message = ClientMessage::default();
    for (name, part) in root {
        if name == "session" {
            let profile = part
                .pointer("/configure/profile/name")
                .and_then(Value::as_str);
            message.profile = profile.map(Into::into);
            message.full_state = part.get("force_render_full_state").is_some();
            continue;
        }
        let Value::Array(devices) = part else {
            return Err(format!("'{name}' is no array of devices"));
        };
        for device in devices {
            orders(&name, device, &mut message.orders)?;
        }
    }
    Ok(message)
}

fn orders(array: &str, device: Value, orders: &mut Vec<Order>) -> Result<(), String> {
    let Value::Object(mut device) = device else {
        return Err(format!("a device of '{array}' is no object"));
    };
    let Some(id) = device
        .get("device_id")
        .and_then(Value::as_str)
        .map(String::from)
    else {
        return Err(format!("a device of '{array}' has no device_id"));
    };
    if let Some(Value::Object(commands)) = device.remove("commands") {
        for (name, fields) in commands {
            let fields = match fields {
                Value::Object(fields) => fields,
                _ => return Err(format!("the command '{name}' is no object")),
            };
            orders.push(Order {
                array: array.into(),
                device: id.clone(),
                name,
                fields,
            });
        }
    }
    Ok(())
}
