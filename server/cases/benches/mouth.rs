//! Time of a tick in a mouth full of teeth: the probe in a pocket, the mirror on the tongue, two hands in closed loop for 10 s.
//! Thread CPU time of all ticks in percentiles and by stage, with teeth at level 3 and 4, and with 4 teeth against 14.
//!
//! `cargo bench -p sulcus-cases --bench mouth`, or with `-- 14 3` behind it for 14 teeth at level 3 alone.

use rustix::time::{ClockId, clock_gettime};
use sulcus_cases::mouth::{hands, mouth};
use sulcus_core::{
    MAX_TOOLS, NoProbe, Scene, Stage, StageProbe, State, TickInput, Workspace, tick,
};
use sulcus_operator::{HandParams, Operator, Shown};

const SECONDS: f64 = 10.0;
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

fn line(times: &mut [u64]) -> String {
    times.sort_unstable();
    format!(
        "{:7.1} {:7.1} {:7.1} {:8.1}",
        at(times, 0.5),
        at(times, 0.99),
        at(times, 0.999),
        at(times, 1.0)
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

/// What two hands do in closed loop, as recorded inputs, and how often each tool was in contact.
fn inputs(scene: &Scene) -> (Vec<TickInput>, [usize; MAX_TOOLS]) {
    let script = hands(scene, SECONDS);
    let mut operator = Operator::new(Box::new(script), HandParams::default(), 7);
    let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
    let mut shown = Shown::NOTHING;
    let mut contact = [0; MAX_TOOLS];
    let inputs = (0..operator.ticks()).map(|_| {
        let mut input = TickInput::IDLE;
        input.tools = operator.step(&shown);
        let out = tick(scene, &mut state, &mut ws, &input, &mut NoProbe);
        shown = Shown::from(&out);
        for (contact, tool) in contact.iter_mut().zip(&out.tools) {
            *contact += usize::from(tool.active > 0);
        }
        input
    });
    (inputs.collect(), contact)
}

/// Times `scene` under `inputs`: whole ticks (each its fastest run), and each stage's in a run of its own.
fn measure(name: &str, scene: &Scene, inputs: &[TickInput]) {
    let mut whole = vec![u64::MAX; inputs.len()];
    let mut stages: [Vec<u64>; 5] = std::array::from_fn(|_| vec![u64::MAX; inputs.len()]);
    let (mut substeps, mut rows, mut work) = ([0; MAX_TOOLS], [0; MAX_TOOLS], Default::default());
    for run in 0..RUNS {
        let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
        for (time, input) in whole.iter_mut().zip(inputs) {
            let before = cpu_ns();
            let out = tick(scene, &mut state, &mut ws, input, &mut NoProbe);
            *time = (*time).min(cpu_ns() - before);
            if run == 0 {
                for t in 0..MAX_TOOLS {
                    substeps[t] += u64::from(out.tools[t].substeps);
                    rows[t] += u64::from(out.tools[t].rows);
                }
            }
        }
        work = ws.work();
        let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
        for (k, input) in inputs.iter().enumerate() {
            let mut probe = Stages::default();
            tick(scene, &mut state, &mut ws, input, &mut probe);
            for (times, sum) in stages.iter_mut().zip(probe.sums) {
                times[k] = times[k].min(sum);
            }
        }
    }
    println!("{name:28} {}", line(&mut whole));
    for (stage, times) in Stage::ALL.iter().zip(&mut stages) {
        println!("{:>28} {}", format!("{stage:?}"), line(times));
    }
    let n = inputs.len() as f64;
    let mean = |x: [u64; MAX_TOOLS]| x.map(|x| format!("{:.2}", x as f64 / n)).join(" and ");
    println!(
        "{:>28} passes {}, rows {}, {work:?}\n",
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
        let (inputs, contact) = inputs(&scene);
        println!("ticks in contact: {contact:?} of {}", inputs.len());
        measure(&format!("{teeth} teeth, level {level}"), &scene, &inputs);
    }
}
