//! Bench of a tick with a mouth mirror on the parametric tongue at level 3.
//!
//! Output: percentiles of the thread's CPU time over ticks in contact, and mean times by stage over all ticks.
//! Variants: coarse skeleton, fine skeleton, both alternately with transitions, and finite elements.
//!
//! `cargo bench -p sulcus-core --bench tongue`

// A bench has a clock and prints; the core does neither.
#![allow(clippy::disallowed_methods, clippy::disallowed_macros)]

use sulcus_cases::statistics::percentiles_us;
use sulcus_cases::timing::{cpu_ns, time_stages};
use sulcus_core::math::exp_rotation;
use sulcus_core::{NoProbe, Pose, Scene, Stage, State, TickInput, Vec3, Workspace, tick};
use sulcus_operator::present;
use sulcus_scene::{BuildOptions, compile_file, default_cache_dir};

/// Returns the input at time `t`, seconds. The flat disc of the mirror moves down by `down` metres in the first second.
/// After 1.5 s the disc slides to and fro and turns.
fn input(scene: &Scene, t: f64, down: f64) -> TickInput {
    let tool = &scene.tools[0];
    let flat = exp_rotation(&Vec3::new(0.0, 0.0, std::f64::consts::PI))
        * exp_rotation(&Vec3::new(0.0, -std::f64::consts::FRAC_PI_4, 0.0));
    let slide = if t > 1.5 { t - 1.5 } else { 0.0 };
    let tilt = Vec3::new(
        0.15 * libm::sin(1.1 * slide),
        0.1 * libm::sin(0.7 * slide),
        0.0,
    );
    let turned = exp_rotation(&tilt) * flat;
    let place = Vec3::new(
        0.005 + 0.008 * libm::sin(slide),
        0.008 * libm::sin(0.8 * slide),
        0.034 - down * if t < 1.0 { t } else { 1.0 },
    );
    let mut input = TickInput::IDLE;
    input.tools[0] = present(&Pose::new(place - turned * tool.working_point, turned));
    input
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
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let compiled = |name: &str| {
        compile_file(&folder.join(name), &options, &|_, _| {})
            .expect("the tongue")
            .scene
    };
    let (springs, elements) = (compiled("tongue.toml"), compiled("organ.toml"));
    println!("mirror on tongue, 6 s, level 3; thread CPU time of ticks in contact, us");
    println!(
        "{:16} {:>7} {:>7} {:>7} {:>8}   substeps  rows  active  force N",
        "", "p50", "p99", "p99.9", "max"
    );
    type Detail = fn(usize) -> u8;
    let details: [(&str, &Scene, Detail); 4] = [
        ("coarse", &springs, |_| 0),
        ("fine", &springs, |_| 1),
        ("always between", &springs, |k| (k / 150 % 2) as u8),
        ("elements", &elements, |_| 0),
    ];
    for (name, scene, detail) in details {
        for down in [0.01, 0.016] {
            let inputs: Vec<TickInput> = (0..6_000)
                .map(|k| TickInput {
                    detail: detail(k),
                    ..input(scene, k as f64 * 1e-3, down)
                })
                .collect();
            let n = inputs.len() as f64;
            let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
            let (mut substeps, mut rows, mut active, mut force) = (0u64, 0u64, 0u64, 0.0);
            let times: Vec<u64> = inputs
                .iter()
                .filter_map(|input| {
                    let before = cpu_ns();
                    let out = tick(scene, &mut state, &mut ws, input, &mut NoProbe);
                    let time = cpu_ns() - before;
                    substeps += u64::from(out.tools[0].substeps);
                    rows += u64::from(out.tools[0].rows);
                    active += u64::from(out.tools[0].active);
                    force += out.tools[0].raw_wrench.force.norm();
                    (out.tools[0].active > 0).then_some(time)
                })
                .collect();
            let us = percentiles_us(times);
            println!(
                "{name:16} {:7.1} {:7.1} {:7.1} {:8.1}   {:7.2} {:6.1} {:6.1} {:6.2}",
                us.p50,
                us.p99,
                us.p999,
                us.max,
                substeps as f64 / n,
                rows as f64 / n,
                active as f64 / n,
                force / n
            );
            let stages = time_stages(scene, &inputs);
            let mean = |stage: Stage| {
                let sum: u64 = stages[stage as usize].iter().sum();
                format!("{stage:?} {:.2}", sum as f64 / n * 1e-3)
            };
            println!(
                "    mean by stage, us (each with the clock's own 0.2 or so): {}",
                Stage::ALL.map(mean).join(", ")
            );
        }
    }
}
