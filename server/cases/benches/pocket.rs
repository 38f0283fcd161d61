//! Time of a tick with a probe in a pocket: the shipped scene at level 3, a hand in closed loop that goes into each site's
//! pocket, bobs on its floor and turns. Thread CPU time of ticks in contact, in percentiles, and by stage.
//!
//! `cargo bench -p sulcus-cases --bench pocket`

use std::path::Path;

use rustix::time::{ClockId, clock_gettime};
use sulcus_cases::pocket::{Way, gingiva_of};
use sulcus_core::{NoProbe, Scene, Stage, StageProbe, State, TickInput, Workspace, tick};
use sulcus_operator::script::{OneTool, smoothstep};
use sulcus_operator::{HandParams, Operator, Shown};
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

fn cpu_ns() -> u64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
}

/// Percentile of sorted nanoseconds, microseconds.
fn at(times: &[u64], q: f64) -> f64 {
    times[((times.len() - 1) as f64 * q) as usize] as f64 * 1e-3
}

#[derive(Default)]
struct Stages {
    current: Option<(Stage, u64)>,
    sums: [u64; 5],
}

impl StageProbe for Stages {
    fn begin(&mut self, stage: Stage) {
        self.end();
        self.current = Some((stage, cpu_ns()));
    }
    fn end(&mut self) {
        if let Some((stage, since)) = self.current.take() {
            self.sums[stage as usize] += cpu_ns() - since;
        }
    }
}

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
    let mut operator = Operator::new(Box::new(script), HandParams::default(), 7);
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
    let mut stages = Stages::default();
    let mut ticks = 0_u64;
    for (degrees, depth) in SITES {
        let inputs = inputs(&scene, degrees, depth);
        let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
        let mut times = Vec::new();
        let (mut substeps, mut rows, mut active) = (0_u64, 0_u64, 0_u64);
        for input in &inputs {
            let before = cpu_ns();
            let out = tick(&scene, &mut state, &mut ws, input, &mut NoProbe);
            let took = cpu_ns() - before;
            if out.tools[0].active > 0 {
                times.push(took);
                substeps += u64::from(out.tools[0].substeps);
                rows += u64::from(out.tools[0].rows);
                active += u64::from(out.tools[0].active);
            }
        }
        let n = times.len() as f64;
        all.extend_from_slice(&times);
        times.sort_unstable();
        println!(
            "{degrees:8} {:7.1} {:7.1} {:7.1} {:8.1}   {:8.2} {:5.1} {:7.1}",
            at(&times, 0.5),
            at(&times, 0.99),
            at(&times, 0.999),
            at(&times, 1.0),
            substeps as f64 / n,
            rows as f64 / n,
            active as f64 / n
        );
        let (mut state, mut ws) = (State::new(&scene), Workspace::new(&scene));
        for input in &inputs {
            tick(&scene, &mut state, &mut ws, input, &mut stages);
        }
        ticks += inputs.len() as u64;
    }
    all.sort_unstable();
    println!(
        "{:>8} {:7.1} {:7.1} {:7.1} {:8.1}",
        "all",
        at(&all, 0.5),
        at(&all, 0.99),
        at(&all, 0.999),
        at(&all, 1.0)
    );
    let mean = |stage: Stage| {
        format!(
            "{stage:?} {:.1}",
            stages.sums[stage as usize] as f64 / ticks as f64 * 1e-3
        )
    };
    println!(
        "mean by stage over all ticks, us (each with the clock's own 0.2 or so): {}",
        Stage::ALL.map(mean).join(", ")
    );
}
