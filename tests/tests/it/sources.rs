//! Rust sources of the workspace, for tests of their form.

use std::path::Path;

/// Top-level folders with sources.
pub const MEMBERS: [&str; 5] = ["proto", "server", "client", "sessions", "tests"];

/// Folder of the workspace.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .expect("the workspace")
}

/// Shows each Rust source below `place`, or `place` itself, with its text. Build folders are skipped.
pub fn walk(place: &Path, see: &mut dyn FnMut(&Path, &str)) {
    if place.is_file() {
        if place.extension().is_some_and(|ending| ending == "rs") {
            see(place, &std::fs::read_to_string(place).expect("text"));
        }
        return;
    }
    for entry in std::fs::read_dir(place).into_iter().flatten().flatten() {
        if !entry.path().ends_with("target") {
            walk(&entry.path(), see);
        }
    }
}
