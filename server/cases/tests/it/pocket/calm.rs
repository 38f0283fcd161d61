//! Turning, bobbing and leaning in a pocket: no buzz, no steps, no normal that flips.

use std::f64::consts::PI;

use sulcus_core::{TickInput, Vec3};
use sulcus_operator::script::{OneTool, smoothstep};
use sulcus_operator::{HandParams, Operator, Shown};

use super::run::{Run, SITES, go_in, model, scene_with, way};

#[test]
fn turning_in_the_narrowest_pocket_is_calm() {
    turning_is_calm(&["0.4"]);
}

/// Turns a probe at every site of the shipped scene with pockets of these widths, millimetres, at the prescribed depths.
pub fn turning_is_calm(widths: &[&str]) {
    for width in widths {
        let scene = scene_with(&[("width_mm = 0.4", &format!("width_mm = {width}"))]);
        for (degrees, depth) in SITES {
            let way = way(&scene, degrees, depth);
            let mut run = Run::new(&scene);
            let tool = run.scene.tools[0].clone();
            go_in(&mut run, &way, 2e-4);
            let insertion = run.measures();
            let side = way.up.cross(&way.outward).normalize();
            let (mut out_torque, mut in_torque) = (0.0, 0.0);
            for k in 0..4000 {
                // A whole turn to each side in four seconds, about the working point.
                let turn = 10_f64.to_radians() * libm::sin(0.5e-3 * PI * f64::from(k));
                let out = run.tick(&way.pose(&tool, 2e-4, turn, 4e-3));
                assert!(out.tools[0].converged, "{width} {degrees}: tick {k}");
                match k {
                    1000 => out_torque = run.torque(&out).dot(&side),
                    3000 => in_torque = run.torque(&out).dot(&side),
                    _ => {}
                }
            }
            let m = run.measures();
            println!(
                "{width} mm, {degrees}: insertion buzz {:.4} N, whole {:.4} N, jump {:.3} mm, torque step {:.2} N mm, torque {:.2} and {:.2} N mm, residual {:.3} um",
                insertion.buzz,
                m.buzz,
                m.jump * 1e3,
                run.torque_step * 1e3,
                out_torque * 1e3,
                in_torque * 1e3,
                m.residual * 1e6
            );
            assert!(insertion.buzz <= 3e-3 && m.buzz <= 3e-3);
            assert!(run.torque_step <= 1e-3, "{:e} N m", run.torque_step);
            // Against the turn on either side.
            assert!(out_torque < 0.0 && in_torque > 0.0);
            assert!(m.jump <= 0.35e-3 && m.solver_failed == 0 && m.exhausted == 0);
            assert!(m.residual <= 1e-6);
        }
    }
}

#[test]
fn a_hand_in_closed_loop_goes_in_bobs_and_leaves_without_a_kick() {
    let scene = scene_with(&[]);
    for (degrees, depth) in SITES {
        let way = way(&scene, degrees, depth);
        let tool = scene.tools[0].clone();
        let pose = move |t: f64| {
            let bob = 3e-4 * (1.0 - libm::cos(9.0 * (t - 2.0).clamp(0.0, 2.0)));
            let above = 8e-3 * (1.0 - smoothstep(t - 0.3)) - 8e-4 * smoothstep(t - 1.3) + bob;
            // Out again faster than in.
            let above = above + 9e-3 * smoothstep(4.0 * (t - 4.5));
            let turn = 10_f64.to_radians() * libm::sin(2.0 * (t - 2.0).clamp(0.0, PI));
            way.pose(&tool, above, turn, 4e-3)
        };
        let script = OneTool {
            pose,
            duration_s: 5.5,
        };
        let mut operator = Operator::new(Box::new(script), HandParams::default(), 3);
        let mut run = Run::new(&scene);
        let mut shown = Shown::NOTHING;
        for _ in 0..operator.ticks() {
            let mut input = TickInput::IDLE;
            input.tools = operator.step(&shown);
            let out = run.step(&input);
            shown = Shown::from(&out);
        }
        let m = run.measures();
        println!(
            "{degrees}: buzz {:.4} N, jump {:.3} mm, torque step {:.2} N mm, energy {:.4} mJ, exhausted {}, most {:.2} N",
            m.buzz,
            m.jump * 1e3,
            run.torque_step * 1e3,
            m.energy * 1e3,
            m.exhausted,
            m.max_raw_force
        );
        assert!(m.buzz <= 3e-3 && m.jump <= 0.35e-3 && m.solver_failed == 0);
        assert!(run.torque_step <= 1e-3, "{:e} N m", run.torque_step);
    }
}

#[test]
fn normals_never_flip_two_millimetres_deep_in_soft_gingiva() {
    let mut scene = scene_with(&[]);
    model(&mut scene).params.wall_stiffness = 100.0;
    model(&mut scene).params.shear_stiffness = 200.0;
    scene.tools[0].stiffness_n_per_m = 1000.0;
    for (degrees, depth) in [SITES[0], SITES[3]] {
        let way = way(&scene, degrees, depth);
        let mut run = Run::new(&scene);
        let tool = run.scene.tools[0].clone();
        go_in(&mut run, &way, 8e-4);
        let mut last: Vec<(u32, u32, Vec3)> = Vec::new();
        let start = run.state.tools[0].graphic.transform(&tool.working_point);
        // Least cosine between a normal and itself a tick before: up to 2 mm deep, and on the way out past the wall.
        let (mut least, mut least_after, mut pairs, mut gone) = (1.0_f64, 1.0_f64, 0, 0.0);
        for k in 0..4000 {
            let mut pose = way.pose(&tool, 8e-4, 0.0, 0.0);
            pose.position += way.outward * (1e-6 * f64::from(k));
            let out = run.tick(&pose);
            assert!(out.tools[0].converged, "tick {k}");
            let now: Vec<_> = run
                .ws
                .contacts()
                .filter(|(contact, load)| contact.object == 1 && *load > 0.0)
                .map(|(contact, _)| (contact.object_sphere, contact.tool_sphere, contact.normal))
                .collect();
            for (object, tool, normal) in &now {
                // No wall is pulled: what bears load pushes the tool inwards, upwards or along, not outwards. From about
                // 1.5 mm on the tip parts single spheres of a wall so soft, and lies beyond them.
                let outward = normal.dot(&way.outward);
                assert!(gone > 1.4e-3 || outward < 0.5, "tick {k}: {normal:?}");
                let same = last.iter().find(|(o, t, _)| o == object && t == tool);
                if let Some((_, _, before)) = same {
                    let cosine = normal.dot(before);
                    if gone <= 2e-3 {
                        least = least.min(cosine);
                    } else {
                        least_after = least_after.min(cosine);
                    }
                    pairs += 1;
                }
            }
            last = now;
            // All in all the wall pushes back; it does not let the tool through and push it on from behind.
            let push = run.state.loads[1].force.dot(&way.outward);
            assert!(k < 10 || gone > 2e-3 || push > 0.0, "tick {k}: {push} N");
            gone = (out.tools[0].graphic.transform(&tool.working_point) - start).dot(&way.outward);
        }
        println!(
            "{degrees}: {:.2} mm deep, {pairs} pairs from tick to tick, least cosine {least:.4}, past 2 mm {least_after:.4}",
            gone * 1e3
        );
        assert!(gone > 2e-3 && pairs > 1000, "{gone:e} m, {pairs} pairs");
        assert!(least > 0.9 && least_after > 0.85, "{least} {least_after}");
    }
}
