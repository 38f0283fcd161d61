//! The programs of the workspace, as the build of the tests made them.

use std::env::consts::EXE_SUFFIX;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Variable with the folder of built programs. Without the variable, cargo is asked for them.
const GIVEN: &str = "SULCUS_PROGRAMS";

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

    /// Path of the program: in the folder that `SULCUS_PROGRAMS` names, else beside the running test.
    ///
    /// Without the variable, cargo first makes the programs of `cargo test --workspace`, which takes a second where they
    /// are up to date. A test run by `cargo test -p sulcus-tests` therefore never meets a program of older sources.
    ///
    /// # Panics
    /// The programs do not build, or the named folder lacks one.
    pub fn path(self) -> &'static Path {
        static PATHS: OnceLock<[PathBuf; 3]> = OnceLock::new();
        let paths = PATHS.get_or_init(|| {
            let given = std::env::var_os(GIVEN).map(PathBuf::from);
            let folder = given.unwrap_or_else(|| {
                let folder = folder();
                build(&folder);
                folder
            });
            let paths = Self::ALL.map(|program| program.at(&folder));
            for path in &paths {
                assert!(path.is_file(), "{} is missing", path.display());
            }
            paths
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

/// Builds the programs in the profile of the running test, with the features of `cargo test --workspace`.
fn build(folder: &Path) {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    // cargo builds the programs of each package that has the test `starts`.
    command
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
        .args(["test", "--workspace", "--test", "starts", "--no-run"]);
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
