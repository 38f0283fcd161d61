//! Pictures of findings, drawn by the program `sulcus-client` in one replay of the recording.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};

use anyhow::{Context as _, bail};
use sulcus_program::{PathText, tell};

use super::picture::BUILDS_CLIENT;
use super::sibling::find;
use crate::grade::Graded;
use crate::pages::instants::{self, Instant};
use crate::pages::{Picture, Pictures};
use crate::record::read::Recording;

/// Size of a picture, pixels. Chosen: twice the width on a page, so that the bands can be read in print.
const SIZE: &str = "720x450";

/// Pictures of the findings of `graded`, at most [`instants::MOST`], from the recording at `path`.
///
/// A program that is missing, was built without pictures or finds no graphics adapter is no error: the result has the
/// reason.
pub fn findings(path: &Path, graded: &Graded) -> Pictures {
    if graded.grade.parts.len() > 1 {
        let why = "the session is in several recordings, and pictures are drawn of one";
        return Pictures::Missing(why.into());
    }
    let all = instants::instants(graded, instants::MOST);
    if all.is_empty() {
        return Pictures::Drawn(Vec::new());
    }
    tell!("drawing {} pictures of {}", all.len(), path.shown());
    match drawn(path, all) {
        Ok(pictures) => Pictures::Drawn(pictures),
        Err(error) => Pictures::Missing(crate::sentence(&error)),
    }
}

fn drawn(path: &Path, all: Vec<Instant>) -> anyhow::Result<Vec<Picture>> {
    let program = find("sulcus-client", BUILDS_CLIENT)?;
    let tick_s = Recording::open(path)?.scene()?.tick_s();
    let folder = Folder::new()?;
    let file = |k: usize| folder.0.join(format!("{k}.png"));
    let mut list = String::new();
    for (k, one) in all.iter().enumerate() {
        let at_s = one.tick as f64 * tick_s;
        // A `String` takes any text.
        let _ = writeln!(list, "{at_s:.9} {} {} {k}.png", one.view, one.tooth);
    }
    let list_file = folder.0.join("list");
    std::fs::write(&list_file, list).context("the list of pictures cannot be written")?;
    let ended = Command::new(&program)
        .args(["picture", "--size", SIZE, "--recording"])
        .arg(path)
        .arg("--list")
        .arg(&list_file)
        .output()
        .with_context(|| format!("{}: cannot be started", program.shown()))?;
    if !ended.status.success() {
        let told = String::from_utf8_lossy(&ended.stderr);
        let mut error = told.lines().filter_map(|line| line.strip_prefix("error: "));
        bail!(
            "{}",
            error
                .next_back()
                .unwrap_or("the program `sulcus-client` has ended with an error")
        );
    }
    let picture = |(k, instant): (usize, Instant)| {
        let png = std::fs::read(file(k)).with_context(|| file(k).shown().to_string())?;
        Ok(Picture {
            at_s: (instant.tick as f64 * tick_s) as u32,
            instant,
            png,
        })
    };
    all.into_iter().enumerate().map(picture).collect()
}

/// Folder for the files of one run, removed with this value.
struct Folder(PathBuf);

impl Folder {
    fn new() -> anyhow::Result<Self> {
        static MADE: AtomicU32 = AtomicU32::new(0);
        let number = MADE.fetch_add(1, Ordering::Relaxed);
        let name = format!("sulcus-pictures-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        // Fails if another user has put a folder there. No other user sees a student's pictures.
        let builder = &mut std::fs::DirBuilder::new();
        #[cfg(unix)]
        std::os::unix::fs::DirBuilderExt::mode(builder, 0o700);
        builder
            .create(&path)
            .with_context(|| format!("{}: cannot make", path.shown()))?;
        Ok(Self(path))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A file that stays is in the folder for temporary files.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
