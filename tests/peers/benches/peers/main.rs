//! Ours beside engines that a user could pick instead: the same scenes, the same path of the hand, one run. Two scenes, a soft
//! block and a rigid tooth; beside the times of a tick stand what they are worth: penetration, force steps, forces.
//!
//! `cargo bench -p sulcus-peers --features rapier`, with `-- --quick` for fewer ticks, `-- --out FILE` for another place of the
//! JSON, which is `peers.json` in the target folder otherwise.
//!
//! Every tick counts with its fastest of a few runs of the same inputs, which leaves out what other processes do to a shared
//! machine's caches; all engines alike, by turns.

mod block;
mod capsule;
mod engine;
mod linear;
mod ours;
mod parry;
mod rapier;
mod report;
mod scene;
mod tooth;

use std::path::PathBuf;

/// Length of a tick of all of them, seconds.
const TICK_S: f64 = 1e-3;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    // `cargo test --benches` passes --test: nothing to check there.
    if args.iter().any(|arg| arg == "--test") {
        return;
    }
    let (ticks, runs) = if args.iter().any(|arg| arg == "--quick") {
        (4_000, 2)
    } else {
        (20_000, 3)
    };
    let out = args.iter().position(|arg| arg == "--out");
    let out = match out.map(|k| args.get(k + 1)) {
        Some(Some(file)) => PathBuf::from(file),
        Some(None) => panic!("--out wants the name of a file behind it"),
        None => std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("../peers.json"),
    };
    let block = block::scene(ticks);
    println!("soft block: force that holds the hand's capsule 6 mm deep, N");
    for (entrant, force) in block.entrants.iter().zip(block::held_forces(&block)) {
        println!("{force:8.3}  {}", entrant.name);
    }
    println!(
        "{:8.3}  linear elasticity, finite elements of 2.5 mm\n",
        linear::held_force(32e-3, 20e-3)
    );
    let mut rows = block.rows(runs);
    rows.extend(tooth::scene(ticks).rows(runs));
    let ratios = report::ratios(&rows);
    report::print(&rows, &ratios, runs);
    let json = report::json(ticks, &rows, &ratios);
    std::fs::write(&out, json).unwrap_or_else(|e| panic!("{}: cannot write: {e}", out.display()));
    println!("{}", out.display());
    if !ratios.iter().all(report::Ratio::holds) {
        std::process::exit(1);
    }
}
