use proptest::prelude::*;

use sulcus_core::math::norm;

use super::raw::REACH_M;
use super::*;

const WHOLE: &str = r#"{"session_id":7,"inverse3":[{"device_id":"049D","config":{"type":"inverse3"},
    "state":{"cursor_position":{"x":0.1,"y":0.2,"z":0.3},"current_cursor_force":{"x":0,"y":-1,"z":0},
    "angular_position":{"a0":1,"a1":2,"a2":3},"mode":"force"},
    "status":{"calibrated":true,"in_use":false,"power_supply":true,"ready":true,"started":true}}],
    "verse_grip":[],"wireless_verse_grip":[{"device_id":"61576","state":{"battery_level":0.8,
    "buttons":{"a":true,"b":false,"c":true},"orientation":{"w":2e0,"x":0,"y":0,"z":0}},
    "status":{"awake":true,"connected":true}}]}"#;

#[test]
fn a_whole_reply_is_read() {
    let text = WHOLE.replace("2e0", "1.001");
    let reply = Reply::parse(&text).unwrap();
    let arm = reply.arm("049D").unwrap();
    assert_eq!(arm.position, Some(Vec3::new(0.1, 0.3, -0.2)));
    assert_eq!(arm.force, Some(Vec3::new(0.0, 0.0, 1.0)));
    assert_eq!(arm.status.power, Some(true));
    let grip = reply.grip(Array::Wireless, "61576").unwrap();
    assert_eq!(grip.orientation, Some(Quat::identity()));
    assert_eq!((grip.buttons, grip.awake), (Some(5), Some(true)));
    assert!(reply.has(Array::Wired) && !reply.has(Array::Custom));
    // A quaternion of length 2 is no rotation.
    let reply = Reply::parse(WHOLE).unwrap();
    assert_eq!(
        reply.grip(Array::Wireless, "61576").unwrap().orientation,
        None
    );
}

#[test]
fn a_field_that_is_absent_or_of_another_type_is_nothing() {
    for x in ["null", "\"0.1\"", "[]", "{}", "true", "5.0"] {
        let reply = Reply::parse(&WHOLE.replace("\"x\":0.1", &format!("\"x\":{x}"))).unwrap();
        let arm = reply.arm("049D").unwrap();
        assert_eq!(arm.position, None, "{x}");
        assert!(arm.force.is_some() && reply.has(Array::Wireless), "{x}");
    }
    for text in [
        "{}",
        r#"{"inverse3":5}"#,
        r#"{"inverse3":null,"verse_grip":{"a":1}}"#,
    ] {
        assert_eq!(Reply::parse(text), Some(Reply::default()), "{text}");
    }
    let odd = Reply::parse(
        r#"{"inverse3":[1,null,{"state":{}},{"device_id":7},{"device_id":"A","state":[]}]}"#,
    );
    assert_eq!(odd.unwrap().arms.unwrap().len(), 1);
}

#[test]
fn what_is_no_json_is_no_reply() {
    let overflow = WHOLE.replace("\"x\":0.1", "\"x\":1e400");
    let nan = WHOLE.replace("\"x\":0.1", "\"x\":NaN");
    for text in [
        "",
        "7",
        "[]",
        "null",
        "{\"inverse3\":[",
        &WHOLE[..200],
        &overflow,
        &nan,
    ] {
        assert_eq!(Reply::parse(text), None, "{text}");
    }
}

#[test]
fn a_wired_grip_has_one_button() {
    let text = r#"{"verse_grip":[{"device_id":"7","state":{"button":true,"hall":3}}]}"#;
    let reply = Reply::parse(text).unwrap();
    assert_eq!(reply.grip(Array::Wired, "7").unwrap().buttons, Some(1));
}

fn json() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        Just("null".to_owned()),
        Just("true".to_owned()),
        any::<f64>().prop_map(|x| format!("{x:e}")),
        any::<i64>().prop_map(|x| x.to_string()),
        "[a-z0-9]{0,4}".prop_map(|text| format!("\"{text}\"")),
    ];
    let names = [
        "inverse3",
        "verse_grip",
        "device_id",
        "state",
        "status",
        "cursor_position",
        "orientation",
        "buttons",
        "w",
        "x",
        "y",
        "z",
        "a",
        "ready",
    ];
    leaf.prop_recursive(5, 64, 5, move |inner| {
        let field = (prop::sample::select(names.to_vec()), inner.clone());
        prop_oneof![
            prop::collection::vec(inner, 0..4).prop_map(|all| format!("[{}]", all.join(","))),
            prop::collection::vec(field, 0..5).prop_map(|all| {
                let all: Vec<String> = all
                    .iter()
                    .map(|(name, value)| format!("\"{name}\":{value}"))
                    .collect();
                format!("{{{}}}", all.join(","))
            }),
        ]
    })
}

proptest! {
    #[test]
    fn no_reply_panics_and_every_pose_is_finite(
        text in prop_oneof![".{0,80}", json()],
        cut in 0..WHOLE.len(),
        other in any::<u8>(),
    ) {
        let mut damaged = WHOLE.as_bytes().to_vec();
        damaged[cut] = other;
        let damaged = String::from_utf8_lossy(&damaged).into_owned();
        for text in [text, damaged] {
            let Some(reply) = Reply::parse(&text) else { continue };
            for arm in reply.arms.iter().flatten() {
                prop_assert!(arm.position.is_none_or(|at| norm(&at) <= REACH_M));
                prop_assert!(arm.force.is_none_or(|force| norm(&force).is_finite()));
            }
            for grip in reply.grips.iter().flat_map(|(_, grips)| grips) {
                prop_assert!(grip.orientation.is_none_or(|q| (q.as_ref().norm() - 1.0).abs() < 1e-9));
            }
        }
    }

    #[test]
    fn an_absent_number_gives_no_pose(x in prop::option::of(-0.5..0.5), z in prop::option::of(-0.5..0.5)) {
        let part = |name: &str, value: Option<f64>| value.map(|v| format!(",\"{name}\":{v}")).unwrap_or_default();
        let text = format!(
            "{{\"inverse3\":[{{\"device_id\":\"A\",\"state\":{{\"cursor_position\":{{\"y\":0.1{}{}}}}}}}]}}",
            part("x", x), part("z", z)
        );
        let reply = Reply::parse(&text).unwrap();
        prop_assert_eq!(reply.arm("A").unwrap().position.is_some(), x.is_some() && z.is_some());
    }
}
