use proptest::prelude::*;
use serde_json::json;

use super::*;

fn sample() -> Value {
    json!({
        "label": "one", "missing": [46], "teeth": [{
            "fdi": 36,
            "depth_mm": { "buccal": [5, 4.5, 4], "lingual": [4, 3, 4] },
            "recession_mm": { "buccal": [-1, 0, -1], "lingual": [-1, 0, -1] },
            "bleeding": { "buccal": [true, false, false], "lingual": [false, false, false] },
            "inflammation": 0.4, "furcation": [1, 0], "mobility": 0,
        }],
    })
}

#[test]
fn a_chart_is_read_as_it_is_written() {
    let chart = Chart::of(Some(&sample())).expect("a chart");
    assert_eq!(chart.teeth[0].depth_mm.buccal, [5.0, 4.5, 4.0]);
    let again = serde_json::to_vec(&chart).expect("JSON");
    assert_eq!(Chart::parse(&again).expect("own form"), chart);
}

#[test]
fn a_value_of_another_form_is_named() {
    let wrong: [(&str, Value, &str); 10] = [
        ("/label", json!(7), "label"),
        ("/missing", json!("46"), "missing"),
        ("/missing/0", json!(-1), "missing"),
        ("/teeth", json!({}), "teeth"),
        ("/teeth/0/fdi", json!(36.5), "fdi"),
        (
            "/teeth/0/depth_mm/buccal/1",
            json!("4"),
            "depth_mm of tooth 36, buccal",
        ),
        (
            "/teeth/0/recession_mm/lingual",
            json!([1, 2]),
            "recession_mm of tooth 36, lingual",
        ),
        (
            "/teeth/0/bleeding/lingual/2",
            json!(1),
            "bleeding of tooth 36, lingual",
        ),
        ("/teeth/0/mobility", json!(12), "mobility of tooth 36"),
        ("/teeth/0/furcation", json!([1]), "furcation of tooth 36"),
    ];
    for (path, value, field) in wrong {
        let mut chart = sample();
        *chart.pointer_mut(path).expect(path) = value;
        let problem = Chart::of(Some(&chart)).expect_err(path);
        assert_eq!(problem.field, field, "{path}");
        assert!(problem.why.contains(", expected "), "{}", problem.why);
    }
    let mut chart = sample();
    chart["teeth"][0]["suppuration"] = json!(true);
    let problem = Chart::of(Some(&chart)).expect_err("unknown");
    assert_eq!(problem.field, "suppuration");
    assert_eq!(Chart::parse(b"[").expect_err("no JSON").field, "body");
}

/// JSON whose keys are those of a chart, with any values.
fn any_json() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        ".{0,6}".prop_map(Value::from),
    ];
    leaf.prop_recursive(5, 64, 6, |inner| {
        let key = prop_oneof![
            Just("label"),
            Just("missing"),
            Just("teeth"),
            Just("fdi"),
            Just("depth_mm"),
            Just("recession_mm"),
            Just("bleeding"),
            Just("inflammation"),
            Just("furcation"),
            Just("mobility"),
            Just("buccal"),
            Just("lingual"),
        ];
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..6).prop_map(Value::from),
            prop::collection::btree_map(key.prop_map(str::to_owned), inner, 0..8)
                .prop_map(|map| Value::Object(map.into_iter().collect())),
        ]
    })
}

proptest! {
    #[test]
    fn any_bytes_are_a_chart_or_a_problem(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = Chart::parse(&bytes);
    }

    #[test]
    fn any_json_is_a_chart_or_a_problem_with_a_field(
        value in any_json(), at in prop::sample::select(vec![
            "", "/label", "/missing", "/teeth", "/teeth/0", "/teeth/0/fdi", "/teeth/0/depth_mm",
            "/teeth/0/depth_mm/lingual", "/teeth/0/bleeding/buccal/0", "/teeth/0/furcation",
        ]),
    ) {
        let mut chart = sample();
        *chart.pointer_mut(at).expect("there") = value;
        if let Err(problem) = Chart::of(Some(&chart)) {
            prop_assert!(!problem.field.is_empty() && problem.why.starts_with(&problem.field));
        }
    }
}
