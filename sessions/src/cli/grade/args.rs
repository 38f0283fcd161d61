//! Arguments of `grade`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use sulcus_program::PathText;

use crate::record::mode::Mode;

#[derive(Args)]
pub(in crate::cli) struct GradeArgs {
    /// Recordings, or folders of recordings. Recordings of one session, which a stop of the station has divided, are
    /// graded together, in any order
    #[arg(required = true, value_name = "FILE")]
    pub(super) files: Vec<PathBuf>,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub(in crate::cli) json: bool,
    /// Folder for the pages: one for each session and one for the class
    #[arg(long, value_name = "DIR")]
    pub(super) html: Option<PathBuf>,
    /// Draw the findings that cost points into the pages, at most six for each session, none in an exam. The program
    /// `sulcus-client` draws them, in one more replay; its build needs the feature `view`
    #[arg(long, requires = "html")]
    pub(super) pictures: bool,
    /// File for a table of all sessions
    ///
    /// Text that a spreadsheet would read as a number, a date or a formula begins with an apostrophe, such as the id
    /// 007 or 1e5. Every signer's key begins with an apostrophe, too. Programs that read the table drop a leading
    /// apostrophe.
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    /// Grade by this rubric instead of the rubric in the recording. The output names the rubric
    #[arg(long, value_name = "FILE")]
    pub(super) rubric: Option<PathBuf>,
    /// Presentation of the grade. Default: the mode in the recording. A recording of another mode is never graded as an
    /// exam
    #[arg(long, value_enum)]
    pub(super) mode: Option<Mode>,
    /// In self-assessment: the learner's own score, 0 to 100, before the grade is shown. Without this option a terminal
    /// asks for the score. The first score is kept in FILE.grade.json
    #[arg(long, value_name = "N", value_parser = points, allow_negative_numbers = true)]
    pub(super) self_score: Option<f64>,
    /// Show the prescribed values on the page and in the table. The JSON object always has them, except in an exam
    #[arg(long)]
    pub(super) truth: bool,
    /// Key table with the columns learner_id and name. Names appear on pages and in the CSV only
    ///
    /// The table is a text file of a spreadsheet: separated by commas, semicolons or tabs; UTF-8, UTF-16 or
    /// Windows-1252. An id may begin with the apostrophe that marks text.
    #[arg(long, value_name = "FILE")]
    pub(super) names: Option<PathBuf>,
    /// Numbering of teeth on the pages
    #[arg(long, value_enum, default_value = "fdi")]
    pub(super) numbering: Numbers,
    /// Accept only recordings signed by this key: a file with the public key, or its 64 hexadecimal digits. The public
    /// key of a station is `station.pub` in $SULCUS_STATE_DIR, else in ~/.local/state/sulcus
    #[arg(long, value_name = "PUBKEYFILE|HEX")]
    pub(super) signer: Option<PathBuf>,
    /// Instructor's score, 0 to 100, in place of the proposal. Both are kept in FILE.grade.json
    #[arg(long, value_name = "N", value_parser = points, allow_negative_numbers = true, requires_all = ["by", "at", "reason"])]
    pub(super) revise: Option<f64>,
    /// With --revise: opaque id of the instructor
    #[arg(long, value_name = "ID", requires = "revise", value_parser = sulcus_proto::learner::parse)]
    pub(super) by: Option<String>,
    /// With --revise: date, such as 2026-11-23
    #[arg(long, value_name = "WHEN", requires = "revise")]
    pub(super) at: Option<String>,
    /// With --revise: reason
    #[arg(long, value_name = "TEXT", requires = "revise")]
    pub(super) reason: Option<String>,
    /// With --revise: whether the session is passed. Default: by the rubric's pass mark
    #[arg(long, value_name = "true|false", requires = "revise")]
    pub(super) passed: Option<bool>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Numbers {
    Fdi,
    Universal,
}

pub(in crate::cli) const LONG_ABOUT: &str = "Grades recorded sessions from their replay.\n\nThe replay runs the session again from the inputs in its recording, and the measures come from the replay. Forces that the recording claims do not count. A recording gets no grade (exit code 1) if its replay differs, if it was cut off, if rows were lost, or if it is not signed. A recording that continues another one is graded with it; alone it gets no grade. A recording of a former version of the format is graded if its replay stays close, and the grade says so. The weights are those of the rubric in the recording. The program proposes a grade; --revise keeps an instructor's score beside the proposal.";

pub(in crate::cli) const EXAMPLES: &str = "Examples:\n  sulcus-sessions grade session.mcap\n  sulcus-sessions grade first.mcap second.mcap\n  sulcus-sessions grade class/*.mcap --html pages --csv class.csv --names key-table.csv\n  sulcus-sessions grade session.mcap --html pages --pictures\n  sulcus-sessions grade session.mcap --json | tail -n 1 | jq '.metrics[] | {name, value, score}'\n  sulcus-sessions grade session.mcap --mode self-assessment --self-score 75\n  sulcus-sessions grade session.mcap --mode exam --signer station.pub\n  sulcus-sessions grade session.mcap --revise 72 --by t04 --at 2026-11-23 --reason \"finger rest slipped\"";

/// Name of a file without its folder. A grade does not depend on the folder of the recording.
pub(super) fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    Path::new(name).shown().to_string()
}

pub(super) fn points(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(score) if (0.0..=100.0).contains(&score) => Ok(score),
        _ => Err(format!(
            "score is `{}`, expected 0 to 100",
            text.escape_debug()
        )),
    }
}
