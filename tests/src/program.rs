//! The programs of the workspace, as the build of the tests made them.

use std::collections::BTreeSet;
use std::env::consts::EXE_SUFFIX;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::SystemTime;

/// A program of the workspace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Program {
    /// `sulcus-client`.
    Client,
    /// `sulcus-server`.
    Server,
    /// `sulcus-sessions`.
    Sessions,
}

impl Program {
    const ALL: [Self; 3] = [Self::Client, Self::Server, Self::Sessions];

    /// Name of the program and of its package.
    pub fn name(self) -> &'static str {
        match self {
            Program::Client => "sulcus-client",
            Program::Server => "sulcus-server",
            Program::Sessions => "sulcus-sessions",
        }
    }

    /// Path of the program beside the running test.
    ///
    /// `cargo test --workspace` has built the programs before any test runs. Where a program is missing or older than one
    /// of its sources, as after `cargo test -p sulcus-tests`, cargo builds all three first.
    ///
    /// # Panics
    /// When the programs do not build.
    pub fn path(self) -> &'static Path {
        static FOLDER: OnceLock<PathBuf> = OnceLock::new();
        static PATHS: OnceLock<[PathBuf; 3]> = OnceLock::new();
        let paths = PATHS.get_or_init(|| {
            let folder = FOLDER.get_or_init(folder);
            if Self::ALL
                .iter()
                .any(|program| is_stale(&program.at(folder)))
            {
                build(folder);
            }
            Self::ALL.map(|program| program.at(folder))
        });
        &paths[self as usize]
    }

    fn at(self, folder: &Path) -> PathBuf {
        folder.join(format!("{}{EXE_SUFFIX}", self.name()))
    }
}

/// Folder of the profile, which holds the programs: the running test lies in its subfolder `deps`.
pub(crate) fn folder() -> PathBuf {
    let own = std::env::current_exe().expect("the path of the running test");
    let deps = own.parent().expect("the folder of the running test");
    deps.parent().expect("the folder of the profile").to_owned()
}

/// Whether a program is missing, or one of the sources that cargo lists beside it is newer.
fn is_stale(program: &Path) -> bool {
    let changed = |path: &Path| path.metadata().and_then(|file| file.modified()).ok();
    let Some(built) = changed(program) else {
        return true;
    };
    let Ok(listed) = std::fs::read_to_string(program.with_extension("d")) else {
        return true;
    };
    let newer = |source: &Path| changed(source).is_none_or(|time: SystemTime| time > built);
    sources(&listed).iter().any(|source| newer(source))
}

/// Sources in a file of cargo in make's notation: a target, a colon, paths with escaped spaces.
fn sources(listed: &str) -> BTreeSet<PathBuf> {
    let mut sources = BTreeSet::new();
    for line in listed.lines() {
        let Some((_, paths)) = line.split_once(": ") else {
            continue;
        };
        let paths = paths.replace("\\ ", "\0");
        let paths = paths.split_whitespace();
        sources.extend(paths.map(|path| PathBuf::from(path.replace('\0', " "))));
    }
    sources
}

/// Builds the three programs in the profile of the running test.
fn build(folder: &Path) {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
        .args(["build", "--bins", "--features", "sulcus-server/console"]);
    for program in Program::ALL {
        command.args(["--package", program.name()]);
    }
    if folder.file_name().is_some_and(|name| name == "release") {
        command.arg("--release");
    }
    if let Some(target) = folder.parent() {
        command.arg("--target-dir").arg(target);
    }
    // Build scripts watch these variables of the running test and would run again.
    for (name, _) in std::env::vars_os() {
        let text = name.to_string_lossy();
        if text.starts_with("CARGO_PKG_") || text.starts_with("CARGO_MANIFEST_") {
            command.env_remove(&name);
        }
    }
    let ended = command.status().expect("cargo starts");
    assert!(ended.success(), "the programs do not build: {ended}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_read_from_make_notation() {
        let listed = "/t/debug/a: /src/a.rs /src/with\\ space.rs\n\n/src/a.rs:\n";
        let expected = ["/src/a.rs", "/src/with space.rs"].map(PathBuf::from);
        assert_eq!(sources(listed), expected.into());
    }

    #[test]
    fn a_program_is_stale_when_missing_unlisted_or_older_than_a_source() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = |name: &str| folder.path().join(name);
        let program = path("program");
        assert!(is_stale(&program));
        let write = |name: &str, text: &str| std::fs::write(path(name), text).expect("written");
        write("source.rs", "");
        write("program", "");
        assert!(is_stale(&program));
        let listed = format!("{}: {}\n", program.display(), path("source.rs").display());
        write("program.d", &listed);
        assert!(!is_stale(&program));
        let later = SystemTime::now() + std::time::Duration::from_secs(60);
        let source = std::fs::File::options()
            .write(true)
            .open(path("source.rs"))
            .expect("opened");
        source.set_modified(later).expect("a later time");
        assert!(is_stale(&program));
    }
}
