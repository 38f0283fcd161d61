//! Bench of a tick on the product's own scene: probe against one molar, level by level (trees built to level 5).
//!
//! Output: percentiles of the thread's CPU time, mean times by stage, and the number of spheres tested. Percentiles,
//! because a mean would hide the tail. The number is the same on every machine. The last line is the cost of level 5 in
//! units of level 3.
//!
//! `cargo bench -p sulcus-core`

// A bench has a clock and prints; the core does neither.
#![allow(clippy::disallowed_methods, clippy::disallowed_macros)]

use sulcus_cases::statistics::{Percentiles, percentiles_us};
use sulcus_cases::timing::{cpu_ns, time_stages};
use sulcus_core::optimise::SolverKind;
use sulcus_core::{NoProbe, Scene, Stage, State, TickInput, Workspace, tick};
use sulcus_operator::crown::{Crown, CrownParams};
use sulcus_operator::{HandParams, Operator, Shown};
use sulcus_scene::BuiltIn;
use sulcus_scene::{BuildOptions, compile_file, default_cache_dir};

/// Returns a line of percentiles, microseconds.
fn line(us: &Percentiles) -> String {
    format!(
        "{:7.2} {:7.2} {:7.2} {:8.2}",
        us.p50, us.p99, us.p999, us.max
    )
}

/// Returns the inputs of a closed loop, so that every run of a variant has the same hand.
fn inputs(scene: &Scene, seconds: f64) -> Vec<TickInput> {
    let crown = Crown::new(
        scene,
        None,
        CrownParams {
            duration: seconds,
            ..CrownParams::default()
        },
    )
    .expect("a tooth");
    let mut operator = Operator::new(Box::new(crown), HandParams::default(), 1);
    let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
    let mut shown = Shown::NOTHING;
    (0..operator.ticks())
        .map(|_| {
            let mut input = TickInput::IDLE;
            input.tools = operator.step(&shown);
            let out = tick(scene, &mut state, &mut ws, &input, &mut NoProbe);
            shown = Shown::from(&out);
            input
        })
        .collect()
}

fn main() {
    // `cargo test --benches` passes --test: nothing to check there.
    if std::env::args().any(|arg| arg == "--test") {
        return;
    }
    let options = BuildOptions {
        cache: default_cache_dir(),
        ..BuildOptions::default()
    };
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("crown-five-levels.toml");
    std::fs::write(
        &path,
        BuiltIn::Crown.text().replace("levels = 4", "levels = 5"),
    )
    .expect("a file");
    let scene = compile_file(&path, &options, &|_, _| {})
        .expect("the built-in scene, one level deeper")
        .scene;
    println!("probe on one molar, 20 s round the crown; thread CPU time, us");
    println!(
        "{:24} {:>7} {:>7} {:>7} {:>8}   substeps  rows  contact",
        "", "p50", "p99", "p99.9", "max"
    );
    let mut costs = [[0.0; 4]; 6];
    for (level, solver, blend) in [
        (2, SolverKind::ActiveSet, false),
        (3, SolverKind::ActiveSet, false),
        (4, SolverKind::ActiveSet, false),
        (5, SolverKind::ActiveSet, false),
        (2, SolverKind::ActiveSet, true),
        (3, SolverKind::ActiveSet, true),
        (4, SolverKind::ActiveSet, true),
        (3, SolverKind::Clarabel, false),
    ] {
        let mut scene = scene.clone();
        scene.params.solver = solver;
        scene.params.blend = blend;
        for tool in &mut scene.tools {
            tool.level = level;
        }
        for object in &mut scene.objects {
            object.level = level;
        }
        let inputs = inputs(&scene, 20.0);
        let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
        let (mut substeps, mut rows, mut contact) = (0u64, 0u64, 0u64);
        let mut times = Vec::with_capacity(inputs.len());
        for input in &inputs {
            let before = cpu_ns();
            let out = tick(&scene, &mut state, &mut ws, input, &mut NoProbe);
            times.push(cpu_ns() - before);
            substeps += u64::from(out.tools[0].substeps);
            rows += u64::from(out.tools[0].rows);
            contact += u64::from(out.tools[0].active > 0);
        }
        let us = percentiles_us(times.iter().copied());
        let n = inputs.len() as f64;
        println!(
            "level {level} {:16} {}   {:7.2} {:6.1} {:7.2}",
            format!("{solver:?}{}", if blend { ", blended" } else { "" }),
            line(&us),
            substeps as f64 / n,
            rows as f64 / n,
            contact as f64 / n
        );
        let work = ws.work();
        println!(
            "    spheres tested {:.0} per tick, lists made {:.3}",
            work.tested as f64 / n,
            work.lists as f64 / n
        );
        if solver == SolverKind::ActiveSet && !blend {
            let mean = times.iter().sum::<u64>() as f64 / n;
            let of_level = &mut costs[usize::from(level)];
            *of_level = [us.p50, mean * 1e-3, us.p99, work.tested as f64 / n];
        }
        let stages = time_stages(&scene, &inputs);
        let mean = |stage: Stage| {
            let sum: u64 = stages[stage as usize].iter().sum();
            format!("{stage:?} {:.2}", sum as f64 / n * 1e-3)
        };
        println!(
            "    mean by stage, us (each with the clock's own 0.2 or so): {}",
            Stage::ALL.map(mean).join(", ")
        );
    }
    let times = |k: usize| costs[5][k] / costs[3][k];
    println!(
        "hard contact, level 5 in units of level 3: p50 {:.2}, mean {:.2}, p99 {:.2}, spheres tested {:.2}",
        times(0),
        times(1),
        times(2),
        times(3)
    );
}
