//! The wall of a pocket is as stiff at one level of detail as at the next.

use sulcus_core::Scene;

use sulcus_support::long;

use crate::pocket::run::{Run, SITES, go_in, model, scene_with, way};

/// Stiffness of the wall at a site, N/m: force over the way of the tip when a probe that cannot turn is pushed against it, and
/// no tooth is in its way. From 0.3 to 0.9 mm deep: no first touch, no edge. Mean over three places 4 degrees apart: at one
/// place alone it tells as much of the bumps of a level as of its stiffness.
fn mean_wall_stiffness(scene: &Scene, (degrees, depth): (f64, f64), level: u8) -> f64 {
    let places = [-4.0, 0.0, 4.0].map(|off| wall_stiffness(scene, (degrees + off, depth), level));
    places.iter().sum::<f64>() / 3.0
}

fn wall_stiffness(with_tooth: &Scene, (degrees, depth): (f64, f64), level: u8) -> f64 {
    let way = way(with_tooth, degrees, depth);
    let mut scene = with_tooth.clone();
    scene.objects[1].level = level;
    model(&mut scene).level = level;
    scene.objects.remove(0);
    scene.tools[0].stiffness_n_per_m = 5e3;
    scene.tools[0].stiffness_nm_per_rad = 100.0;
    let mut run = Run::new(&scene);
    let tool = run.scene.tools[0].clone();
    go_in(&mut run, &way, 2e-4);
    let mut seen: Vec<(f64, f64)> = Vec::new();
    let mut touched = None;
    for k in 0..4000 {
        let mut pose = way.pose(&tool, 2e-4, 0.0, 0.0);
        pose.position += way.outward * (5e-7 * f64::from(k) - 3e-4);
        let out = run.tick(&pose);
        let at = out.tools[0].graphic.transform(&tool.tip).dot(&way.outward);
        let force = run.state.loads[0].force.dot(&way.outward);
        if force > 0.01 {
            let touched = *touched.get_or_insert(at);
            seen.push((at - touched, force));
        }
    }
    let past = |depth: f64| {
        let found = seen.iter().find(|(at, _)| *at >= depth);
        *found.unwrap_or_else(|| panic!("never {depth} m deep: {:?}", seen.last()))
    };
    let (from, to) = (past(3e-4), past(9e-4));
    (to.1 - from.1) / (to.0 - from.0)
}

#[test]
fn the_wall_is_as_stiff_at_level_4_as_at_level_3() {
    if !long::selected("pocket-wall-and-tooth") {
        return;
    }
    let mut scene = scene_with(&[("levels = 3", "levels = 4")]);
    let mut stiffness = [0.0; 2];
    for (degrees, depth) in [SITES[0], SITES[3], SITES[4]] {
        for (level, found) in [3, 4].into_iter().zip(&mut stiffness) {
            scene.objects[1].level = level;
            model(&mut scene).level = level;
            let way = way(&scene, degrees, depth);
            let mut run = Run::new(&scene);
            let tool = run.scene.tools[0].clone();
            go_in(&mut run, &way, 6e-4);
            // Away from the tooth, slowly; force on the gingiva over the way of the working point.
            let mut seen = Vec::new();
            for k in 0..2400 {
                let mut pose = way.pose(&tool, 6e-4, 0.0, 0.0);
                pose.position += way.outward * (1e-6 * f64::from(k));
                let out = run.tick(&pose);
                let at = out.tools[0].graphic.transform(&tool.working_point);
                let force = run.state.loads[1].force.dot(&way.outward);
                seen.push((at.dot(&way.outward), force));
            }
            let (from, to) = (seen[1200], seen[2399]);
            *found = (to.1 - from.1) / (to.0 - from.0);
        }
        let [three, four] = stiffness;
        println!("{degrees}: wall {three:.0} N/m at level 3, {four:.0} N/m at level 4");
        assert!((three / four - 1.0).abs() <= 0.05, "{three} {four}");
    }
}

#[test]
fn the_wall_alone_is_as_stiff_at_level_4_as_at_level_3() {
    if !long::selected("pocket-wall-alone") {
        return;
    }
    let scene = scene_with(&[("levels = 3", "levels = 4")]);
    let pairs = SITES.map(|site| [3, 4].map(|level| mean_wall_stiffness(&scene, site, level)));
    for ((degrees, _), [three, four]) in SITES.iter().zip(&pairs) {
        println!(
            "{degrees}: wall {three:.0} N/m at level 3, {four:.0} N/m at level 4: {:+.1} %",
            100.0 * (three / four - 1.0)
        );
    }
    let [three, four] = [0, 1].map(|k| pairs.iter().map(|pair| pair[k]).sum::<f64>() / 6.0);
    println!("mean {three:.0} and {four:.0} N/m");
    assert!((three / four - 1.0).abs() <= 0.02, "{three} {four}");
    for ((degrees, depth), [three, four]) in SITES.iter().zip(&pairs) {
        // Where the pocket is shallow the ends of the contact still tell.
        let bound = if *depth > 2e-3 { 0.05 } else { 0.1 };
        assert!(
            (three / four - 1.0).abs() <= bound,
            "{degrees}: {three} {four}"
        );
    }
}
