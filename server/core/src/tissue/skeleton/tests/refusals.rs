//! Tests of validation: an error names the invalid field.

use super::*;

fn refused(change: impl Fn(&mut SkeletonLevel)) -> String {
    let (tree, mut model) = soft_block(SOFT);
    change(&mut model.coarse);
    model.validate(&tree).expect_err("refused").to_string()
}

#[test]
fn broken_data_is_refused_with_field_found_and_expected() {
    let (tree, model) = two_levels(SOFT);
    model.validate(&tree).expect("stands");
    type Case = (fn(&mut SkeletonLevel), &'static str);
    let cases: [Case; 14] = [
        (
            |m| m.params.mass = 0.0,
            "mass of a skeleton node is 0, expected 1e-7 to 10 kg",
        ),
        (
            |m| m.params.mass = f64::NAN,
            "mass of a skeleton node is NaN",
        ),
        (
            |m| m.params.damping = -1.0,
            "damping of a skeleton node is -1",
        ),
        (
            |m| m.params.law.limit = 0.5,
            "limit of the stretch law is 0.5, expected 1 to 100",
        ),
        (|m| m.params.law.half = 0.0, "half of the stretch law is 0,"),
        (
            |m| m.springs[3].stiffness[1] = -2.0,
            "stiffness of a spring is -2 N/m between",
        ),
        (
            |m| m.springs[3].b = 400,
            "spring of the skeleton is between",
        ),
        (
            |m| m.nodes[5] = 9999,
            "skeleton node is tree node 9999, expected one of",
        ),
        (
            |m| m.nodes[13] = m.nodes[12],
            "length of a spring is 0 m between 13 and 12",
        ),
        (|m| m.fixed.fill(true), "number of free skeleton nodes is 0"),
        (
            |m| m.fixed.fill(false),
            "number of free skeleton nodes is 36",
        ),
        (
            |m| m.fixed.truncate(3),
            "fixed flags of the skeleton is 3, expected 36",
        ),
        (|m| m.skin[7].weights[0] += 0.1, "skin weights is"),
        (|m| m.skin.truncate(3), "skin of the skeleton is 3"),
    ];
    for (change, begin) in cases {
        let message = refused(change);
        assert!(message.starts_with(begin), "{message}\nexpected {begin}");
    }
}

#[test]
fn a_node_without_a_way_to_a_fixed_one_is_named() {
    let message = refused(|m| m.springs.retain(|s| s.a != 35 && s.b != 35));
    assert!(
        message.starts_with("skeleton node is 35 at (18.0, 12.0, 12.0) mm without a way"),
        "{message}"
    );
}

#[test]
fn a_scene_with_a_skeleton_survives_its_bytes() {
    let (tree, model) = two_levels(SOFT);
    let model = crate::tissue::TissueModel::Skeleton(Box::new(model));
    let config = bincode::config::standard();
    let bytes = bincode::serde::encode_to_vec(&model, config).expect("bytes");
    let (back, used): (crate::tissue::TissueModel, usize) =
        bincode::serde::decode_from_slice(&bytes, config).expect("model");
    assert_eq!((&back, used), (&model, bytes.len()));
    assert_eq!(back.state_len(&tree), model.state_len(&tree));
}
