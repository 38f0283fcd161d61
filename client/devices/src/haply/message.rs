//! Message to the service: the force of every hand for one period.

use std::fmt::Write;

use super::reply::Array;
use super::version::Field;

/// Name of this program at the service.
const PROFILE: &str = "org.sulcus:client";

/// Part of a message for one hand.
#[derive(Clone, Debug)]
pub(super) struct Order<'a> {
    /// Id of the arm as a text of JSON, and its force in the axes of the service; `None` for an arm that is absent.
    pub(super) arm: Option<(&'a str, [f64; 3])>,
    /// Array and id of the grip, the id as a text of JSON; `None` for no grip or one that is absent.
    pub(super) grip: Option<(Array, &'a str)>,
}

/// Returns `id` as a text of JSON.
pub(super) fn quoted(id: &str) -> String {
    serde_json::Value::from(id).to_string()
}

/// Returns a message. The `first` one of a connection names this program.
///
/// A force that is not finite is zero in the message.
pub(super) fn message<'a>(
    first: bool,
    field: Field,
    orders: impl Iterator<Item = Order<'a>> + Clone,
) -> String {
    let mut out = String::with_capacity(512);
    out.push('{');
    // A write to a text has no error.
    if first {
        let _ = write!(
            out,
            r#""session":{{"configure":{{"profile":{{"name":"{PROFILE}"}}}}}},"#
        );
    }
    out.push_str(r#""inverse3":["#);
    for (i, (id, force)) in orders.clone().filter_map(|order| order.arm).enumerate() {
        let finite = force.iter().all(|x| x.is_finite());
        let [x, y, z] = if finite { force } else { [0.0; 3] };
        let comma = if i > 0 { "," } else { "" };
        let name = field.name();
        let _ = write!(
            out,
            r#"{comma}{{"device_id":{id},"commands":{{"set_cursor_force":{{"{name}":{{"x":{x},"y":{y},"z":{z}}}}}}}}}"#
        );
    }
    out.push(']');
    for array in [Array::Wireless, Array::Wired, Array::Custom] {
        let grips = orders.clone().filter_map(|order| order.grip);
        for (i, (_, id)) in grips.filter(|(of, _)| *of == array).enumerate() {
            let begin = if i > 0 { "," } else { "" };
            if i == 0 {
                let _ = write!(out, r#","{}":["#, array.name());
            }
            let _ = write!(
                out,
                r#"{begin}{{"device_id":{id},"commands":{{"probe_orientation":{{}}}}}}"#
            );
        }
        if orders
            .clone()
            .any(|order| order.grip.is_some_and(|(of, _)| of == array))
        {
            out.push(']');
        }
    }
    out.push('}');
    out
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde_json::{Value, json};

    use super::*;

    fn read(first: bool, field: Field, orders: &[Order<'_>]) -> Value {
        serde_json::from_str(&message(first, field, orders.iter().cloned())).unwrap()
    }

    #[test]
    fn a_message_has_the_force_of_every_hand() {
        let orders = [
            Order {
                arm: Some(("\"049D\"", [0.1, -2.5, 1e-9])),
                grip: Some((Array::Wireless, "\"1\"")),
            },
            Order {
                arm: Some(("\"04A1\"", [0.0; 3])),
                grip: Some((Array::Wireless, "\"2\"")),
            },
        ];
        let force = |x, y, z| json!({"set_cursor_force":{"vector":{"x":x,"y":y,"z":z}}});
        let probe = |id: &str| json!({"device_id":id,"commands":{"probe_orientation":{}}});
        assert_eq!(
            read(true, Field::Vector, &orders),
            json!({
                "session":{"configure":{"profile":{"name":"org.sulcus:client"}}},
                "inverse3":[
                    {"device_id":"049D","commands":force(json!(0.1), json!(-2.5), json!(1e-9))},
                    {"device_id":"04A1","commands":force(json!(0), json!(0), json!(0))},
                ],
                "wireless_verse_grip":[probe("1"), probe("2")],
            })
        );
        let old = read(false, Field::Values, &orders[..1]);
        assert_eq!(
            old.pointer("/inverse3/0/commands/set_cursor_force/values/y"),
            Some(&json!(-2.5))
        );
        assert_eq!(old.get("session"), None);
        let none = Order {
            arm: None,
            grip: None,
        };
        assert_eq!(read(false, Field::Vector, &[none]), json!({"inverse3":[]}));
    }

    proptest! {
        /// The service gets exactly the force, and zero for one that is not finite.
        #[test]
        fn every_message_is_json(id in ".{0,9}", x: f64, y in -20.0..20.0, z in -20.0..20.0) {
            let id = quoted(&id);
            let order = Order { arm: Some((&id, [x, y, z])), grip: Some((Array::Custom, &id)) };
            let value = read(false, Field::Vector, &[order]);
            let read = value.pointer("/inverse3/0/commands/set_cursor_force/vector/y").and_then(Value::as_f64);
            let expected: f64 = if x.is_finite() { y } else { 0.0 };
            prop_assert!((read.unwrap() - expected).abs() <= 1e-15 * expected.abs());
        }
    }
}
