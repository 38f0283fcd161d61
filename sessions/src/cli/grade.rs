//! `grade`: recorded sessions graded from their replay.

use std::collections::BTreeSet;
use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};

use super::print::{at, complain, object, say};
use crate::grade::class::{Session, Shown, csv, number_attempts};
use crate::grade::names::Names;
use crate::grade::page::{Look, Numbering, class_page, student_page};
use crate::grade::report::Source;
use crate::grade::revision::{Revision, Sidecar};
use crate::grade::{Graded, Options, Rubric, grade};
use crate::key::PublicKey;
use crate::mode::Mode;
use crate::read::Recording;

#[derive(Args)]
pub(super) struct GradeArgs {
    /// Recordings
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Print one JSON object on the last line of standard output
    #[arg(long)]
    pub(super) json: bool,
    /// Write a page for each session, and one for the class, into this folder
    #[arg(long, value_name = "DIR")]
    html: Option<PathBuf>,
    /// Write a table of all sessions into this file
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Grade by this rubric instead of the recording's own; the output says so
    #[arg(long, value_name = "FILE")]
    rubric: Option<PathBuf>,
    /// How to show it; when omitted as what it was recorded. What was recorded as something else is no exam
    #[arg(long, value_enum)]
    mode: Option<Mode>,
    /// The learner's own score, 0 to 100, given before the grade is shown (asked for on a terminal in self-assessment); the first
    /// one is kept in FILE.grade.json
    #[arg(long, value_name = "N", value_parser = points)]
    self_score: Option<f64>,
    /// Show what is prescribed, on the page and in the table
    #[arg(long)]
    truth: bool,
    /// Key table with the columns learner_id and name: names go onto pages and into the CSV, and nowhere else
    #[arg(long, value_name = "FILE")]
    names: Option<PathBuf>,
    /// How pages number teeth
    #[arg(long, value_enum, default_value = "fdi")]
    numbering: Numbers,
    /// Accept only recordings signed by this key: a file with the public key, or its 64 hexadecimal digits. A
    /// station keeps its own as `station.pub` beside its key: $SULCUS_STATE_DIR, else ~/.local/state/sulcus
    #[arg(long, value_name = "PUBKEYFILE|HEX")]
    signer: Option<String>,
    /// An instructor's score instead of the proposed one, 0 to 100; kept in FILE.grade.json beside the proposal
    #[arg(long, value_name = "N", value_parser = points, requires_all = ["by", "at", "reason"])]
    revise: Option<f64>,
    /// With --revise: opaque id of the instructor
    #[arg(long, value_name = "ID", requires = "revise")]
    by: Option<String>,
    /// With --revise: when, such as 2026-11-23
    #[arg(long, value_name = "WHEN", requires = "revise")]
    at: Option<String>,
    /// With --revise: why
    #[arg(long, value_name = "TEXT", requires = "revise")]
    reason: Option<String>,
    /// With --revise: whether it is passed; when omitted by the rubric's pass mark
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

/// One recording, graded.
struct One {
    graded: Graded,
    sidecar: Option<Sidecar>,
    self_score: Option<f64>,
    shown: Shown,
}

/// What is graded by, for all recordings.
struct Asked {
    rubric: Option<Rubric>,
    /// The key that was named.
    signer: Option<PublicKey>,
}

pub(super) fn run(args: &GradeArgs) -> anyhow::Result<ExitCode> {
    let asked = asked(args)?;
    let names = args.names.as_deref().map(Names::open).transpose()?;
    if args.self_score.is_some() && args.files.len() > 1 {
        bail!(
            "--self-score is one learner's own score of one session, found {} files",
            args.files.len()
        );
    }
    if args.revise.is_some() && args.files.len() > 1 {
        bail!(
            "--revise is about one session, found {} files",
            args.files.len()
        );
    }
    let (mut code, mut objects, mut all) = (0u8, Vec::new(), Vec::new());
    let mut unread: Vec<(String, String)> = Vec::new();
    for path in &args.files {
        match one(path, args, &asked) {
            Ok(one) => {
                code = code.max(u8::from(one.graded.grade.score.is_none()));
                if !args.json {
                    say(&text(path, &one, args))?;
                }
                objects.push(json(path, &one));
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
    let sessions = sessions(&all);
    let table = args.csv.as_deref().map(|path| {
        let table = csv(&sessions, &unread, names.as_ref())?;
        std::fs::write(path, table).with_context(|| format!("cannot write `{}`", path.display()))
    });
    let html = args.html.as_deref();
    let pages = html.map(|folder| pages(folder, &all, (&sessions, &unread), names.as_ref(), args));
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
        say(&object.to_string())?;
    }
    Ok(ExitCode::from(code))
}

fn asked(args: &GradeArgs) -> anyhow::Result<Asked> {
    if args.mode == Some(Mode::Exam) {
        no_exam(args)?;
    }
    let signer = args.signer.as_deref().map(PublicKey::from_file_or_hex);
    Ok(Asked {
        rubric: args.rubric.as_deref().map(Rubric::open).transpose()?,
        signer: signer.transpose()?,
    })
}

/// What an exam is not graded with.
fn no_exam(args: &GradeArgs) -> anyhow::Result<()> {
    if args.rubric.is_some() {
        bail!(
            "--rubric is given, expected none in an exam: it is graded by the rubric that was recorded"
        );
    }
    if args.truth {
        bail!(
            "--truth is given, expected not in an exam (to look at one with its learner: --mode practice)"
        );
    }
    Ok(())
}

/// How a recording is graded in this mode.
fn options(asked: &Asked, mode: Mode) -> anyhow::Result<Options> {
    let exam = mode == Mode::Exam;
    let station = || exam.then(PublicKey::of_this_station).flatten();
    let trust = asked.signer.or_else(station);
    if exam && trust.is_none() {
        bail!(
            "--signer is missing, expected the station's public key in an exam (`station.pub` beside its key, on the station in ~/.local/state/sulcus): without it whoever makes a recording can sign it"
        );
    }
    Ok(Options {
        rubric: asked.rubric.clone(),
        trust,
    })
}

/// How a recording is shown.
fn shown(recording: &Recording, args: &GradeArgs) -> anyhow::Result<Shown> {
    let recorded = recording.header().mode;
    let mode = args.mode.or(recorded).unwrap_or_default();
    if mode == Mode::Exam {
        if let Some(other) = recorded.filter(|recorded| *recorded != Mode::Exam) {
            bail!("mode is {other} in the recording, expected exam: what was practised is no exam");
        }
        no_exam(args)?;
    }
    Ok(Shown { mode, recorded })
}

fn one(path: &Path, args: &GradeArgs, asked: &Asked) -> anyhow::Result<One> {
    let recording = Recording::open(path).map_err(|error| at(path, &error))?;
    let named = |error: anyhow::Error| at(path, &*error);
    let shown = shown(&recording, args).map_err(named)?;
    let options = options(asked, shown.mode).map_err(named)?;
    // The learner's own score comes before the program's.
    let kept = Sidecar::read(path).map_err(|error| at(path, &error))?;
    let kept = kept.and_then(|sidecar| sidecar.self_score);
    let given = match (shown.mode, args.self_score.or(kept)) {
        (Mode::SelfAssessment, None) => Some(ask(path)?),
        (_, given) => given,
    };
    // Draws nothing when standard error is no terminal.
    let bar =
        ProgressBar::with_draw_target(Some(recording.facts().rows), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} ticks, {eta} left") {
        bar.set_style(style);
    }
    let graded = grade(&recording, &options, &mut |ticks| bar.set_position(ticks));
    bar.finish_and_clear();
    let graded = graded.map_err(|error| at(path, &error))?;
    let used = graded.grade.rubric.as_ref().map(|used| used.source);
    if shown.mode == Mode::Exam && used.is_some_and(|source| source != Source::Recording) {
        bail!(
            "{}: holds no rubric, expected its own in an exam",
            path.display()
        );
    }
    if args.revise.is_some() && args.passed.is_none() && graded.grade.pass_mark.is_none() {
        bail!(
            "{}: --passed is missing, expected where the recording has no rubric with a pass mark",
            path.display()
        );
    }
    if let Some(own) = given {
        Sidecar::assess(path, &graded.grade, own).map_err(|error| at(path, &error))?;
    }
    let sidecar = match args.revise {
        Some(score) => {
            let given = |text: &Option<String>| text.clone().unwrap_or_default();
            let pass_mark = graded.grade.pass_mark.unwrap_or_default();
            let revision = Revision {
                score,
                passed: args.passed.unwrap_or(score >= pass_mark),
                by: given(&args.by),
                at: given(&args.at),
                reason: given(&args.reason),
            };
            Some(Sidecar::add(path, &graded.grade, revision)?)
        }
        None => Sidecar::read(path)?,
    };
    if let Some(sidecar) = &sidecar {
        sidecar
            .belongs_to(&graded.grade)
            .map_err(|error| at(path, &error))?;
    }
    Ok(One {
        graded,
        sidecar,
        self_score: given,
        shown,
    })
}

/// The learner's own score, from a terminal.
fn ask(path: &Path) -> anyhow::Result<f64> {
    let stdin = std::io::stdin();
    if !stdin.is_terminal() {
        bail!(
            "--self-score is missing, expected 0 to 100 in self-assessment: the own score comes before the grade"
        );
    }
    loop {
        write!(
            std::io::stderr(),
            "Your own score for {}, 0 to 100: ",
            file_name(path)
        )?;
        let mut line = String::new();
        if stdin.read_line(&mut line)? == 0 {
            bail!("--self-score is missing, expected 0 to 100 in self-assessment");
        }
        match points(line.trim()) {
            Ok(score) => return Ok(score),
            Err(why) => writeln!(std::io::stderr(), "{why}")?,
        }
    }
}

fn text(path: &Path, one: &One, args: &GradeArgs) -> String {
    let exam = one.shown.mode == Mode::Exam;
    let grade = &one.graded.grade;
    let mut lines = vec![path.display().to_string()];
    lines.push(format!("  mode       {}", one.shown.words()));
    if let (Some(own), Some(score)) = (one.self_score, grade.score) {
        lines.push(format!(
            "  own score  {own:.1}, {:+.1} against the program's",
            own - score
        ));
    }
    lines.push(grade.text(exam, args.truth));
    if let Some(sidecar) = &one.sidecar {
        for said in &sidecar.revisions {
            lines.push(format!(
                "  REVISED    {:.1}, {}, by {} at {}: {}",
                said.score,
                if said.passed { "passed" } else { "not passed" },
                said.by.escape_debug(),
                said.at.escape_debug(),
                said.reason.escape_debug()
            ));
        }
    }
    lines.push(String::new());
    lines.join("\n")
}

/// What of a zone tells how deep it is, or was to be: not in an exam.
const TELLS: [&str; 7] = [
    "truth_mm",
    "recession_truth_mm",
    "measured_mm",
    "deepest_mm",
    "shown_mm",
    "bled",
    "finding",
];

fn json(path: &Path, one: &One) -> Value {
    let mut json = object(one.graded.grade.to_json());
    if one.shown.mode == Mode::Exam {
        json.remove("advice");
        let sites = json.get_mut("sites").and_then(Value::as_array_mut);
        for site in sites.into_iter().flatten().filter_map(Value::as_object_mut) {
            for tells in TELLS {
                site.remove(tells);
            }
        }
    }
    json.insert("file".into(), json!(file_name(path)));
    json.insert("mode".into(), json!(one.shown.mode));
    json.insert("recorded_mode".into(), json!(one.shown.recorded));
    json.insert("self_score".into(), json!(one.self_score));
    let revisions = one.sidecar.as_ref().map(|sidecar| &sidecar.revisions);
    json.insert(
        "revisions".into(),
        json!(revisions.map_or(&[][..], Vec::as_slice)),
    );
    Value::Object(json)
}

fn sessions(all: &[(String, One)]) -> Vec<Session> {
    let session = |(file, one): &(String, One)| Session {
        file: file.clone(),
        grade: one.graded.grade.clone(),
        sidecar: one.sidecar.clone(),
        self_score: one.self_score,
        shown: one.shown,
        attempt: 0,
    };
    let sessions: Vec<Session> = all.iter().map(session).collect();
    let mut once: Vec<Session> = Vec::new();
    for session in sessions {
        match once.iter().find(|other| other.is(&session)) {
            Some(other) => eprintln!(
                "{}: is the session of {}, counted once",
                session.file, other.file
            ),
            None => once.push(session),
        }
    }
    number_attempts(&mut once);
    once
}

fn pages(
    folder: &Path,
    all: &[(String, One)],
    (sessions, unread): (&[Session], &[(String, String)]),
    names: Option<&Names>,
    args: &GradeArgs,
) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder)
        .with_context(|| format!("cannot make the folder `{}`", folder.display()))?;
    let look = Look {
        names,
        numbering: match args.numbering {
            Numbers::Fdi => Numbering::Fdi,
            Numbers::Universal => Numbering::Universal,
        },
        truth: args.truth,
    };
    let mut used = BTreeSet::from(["class".to_owned()]);
    let write = |name: &str, page: String| {
        let path = folder.join(format!("{name}.html"));
        std::fs::write(&path, page).with_context(|| format!("cannot write `{}`", path.display()))
    };
    for (file, one) in all {
        let stem = file.strip_suffix(".mcap").unwrap_or(file);
        let mut name = stem.to_owned();
        let mut k = 2;
        while !used.insert(name.clone()) {
            name = format!("{stem}-{k}");
            k += 1;
        }
        let own = sessions.iter().find(|session| {
            session.file == *file
                && session.grade.started_unix_ns == one.graded.grade.started_unix_ns
        });
        if let Some(session) = own {
            write(&name, student_page(session, &one.graded, &look))?;
        }
    }
    write("class", class_page(sessions, unread, &look))?;
    eprintln!("pages in {}", folder.display());
    Ok(())
}

/// Without its folder: a grade is the same wherever the recording lies.
fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
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
