//! Time of a tick with a probe in a pocket: the shipped scene at level 3, a hand in closed loop that goes into each site's
//! pocket, bobs on its floor and turns. Thread CPU time of ticks in contact, in percentiles, and by stage.
//!
//! `cargo bench -p sulcus-cases --bench pocket`

use std::path::Path;

use sulcus_cases::pocket::{Way, gingiva_of};
use sulcus_cases::record;
use sulcus_cases::statistics::percentiles_us;
use sulcus_cases::timing::{time, time_stages};
use sulcus_core::{Scene, Stage, TickInput};
use sulcus_operator::HandParams;
use sulcus_operator::script::{OneTool, smoothstep};
use sulcus_scene::{BuildOptions, compile_file};

/// Angles of the sites, degrees, and their depths, metres.
const SITES: [(f64, f64); 6] = [
    (35.0, 3e-3),
    (90.0, 2e-3),
    (145.0, 3e-3),
    (-145.0, 4e-3),
    (-90.0, 2.5e-3),
    (-35.0, 3e-3),
];
const SECONDS: f64 = 6.0;

/// What a hand does at one site, as recorded inputs.
fn inputs(scene: &Scene, degrees: f64, depth: f64) -> Vec<TickInput> {
    let (_, _, model) = gingiva_of(scene).expect("a gingiva");
    let around = degrees.to_radians();
    let height = model.margin_at(around) - depth + model.params.sink();
    let way = Way::new(scene, 0, &model.tooth, around, height);
    let tool = scene.tools[0].clone();
    let pose = move |t: f64| {
        // In by one second, bobbing from two on, turning to and fro meanwhile.
        let bob = 3e-4 * (1.0 - libm::cos(9.0 * (t - 2.0).max(0.0)));
        let above = 8e-3 * (1.0 - smoothstep(t - 0.3)) - 8e-4 * smoothstep(t - 1.3) + bob;
        let turn = 10f64.to_radians() * libm::sin(2.0 * (t - 2.0).max(0.0));
        way.pose(&tool, above, turn, 4e-3)
    };
    let script = OneTool {
        pose,
        duration_s: SECONDS,
    };
    let ticks = (SECONDS * 1e3) as u64;
    record(
        scene,
        Box::new(script),
        (HandParams::default(), 7),
        ticks,
        |_, _| {},
    )
}

fn main() {
    // `cargo test --benches` passes --test: nothing to check there.
    if std::env::args().any(|arg| arg == "--test") {
        return;
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/pocket.toml");
    let scene = compile_file(&file, &BuildOptions::cached(), &|_, _| ())
        .expect("the shipped scene")
        .scene;
    println!("probe in a pocket, level 3, closed loop; thread CPU time of ticks in contact, us");
    println!(
        "{:>8} {:>7} {:>7} {:>7} {:>8}   substeps  rows  active",
        "site", "p50", "p99", "p99.9", "max"
    );
    let mut all = Vec::new();
    let mut sums = [0; Stage::ALL.len()];
    let mut ticks = 0_u64;
    let line = |site: &str, times: &[u64]| {
        let at = percentiles_us(times.iter().copied());
        format!(
            "{site:>8} {:7.1} {:7.1} {:7.1} {:8.1}",
            at.p50, at.p99, at.p999, at.max
        )
    };
    for (degrees, depth) in SITES {
        let inputs = inputs(&scene, degrees, depth);
        let mut touching = vec![false; inputs.len()];
        let (mut substeps, mut rows, mut active) = (0_u64, 0_u64, 0_u64);
        let run = time(&scene, &inputs, |k, out| {
            touching[k] = out.tools[0].active > 0;
            if touching[k] {
                substeps += u64::from(out.tools[0].substeps);
                rows += u64::from(out.tools[0].rows);
                active += u64::from(out.tools[0].active);
            }
        });
        let in_contact = run.cpu.iter().zip(&touching);
        let times: Vec<u64> = in_contact.filter_map(|(t, on)| on.then_some(*t)).collect();
        let n = times.len() as f64;
        println!(
            "{}   {:8.2} {:5.1} {:7.1}",
            line(&degrees.to_string(), &times),
            substeps as f64 / n,
            rows as f64 / n,
            active as f64 / n
        );
        all.extend_from_slice(&times);
        for (sum, times) in sums.iter_mut().zip(time_stages(&scene, &inputs)) {
            *sum += times.iter().sum::<u64>();
        }
        ticks += inputs.len() as u64;
    }
    println!("{}", line("all", &all));
    let mean = |stage: Stage| {
        format!(
            "{stage:?} {:.1}",
            sums[stage as usize] as f64 / ticks as f64 * 1e-3
        )
    };
    println!(
        "mean by stage over all ticks, us (each with the clock's own 0.2 or so): {}",
        Stage::ALL.map(mean).join(", ")
    );
}
