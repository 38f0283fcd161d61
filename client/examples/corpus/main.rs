//! Makes the corpus of recordings that every later version must replay bit for bit (`sessions/tests/corpus`), and the grades
//! that every later version must give those that can be graded (`NAME.grade.json`).
//!
//! ```text
//! cargo run --release -p sulcus-client --example corpus [-- [grades] [--folder FOLDER]]
//! ```
//!
//! Each file is a second or so of an exercise or a hard case: the one in which most is touched and let go. The whole is performed
//! first to find it, then again to record it, from a snapshot on. Scenes carry no meshes to look at, no levels finer than
//! the one in contact, and of the mouth one tooth with its gingiva and the tongue, so that a file is small; the tick is the
//! same.
//!
//! The bytes depend on the core and the operator alone: no clock, no chance, one key for all. So a corpus made twice is the
//! same twice. Made by a release build, it is replayed by the tests' dev build.

mod cut;
mod entries;
mod perform;

use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use clap::{Parser, ValueEnum};
use sulcus_sessions::grade;
use sulcus_sessions::grade::grade;
use sulcus_sessions::{Recording, ReplayOptions, replay};

use entries::{ENTRIES, Entry};

/// Largest file, bytes.
const MOST_BYTES: u64 = 290_000;

/// Make the recordings of the corpus, and their golden grades
#[derive(Parser)]
struct Arguments {
    /// Keep the recordings and write the golden grades alone
    #[arg(value_name = "grades")]
    only: Option<Only>,
    /// Folder of the corpus
    #[arg(
        long,
        default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/../sessions/tests/corpus"),
        hide_default_value = true
    )]
    folder: PathBuf,
}

/// A part of the work.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Only {
    /// The golden grades.
    Grades,
}

fn main() -> anyhow::Result<()> {
    let Arguments { only, folder } = Arguments::parse();
    if cfg!(debug_assertions) {
        bail!("the corpus is what a release build records: cargo run --release ...");
    }
    std::fs::create_dir_all(&folder)?;
    for entry in ENTRIES {
        let path = folder.join(format!("{}.mcap", entry.name));
        if only == Some(Only::Grades) {
            golden(&Recording::open(&path)?, &path.with_extension("grade.json"))?;
            continue;
        }
        make(entry, &path).with_context(|| format!("`{}`", entry.name))?;
    }
    Ok(())
}

/// Makes one file, over whatever was there, as long as fits.
fn make(entry: &Entry, path: &Path) -> anyhow::Result<()> {
    let scene = (entry.scene)()?;
    let found = perform::look(entry, &scene)?;
    let mut length = entry.ticks;
    loop {
        let window = perform::window(&found, length);
        if path.exists() {
            std::fs::remove_file(path)?;
        }
        perform::record(entry, &scene, &window, path)?;
        let bytes = std::fs::metadata(path)?.len();
        if bytes > MOST_BYTES {
            length = length * 4 / 5;
            ensure!(length >= 200, "{bytes} bytes, most of them the scene");
            continue;
        }
        let recording = Recording::open(path)?;
        let report = replay(&recording, &ReplayOptions::default(), &mut |_| {})?;
        ensure!(report.identical && report.gradable, "{report:?}");
        println!(
            "{:22} ticks {:>6} to {:>6} of {:>6}: {} in contact, {} changes; {} kB, scene {} kB",
            entry.name,
            window.from,
            window.to,
            found.len(),
            window.contact,
            window.changes,
            bytes / 1000,
            recording.header().scene.len() / 1000
        );
        return golden(&recording, &path.with_extension("grade.json"));
    }
}

/// The grade of what can be graded.
fn golden(recording: &Recording, path: &Path) -> anyhow::Result<()> {
    let graded = grade(recording, &grade::Options::default(), &mut |_| {})?;
    if graded.grade.score.is_none() {
        return Ok(());
    }
    let text = serde_json::to_string_pretty(&graded.grade.to_json())?;
    Ok(std::fs::write(path, text + "\n")?)
}
