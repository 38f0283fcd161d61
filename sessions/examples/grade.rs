//! A recording opened, replayed bit for bit and graded.
//!
//! ```text
//! cargo run --release -p sulcus-sessions --example grade -- recordings/SESSION.mcap
//! ```

use std::path::PathBuf;

use sulcus_sessions::grade::{Options, grade};
use sulcus_sessions::{Recording, ReplayOptions, replay};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let corpus = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/corpus/probing.mcap");
    let file = std::env::args_os()
        .nth(1)
        .map_or_else(|| corpus.into(), PathBuf::from);
    let recording = Recording::open(&file)?;
    let report = replay(&recording, &ReplayOptions::default(), &mut |_| ())?;
    println!(
        "{} ticks, identical: {}, chain valid: {}",
        report.ticks, report.identical, report.chain_ok
    );
    let grade = grade(&recording, &Options::default(), &mut |_| ())?.grade;
    match (grade.score, &grade.reason) {
        (Some(score), _) => println!("{}: {score} of 100", grade.exercise),
        (None, reason) => println!(
            "{}: no grade, {}",
            grade.exercise,
            reason.as_deref().unwrap_or("no rubric")
        ),
    }
    Ok(())
}
