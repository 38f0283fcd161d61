//! Settings of the service that change the force or the axes.
//!
//! The back-end changes no setting. It refuses a device whose force or axes another program has changed.

use serde_json::Value;

/// Reads the answer to `GET /settings/devices/force_scale`: a number, or an object with the number.
pub(super) fn force_scale(body: &str) -> Option<f64> {
    let value: Value = serde_json::from_str(body).ok()?;
    let named = ["force_scale", "value"]
        .iter()
        .find_map(|name| value.get(name));
    named.unwrap_or(&value).as_f64()
}

/// Reason against a factor on all forces; `None` for the factor 1.
pub(super) fn against_scale(factor: f64) -> Option<String> {
    (factor != 1.0).then(|| {
        format!("the force_scale of the Haply service is {factor}, expected 1: set it to 1 in the Haply software")
    })
}

/// Reason against the `config` of the arm `id`; `None` for an arm with factor 1 and unchanged axes.
pub(super) fn against_config(id: &str, config: &Value) -> Option<String> {
    let factor = config.get("torque_scaling").and_then(factor);
    if let Some(factor) = factor.filter(|factor| *factor != 1.0) {
        return Some(format!(
            "the torque_scaling of {id} is {factor}, expected 1: set it to 1 in the Haply software"
        ));
    }
    let basis = config.pointer("/basis/permutation").and_then(Value::as_str);
    let basis = basis.filter(|basis| !basis.eq_ignore_ascii_case("xyz"))?;
    Some(format!(
        "the basis of {id} is {basis}, expected XYZ: set it to XYZ in the Haply software"
    ))
}

/// Reason against the transform in the `state` of the arm `id`; `None` for none, or for one that changes nothing.
pub(super) fn against_transform(id: &str, state: &Value) -> Option<String> {
    let transform = state.get("transform")?;
    let is = |name: &str, axes: &[&str], expected: f64| {
        let part = transform.get(name);
        axes.iter().all(|axis| {
            let value = part.and_then(|part| part.get(axis)).and_then(Value::as_f64);
            value.is_none_or(|value| (value - expected).abs() < 1e-6)
        })
    };
    let plain = is("position", &["x", "y", "z"], 0.0)
        && is("rotation", &["x", "y", "z"], 0.0)
        && is("scale", &["x", "y", "z"], 1.0);
    (!plain).then(|| {
        format!(
            "a transform of another program changes the poses of {id}: close that program, or restart the Haply \
             service"
        )
    })
}

/// Factor of `torque_scaling`; `None` for a form that is not known.
fn factor(value: &Value) -> Option<f64> {
    let enabled = value.get("enabled").and_then(Value::as_bool);
    let named = ["scaling_factor", "value"]
        .iter()
        .find_map(|name| value.get(name));
    match (value, enabled) {
        (Value::Bool(false), _) | (_, Some(false)) => Some(1.0),
        _ => named.unwrap_or(value).as_f64(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_scale_is_read_in_each_form() {
        for (body, scale) in [
            ("1", Some(1.0)),
            ("{\"force_scale\":2.5}", Some(2.5)),
            ("{\"value\":0.5}", Some(0.5)),
            ("{}", None),
            ("two", None),
        ] {
            assert_eq!(force_scale(body), scale, "{body}");
        }
        assert_eq!(against_scale(1.0), None);
        assert!(against_scale(2.0).unwrap().contains("is 2, expected 1"));
    }

    #[test]
    fn a_changed_config_is_refused() {
        let against = |config: Value| against_config("049D", &config);
        for plain in [
            json!({}),
            json!({"torque_scaling":{"enabled":false,"scaling_factor":3}}),
            json!({"torque_scaling":{"enabled":true,"scaling_factor":1.0},"basis":{"permutation":"XYZ"}}),
            json!({"torque_scaling":{"enabled":true}}),
            json!({"torque_scaling":1}),
            json!({"torque_scaling":false}),
        ] {
            assert_eq!(against(plain.clone()), None, "{plain}");
        }
        for changed in [
            json!({"torque_scaling":{"enabled":true,"scaling_factor":2}}),
            json!({"torque_scaling":0.5}),
            json!({"basis":{"permutation":"XZY"}}),
        ] {
            assert!(against(changed.clone()).is_some(), "{changed}");
        }
    }

    #[test]
    fn a_transform_is_refused_unless_it_changes_nothing() {
        let against = |state: Value| against_transform("049D", &state);
        assert_eq!(against(json!({})), None);
        assert_eq!(
            against(
                json!({"transform":{"position":{"x":0},"rotation":{"w":1,"x":0},"scale":{"x":1,"y":1,"z":1}}})
            ),
            None
        );
        assert!(against(json!({"transform":{"scale":{"x":2}}})).is_some());
        assert!(against(json!({"transform":{"rotation":{"w":0.7,"z":0.7}}})).is_some());
    }
}
