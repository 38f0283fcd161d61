//! Search and start of the viewer.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use sulcus_program::PathText;

/// A viewer that fails within this time has not started.
const AT_ONCE: Duration = Duration::from_millis(700);
/// Pause between two looks at a viewer that has just been started.
const LOOK: Duration = Duration::from_millis(20);

/// Version of Rerun that files are written with. A viewer of another version may refuse them.
pub fn version() -> String {
    let version = rerun::build_info().version;
    format!("{}.{}.{}", version.major, version.minor, version.patch)
}

/// Reason why no viewer was started.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoViewer {
    /// There is no viewer on PATH.
    #[error(
        "no Rerun viewer on PATH; to install the viewer: pip install rerun-sdk=={expected}, then: rerun {file}"
    )]
    Missing {
        /// Expected version.
        expected: String,
        /// Path of the file.
        file: String,
    },
    /// The viewer has another version.
    #[error(
        "the Rerun viewer on PATH has version `{found}`, expected {expected}: pip install rerun-sdk=={expected}, then: rerun {file}"
    )]
    Version {
        /// Version text of the viewer.
        found: String,
        /// Expected version.
        expected: String,
        /// Path of the file.
        file: String,
    },
    /// The viewer does not start.
    #[error("the Rerun viewer does not start: {why}")]
    Start {
        /// Error of the system.
        why: String,
    },
}

/// Opens `file` in the viewer `rerun` on PATH. The viewer runs on after this program.
///
/// # Errors
/// There is no viewer, or a viewer of another version: a text with the command that installs the right one.
pub fn open_viewer(file: &Path) -> Result<(), NoViewer> {
    open_with("rerun", file)
}

fn open_with(program: &str, file: &Path) -> Result<(), NoViewer> {
    let expected = version();
    let name = file.shown().to_string();
    let asked = Command::new(program)
        .arg("--version")
        .stdin(Stdio::null())
        .output();
    let said = match asked {
        Ok(output) => String::from_utf8_lossy(&output.stdout).into_owned(),
        Err(_) => {
            return Err(NoViewer::Missing {
                expected,
                file: name,
            });
        }
    };
    // `rerun-cli 0.36.3 [rustc ...] x86_64-unknown-linux-gnu ...`
    if said.split_whitespace().nth(1) != Some(expected.as_str()) {
        return Err(NoViewer::Version {
            found: said.chars().take(60).collect::<String>().trim().to_owned(),
            expected,
            file: name,
        });
    }
    start(Command::new(program).arg(file), AT_ONCE)
}

/// Starts a viewer that runs on after this program. A viewer that fails within `at_once` has not started.
fn start(command: &mut Command, at_once: Duration) -> Result<(), NoViewer> {
    let failed = |why: String| NoViewer::Start { why };
    let mut viewer = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .map_err(|error| failed(error.to_string()))?;
    let begin = Instant::now();
    // Without a display, for example, the viewer ends at once with an error. A viewer that hands the file to a running
    // viewer ends at once with success.
    loop {
        match viewer.try_wait() {
            Ok(Some(end)) if !end.success() => {
                return Err(failed(format!("the viewer ended at once, {end}")));
            }
            Ok(None) if begin.elapsed() < at_once => std::thread::sleep(LOOK),
            _ => return Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whoever_has_no_viewer_is_told_how_to_get_the_right_one() {
        let told = open_with("no-such-program-anywhere", Path::new("a.rrd"))
            .expect_err("there is none")
            .to_string();
        let version = version();
        assert!(
            told.contains(&format!("pip install rerun-sdk=={version}"))
                && told.ends_with("rerun a.rrd"),
            "{told}"
        );
        assert!(version.starts_with("0."), "{version}");
    }

    #[test]
    #[cfg(unix)]
    fn another_program_is_not_taken_for_the_viewer() {
        let told = open_with("echo", Path::new("a.rrd")).expect_err("it is echo");
        assert!(matches!(told, NoViewer::Version { .. }), "{told:?}");
    }

    #[test]
    #[cfg(unix)]
    fn a_viewer_that_ends_at_once_was_not_opened() {
        let run = |script: &str, at_once: Duration| {
            start(Command::new("sh").args(["-c", script]), at_once)
        };
        // A busy machine takes its time to start a shell. The shell's end ends the wait.
        let long = Duration::from_secs(120);
        let told = run("exit 3", long).expect_err("it failed").to_string();
        assert!(
            told.contains("ended at once") && told.contains('3'),
            "{told}"
        );
        // The first hands over to a running viewer, the second runs on.
        assert_eq!(run("exit 0", long), Ok(()));
        assert_eq!(run("sleep 2", Duration::from_millis(100)), Ok(()));
    }
}
