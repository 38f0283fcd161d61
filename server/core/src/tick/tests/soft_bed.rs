//! Tests of tools on a bed of spheres, each sphere on its own spring.

use super::*;

/// Returns `n` by `n` spheres of radius 0.3 mm, `spacing` metres apart, with their tops at z = 0.
fn spheres(n: i32, spacing: f64) -> Vec<Sphere> {
    let place = |k: i32| spacing * (f64::from(k) - 0.5 * f64::from(n - 1));
    (0..n * n)
        .map(|k| Sphere {
            centre: Vec3::new(place(k % n), place(k / n), -3e-4),
            radius: 3e-4,
        })
        .collect()
}

pub(super) fn bed(n: i32) -> Object {
    let compliance = Mat3::from_diagonal(&Vec3::new(0.001, 0.001, 0.004));
    Object {
        tree: SphereTree::over_leaves(&spheres(n, 2.5e-4)).expect("valid"),
        level: crate::tree::MAX_LEVEL,
        ..ball(0.01, TissueModel::Winkler(Winkler { compliance }))
    }
}

#[test]
fn what_is_kept_of_a_tissue_never_shows() {
    let scene = scene(vec![bed(24), ball(0.01, TissueModel::Rigid)]);
    let mut kept = (State::new(&scene), Workspace::new(&scene));
    let mut plain = (State::new(&scene), Workspace::plain(&scene));
    let mut touched = 0;
    for k in 0..3000 {
        let t = f64::from(k) * 1e-3;
        // Slow and fast, pressed and lifted, tilted to and fro.
        let speed = if k % 1000 < 500 { 1.0 } else { 8.0 };
        let tilt = exp_rotation(&Vec3::new(
            0.2 * libm::sin(1.7 * t),
            0.2 * libm::sin(speed * t),
            0.0,
        ));
        let tip = Vec3::new(
            2e-3 * libm::sin(2.3 * speed * t),
            2e-3 * libm::sin(3.1 * t),
            -5e-4 + 1e-3 * libm::sin(5.0 * t),
        );
        let input = at(tip + tilt * Vec3::new(0.0, 0.0, 0.09025), tilt);
        let a = tick(&scene, &mut kept.0, &mut kept.1, &input, &mut NoProbe);
        let b = tick(&scene, &mut plain.0, &mut plain.1, &input, &mut NoProbe);
        assert_eq!(a, b, "tick {k}");
        assert!(a.tools[0].status & (status::SOLVER_FAILED | status::FAULT) == 0);
        touched += u32::from(a.tools[0].active > 0);
    }
    assert!(touched > 1000, "{touched} ticks in contact");
    // Construction of a list tests eight spheres at once and counts all of them.
    let (lists, plainly) = (kept.1.work().lists, plain.1.work().tested);
    let kept = kept.1.work().tested / 8;
    assert!(2 * kept < plainly, "{kept} tests and {plainly}");
    assert!(lists > 0 && lists < u64::from(touched), "{lists} lists");
    assert_eq!(plain.1.work().lists, 0);
}

#[test]
fn more_rows_than_a_dense_problem_holds_are_said_and_the_nearest_kept() {
    // A plate of 400 spheres comes down flat on a bed of 400 spheres.
    let mut scene = scene(vec![bed(20)]);
    let plate: Vec<Sphere> = spheres(20, 2.5e-4)
        .into_iter()
        .map(|mut sphere| {
            sphere.centre.z -= 0.09 - 5e-5;
            sphere
        })
        .collect();
    scene.tools[0].tree = SphereTree::over_leaves(&plate).expect("valid");
    scene.tools[0].level = crate::tree::MAX_LEVEL;
    let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
    let (mut full, mut force) = (0, 0.0);
    for k in 0..250 {
        let z = 1e-3 - 1.5e-3 * f64::from(k) / 200.0;
        let out = tick(&scene, &mut state, &mut ws, &tip_at(z), &mut NoProbe);
        let tool = &out.tools[0];
        assert!(usize::from(tool.rows) <= 256, "{} rows", tool.rows);
        assert!(
            tool.status & (status::SOLVER_FAILED | status::FAULT) == 0,
            "tick {k}"
        );
        full += u32::from(tool.status & status::CONTACTS_FULL != 0);
        force = tool.raw_wrench.force.z;
    }
    assert!(full > 0);
    assert!(force > 0.05, "{force}");
}
