//! Time of a tick in a mouth full of teeth: the probe in a pocket, the mirror on the tongue, two hands in closed loop for 10 s
//! from when both are at work on. Thread CPU time of all these ticks in percentiles and by stage, with teeth at level 3 and 4, and
//! with 4 teeth against 14.
//!
//! `cargo bench -p sulcus-cases --bench mouth`, or with `-- 14 3` behind it for 14 teeth at level 3 alone.

use sulcus_cases::mouth::{hands, mouth};
use sulcus_cases::record;
use sulcus_cases::statistics::percentiles_us;
use sulcus_cases::timing::{keep_fastest, time, time_stages};
use sulcus_core::{MAX_TOOLS, Scene, Stage, TickInput};
use sulcus_operator::HandParams;

/// Length of a tick, seconds.
const TICK_S: f64 = 1e-3;
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

/// Percentiles of the measured ticks among `times`.
fn line(times: &[u64]) -> String {
    let measured = times.iter().enumerate();
    let at = percentiles_us(measured.filter_map(|(k, time)| is_measured(k).then_some(*time)));
    format!(
        "{:7.1} {:7.1} {:7.1} {:8.1}",
        at.p50, at.p99, at.p999, at.max
    )
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
    let (mut whole, mut once) = (Vec::new(), Vec::new());
    let mut stages: [Vec<u64>; Stage::ALL.len()] = Default::default();
    let (mut substeps, mut rows) = ([0; MAX_TOOLS], [0; MAX_TOOLS]);
    for run in 0..RUNS {
        let times = time(scene, inputs, |k, out| {
            if run == 0 && is_measured(k) {
                for t in 0..MAX_TOOLS {
                    substeps[t] += u64::from(out.tools[t].substeps);
                    rows[t] += u64::from(out.tools[t].rows);
                }
            }
        });
        keep_fastest(&mut whole, &times.cpu);
        if run == 0 {
            once = times.cpu;
        }
        for (times, run) in stages.iter_mut().zip(time_stages(scene, inputs)) {
            keep_fastest(times, &run);
        }
    }
    println!("{name:28} {}", line(&whole));
    println!("{:>28} {}", "the first run alone", line(&once));
    for (stage, times) in Stage::ALL.iter().zip(&stages) {
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
        let hand = (HandParams::default(), 7);
        let inputs = record(&scene, Box::new(script), hand, ticks(), |k, played| {
            for (contact, tool) in contact.iter_mut().zip(&played.output.tools) {
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
