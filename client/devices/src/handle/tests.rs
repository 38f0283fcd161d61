use proptest::prelude::*;
use sulcus_core::math::{exp_rotation, norm};
use sulcus_core::{Pose, Quat, Vec3};

use super::*;

/// Poses with the tip `tip` in the dimple, tilted by `tilt` radians to all sides.
fn around(tip: &Vec3, dimple: &Vec3, count: usize, tilt: f64, turn: f64) -> Vec<Pose> {
    (0..count)
        .map(|k| {
            let angle = std::f64::consts::TAU * k as f64 / count as f64 + turn;
            let aside = Vec3::new(angle.cos(), 0.0, angle.sin()) * tilt;
            let spin = exp_rotation(&Vec3::new(0.0, 0.7 * (angle * 2.0 + turn).sin(), 0.0));
            let orientation = exp_rotation(&aside) * spin;
            Pose::new(dimple - orientation * tip, orientation)
        })
        .collect()
}

fn vector(most: f64) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-most..most).prop_map(Vec3::from)
}

proptest! {
    #[test]
    fn exact_poses_give_the_tip_and_the_dimple(
        tip in vector(0.15),
        dimple in vector(0.1),
        count in 4_usize..30,
        tilt in 0.3..0.9_f64,
        turn in 0.0..6.0_f64,
    ) {
        let found = pivot(&around(&tip, &dimple, count, tilt, turn)).expect("well spread");
        prop_assert!(norm(&(found.gimbal_from_tip - tip)) < 1e-9);
        prop_assert!(norm(&(found.dimple - dimple)) < 1e-9);
        prop_assert!(found.residual < 1e-9);
    }

    #[test]
    fn noise_of_a_twentieth_of_a_millimetre_moves_the_tip_by_less_than_a_fifth(
        tip in vector(0.15),
        tilt in 0.5..0.9_f64,
        turn in 0.0..6.0_f64,
        noise in prop::collection::vec(vector(1.0), 8),
    ) {
        let mut poses = around(&tip, &Vec3::zeros(), 8, tilt, turn);
        for (pose, noise) in poses.iter_mut().zip(&noise) {
            pose.position += noise * (5e-5 / norm(noise).max(1.0));
        }
        let found = pivot(&poses).expect("well spread");
        let off = norm(&(found.gimbal_from_tip - tip));
        prop_assert!(off < 2e-4, "{off}");
        prop_assert!(found.residual < 5e-5);
    }

    #[test]
    fn one_bad_pose_is_named(
        tip in vector(0.15),
        bad in 0_usize..6,
        turn in 0.0..6.0_f64,
        way in vector(1.0),
    ) {
        prop_assume!(norm(&way) > 0.1);
        let mut poses = around(&tip, &Vec3::zeros(), 6, 0.6, turn);
        poses[bad].position += way * (5e-3 / norm(&way));
        match pivot(&poses) {
            Err(PivotError::Moved { number, .. }) => prop_assert_eq!(number, bad + 1),
            other => prop_assert!(false, "{:?}", other),
        }
    }

    #[test]
    fn a_tool_in_a_handle_has_tip_axis_and_roll_of_the_handle(
        tip in vector(0.15),
        axis in vector(1.0),
        tool_tip in vector(0.05),
        tool_axis in vector(1.0),
    ) {
        prop_assume!(norm(&axis) > 0.1 && norm(&tool_axis) > 0.1);
        let (axis, tool_axis) = (axis / norm(&axis), tool_axis / norm(&tool_axis));
        prop_assume!(axis.x.abs() < 0.99 && tool_axis.x.abs() < 0.99);
        let handle = Handle {
            gimbal_from_tip_mm: (tip * 1e3).into(),
            axis: axis.into(),
            ..probe()
        };
        let pose = handle.gimbal_from_tool(&tool_tip, &tool_axis);
        prop_assert!(norm(&(pose.transform(&tool_tip) - tip)) < 1e-12);
        prop_assert!(norm(&(pose.orientation * tool_axis - axis)) < 1e-9);
        let across = |v: Vec3| v - axis * axis.dot(&v);
        let [of_tool, of_handle] = [across(pose.orientation * Vec3::x()), across(Vec3::x())];
        prop_assert!(norm(&of_tool.cross(&of_handle)) < 1e-9);
        prop_assert!(of_tool.dot(&of_handle) > 0.0);
        // A roll turns the tool about the axis and leaves tip and axis.
        let rolled = Handle { roll_deg: 90.0, ..handle }.gimbal_from_tool(&tool_tip, &tool_axis);
        prop_assert!(norm(&(rolled.transform(&tool_tip) - tip)) < 1e-12);
        let sideways = across(rolled.orientation * Vec3::x());
        prop_assert!(sideways.dot(&of_tool).abs() < 1e-9);
        prop_assert!(of_tool.cross(&sideways).dot(&axis) > 0.0);
    }
}

fn probe() -> Handle {
    Handle {
        instrument: "periodontal probe".into(),
        hand: Side::Right,
        gimbal_from_tip_mm: [1.0, -2.0, -85.5],
        axis: [0.0, 0.0, -1.0],
        roll_deg: 0.0,
        mass_g: 22.0,
        residual_mm: Some(0.11),
    }
}

#[test]
fn few_similar_and_invalid_poses_are_refused_with_the_remedy() {
    let tip = Vec3::new(0.0, 0.0, -0.09);
    let good = around(&tip, &Vec3::zeros(), 5, 0.6, 0.0);
    let text = |poses: &[Pose]| pivot(poses).expect_err("refused").to_string();
    assert!(
        text(&good[..3]).contains("3 poses, expected at least 4"),
        "{}",
        text(&good[..3])
    );
    let alike = around(&tip, &Vec3::zeros(), 5, 0.05, 0.0);
    assert!(text(&alike).contains("too similar"), "{}", text(&alike));
    // Turns about one axis leave the tip's place on the axis open.
    let about_one: Vec<Pose> = (0..6)
        .map(|k| {
            let orientation = exp_rotation(&Vec3::new(0.3 * f64::from(k), 0.0, 0.0));
            Pose::new(-(orientation * tip), orientation)
        })
        .collect();
    assert!(
        text(&about_one).contains("too similar"),
        "{}",
        text(&about_one)
    );
    let mut broken = good.clone();
    broken[2].position.y = f64::NAN;
    assert!(text(&broken).contains("pose 3"), "{}", text(&broken));
}

#[test]
fn a_guide_takes_still_poses_that_differ_and_replaces_a_bad_one() {
    let tip = Vec3::new(0.002, -0.001, -0.08);
    let poses = around(&tip, &Vec3::new(0.0, -0.05, 0.0), 6, 0.6, 0.3);
    let mut guide = Guide::new();
    let hold = |guide: &mut Guide, pose: &Pose| {
        let hints = (0..400).map(|k| {
            let shake = Vec3::new(f64::from(k % 3) - 1.0, 0.0, f64::from(k % 2)) * 2e-5;
            guide.step(&Pose::new(pose.position + shake, pose.orientation))
        });
        hints.filter(|hint| matches!(hint, Hint::Taken(_))).count()
    };
    for (k, pose) in poses.iter().take(4).enumerate() {
        let moved = if k == 2 {
            Vec3::new(0.004, 0.0, 0.0)
        } else {
            Vec3::zeros()
        };
        assert_eq!(
            hold(
                &mut guide,
                &Pose::new(pose.position + moved, pose.orientation)
            ),
            1
        );
        // The same pose again is not taken.
        assert_eq!(hold(&mut guide, pose), 0);
        assert_eq!(guide.is_enough(), k == 3);
    }
    assert!(matches!(guide.finish(), Err(PivotError::Moved { .. })));
    assert_eq!(guide.poses().len(), 3);
    let moving = Pose::new(Vec3::zeros(), Quat::identity());
    for k in 0..1000 {
        let way = Vec3::new(f64::from(k) * 1e-3, 0.0, 0.0);
        assert_eq!(
            guide.step(&Pose::new(moving.position + way, moving.orientation)),
            Hint::Still
        );
    }
}

#[test]
fn a_handle_file_is_read_as_written_and_checked() {
    let handle = probe();
    let text = handle.to_toml().expect("TOML");
    assert_eq!(Handle::from_toml(&text).as_ref(), Ok(&handle));
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from} in {text}");
        Handle::from_toml(&text.replacen(from, to, 1))
            .expect_err("refused")
            .to_string()
    };
    assert_eq!(with("22.0", "nan"), "mass_g is NaN, expected 0 to 1000");
    assert_eq!(
        with("-1.0]", "-2.0]"),
        "axis is 2, expected a vector of length 1"
    );
    assert!(with("\"right\"", "\"upper\"").contains("upper"));
    assert!(with("mass_g", "mass").contains("mass"));
    assert!(with("periodontal probe", " ").contains("the name of the instrument"));
}

#[test]
fn a_straight_handle_points_from_the_gimbal_to_its_tip() {
    let tip = Vec3::new(0.0, -0.03, -0.04);
    let found = pivot(&around(&tip, &Vec3::zeros(), 8, 0.6, 0.0)).expect("well spread");
    let handle = Handle::straight("scaler", Side::Either, 20.0, &found);
    assert!(norm(&(Vec3::from(handle.axis) - Vec3::new(0.0, -0.6, -0.8))) < 1e-9);
    assert_eq!(handle.validate(), Ok(()));
    // An axis along x takes the roll from y.
    let along_x = Handle {
        axis: [1.0, 0.0, 0.0],
        ..probe()
    };
    let pose = along_x.gimbal_from_tool(&Vec3::zeros(), &-Vec3::z());
    assert!((pose.orientation.norm() - 1.0).abs() < 1e-12);
}
