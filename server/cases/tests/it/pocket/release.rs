//! What was pressed comes back and gives no energy.

use sulcus_core::{Pose, TickInput, Wrench};

use super::run::{Feeler, Run, SITES, go_in, scene_with, way};

#[test]
fn let_go_it_gives_no_energy_and_comes_back() {
    let scene = scene_with(&[]);
    let (degrees, depth) = SITES[0];
    let way = way(&scene, degrees, depth);
    let mut run = Run::new(&scene);
    let tool = run.scene.tools[0].clone();
    go_in(&mut run, &way, 0.0);
    let (mut work_in, mut work_out) = (0.0, 0.0_f64);
    let mut last: Option<(Pose, Wrench)> = None;
    // Pressed down and outwards, and back the same way.
    for k in 0..=4000_i32 {
        let share = f64::from(2000 - (2000 - k).abs()) / 2000.0;
        let mut pose = way.pose(&tool, -1.2e-3 * share, 0.0, 0.0);
        pose.position += way.outward * (1e-3 * share);
        let out = run.tick(&pose);
        let o = &out.tools[0];
        if let Some((before, raw)) = last {
            let work = -raw.force.dot(&(o.haptic.position - before.position));
            work_in += if work > 0.0 { work } else { 0.0 };
            work_out += if work < 0.0 { -work } else { 0.0 };
        }
        last = Some((o.haptic, o.raw_wrench));
    }
    println!(
        "work in {:.3} mJ, out again {:.3} mJ",
        work_in * 1e3,
        work_out * 1e3
    );
    assert!(work_in > 1e-4 && work_out <= 1.01 * work_in);
    // Pressed again, and the hand opens: nothing holds the tool, the tissue comes back.
    let mut before = f64::INFINITY;
    Feeler::default().press_to(&mut run, &way, 0.3);
    for k in 0..500 {
        run.step(&TickInput::IDLE);
        let most = run
            .ws
            .shape_of(1)
            .iter()
            .fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most });
        assert!(most <= before, "tick {k}: {most:e} m after {before:e}");
        before = most;
    }
    assert!(before <= 1e-6, "{before:e} m from rest");
    assert!(
        run.state.tissue.iter().all(|x| *x == 0.0),
        "at rest, and asleep"
    );
}
