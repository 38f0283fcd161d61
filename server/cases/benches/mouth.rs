//! Time of a tick in a mouth full of teeth: the probe in a pocket, the mirror on the tongue, two hands in closed loop for 10 s
//! from when both are at work on. Thread CPU time of all these ticks in percentiles and by stage, with teeth at level 3 and 4, and
//! with 4 teeth against 14.
//!
//! `cargo bench -p sulcus-cases --bench mouth`, or with `-- 14 3` behind it for 14 teeth at level 3 alone.

use rustix::time::{ClockId, clock_gettime};
use sulcus_cases::mouth::{hands, inputs, mouth};
use sulcus_core::{
    MAX_TOOLS, NoProbe, Scene, Stage, StageProbe, State, TICK_S, TickInput, Workspace, tick,
};

/// When the mirror holds the tongue and the probe is in the pocket, seconds, and how long is measured from then on.
const BEGINS: f64 = 7.0;
const SECONDS: f64 = 10.0;
/// Time for the hands to leave afterwards, seconds.
const LEAVING: f64 = 8.0;
/// A patient with all teeth.
const PATIENT: u64 = 1;
/// Times that the same inputs are run: each tick counts with its fastest, which leaves out what other processes do to a
/// shared machine's caches, and nothing of the tick's own.
const RUNS: usize = 5;

fn cpu_ns() -> u64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as u64 * 1_000_000_000 + now.tv_nsec as u64
}

/// Percentile of sorted nanoseconds, microseconds.
fn at(times: &[u64], q: f64) -> f64 {
    times[((times.len() - 1) as f64 * q) as usize] as f64 * 1e-3
}

/// Percentiles of the measured ticks among `times`.
fn line(times: Vec<u64>) -> String {
    let measured = times.into_iter().enumerate();
    let mut times: Vec<u64> = measured
        .filter_map(|(k, time)| is_measured(k).then_some(time))
        .collect();
    times.sort_unstable();
    format!(
        "{:7.1} {:7.1} {:7.1} {:8.1}",
        at(&times, 0.5),
        at(&times, 0.99),
        at(&times, 0.999),
        at(&times, 1.0)
    )
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

/// Ticks run, and whether one is measured.
fn ticks() -> u64 {
    ((BEGINS + SECONDS) / TICK_S).round() as u64
}

fn is_measured(k: usize) -> bool {
    k as f64 * TICK_S >= BEGINS
}

/// Times `scene` under `inputs`: whole ticks (each its fastest run), and each stage's in a run of its own.
fn measure(name: &str, scene: &Scene, inputs: &[TickInput]) {
    let (mut whole, mut once) = (vec![u64::MAX; inputs.len()], Vec::new());
    let mut stages: [Vec<u64>; 5] = std::array::from_fn(|_| vec![u64::MAX; inputs.len()]);
    let (mut substeps, mut rows) = ([0; MAX_TOOLS], [0; MAX_TOOLS]);
    for run in 0..RUNS {
        let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
        for (k, (time, input)) in whole.iter_mut().zip(inputs).enumerate() {
            let before = cpu_ns();
            let out = tick(scene, &mut state, &mut ws, input, &mut NoProbe);
            let taken = cpu_ns() - before;
            *time = (*time).min(taken);
            if run == 0 {
                once.push(taken);
            }
            if run == 0 && is_measured(k) {
                for t in 0..MAX_TOOLS {
                    substeps[t] += u64::from(out.tools[t].substeps);
                    rows[t] += u64::from(out.tools[t].rows);
                }
            }
        }
        let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
        for (k, input) in inputs.iter().enumerate() {
            let mut probe = Stages::default();
            tick(scene, &mut state, &mut ws, input, &mut probe);
            for (times, sum) in stages.iter_mut().zip(probe.sums) {
                times[k] = times[k].min(sum);
            }
        }
    }
    println!("{name:28} {}", line(whole));
    println!("{:>28} {}", "the first run alone", line(once));
    for (stage, times) in Stage::ALL.iter().zip(stages) {
        println!("{:>28} {}", format!("{stage:?}"), line(times));
    }
    let n = SECONDS / TICK_S;
    let mean = |x: [u64; MAX_TOOLS]| x.map(|x| format!("{:.2}", x as f64 / n)).join(" and ");
    println!(
        "{:>28} passes {}, rows {}\n",
        "",
        mean(substeps),
        mean(rows)
    );
}

fn main() {
    // `cargo test --benches` passes --test: nothing to check there.
    if std::env::args().any(|arg| arg == "--test") {
        return;
    }
    println!("probe in a pocket and mirror on the tongue, closed loop; thread CPU time, us");
    println!(
        "{:28} {:>7} {:>7} {:>7} {:>8}",
        "", "p50", "p99", "p99.9", "max"
    );
    let numbers: Vec<usize> = std::env::args()
        .filter_map(|arg| arg.parse().ok())
        .collect();
    for (teeth, level) in [(14, 3), (4, 3), (14, 4), (4, 4)] {
        if !numbers.is_empty() && numbers != [teeth, usize::from(level)] {
            continue;
        }
        let scene = mouth(PATIENT, teeth == 4, level);
        let mut contact = [0; MAX_TOOLS];
        let script = hands(&scene, BEGINS + SECONDS + LEAVING);
        let inputs = inputs(&scene, script, ticks(), |k, out| {
            for (contact, tool) in contact.iter_mut().zip(&out.tools) {
                *contact += usize::from(tool.active > 0 && is_measured(k as usize));
            }
        });
        println!(
            "measured ticks in contact: {contact:?} of {:.0}",
            SECONDS / TICK_S
        );
        measure(&format!("{teeth} teeth, level {level}"), &scene, &inputs);
    }
}
