//! Student's page beside a recording, the same as the page of `sulcus-sessions grade --html`.

use std::path::{Path, PathBuf};

use sulcus_program::{PathText, disk};
use sulcus_sessions::Mode;
use sulcus_sessions::grade::Graded;
use sulcus_sessions::grade::class::{Session, Shown};
use sulcus_sessions::pages::{Look, Numbering, Pictures, student_page};

/// Writes the student's page of a graded session, and returns its path: that of the recording, with the ending `.html`.
///
/// `recorded` is the mode in the recording's header; `None` counts as the default mode. `pictures` are those of the
/// findings, if they were asked for.
///
/// # Errors
/// The file cannot be written. The message is one sentence that names the file.
pub fn write(
    recording: &Path,
    recorded: Option<Mode>,
    graded: &Graded,
    pictures: Option<&Pictures>,
) -> Result<PathBuf, String> {
    let name = recording.file_name().unwrap_or(recording.as_os_str());
    let session = Session {
        file: Path::new(name).shown().to_string(),
        grade: graded.grade.clone(),
        sidecar: None,
        self_score: None,
        shown: Shown {
            mode: recorded.unwrap_or_default(),
            recorded,
        },
        attempt: 1,
    };
    let look = Look {
        names: None,
        numbering: Numbering::Fdi,
        truth: false,
    };
    let path = recording.with_extension("html");
    std::fs::write(&path, student_page(&session, graded, &look, pictures)).map_err(|error| {
        format!(
            "cannot write the page `{}`: {error}{}",
            path.shown(),
            disk::advice(&error)
        )
    })?;
    Ok(path)
}
