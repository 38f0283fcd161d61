//! A recording opened, replayed bit for bit and graded.
//!
//! ```text
//! cargo run --release -p sulcus-sessions --example grade -- recordings/SESSION.mcap
//! ```

use std::path::PathBuf;

use clap::Parser;
use sulcus_sessions::grade::{Options, grade};
use sulcus_sessions::{Recording, ReplayOptions, replay};

/// Open, replay and grade a recording
#[derive(Parser)]
struct Arguments {
    /// Recording of a session. A recording of the corpus without a file
    #[arg(
        value_name = "FILE",
        default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/corpus/probing.mcap"),
        hide_default_value = true
    )]
    recording: PathBuf,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::parse();
    let recording = Recording::open(&arguments.recording)?;
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
