//! `grade`: recorded sessions graded from their replay.

mod class;
mod say;
mod session;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use sulcus_program::{PathText, say};

use super::inputs::recordings;
use super::print::complain;
use super::written::may_write;
use crate::grade::class::csv;
use crate::grade::names::Names;
use crate::grade::revision::beside;
use crate::record::mode::Mode;

use session::{Asked, one};

#[derive(Args)]
pub(super) struct GradeArgs {
    /// Recordings, or folders of recordings
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Print one JSON object as the last line of standard output
    #[arg(long)]
    pub(super) json: bool,
    /// Folder for the pages: one for each session and one for the class
    #[arg(long, value_name = "DIR")]
    html: Option<PathBuf>,
    /// File for a table of all sessions
    ///
    /// Text that a spreadsheet would read as a number, a date or a formula begins with an apostrophe, such as the id 007 or
    /// 1e5, and so does every signer's key. Programs that read the table drop a leading apostrophe.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Grade by this rubric instead of the rubric in the recording. The output names the rubric
    #[arg(long, value_name = "FILE")]
    rubric: Option<PathBuf>,
    /// Presentation of the grade. Default: the mode in the recording. A recording of another mode is never graded as an exam
    #[arg(long, value_enum)]
    mode: Option<Mode>,
    /// In self-assessment: the learner's own score, 0 to 100, before the grade is shown. A terminal asks for it. The first
    /// score is kept in FILE.grade.json
    #[arg(long, value_name = "N", value_parser = points, allow_negative_numbers = true)]
    self_score: Option<f64>,
    /// Show the prescribed values on the page and in the table. The JSON object always has them, except in an exam
    #[arg(long)]
    truth: bool,
    /// Key table with the columns learner_id and name. Names appear on pages and in the CSV only
    ///
    /// The table is a text file of a spreadsheet: separated by commas, semicolons or tabs; UTF-8, UTF-16 or Windows-1252. An
    /// id may begin with the apostrophe that marks text.
    #[arg(long, value_name = "FILE")]
    names: Option<PathBuf>,
    /// Numbering of teeth on the pages
    #[arg(long, value_enum, default_value = "fdi")]
    numbering: Numbers,
    /// Accept only recordings signed by this key: a file with the public key, or its 64 hexadecimal digits. The public key
    /// of a station is `station.pub` in $SULCUS_STATE_DIR, else in ~/.local/state/sulcus
    #[arg(long, value_name = "PUBKEYFILE|HEX")]
    signer: Option<PathBuf>,
    /// Instructor's score, 0 to 100, in place of the proposal. Both are kept in FILE.grade.json
    #[arg(long, value_name = "N", value_parser = points, allow_negative_numbers = true, requires_all = ["by", "at", "reason"])]
    revise: Option<f64>,
    /// With --revise: opaque id of the instructor
    #[arg(long, value_name = "ID", requires = "revise", value_parser = sulcus_proto::learner::parse)]
    by: Option<String>,
    /// With --revise: date, such as 2026-11-23
    #[arg(long, value_name = "WHEN", requires = "revise")]
    at: Option<String>,
    /// With --revise: reason
    #[arg(long, value_name = "TEXT", requires = "revise")]
    reason: Option<String>,
    /// With --revise: whether the session is passed. Default: by the rubric's pass mark
    #[arg(long, value_name = "true|false", requires = "revise")]
    passed: Option<bool>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Numbers {
    Fdi,
    Universal,
}

pub(super) const LONG_ABOUT: &str = "Grades recorded sessions from their replay.\n\nA session is run again from the inputs in its recording and measured then: nothing that the recording claims of forces counts. A recording that differs (by more than a former version of the format explains, which the grade then says), was cut off, lost rows or is not signed gets no grade (exit code 1). What counts how much is the rubric that travels in the recording. The program proposes a grade; an instructor's word is kept beside it with --revise.";

pub(super) const EXAMPLES: &str = "Examples:\n  sulcus-sessions grade session.mcap\n  sulcus-sessions grade class/*.mcap --html pages --csv class.csv --names key-table.csv\n  sulcus-sessions grade session.mcap --json | tail -n 1 | jq '.metrics[] | {name, value, score}'\n  sulcus-sessions grade session.mcap --mode self-assessment --self-score 75\n  sulcus-sessions grade session.mcap --mode exam --signer station.pub\n  sulcus-sessions grade session.mcap --revise 72 --by t04 --at 2026-11-23 --reason \"finger rest slipped\"";

pub(super) fn run(args: &GradeArgs) -> anyhow::Result<ExitCode> {
    let asked = Asked::of(args)?;
    let names = args.names.as_deref().map(Names::open).transpose()?;
    let files = recordings(&args.files);
    if args.self_score.is_some() && files.len() > 1 {
        bail!(
            "--self-score is one learner's own score of one session, found {} files",
            files.len()
        );
    }
    if args.revise.is_some() && files.len() > 1 {
        bail!("--revise is about one session, found {} files", files.len());
    }
    if let Some(table) = &args.csv {
        let others = [&args.names, &args.rubric, &args.signer]
            .into_iter()
            .flatten();
        let beside: Vec<PathBuf> = files.iter().map(|file| beside(file)).collect();
        let mut read: Vec<&Path> = others.map(PathBuf::as_path).collect();
        read.extend(files.iter().chain(&beside).map(PathBuf::as_path));
        may_write("--csv", table, read)?;
    }
    let (mut code, mut objects, mut all) = (0u8, Vec::new(), Vec::new());
    let mut unread: Vec<(String, String)> = Vec::new();
    for path in &files {
        match one(path, args, &asked) {
            Ok(one) => {
                code = code.max(u8::from(one.graded.grade.score.is_none()));
                if !args.json {
                    say!("{}", say::text(path, &one, args));
                }
                objects.push(say::json(path, &one));
                if let Some(error) = &one.unkept {
                    code = 2;
                    complain(error);
                }
                all.push((file_name(path), one));
            }
            Err(error) => {
                code = 2;
                complain(&error);
                let why = crate::sentence(&error);
                objects.push(json!({ "file": file_name(path), "error": why }));
                unread.push((file_name(path), why));
            }
        }
    }
    let sessions = class::sessions(&all);
    if let Some(names) = &names {
        class::warn_of_unnamed(&sessions, names);
    }
    let table = args.csv.as_deref().map(|path| {
        let table = csv(&sessions, &unread, names.as_ref())?;
        std::fs::write(path, table).with_context(|| format!("cannot write `{}`", path.shown()))
    });
    let html = args.html.as_deref();
    let pages =
        html.map(|folder| class::pages(folder, &all, (&sessions, &unread), names.as_ref(), args));
    // What cannot be written loses nothing of the rest.
    for error in [table, pages].into_iter().flatten().filter_map(Result::err) {
        code = 2;
        complain(&error);
    }
    if args.json {
        let object = match <[Value; 1]>::try_from(objects) {
            Ok([only]) => only,
            Err(objects) => json!({ "sessions": objects.len(), "files": objects }),
        };
        say!("{object}");
    }
    Ok(ExitCode::from(code))
}

/// Without its folder: a grade is the same wherever the recording lies.
fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    Path::new(name).shown().to_string()
}

fn points(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(score) if (0.0..=100.0).contains(&score) => Ok(score),
        _ => Err(format!(
            "`{}` is not a score from 0 to 100",
            text.escape_debug()
        )),
    }
}
