//! Counted work of ticks beside their CPU time, case by case: the calibration of the weights of `sulcus_core::work`.

use std::io::Write;
use std::path::PathBuf;

use clap::Parser;
use sulcus_cases::bounded::Comparison;
use sulcus_cases::statistics::percentile;
use sulcus_cases::timing::cpu_ns;
use sulcus_cases::{Case, TABLE, find, fuzz, run_on};
use sulcus_core::output::status;
use sulcus_core::work::Counts;
use sulcus_core::{NoProbe, Params, Scene, State, TickInput, Workspace, tick};

/// Number of runs of which the fastest time of each tick counts.
const RUNS: usize = 3;

/// Print counted work and CPU time of the ticks of hard cases and random walks
#[derive(Parser)]
struct Arguments {
    /// Names of hard cases. All cases and all random walks without a name
    #[arg(value_name = "CASE", value_parser = known)]
    cases: Vec<&'static Case>,
    /// Bound on the work of a tick, operations; 0 for none. The scene's own without this option
    #[arg(long, value_name = "OPERATIONS")]
    max_work: Option<u32>,
    /// Print exhausted tool-ticks instead: without a bound as in scenes up to version 7, and with the bound
    #[arg(long)]
    exhausted: bool,
    /// File to which each tick's time (nanoseconds) and counts are written, separated by commas
    #[arg(long, value_name = "FILE")]
    ticks: Option<PathBuf>,
}

/// Returns the hard case of that name.
fn known(name: &str) -> Result<&'static Case, String> {
    find(name).ok_or_else(|| format!("no hard case is called `{name}`"))
}

/// Time and counts of one tick.
struct Measured {
    ns: u64,
    counts: Counts,
    exhausted: bool,
}

/// Runs the inputs several times and returns the fastest time of each tick.
fn measured(scene: &Scene, inputs: &[TickInput]) -> Vec<Measured> {
    let mut all: Vec<Measured> = Vec::new();
    for run in 0..RUNS {
        let (mut state, mut ws) = (State::new(scene), Workspace::new(scene));
        for (k, input) in inputs.iter().enumerate() {
            let begun = cpu_ns();
            let out = tick(scene, &mut state, &mut ws, input, &mut NoProbe);
            let ns = cpu_ns() - begun;
            if run == 0 {
                let bits = out.tools.iter().fold(0, |bits, tool| bits | tool.status);
                all.push(Measured {
                    ns,
                    counts: ws.counts(),
                    exhausted: bits & status::EXHAUSTED != 0,
                });
            } else {
                all[k].ns = all[k].ns.min(ns);
            }
        }
    }
    all
}

fn line(name: &str, ticks: &[Measured]) -> String {
    let at = |value: &dyn Fn(&Measured) -> u64, share: f64| {
        let mut values: Vec<u64> = ticks.iter().map(value).collect();
        values.sort_unstable();
        percentile(&values, share).unwrap_or(0) as f64 * 1e-3
    };
    let ns = |tick: &Measured| tick.ns;
    let work = |tick: &Measured| tick.counts.work();
    let exhausted = ticks.iter().filter(|tick| tick.exhausted).count();
    format!(
        "{name:36} {:7.1} {:7.1} {:7.1}  {:7.1} {:7.1} {:7.1}  {:6.3}",
        at(&ns, 0.5),
        at(&ns, 0.999),
        at(&ns, 1.0),
        at(&work, 0.5),
        at(&work, 0.999),
        at(&work, 1.0),
        100.0 * exhausted as f64 / ticks.len().max(1) as f64,
    )
}

/// Prints the exhausted tool-ticks of each case without and with a bound, and the largest work with it.
fn print_exhausted(cases: &[&'static Case], max_work: Option<u32>) {
    println!(
        "{:24} {:>8} {:>8} {:>8} {:>8} {:>6} {:>6} {:>8} {:>8}  broken bounds",
        "case", "ticks", "without", "with", "kop max", "forks", "beyond", "force %", "mm"
    );
    let chosen = |name: &str| cases.is_empty() || cases.iter().any(|case| case.name == name);
    for case in TABLE.iter().filter(|case| chosen(case.name)) {
        let former = run_on(case, |scene| without_bound(&mut scene.params), |_| {});
        let mut most = 0;
        let mut comparison = Comparison::default();
        let bounded = run_on(
            case,
            |scene| {
                if let Some(max_work) = max_work {
                    scene.params.max_work = max_work;
                }
            },
            |seen| {
                most = most.max(seen.output.work);
                comparison.observe(seen);
            },
        );
        let deviation = comparison.found;
        println!(
            "{:24} {:8} {:8} {:8} {:8.1} {:6} {:6} {:8.2} {:8.4}  {:?} {:?}",
            case.name,
            former.measures.ticks,
            former.measures.exhausted,
            bounded.measures.exhausted,
            f64::from(most) * 1e-3,
            deviation.forks,
            deviation.beyond,
            deviation.force * 100.0,
            deviation.place * 1e3,
            former.broken,
            bounded.broken,
        );
    }
}

/// Sets the parameters of a scene up to version 7.
fn without_bound(params: &mut Params) {
    (params.max_work, params.max_arrival_step, params.ramp_up_ms) = (0, 0.0, 100);
}

fn main() -> std::io::Result<()> {
    let Arguments {
        cases,
        max_work,
        exhausted,
        ticks,
    } = Arguments::parse();
    if exhausted {
        print_exhausted(&cases, max_work);
        return Ok(());
    }
    let mut file = match &ticks {
        Some(path) => Some(std::io::BufWriter::new(std::fs::File::create(path)?)),
        None => None,
    };
    println!(
        "{:36} {:>7} {:>7} {:>7}  {:>7} {:>7} {:>7}  {:>6}",
        "case", "us p50", "p99.9", "max", "kop p50", "p99.9", "max", "exh %"
    );
    let mut say = |name: &str, scene: &Scene, inputs: &[TickInput]| {
        let found = measured(scene, inputs);
        println!("{}", line(name, &found));
        if let Some(file) = &mut file {
            for tick in &found {
                let counts = tick.counts.all().map(|count| count.to_string()).join(",");
                writeln!(file, "{name},{},{counts}", tick.ns)?;
            }
        }
        Ok::<(), std::io::Error>(())
    };
    let bounded = |scene: &mut Scene| {
        if let Some(max_work) = max_work {
            scene.params.max_work = max_work;
        }
    };
    let chosen = |name: &str| cases.is_empty() || cases.iter().any(|case| case.name == name);
    for case in TABLE.iter().filter(|case| chosen(case.name)) {
        let (mut inputs, mut scene) = (Vec::new(), None);
        run_on(case, bounded, |seen| {
            scene.get_or_insert_with(|| seen.scene.clone());
            inputs.push(*seen.input);
        });
        if let Some(scene) = scene {
            say(case.name, &scene, &inputs)?;
        }
    }
    if cases.is_empty() {
        for walk in fuzz::ALL {
            let (scene, inputs) = walk.inputs(7, 10_000);
            let mut scene = scene;
            bounded(&mut scene);
            say(walk.name, &scene, &inputs)?;
        }
    }
    Ok(())
}
