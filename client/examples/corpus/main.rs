//! Makes the corpus of recordings, which every later version must replay bit for bit (`sessions/tests/corpus`).
//!
//! A recording that can be graded has a golden grade in `NAME.grade.json`. Every later version must give the same
//! grade.
//!
//! ```text
//! cargo run --release -p sulcus-client --example corpus [-- [grades] [--folder FOLDER]]
//! ```
//!
//! A file holds about a second of an exercise or a hard case: the part with the most changes of contact. A first
//! performance finds that part. A second performance records it, from a snapshot on.
//!
//! Small scenes keep the files small, and the tick is the same. The scenes have no meshes and no levels finer than the
//! contact level. Of the mouth, one tooth with its gingiva and the tongue remain.
//!
//! The bytes depend only on the core and the operator. There is no clock and no chance, and all files have one key. A
//! second run therefore gives the same bytes. A release build makes the corpus, and the tests replay it in a dev build.

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

/// Part of the program's work.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Only {
    /// The golden grades.
    Grades,
}

fn main() -> anyhow::Result<()> {
    let Arguments { only, folder } = Arguments::parse();
    if cfg!(debug_assertions) {
        bail!("this is a dev build, but the corpus needs a release build: use cargo run --release");
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

/// Records one entry to `path`, replays it, and writes its golden grade. A former file is replaced.
///
/// The part is shortened until the file has at most [`MOST_BYTES`].
///
/// # Errors
/// The part would be shorter than 200 ticks, or the replay is not identical or not gradable.
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
            ensure!(
                length >= 200,
                "{bytes} bytes, expected at most {MOST_BYTES}; most of the bytes are the scene, so reduce the scene"
            );
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

/// Writes the grade of `recording` to `path`. A recording without a score gets no file.
fn golden(recording: &Recording, path: &Path) -> anyhow::Result<()> {
    let graded = grade(recording, &grade::Options::default(), &mut |_| {})?;
    if graded.grade.score.is_none() {
        return Ok(());
    }
    let text = serde_json::to_string_pretty(&graded.grade.to_json())?;
    Ok(std::fs::write(path, text + "\n")?)
}
