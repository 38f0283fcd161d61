//! Grade of one recording: mode, the learner's own score, grade, revisions.

use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};

use anyhow::bail;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use sulcus_program::{PathText, tell};

use super::args::{GradeArgs, file_name, points};
use super::sessions::SessionFiles;
use crate::cli::inputs::open;
use crate::cli::print::at;
use crate::grade::class::Shown;
use crate::grade::report::Source;
use crate::grade::revision::{Proposal, Revision, RevisionError, Sidecar};
use crate::grade::{Graded, Options, Rubric, grade_session};
use crate::pages::moments::{Moment, moments};
use crate::record::key::PublicKey;
use crate::record::mode::Mode;
use crate::record::read::Recording;

/// Grade of one recording, with the scores of people.
pub(super) struct One {
    /// Path of the recording, of several the last.
    pub path: PathBuf,
    pub graded: Graded,
    pub sidecar: Option<Sidecar>,
    pub self_score: Option<f64>,
    pub shown: Shown,
    /// Moments that explain the grade.
    pub moments: Vec<Moment>,
    /// Reason why a score of a person could not be kept.
    pub unkept: Option<anyhow::Error>,
}

/// Options of the grades of all recordings.
pub(super) struct Asked {
    rubric: Option<Rubric>,
    /// Key given by `--signer`.
    signer: Option<PublicKey>,
}

impl Asked {
    pub fn of(args: &GradeArgs) -> anyhow::Result<Self> {
        if args.mode == Some(Mode::Exam) {
            no_exam(args)?;
        }
        let signer = args.signer.as_deref().map(PublicKey::from_file_or_hex);
        Ok(Self {
            rubric: args.rubric.as_deref().map(Rubric::open).transpose()?,
            signer: signer.transpose()?,
        })
    }

    /// Options of a grade in this mode.
    fn options(&self, mode: Mode) -> anyhow::Result<Options> {
        let exam = mode == Mode::Exam;
        let station = || exam.then(PublicKey::of_this_station).flatten();
        let trust = self.signer.or_else(station);
        if exam && trust.is_none() {
            bail!(
                "--signer is missing, expected the station's public key in an exam (`station.pub` beside its key, on the station in $SULCUS_STATE_DIR, else ~/.local/state/sulcus): without a trusted key any person could sign a recording"
            );
        }
        Ok(Options {
            rubric: self.rubric.clone(),
            trust,
        })
    }
}

/// Refuses options that an exam does not allow.
fn no_exam(args: &GradeArgs) -> anyhow::Result<()> {
    if args.rubric.is_some() {
        bail!("--rubric is given, expected no rubric in an exam: the recorded rubric counts");
    }
    if args.truth {
        bail!(
            "--truth is given, expected outside of exams; for a talk with the learner afterwards: --mode practice"
        );
    }
    Ok(())
}

/// Mode in which a recording is shown.
fn shown(recording: &Recording, args: &GradeArgs) -> anyhow::Result<Shown> {
    let recorded = recording.header().mode;
    let mode = args.mode.or(recorded).unwrap_or_default();
    if mode == Mode::Exam {
        if let Some(other) = recorded.filter(|recorded| *recorded != Mode::Exam) {
            bail!(
                "mode is {other} in the recording, expected exam: a session of another mode cannot be an exam"
            );
        }
        no_exam(args)?;
    }
    if args.self_score.is_some() && mode != Mode::SelfAssessment {
        bail!("--self-score is given in mode {mode}, expected mode self-assessment");
    }
    Ok(Shown { mode, recorded })
}

/// Grades one session.
///
/// # Errors
/// The recording cannot be graded with these options, or the file beside it belongs to another grade.
pub(super) fn one(session: &SessionFiles, args: &GradeArgs, asked: &Asked) -> anyhow::Result<One> {
    let path = session.last.as_path();
    let recording = open(path)?;
    let before: Vec<Recording> = session
        .before
        .iter()
        .map(|path| open(path))
        .collect::<Result<_, _>>()?;
    let before: Vec<&Recording> = before.iter().collect();
    let named = |error: anyhow::Error| at(path, &*error);
    let shown = shown(&recording, args).map_err(named)?;
    let options = asked.options(shown.mode).map_err(named)?;
    // The learner's own score precedes the program's score.
    let kept = Sidecar::read(path).map_err(|error| at(path, &error))?;
    let kept = kept.and_then(|sidecar| sidecar.self_score);
    if let (Some(kept), Some(given)) = (kept, args.self_score)
        && (kept - given).abs() > 0.0
    {
        let first = RevisionError::another(given, kept);
        return Err(at(path, &first));
    }
    let given = match (shown.mode, kept.or(args.self_score)) {
        (Mode::SelfAssessment, None) => Some(ask(path).map_err(named)?),
        (_, given) => given,
    };
    let revision = args.revise.map(|score| Revision {
        score,
        passed: args.passed.unwrap_or_default(),
        by: args.by.clone().unwrap_or_default(),
        at: args.at.clone().unwrap_or_default(),
        reason: args.reason.clone().unwrap_or_default(),
    });
    let checked = revision.as_ref().map_or(Ok(()), Revision::check);
    checked.map_err(|error| at(path, &error))?;
    // The bar draws nothing if standard error is no terminal.
    let rows = |of: &&Recording| of.facts().rows;
    let rows = recording.facts().rows + before.iter().map(rows).sum::<u64>();
    let bar = ProgressBar::with_draw_target(Some(rows), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} ticks, {eta} left") {
        bar.set_style(style);
    }
    let graded = grade_session(&recording, &before, &options, &mut |ticks| {
        bar.set_position(ticks)
    });
    bar.finish_and_clear();
    let graded = graded.map_err(|error| at(path, &error))?;
    let used = graded.grade.rubric.as_ref();
    if let Some(used) =
        used.filter(|used| shown.mode == Mode::Exam && used.source != Source::Recording)
    {
        bail!(
            "{}: rubric is {}, expected the recording's own in an exam",
            path.shown(),
            used.source.words()
        );
    }
    if let Some(used) =
        used.filter(|used| used.source == Source::File && used.name != graded.grade.exercise)
    {
        tell!(
            "warning: {}: rubric `{}` is for another exercise than `{}`",
            path.shown(),
            used.name.escape_debug(),
            graded.grade.exercise.escape_debug()
        );
    }
    if args.revise.is_some() && args.passed.is_none() && graded.grade.pass_mark.is_none() {
        bail!(
            "{}: --passed is missing, expected true or false for a recording without a pass mark",
            path.shown()
        );
    }
    let moments = moments(&recording, &graded, shown.mode == Mode::Exam);
    let moments = moments.map_err(|error| at(path, &error))?;
    let mut one = One {
        path: path.to_owned(),
        graded,
        sidecar: None,
        self_score: given,
        shown,
        moments,
        unkept: None,
    };
    // The grade is shown even if a score cannot be kept.
    let kept = one.keep(path, revision.map(|said| one.judged(said, args.passed)));
    one.unkept = kept.err().map(|error| {
        let advice = match error {
            RevisionError::File { .. } => {
                ": to keep the score, grade a copy of the recording in a folder with write permission"
            }
            RevisionError::Field { .. } => "",
        };
        anyhow::anyhow!("{}: {error}{advice}", path.shown())
    });
    let sidecar = Sidecar::read(path).map_err(|error| at(path, &error))?;
    if let Some(sidecar) = &sidecar {
        let belongs = sidecar.belongs_to(&Proposal::of(&one.graded.grade));
        belongs.map_err(|error| at(path, &error))?;
    }
    one.sidecar = sidecar;
    Ok(one)
}

impl One {
    /// Revision with `passed` by the option, else by the rubric's pass mark.
    fn judged(&self, said: Revision, passed: Option<bool>) -> Revision {
        let pass_mark = self.graded.grade.pass_mark.unwrap_or_default();
        Revision {
            passed: passed.unwrap_or(said.score >= pass_mark),
            ..said
        }
    }

    /// Keeps the scores of people beside the recording.
    fn keep(&self, path: &Path, revision: Option<Revision>) -> Result<(), RevisionError> {
        let grade = &self.graded.grade;
        // A session without a grade gets no own score.
        if let Some(own) = self.self_score.filter(|_| grade.score.is_some()) {
            Sidecar::assess(path, &Proposal::of(grade), own)?;
        }
        if let Some(revision) = revision {
            Sidecar::add(path, &Proposal::of(grade), revision)?;
        }
        Ok(())
    }
}

/// Learner's own score, from a terminal.
fn ask(path: &Path) -> anyhow::Result<f64> {
    let stdin = std::io::stdin();
    if !stdin.is_terminal() {
        bail!(
            "--self-score is missing, expected 0 to 100 in self-assessment: the own score precedes the grade"
        );
    }
    loop {
        tell!("Your own score for {}, 0 to 100:", file_name(path));
        let mut line = String::new();
        if stdin.read_line(&mut line)? == 0 {
            bail!("--self-score is missing, expected 0 to 100 in self-assessment");
        }
        match points(line.trim()) {
            Ok(score) => return Ok(score),
            Err(why) => tell!("{why}"),
        }
    }
}
