//! Other programs of this project, started as child processes.

use std::env::consts::EXE_SUFFIX;
use std::path::PathBuf;

/// Command that builds `sulcus-review`.
pub const BUILDS_REVIEW: &str = "cargo build --release -p sulcus-view --features rerun";

/// Command that builds `sulcus-sessions`.
pub const BUILDS_SESSIONS: &str = "cargo build --release -p sulcus-sessions";

/// Path of the program `name`, beside the running program or on PATH. `build` is the command that builds the program.
///
/// # Errors
/// The program is in neither place: a text with the command.
pub fn find(name: &str, build: &str) -> anyhow::Result<PathBuf> {
    let file = format!("{name}{EXE_SUFFIX}");
    let beside = std::env::current_exe()
        .ok()
        .and_then(|own| own.parent().map(|folder| folder.join(&file)));
    let path = std::env::var_os("PATH").unwrap_or_default();
    let on_path = std::env::split_paths(&path).map(|folder| folder.join(&file));
    let mut places = beside.into_iter().chain(on_path);
    places.find(|place| place.is_file()).ok_or_else(|| {
        anyhow::anyhow!(
            "the program `{name}` is neither beside this program nor on PATH; to build the program: {build}"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_program_is_named_with_the_command_that_builds_it() {
        let told = find("sulcus-none", "cargo build --features rerun")
            .expect_err("no such program")
            .to_string();
        assert!(
            told.contains("`sulcus-none`") && told.contains("--features rerun"),
            "{told}"
        );
    }
}
